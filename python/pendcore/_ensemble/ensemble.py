"""What an ensemble found: arrays with the members' axes first, and what can be made of them."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from contextlib import suppress
from operator import index as whole
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._ensemble.members import Members, coordinates, member_axes
from pendcore._ensemble.request import NOT_RUN, Request
from pendcore._messages.arguments import Floats
from pendcore._messages.html import table
from pendcore._messages.progress import Progress
from pendcore._messages.warning import silence
from pendcore._run.energy import Energy
from pendcore._run.solution import Solution
from pendcore.reducers import Sensitivities

if TYPE_CHECKING:
    import xarray as xr

Quantity = Callable[[_core.Scene, Floats, Floats, Floats], Floats]
"""A quantity of k states of one scene, (k, ...), from times (k,), angles and rates (k, n)."""


class Ensemble:
    """The result of `ensemble`: arrays whose first axes are those of the members.

    Its arrays are ``q`` and ``qd``, ``t_reached``, ``status``, ``success`` and ``failed``; those of
    a reducer have its name, ``found["name"]``.

    Attributes
    ----------
    arrays : mapping of str to array
        The same arrays by name, as `save` writes them. Those of a store read from the disk when
        they are indexed.
    ending : {"finished", "time_limit", "interrupted"}
        How the ensemble as a whole ended.
    members, request
        The scene with all starts and values, and what was asked of each member.
    statistics : dict
        The sums over the members of what their runs took, as in `Statistics`.

    Examples
    --------
    >>> scene, masses = pc.Scene.textbook(), np.linspace(0.5, 1.5, 5)
    >>> found = pc.ensemble(scene, (0, 5), [0.5, 1.0], vary={"link[2].mass": masses})
    >>> found.q.shape, found.success.all()
    ((5, 2), np.True_)
    >>> one = found.member(3)  # a Solution, with the same bits
    >>> np.array_equal(one.q[-1], found.q[3])
    True
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
            one = "" if isinstance(name, str) else f"; a member is found.member({name!r})"
            raise KeyError(f"no reducer is called {name!r}: {known}{one}")
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
        >>> scene, vary = pc.Scene.textbook(), {"gravity": [9.8, 1.62]}
        >>> found = pc.ensemble(scene, (0, 5), [0.5, 1.0], vary=vary)
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
        """Return a quantity of every state that was kept; NaN where a member was refused."""
        members, q, qd = self.members, self.q, self.qd
        axes, n = q.shape[:-1], q.shape[-1]
        times = np.broadcast_to(self.t, axes)

        def computed(scene: _core.Scene, t: Floats, angles: Floats, rates: Floats) -> Floats:
            found = quantity(scene, t.reshape(-1), angles.reshape(-1, n), rates.reshape(-1, n))
            return found.reshape(*t.shape, *found.shape[1:])

        if not members.vary:
            values = computed(members.scene._compiled, times, q, qd)
        else:
            one = computed(members.scene._compiled, np.zeros(1), np.zeros((1, n)), np.zeros((1, n)))
            values = np.full((*axes, *one.shape[1:]), np.nan)
            with silence():  # of implausible parameters
                for place in np.ndindex(members.shape):
                    with suppress(ValueError):  # it was refused
                        scene = members.scene_of(place)
                        values[place] = computed(scene._compiled, times[place], q[place], qd[place])
        values[np.isnan(q).any(axis=-1)] = np.nan  # positions() has a pivot even without a state
        return values

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

    def member(self, index: Any) -> Solution:
        """Return the run of one member as a full `Solution`, with the bits that it had.

        With `reducers.Sensitivities` it has its sensitivities, and warns if there are none.

        Parameters
        ----------
        index : int, tuple of int, or a row of ``failed``
            Which member.

        Raises
        ------
        ValueError
            If the member was refused: the message says why.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> sol = found.member(1)
        >>> sol.status, np.array_equal(sol.q[-1], found.q[1])
        ('finished', True)
        """
        from pendcore._api.simulate import simulate

        place = _place(index, self.shape)
        scene = self.members.scene_of(place)
        q0, qd0 = self.members.q0[place], self.members.qd0[place]
        return simulate(
            scene, self.request.t_span, q0, qd0, t_eval=self.request.t_eval, on_failure="ignore",
            sensitivities=self.request.sensitivity_names, **self.request.of_simulate(),
        )  # fmt: skip

    def message(self, index: Any) -> str:
        """Return what the run of one member says of its end, or why it was refused.

        The member is run again, because an ensemble keeps no texts.

        Examples
        --------
        >>> scene, starts = pc.Scene.textbook(), [[0.5, np.nan]]
        >>> found = pc.ensemble(scene, (0, 5), starts, on_failure="ignore")
        >>> found.message(0)
        'q0[1] = nan: must be finite (rad)'
        """
        if self.codes[_place(index, self.shape)] == NOT_RUN:
            return "was not run: .rerun() runs it, and with a store the same call of pc.ensemble"
        try:
            return self.member(index).message
        except ValueError as refusal:
            return str(refusal)

    def rerun(self, **options: Any) -> Ensemble:
        """Run the members that failed once more, along one axis, with other options.

        Parameters
        ----------
        **options
            As in `ensemble`; what is not given stays.

        Returns
        -------
        Ensemble
            Member k is the one at ``failed[k]``.

        Examples
        --------
        >>> scene, starts = pc.Scene.textbook(), [[0.1, 0.1], [1.5, 1.5]]
        >>> how = {"max_steps": 60, "on_failure": "ignore"}
        >>> short = pc.ensemble(scene, (0, 9), starts, **how)
        >>> print(short.status, short.rerun(max_steps=1000).status)
        ['max_steps' 'finished'] ['finished']
        """
        from pendcore._ensemble.whole_run import execution, run_ensemble

        own = [name for name in self.request.options if name != "events"]
        of_members = {name: options.pop(name) for name in own if name in options}
        how = execution("rerun", options, own)
        places = np.flatnonzero(~self.success)
        request = self.request.with_options(**of_members)
        return run_ensemble(self.members.selected(places), request, how)

    def second(self, **options: Any) -> Ensemble:
        """Run the same members once more, independently, to see which of them are resolved.

        Another method runs them at a hundredth of the tolerances, with constants and starts that
        are some last bits off. If events are looked for, Taylor series are kept: their order and
        their steps are others at the other tolerances.

        Parameters
        ----------
        **options
            As in `ensemble`, from ``workers`` on.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> bool(np.abs(found.second().q - found.q).max() < 1e-6)
        True
        """
        from pendcore._ensemble.trust import second
        from pendcore._ensemble.whole_run import execution, run_ensemble

        how = execution("second", options)
        return run_ensemble(*second(self), how)

    def resolved(
        self,
        other: Ensemble | None = None,
        *,
        name: str | None = None,
        within: float | None = None,
        progress: Progress = None,
    ) -> npt.NDArray[np.bool_]:
        """Return which members have a value that a second, independent ensemble confirms, (...).

        Parameters
        ----------
        other : Ensemble, optional
            The second one, of the same shape, links, times and reducers. Default: it is run now,
            see `second`.
        name : str, optional
            A reducer, or ``"q"`` or ``"qd"``. Default: the first reducer, or ``"q"``. An energy
            drift counts as resolved where the angles at the end are.
        within : float, optional
            How far the two may differ. Default: 1 % of the time of an event, a tenth of the largest
            exponent, and else 0.1 rad or rad/s.
        progress : as in `ensemble`

        Raises
        ------
        TypeError, ValueError
            If ``other`` was asked for something else, or for a name or a limit that cannot be.

        Examples
        --------
        >>> found = pc.ensemble(  # the second start is chaotic
        ...     pc.Scene.textbook(), q0=[[1.5, 1.5], [0.0, 0.0]], t_span=(0, 60)
        ... )
        >>> found.resolved()
        array([ True, False])
        """
        from pendcore._ensemble.trust import resolved

        return resolved(self, other, name, within, progress)

    def plot(
        self,
        what: str | None = None,
        ax: Any = None,
        *,
        resolved: npt.ArrayLike | None = None,
        **properties: Any,
    ) -> list[Any]:
        """Draw values of the members: a curve over one axis, or a map over two, with units.

        Parameters
        ----------
        what : str, optional
            A reducer with one number for each member, or a component of the end state: ``"q[1]"``,
            ``"qd[2]"``. Default: the first such reducer, or ``"q[1]"``.
        ax : Axes, optional
            Default: those of a new figure of pyplot's, which is not shown.
        resolved : array_like of bool, (...), optional
            What `resolved` found: what is not resolved is hatched in red.
        **properties
            Passed on to matplotlib's ``pcolormesh`` or ``plot``.

        Returns
        -------
        list
            What was drawn.

        Examples
        --------
        >>> plane = np.meshgrid([0.5, 1.0, 1.5], [0.0, 1.0], indexing="ij")
        >>> q0 = np.stack(plane, axis=-1)
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), q0)
        >>> [image] = found.plot("q[2]")
        >>> image.axes.get_xlabel()
        '$q_{1}(0)$ (rad)'
        """
        from pendcore.plotting.map import plot

        return plot(self, what, ax, resolved, properties)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Write everything to a file of NumPy's npz format; see `pendcore.load`.

        The file has just that name, and is complete or absent. Zarr stores are written while an
        ensemble is computed: ``pc.ensemble(store="two.zarr")``.

        Raises
        ------
        ValueError
            If the name ends in ``.zarr``.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), [[0.5, 1.0], [0.6, 1.0]])
        >>> found.save("two.npz")
        >>> np.array_equal(pc.load("two.npz").q, found.q)
        True
        """
        from pendcore._ensemble.archive import save

        save(self, path)

    def to_xarray(self) -> xr.Dataset:
        """Return everything as a data set of xarray, with units.

        The members' axes are ``member_0``, ``member_1``, ...; starts and varied parameters are
        coordinates along the axes on which they depend.

        Raises
        ------
        ImportError
            If xarray is not installed.

        Examples
        --------
        >>> scene, vary = pc.Scene.textbook(), {"gravity": [9.8, 1.62]}
        >>> found = pc.ensemble(scene, (0, 5), [0.5, 1.0], vary=vary)
        >>> found.to_xarray().sizes["member_0"]
        2
        """
        try:
            import xarray as xr
        except ImportError:
            raise ImportError("to_xarray() needs xarray: pip install xarray") from None
        axes, request = member_axes(self.shape), self.request
        data: dict[str, Any] = {}
        starts = coordinates(self.members)
        coords: dict[str, Any] = {x.name: (x.axes, x.values, {"units": x.unit}) for x in starts}
        for one in request.variables(len(self.members.scene.links)):
            values = self.status if one.name == "status" else self._read(one.name)
            data[one.name] = ([*axes, *one.labels], values, {"units": one.unit} if one.unit else {})
            coords |= {axis: list(labels) for axis, labels in one.labels.items()}
        if request.t_eval is not None:
            coords["time"] = ("time", request.t_eval, {"units": "s"})
        told = {"scene": repr(self.members.scene), "t_span": list(request.t_span),
                "pendcore": _core.__version__}  # fmt: skip
        return xr.Dataset(data, coords=coords, attrs=told)

    def __len__(self) -> int:
        return self.members.count

    def __str__(self) -> str:
        told = ", ".join(f"{count} {name}" for name, count in self.counts().items()) or "none"
        begin, end = self.request.t_span
        lines = [f"{len(self)} members {self.shape}, t = {begin:g} to {end:g} s: {told}"]
        lines += [f"varied: {name}" for name in self.members.vary]
        for name, one in self.request.reducers.items():
            if isinstance(one, Sensitivities):
                has_all = np.isfinite(self[name]).all(axis=(-2, -1))
                lines.append(f"{name}: in {np.count_nonzero(has_all)} of {len(self)}")
            if one.axes:
                continue
            found = self[name]
            some = found[np.isfinite(found)]
            span = f"{some.min():.6g} to {some.max():.6g} {one.unit}" if some.size else "in none"
            lines.append(f"{name}: in {some.size} of {found.size}, {span}")
        if self.statistics:
            steps = self.statistics["accepted"]
            lines.append(f"{steps} steps, {self.statistics['nfev']} right-hand sides or series")
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        return table([("", line) for line in str(self).split("\n")])

    def __repr__(self) -> str:
        return f"<{type(self).__name__} of {len(self)} members {self.shape}>"


def _place(given: Any, shape: tuple[int, ...]) -> tuple[int, ...]:
    """Return an index of a member as a tuple."""
    place: tuple[int, ...]
    try:
        try:
            place = (whole(given),)
        except TypeError:
            place = tuple(whole(one) for one in given)
        if len(place) != len(shape):
            raise TypeError
    except TypeError:
        raise TypeError(
            f"index = {given!r}: must be {len(shape)} whole numbers: the ensemble has the shape "
            f"{shape}"
        ) from None
    for axis, (i, size) in enumerate(zip(place, shape, strict=True)):
        if not -size <= i < size:
            raise IndexError(f"index[{axis}] = {i}: must be below {size}: the shape is {shape}")
    return place
