"""Many runs of one scene: the call, and what it returns."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import inf
from operator import index as whole
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore.api.scene import Scene
from pendcore.api.simulate import simulate
from pendcore.api.solution import Solution
from pendcore.ensemble.export import to_xarray
from pendcore.ensemble.keep import USUAL_NAMES, FirstEvent, Reducer
from pendcore.ensemble.members import Members, members_of
from pendcore.ensemble.result import OF_THE_WHOLE, EnsembleResult, run_members
from pendcore.messages.arguments import (
    known_keywords,
    numbers,
    time_limit_of,
    time_span,
    whole_number,
)
from pendcore.messages.progress import Progress, callback, close
from pendcore.messages.warning import PendcoreWarning, warn
from pendcore.run.events import Event, events_asked_for
from pendcore.run.options import RUN_DEFAULTS
from pendcore.run.run_error import require_check
from pendcore.scene.scene import require_start

if TYPE_CHECKING:
    import xarray as xr

Keep = str | Reducer | Mapping[str, Reducer]
_KEEPS = '"end", "times", a reducer of pendcore.keep, or a dictionary of reducers'


class Ensemble(EnsembleResult):
    """The result of `ensemble`: arrays whose first axes are those of the members.

    Examples
    --------
    >>> masses = np.linspace(0.5, 1.5, 5)
    >>> found = pc.ensemble(
    ...     pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 5), vary={"link[2].mass": masses}
    ... )
    >>> found.q.shape, found.success.all()
    ((5, 2), np.True_)
    >>> one = found.member(3)  # a Solution, with the same bits
    >>> np.array_equal(one.q[-1], found.q[3])
    True
    """

    __slots__ = ()

    @known_keywords
    def member(self, index: Any) -> Solution:
        """Return the run of one member as a full `Solution`, with the bits that it had.

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
        >>> found = pc.ensemble(pc.Scene.textbook(), q0=[[0.5, 1.0], [0.6, 1.0]], t_span=(0, 5))
        >>> sol = found.member(1)
        >>> sol.status, np.array_equal(sol.q[-1], found.q[1])
        ('finished', True)
        """
        place = _place(index, self.shape)
        scene = self.members.scene_of(place)
        q0, qd0 = self.members.q0[place], self.members.qd0[place]
        return simulate(
            scene, q0, qd0, self.t_span, t_eval=self.t_eval, check=False,
            **self.options_of_members(),
        )  # fmt: skip

    @known_keywords
    def message(self, index: Any) -> str:
        """Return what the run of one member says of its end, or why it was refused.

        The member is run again: an ensemble keeps no texts.

        Examples
        --------
        >>> found = pc.ensemble(pc.Scene.textbook(), q0=[[0.5, np.nan]], t_span=(0, 5), check=False)
        >>> found.message(0)
        'q0[1] = nan: must be finite (rad)'
        """
        try:
            return self.member(index).message
        except ValueError as refusal:
            return str(refusal)

    @known_keywords
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
        >>> short = pc.ensemble(
        ...     pc.Scene.textbook(), q0=[[0.1, 0.1], [1.5, 1.5]], t_span=(0, 9), max_steps=60,
        ...     check=False,
        ... )
        >>> short.status, short.rerun(max_steps=1000).status
        (array(['max_steps', 'finished'], dtype='<U14'), array(['finished'], dtype='<U14'))
        """
        places = np.flatnonzero(~self.success)
        return _run(
            self.members.selected(places), self.t_span, self.t_eval, self.reducers,
            self.options | _known(options),
        )  # fmt: skip

    @known_keywords
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
        >>> found = pc.ensemble(
        ...     pc.Scene.textbook(), q0=[0.5, 1.0], t_span=(0, 5), vary={"gravity": [9.8, 1.62]}
        ... )
        >>> found.to_xarray().sizes["member_0"]
        2
        """
        return to_xarray(self)


@known_keywords
def ensemble(
    scene: Scene,
    q0: npt.ArrayLike | None = None,
    qd0: npt.ArrayLike = 0.0,
    t_span: Iterable[float] | None = None,
    *,
    vary: Mapping[str, npt.ArrayLike] | None = None,
    keep: Keep = "end",
    t_eval: npt.ArrayLike | None = None,
    method: str = "auto",
    rtol: npt.ArrayLike = RUN_DEFAULTS["rtol"],
    atol: npt.ArrayLike = RUN_DEFAULTS["atol"],
    events: Iterable[Event] = (),
    max_steps: int = RUN_DEFAULTS["max_steps"],
    max_step: float = inf,
    workers: int | None = None,
    time_limit: float | None = None,
    check: bool | None = None,
    progress: Progress = None,
) -> Ensemble:
    """Run a scene from many starts, and with many values of its parameters.

    A member has the bits of `simulate` with its scene and its start, whatever the number of
    threads and whatever runs beside it.

    Parameters
    ----------
    scene : Scene
        What moves.
    q0 : array_like, (..., n)
        Angles at the start, rad. The leading axes of ``q0``, ``qd0`` and ``vary`` broadcast, and
        are those of the ensemble.
    qd0 : array_like, (..., n), default 0
        Rates at the start, rad/s.
    t_span : (float, float)
        Start and end, s, of every member.
    vary : dict, optional
        Names of parameters, as `Scene.parameters` has them, and their values, (...).
    keep : "end", "times", a reducer of `pendcore.keep`, or a dictionary of reducers
        With ``"end"`` the ensemble keeps the last state of each member, with ``"times"`` the states
        at ``t_eval``, and with reducers the last state and what the reducers find.
    t_eval : array_like, (n_t,), optional
        The times for ``keep="times"``, s.
    method, rtol, atol, events, max_steps, max_step
        As in `simulate`. An event that is ``terminal`` ends a member.
    workers : int, optional
        The number of threads. Default: one for each processor.
    time_limit : float, optional
        s, for the whole ensemble; what is not run by then has the status ``"not_run"``.
    check : bool, optional
        What to do if members fail. True raises an error, False says nothing. Default: a warning.
    progress : bool or callable, optional
        As in `simulate`, for the whole ensemble.

    Returns
    -------
    Ensemble
        A member that is not allowed has the status ``"refused"``, and one that fails its own
        status: neither affects the others.

    Raises
    ------
    ValueError, TypeError
        If an argument is wrong for every member; the message names it.
    KeyboardInterrupt
        The attribute ``ensemble`` has the members that were run.

    Examples
    --------
    >>> starts = pc.draw.uniform(-np.pi, np.pi, (100, 2), seed=1)
    >>> found = pc.ensemble(pc.Scene.textbook(), q0=starts, t_span=(0, 5))
    >>> found.q.shape, found.counts()
    ((100, 2), {'finished': 100})
    """
    q0 = require_start(scene, q0)
    members = members_of(scene, q0, qd0, vary)
    reducers, asked = _reducers(keep, events)
    times = _times(keep, t_eval)
    options = {
        "method": method, "rtol": rtol, "atol": atol, "events": asked, "max_steps": max_steps,
        "max_step": max_step, "workers": workers, "time_limit": time_limit, "check": check,
        "progress": progress,
    }  # fmt: skip
    return _run(members, time_span(t_span), times, reducers, options)


def _run(
    members: Members,
    t_span: tuple[float, float],
    times: Any,
    reducers: dict[str, int],
    options: dict[str, Any],
) -> Ensemble:
    require_check(options["check"])
    workers = 0 if options["workers"] is None else whole_number("workers", options["workers"])
    if options["workers"] is not None and workers < 1:
        raise ValueError(f"workers = {workers}: must be 1 or more threads")
    limit = time_limit_of(options["time_limit"])
    found = Ensemble(members, t_span, options, times, reducers, len(options["events"]))
    report = callback(options["progress"], f"running {members.count} members")
    try:
        error = run_members(found, workers, limit, report)
    finally:
        close(report)
    if error is not None:
        error.ensemble = found  # type: ignore[attr-defined]
        raise error
    return _checked(found, options["check"])


def _checked(found: Ensemble, check: bool | None) -> Ensemble:
    if check is False or found.success.all():
        return found
    told = ", ".join(f"{count} {name}" for name, count in found.counts().items())
    place = tuple(found.failed[0].tolist())
    complaint = f"of {len(found)} members {told}; .failed lists those that failed, the first is "
    complaint += f"{place}: .message({place}) says why"
    if check:
        error = RuntimeError(complaint)
        error.ensemble = found  # type: ignore[attr-defined]
        raise error
    try:
        warn(f"{complaint}; check=True raises an error, check=False says nothing")
    except PendcoreWarning as error:
        error.ensemble = found  # type: ignore[attr-defined]
        raise
    return found


def _reducers(keep: Keep, events: Iterable[Event]) -> tuple[dict[str, int], tuple[Event, ...]]:
    """Return the name of each reducer with the number of its event, and all events."""
    asked = tuple(events_asked_for(events))
    if isinstance(keep, str):
        if keep not in ("end", "times"):
            raise ValueError(f"keep = {keep!r}: must be {_KEEPS}")
        return {}, asked
    if isinstance(keep, Reducer):
        keep = {USUAL_NAMES[type(keep)]: keep}  # type: ignore[index]
    if not isinstance(keep, Mapping) or not keep:
        raise TypeError(f"keep = {keep!r}: must be {_KEEPS}")
    places: dict[str, int] = {}
    for name, reducer in keep.items():
        if not isinstance(name, str) or not isinstance(reducer, FirstEvent):
            raise TypeError(f"keep[{name!r}] = {reducer!r}: must be a reducer of pendcore.keep")
        places[name] = len(asked)
        asked += (reducer.event,)
    return places, asked


def _times(keep: Keep, t_eval: npt.ArrayLike | None) -> Any:
    if not isinstance(keep, str) or keep == "end":
        if t_eval is not None:
            raise ValueError('t_eval: is kept only with keep="times"')
        return None
    if t_eval is None:
        raise TypeError('t_eval is missing: keep="times" keeps the states at these times, in s')
    return np.array(numbers("t_eval", t_eval, "s"))


def _known(options: dict[str, Any]) -> dict[str, Any]:
    names = ("method", "rtol", "atol", "max_steps", "max_step", *OF_THE_WHOLE)
    for name in options:
        if name not in names:
            raise TypeError(f"rerun: has no parameter {name!r}: known are {', '.join(names)}")
    return options


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
