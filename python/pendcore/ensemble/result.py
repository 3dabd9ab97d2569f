"""What an ensemble found: arrays with the members' axes first."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore.ensemble.members import Members
from pendcore.messages.arguments import Floats

OF_THE_WHOLE = ("workers", "time_limit", "check", "progress")
"""The options of an ensemble that are none of its members."""


class EnsembleResult:
    """An ensemble without what is built on it; `pendcore.Ensemble` has the rest.

    Attributes
    ----------
    members : Members
        What was run.
    t_span : (float, float)
        s.
    options : dict
        What `ensemble` was given by name, beside what is kept.
    codes : ndarray of uint8, (...)
        The statuses as numbers, in the order of ``pendcore._core.member_statuses``.
    statistics : dict
        The work of all members.
    ending : str
        ``"finished"``, or what ended the whole: ``"time_limit"``, ``"interrupted"``.
    """

    __slots__ = (
        "_first", "_states", "_t", "codes", "ending", "members", "options",
        "reducers", "statistics", "t_eval", "t_span",
    )  # fmt: skip

    def __init__(
        self,
        members: Members,
        t_span: tuple[float, float],
        options: dict[str, Any],
        t_eval: Floats | None,
        reducers: dict[str, int],
        event_count: int,
    ) -> None:
        self.members, self.t_span, self.options, self.t_eval = members, t_span, options, t_eval
        self.reducers = reducers
        """The name of each reducer, and the number of its event."""
        shape, n = members.shape, len(members.scene.links)
        times = () if t_eval is None else t_eval.shape
        not_run = _core.member_statuses.index("not_run")
        self.codes: npt.NDArray[np.uint8] = np.full(shape, not_run, dtype=np.uint8)
        self._t = np.full(shape, np.nan)
        self._states = np.full((*shape, *times, 2 * n), np.nan)
        self._first = np.full((*shape, event_count), np.nan) if reducers else None
        self.statistics: dict[str, Any] = {}
        self.ending = "finished"

    @property
    def shape(self) -> tuple[int, ...]:
        """The shape of the ensemble: the leading axes of starts and parameters, broadcast."""
        return self.members.shape

    @property
    def t(self) -> Floats:
        """The time that each member reached, s, (...); with ``keep="times"`` the times, (n_t,)."""
        return self._t if self.t_eval is None else self.t_eval

    @property
    def q(self) -> Floats:
        """The angles of each member at its end, rad, (..., n), or at the times, (..., n_t, n)."""
        return self._states[..., : len(self.members.scene.links)]

    @property
    def qd(self) -> Floats:
        """The rates there, rad/s, with the shape of ``q``."""
        return self._states[..., len(self.members.scene.links) :]

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
        if name not in self.reducers or self._first is None:
            known = ", ".join(map(repr, self.reducers)) or "none were kept"
            raise KeyError(f"no reducer is called {name!r}: {known}")
        return self._first[..., self.reducers[name]]

    def options_of_members(self) -> dict[str, Any]:
        """Return the options as `simulate` takes them.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 1), rtol=1e-6)
        >>> found.options_of_members()["rtol"]
        1e-06
        """
        return {name: value for name, value in self.options.items() if name not in OF_THE_WHOLE}

    def counts(self) -> dict[str, int]:
        """Return how many members have each status that occurs.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), q0=np.zeros((3, 2)), t_span=(0, 1))
        >>> found.counts()
        {'finished': 3}
        """
        found = np.bincount(self.codes.ravel(), minlength=len(_core.member_statuses))
        pairs = zip(_core.member_statuses, found.tolist(), strict=True)
        return {name: count for name, count in pairs if count}

    def __len__(self) -> int:
        return self.members.count

    def __str__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in self.counts().items()) or "none"
        begin, end = self.t_span
        lines = [f"{len(self)} members {self.shape}, t = {begin:g} to {end:g} s: {told}"]
        lines += [f"varied: {name}" for name in self.members.vary]
        for name in self.reducers:
            found = self[name]
            some = found[np.isfinite(found)]
            span = f"{some.min():.6g} to {some.max():.6g} s" if some.size else "in none"
            lines.append(f"{name}: in {some.size} of {found.size}, {span}")
        if self.statistics:
            steps = self.statistics["accepted"]
            lines.append(f"{steps} steps, {self.statistics['nfev']} right-hand sides or series")
        return "\n".join(lines)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} members {self.shape}>"


def run_members(
    result: EnsembleResult, workers: int, time_limit: float, progress: Any
) -> BaseException | None:
    """Run all members, and return the exception that broke it off, if there was one."""
    members = result.members
    shape, vary = members.shape, members.vary
    values = np.stack([*vary.values()], axis=-1) if vary else np.empty((*shape, 0))
    given = result.options_of_members() | {
        "store": "end" if result.t_eval is None else "times",
        "t_eval": result.t_eval,
        "events": [event._as_pair() for event in result.options["events"]],
    }
    result.ending, result.statistics, error = _core.ensemble(
        members.scene._compiled, shape, members.q0, members.qd0, list(vary), values,
        *result.t_span, given, workers, time_limit, progress,
        result.codes, result._t, result._states, result._first,
    )  # fmt: skip
    return error
