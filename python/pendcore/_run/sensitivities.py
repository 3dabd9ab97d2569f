"""Derivatives of a run that is there: found along the same steps, or along shorter ones."""

from __future__ import annotations

from typing import Any

import numpy as np

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._run.call import Choice, Start, run
from pendcore._run.solution import Solution

TIGHTEST = 1e-12
"""Below this relative tolerance rounding shows: looser runs are compared."""


def derivatives_of(
    solution: Solution, names: tuple[str, ...], **changed: Any
) -> _core.Sensitivities:
    """Simulate a run anew, some options changed, and return what looked on."""
    asked = solution._run.arguments | changed
    q0, qd0, t_start, t_end = (asked.pop(name) for name in ("q0", "qd0", "t_start", "t_end"))
    choice = Choice(*(asked.pop(name) for name in Choice._fields))
    watch = _core.Sensitivities(solution.scene._compiled, list(names))
    run(Start(solution.scene, q0, qd0, t_start, t_end), choice, watch=watch, **asked)
    return watch


def errors_of(solution: Solution) -> Floats:
    """See `Solution.sensitivity_errors`."""
    if solution.sensitivities is None:
        raise ValueError(
            "the run has no sensitivities: simulate(..., sensitivities=[names]) finds them"
        )
    if not len(solution.t):
        return np.empty((0, len(solution.sensitivity_names)))
    asked = solution._run.arguments
    share = 0.1 if np.min(asked["rtol"]) >= TIGHTEST else 10.0
    closer: dict[str, Any] = {name: asked[name] * share for name in ("rtol", "atol")}
    if asked["step"] is not None:
        closer = {"step": asked["step"] / 2}
    backward = solution.t[-1] < solution.t[0]
    times, places = np.unique(-solution.t if backward else solution.t, return_inverse=True)
    if backward:
        times = -times
    t_end = solution.t[-1] if solution.t[-1] != asked["t_start"] else asked["t_end"]
    # The other run has an event a little earlier or later: at its very time, one of the two is
    # before it. There, the error is that of the times around; at the end, of a moment before.
    grid = times
    if len(times) > 1:
        moment = min(1e-7, 0.5 * abs(np.diff(times)[-1] / (times[-1] - times[0])))
        grid = np.insert(times, -1, times[-1] - moment * (times[-1] - times[0]))
    more: dict[str, Any] = {"t_eval": grid, "store": None, "t_end": t_end, "events": ()}
    more |= {"max_steps": 10**9, "time_limit": float("inf")}
    found = derivatives_of(solution, solution.sensitivity_names, **closer, **more).values
    latest = np.append(np.flatnonzero(np.diff(places)), len(places) - 1)  # after a jump
    kept = solution.sensitivities[latest]
    if len(times) == 1:
        errors: Floats = np.abs(kept - found).max(axis=1)
        return errors[places]
    errors = np.abs(kept - np.delete(found, -2, axis=0)).max(axis=1)
    errors[-1] = np.minimum(errors[-1], np.abs(kept[-1] - found[-2]).max(axis=0))
    errors[1:-1] = np.minimum(errors[1:-1], np.maximum(errors[:-2], errors[2:]))
    return errors[places]
