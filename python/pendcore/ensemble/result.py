"""What an ensemble found: arrays with the members' axes first."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.ensemble.members import Members
from pendcore.ensemble.request import Request
from pendcore.ensemble.states import Quantity, quantity_of_states
from pendcore.messages.arguments import Floats
from pendcore.messages.html import table
from pendcore.run.energy import Energy


class EnsembleResult:
    """An ensemble without what is built on it; `pendcore.Ensemble` has the rest.

    Attributes
    ----------
    members : Members
        What was run.
    request : Request
        What was asked of each.
    arrays : mapping
        Name to array, in memory or in a store, by the names of `Request.variables`.
    statistics : dict
        The work of all members that this call ran; empty where it is not known.
    ending : str
        ``"finished"``, or what ended the whole: ``"time_limit"``, ``"interrupted"``.
    """

    __slots__ = ("arrays", "ending", "members", "request", "statistics")

    def __init__(
        self,
        members: Members,
        request: Request,
        arrays: Mapping[str, Any],
        ending: str = "finished",
        statistics: dict[str, Any] | None = None,
    ) -> None:
        self.members, self.request, self.arrays = members, request, arrays
        self.ending, self.statistics = ending, statistics or {}

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the ensemble: the leading axes of starts and parameters, broadcast."""
        return self.members.shape

    @property
    def codes(self) -> npt.NDArray[np.uint8]:
        """The statuses as numbers, in the order of ``pendcore._core.member_statuses``, (...)."""
        return np.asarray(self.arrays["status"][...])

    @property
    def t_reached(self) -> Floats:
        """The time that each member reached, s, (...)."""
        return self._read("t_reached")

    @property
    def t(self) -> Floats:
        """The time that each member reached, s, (...); with ``keep="times"`` the times, (n_t,)."""
        return self.t_reached if self.request.t_eval is None else self.request.t_eval

    @property
    def q(self) -> Floats:
        """The angles of each member at its end, rad, (..., n), or at the times, (..., n_t, n)."""
        return self._read("q")

    @property
    def qd(self) -> Floats:
        """The rates there, rad/s, with the shape of ``q``."""
        return self._read("qd")

    @property
    def status(self) -> npt.NDArray[np.str_]:
        """The status of each member, as in `Solution`, or ``"refused"`` or ``"not_run"``, (...)."""
        return np.array(_core.member_statuses)[self.codes]

    @property
    def success(self) -> npt.NDArray[np.bool_]:
        """Whether each member reached its goal, (...)."""
        return np.array(_core.member_successes)[self.codes]

    @property
    def failed(self) -> npt.NDArray[np.intp]:
        """The indices of the members that did not, a row each, (k, axes)."""
        return np.argwhere(~self.success)

    def __getitem__(self, name: str) -> Floats:
        """Return what a reducer of ``keep`` found, (...)."""
        if name not in self.request.reducers:
            known = ", ".join(map(repr, self.request.reducers)) or "none were kept"
            raise KeyError(f"no reducer is called {name!r}: {known}")
        return self._read(name)

    def _read(self, name: str) -> Floats:
        """Return an array by the name that it has in ``arrays``."""
        return np.asarray(self.arrays[name][...])

    def energy(self) -> Energy:
        """Return kinetic, potential and total energy of the kept states, J, each (...).

        They are those of each member's own scene, and NaN where a member was refused or not run.
        With ``keep="times"`` they are (..., n_t). With varied parameters, the scene of each member
        is made anew.

        Examples
        --------
        >>> found = pc.ensemble(
        ...     pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 5), vary={"gravity": [9.8, 1.62]}
        ... )
        >>> found.energy().total.round(4)
        array([-11.1708,  -1.8466])
        """
        both = self._of_states(lambda scene, *state: np.stack(scene.energy(*state), axis=-1))
        kinetic, potential = both[..., 0], both[..., 1]
        with np.errstate(all="ignore"):  # the energies of a blow-up may be infinite
            return Energy(kinetic, potential, kinetic + potential)

    def positions(self) -> Floats:
        """Return pivot, joints and tip of the kept states, m, (..., n+1, 2): x right, y down.

        With ``keep="times"`` they are (..., n_t, n+1, 2). The rest is as for `energy`.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> found.positions()[:, -1].round(3)  # the tips
        array([[1.611, 1.18 ],
               [1.555, 1.163]])
        """
        return self._of_states(lambda scene, t, q, qd: scene.positions(t, q))

    def _of_states(self, quantity: Quantity) -> Floats:
        return quantity_of_states(quantity, self.members, self.t, self.q, self.qd)

    def counts(self) -> dict[str, int]:
        """Return how many members have each status that occurs.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 1), np.zeros((3, 2)))
        >>> found.counts()
        {'finished': 3}
        """
        codes = self.codes
        found = [int(np.count_nonzero(codes == i)) for i in range(len(_core.member_statuses))]
        pairs = zip(_core.member_statuses, found, strict=True)
        return {name: count for name, count in pairs if count}

    def __len__(self) -> int:
        return self.members.count

    def __str__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in self.counts().items()) or "none"
        begin, end = self.request.t_span
        lines = [f"{len(self)} members {self.shape}, t = {begin:g} to {end:g} s: {told}"]
        lines += [f"varied: {name}" for name in self.members.vary]
        for name, reducer in self.request.reducers.items():
            if reducer.labels(1):
                continue
            found = self[name]
            some = found[np.isfinite(found)]
            span = (
                f"{some.min():.6g} to {some.max():.6g} {reducer.unit}" if some.size else "in none"
            )
            lines.append(f"{name}: in {some.size} of {found.size}, {span}")
        if self.statistics:
            steps = self.statistics["accepted"]
            lines.append(f"{steps} steps, {self.statistics['nfev']} right-hand sides or series")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return table([("", line) for line in str(self).split("\n")])

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} members {self.shape}>"
