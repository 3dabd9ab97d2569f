"""Derivatives of a run that is there: found along the same steps, or along shorter ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._messages.arguments import Floats, moments, positive
from pendcore._run.call import run_again
from pendcore._run.dense_output import ANOTHER_COURSE, ends_alike, simulated_anew
from pendcore._run.solution import Solution

SMALLEST = 1e-10
"""What a name moves by less than this, in rad or rad/s when it changes by its own size, is none."""
TIGHTEST = 1e-12
"""Below this relative tolerance rounding shows: looser runs are compared."""


def derivatives_of(
    solution: Solution, names: tuple[str, ...], **changed: Any
) -> tuple[_core.Sensitivities, Solution]:
    """Simulate a run anew, some arguments changed, and return what looked on beside the run."""
    watch = _core.Sensitivities(solution.scene._compiled, list(names))
    return watch, run_again(solution, watch, **changed | {"time_limit": None})


def sensitivities_there(solution: Solution) -> Floats:
    """Return the sensitivities of a run; raise ValueError if it has none."""
    if solution.sensitivities is None:
        raise ValueError(
            "the run has no sensitivities: simulate(..., sensitivities=[names]) finds them"
        )
    return solution.sensitivities


def sensitivities_at(solution: Solution, t: npt.ArrayLike) -> Floats:
    """See `Solution.sensitivities_at`."""
    sensitivities_there(solution)
    times = times_within(solution, t)
    found, _ = along(solution, times.reshape(-1))
    return found[0] if times.ndim == 0 else found


def times_within(solution: Solution, t: npt.ArrayLike) -> Floats:
    """Return one time, (), or several, (k,), of a run; refuse others in the words of ``sol(t)``."""
    times = moments(t)
    (start, _), end = solution.t_span, solution.t_reached
    outside = times[(times < min(start, end)) | (times > max(start, end))]
    if outside.size:
        told = f"must be within the run, {start!r} to {end!r} s"
        raise ValueError(f"t = {outside.flat[0].item()!r}: {told}")
    return times


def along(solution: Solution, times: Floats) -> tuple[Floats, Floats]:
    """Return the sensitivities (k, 2n, m) and the states (k, 2n) at times of a run, (k,).

    The run is made again with its own steps; at a jump they are those after it.
    """
    grid, places = _in_order(solution, times)
    if not len(grid):
        dimension = 2 * len(solution.scene.links)
        return np.empty((0, dimension, len(solution.sensitivity_names))), np.empty((0, dimension))
    again = simulated_anew(solution, t_eval=grid, store="times")
    if not ends_alike(again, solution):
        raise ValueError(f"the run has no sensitivities at other times: {ANOTHER_COURSE}")
    return sensitivities_there(again)[places], again.y.T[places]


def _in_order(solution: Solution, t: Floats) -> tuple[Floats, npt.NDArray[np.intp]]:
    """Return times as the run goes, each once, and the place of each of ``t`` among them."""
    times, places = np.unique(t, return_inverse=True)
    start, end = solution.t_span
    return (times, places) if end >= start else (times[::-1], len(times) - 1 - places)


def _last_rows(places: npt.NDArray[np.intp]) -> npt.NDArray[np.intp]:
    """Return the last row that a run has kept of each time: at a jump, the one after it."""
    return np.append(np.flatnonzero(np.diff(places)), len(places) - 1)


def errors_of(solution: Solution) -> Floats:
    """See `Solution.sensitivity_errors`."""
    known = sensitivities_there(solution)
    if not len(solution.t):
        return np.empty((0, len(solution.sensitivity_names)))
    times, places = _in_order(solution, solution.t)
    grid = _with_moments_around_the_end(times, solution._run.arguments["t_start"])
    watch, other = derivatives_of(
        solution, solution.sensitivity_names, **_more_exact(solution._run.arguments),
        t_eval=grid, store=None, t_end=grid[-1], events=(), max_steps=10**9,
    )  # fmt: skip
    rows = np.arange(len(times))
    rows[-1] += _of_the_nearest_state(solution.y[:, -1], other.y[:, len(times) - 1 :])
    errors: Floats = np.abs(known[_last_rows(places)] - watch.values[rows]).max(axis=1)
    # The other run has an event a little earlier or later: at its very time, one of the two is
    # before it. There, the error is that of the times around.
    errors[1:-1] = np.minimum(errors[1:-1], np.maximum(errors[:-2], errors[2:]))
    return errors[places]


def valid_until_of(solution: Solution, limit: float) -> Floats:
    """See `Solution.sensitivities_valid_until`."""
    share = positive("limit", limit, "of the largest sensitivity")
    if not np.isfinite(share):
        raise ValueError(f"limit = {share}: must be finite, a share of the largest sensitivity")
    known, errors = sensitivities_there(solution), solution.sensitivity_errors()
    start, _ = solution.t_span
    if not len(solution.t):
        return np.full(len(solution.sensitivity_names), start)
    _, places = _in_order(solution, solution.t)
    size = np.maximum.accumulate(np.abs(known).max(axis=1), axis=0)[_last_rows(places)][places]
    values = solution.scene.parameters()
    scale = np.array([abs(values.get(name, 1.0)) or 1.0 for name in solution.sensitivity_names])
    is_past = ~(errors <= np.maximum(share * size, SMALLEST / scale))  # NaN is past
    is_past |= np.abs(solution.t - start)[:, np.newaxis] > abs(solution.valid_until() - start)
    count = np.where(is_past.any(axis=0), is_past.argmax(axis=0), len(is_past))
    return np.append(start, solution.t)[count]


def _more_exact(asked: dict[str, Any]) -> dict[str, Any]:
    """Return tolerances or a step that tell how far off a run is."""
    if asked["step"] is not None:
        return {"step": asked["step"] / 2}
    share = 0.1 if np.min(asked["rtol"]) >= TIGHTEST else 10.0
    return {name: asked[name] * share for name in ("rtol", "atol")}


def _with_moments_around_the_end(times: Floats, t_start: float) -> list[float]:
    """Return times with one just before the last of them, and one just after it."""
    last, since = times[-1], times[-2] if len(times) > 1 else t_start
    moment = np.copysign(min(1e-7 * abs(last - t_start), 0.5 * abs(last - since)), last - t_start)
    return [*times[:-1], *([last - moment, last, last + moment] if moment else [last])]


def _of_the_nearest_state(end: Floats, found: Floats) -> int:
    """Return which of the moments is on the same side of an event; the middle one, if none is.

    A table may end in the middle, so that there is no moment after it.
    """
    distances = np.abs(found.T - end).max(axis=1)
    middle = min(1, len(distances) - 1)
    return middle if distances[middle] < 100 * distances.min() else int(distances.argmin())
