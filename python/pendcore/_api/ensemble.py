"""Many runs of one scene: the call."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping
from math import inf
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._ensemble.ensemble import Ensemble
from pendcore._ensemble.members import members_of
from pendcore._ensemble.request import Request
from pendcore._ensemble.whole_run import Execution, run_ensemble
from pendcore._messages.arguments import Floats, numbers, text, time_span
from pendcore._messages.progress import Progress
from pendcore._messages.warning import warn
from pendcore._scene.scene import Scene, require_scene
from pendcore.events import Event, events_asked_for
from pendcore.options import OPTIONS, RUN_DEFAULTS, OnFailure
from pendcore.reducers import REDUCERS, Reducer

Keep = str | Reducer | Mapping[str, Reducer]
_TAKEN = {"status", "t_reached", "q", "qd", "q0", "qd0", "link", "time"}
_TAKEN |= {axis for kind in REDUCERS for axis in kind.axes}
_REDUCERS = ", ".join(f"pc.reducers.{one.__name__}" for one in REDUCERS)
_KEEPS = f'"end", "times", or a reducer or a dictionary of reducers: {_REDUCERS}'


def ensemble(
    scene: Scene,
    t_span: Iterable[float],
    q0: npt.ArrayLike,
    qd0: npt.ArrayLike = 0.0,
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
    executor: Any = None,
    store: str | os.PathLike[str] | None = None,
    chunk: int | None = None,
    time_limit: float | None = None,
    on_failure: OnFailure = "warn",
    progress: Progress = None,
) -> Ensemble:
    """Run a scene from many starts, and with many values of its parameters.

    A member has the bits of `simulate` with its scene and its start, whatever the number of
    threads and whatever runs beside it.

    Parameters
    ----------
    scene : Scene
        What moves.
    t_span : (float, float)
        Start and end, s, of every member.
    q0 : array_like, (..., n)
        Angles at the start, rad. The leading axes of ``q0``, ``qd0`` and ``vary`` broadcast, and
        are those of the ensemble.
    qd0 : array_like, (..., n), default 0
        Rates at the start, rad/s.
    vary : dict, optional
        Names of parameters, as `Scene.parameters` has them, and their values, (...).
    keep : "end", "times", a reducer of `pendcore.reducers`, or a dictionary of reducers
        With ``"end"`` the ensemble keeps the last state of each member, with ``"times"`` the states
        at ``t_eval``, and with reducers the last state and what the reducers find.
    t_eval : array_like, (n_t,), optional
        The times for ``keep="times"``, s.
    method, rtol, atol, events, max_steps, max_step
        As in `simulate`. An event that is ``terminal`` ends a member.
    workers : int, optional
        The number of threads. Default: one for each processor, and with an ``executor`` one in each
        of its tasks.
    executor : optional
        An executor of `concurrent.futures`, or a ``Client`` of `dask.distributed`: its workers run
        the members, chunk by chunk.
    store : path, optional
        A folder for the results, of Zarr 3, written chunk by chunk. If it is there, the call goes
        on where it stopped. `load` reads it, and so does xarray.
    chunk : int, optional
        The number of members in a chunk. Default: so many that a chunk takes about 2 s. A store
        that is there keeps its own.
    time_limit : float, optional
        s, for the whole ensemble; what is not run by then has the status ``"not_run"``. If it is
        too short for the few members whose work tells the default of ``chunk``, no store is made.
    on_failure : {"warn", "raise", "ignore"}
        What to do if members fail.
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
        If an argument is wrong for every member; the message names it. A store with results of
        another scene, start, option or version is refused.
    OSError
        If the disk is too small for the store, or full, or cannot be written, or if another run is
        writing the store.
    RuntimeError
        With ``on_failure="raise"``, if members fail.
    KeyboardInterrupt, or any exception of ``progress``, a worker or the disk
        The attribute ``ensemble`` has the members that were run.

    Warns
    -----
    PendcoreWarning
        If all starts are multiples of 5 and some are large, as angles in degrees are; or if members
        fail, unless ``on_failure`` says otherwise.

    Examples
    --------
    >>> starts = pc.sampling.uniform(-np.pi, np.pi, (100, 2), seed=1)
    >>> found = pc.ensemble(pc.Scene.textbook(), (0, 5), starts)
    >>> found.q.shape, found.counts()
    ((100, 2), {'finished': 100})
    """
    require_scene(scene)
    if isinstance(store, str) and f'"{store}"' in OPTIONS["store"].type:  # as in simulate
        raise ValueError(
            f"store = {store!r}: is a folder for the results here: name one, {store + '.zarr'!r}; "
            "what is kept of each member is for keep"
        )
    members = members_of(scene, q0, qd0, vary)
    _warn_of_degrees(np.asarray(q0, dtype=np.float64))
    options = {
        "method": method, "rtol": rtol, "atol": atol, "events": tuple(events_asked_for(events)),
        "max_steps": max_steps, "max_step": max_step,
    }  # fmt: skip
    reducers = _reducers(keep)
    request = Request(time_span(t_span), _times(keep, t_eval), reducers, options)
    how = Execution(workers, executor, store, chunk, time_limit, on_failure, progress)
    return run_ensemble(members, request, how)


def _warn_of_degrees(q0: Floats) -> None:
    """Warn once if the starts look like degrees, as `simulate` does of each."""
    place = _core.first_in_degrees(q0)
    if place is not None:
        index = [str(int(i)) for i in np.unravel_index(place, q0.shape)]
        name = f"q0[{', '.join(index)}]" if index else "q0"
        warn(_core.warning_of_degrees(name, float(q0.flat[place])))


def _reducers(keep: Keep) -> dict[str, Reducer]:
    """Return the name of each reducer, and the reducer."""
    if isinstance(keep, str):
        if keep not in ("end", "times"):
            raise ValueError(f"keep = {keep!r}: must be {_KEEPS}")
        return {}
    if isinstance(keep, Reducer):
        _require_reducer("keep", keep)
        return {keep.usual_name: keep}
    if not isinstance(keep, Mapping) or not keep:
        raise TypeError(f"keep = {keep!r}{_uncalled(keep)}: must be {_KEEPS}")
    for name, reducer in keep.items():
        if not isinstance(name, str):
            raise TypeError(f"keep[{name!r}]: the name must be a text")
        text("keep: name", name)
        _require_reducer(f"keep[{name!r}]", reducer)
        if name in _TAKEN:
            raise ValueError(f"keep[{name!r}]: this name is taken: choose another one")
    return dict(keep)


def _require_reducer(where: str, reducer: object) -> None:
    if type(reducer) in REDUCERS:
        return
    own = ": the core does not know this class" if isinstance(reducer, Reducer) else ""
    raise TypeError(f"{where} = {reducer!r}{_uncalled(reducer)}{own}: must be one of {_REDUCERS}")


def _uncalled(reducer: object) -> str:
    is_class = isinstance(reducer, type) and issubclass(reducer, Reducer)
    return ": call it" if is_class else ""


def _times(keep: Keep, t_eval: npt.ArrayLike | None) -> Any:
    if not isinstance(keep, str) or keep == "end":
        if t_eval is not None:
            raise ValueError('t_eval: is kept only with keep="times"')
        return None
    if t_eval is None:
        raise TypeError('t_eval is missing: keep="times" keeps the states at these times, in s')
    return np.array(numbers("t_eval", t_eval, "s"))
