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
) -> tuple[_core.Sensitivities, Solution]:
    """Simulate a run anew, some options changed, and return what looked on beside the run."""
    asked = solution._run.arguments | changed
    q0, qd0, t_start, t_end = (asked.pop(name) for name in ("q0", "qd0", "t_start", "t_end"))
    choice = Choice(*(asked.pop(name) for name in Choice._fields))
    watch = _core.Sensitivities(solution.scene._compiled, list(names))
    return watch, run(Start(solution.scene, q0, qd0, t_start, t_end), choice, watch=watch, **asked)


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
    # The other run has an event a little earlier or later: at its very time, one of the two is
    # before it. There, the error is that of the times around; at the end, that of
    # the moment whose state is nearest.
    last, since = times[-1], times[-2] if len(times) > 1 else asked["t_start"]
    moment = min(1e-7 * abs(last - asked["t_start"]), 0.5 * abs(last - since))
    around = last + np.sign(asked["t_end"] - asked["t_start"]) * moment * np.array([-1, 0, 1])
    grid = [*times[:-1], *(around if moment > 0 else [last])]
    t_end = grid[-1] if moment > 0 else asked["t_end"]
    more: dict[str, Any] = {"t_eval": grid, "store": None, "t_end": t_end, "events": ()}
    more |= {"max_steps": 10**9, "time_limit": float("inf")}
    watch, other = derivatives_of(solution, solution.sensitivity_names, **closer, **more)
    latest = np.append(np.flatnonzero(np.diff(places)), len(places) - 1)  # after a jump
    rows = np.arange(len(times))
    distances = np.abs(other.y[:, len(times) - 1 :].T - solution.y[:, -1]).max(axis=1)
    middle = min(1, len(distances) - 1)  # a table may end there
    rows[-1] += middle if distances[middle] < 100 * distances.min() else distances.argmin()
    errors: Floats = np.abs(solution.sensitivities[latest] - watch.values[rows]).max(axis=1)
    errors[1:-1] = np.minimum(errors[1:-1], np.maximum(errors[:-2], errors[2:]))
    return errors[places]
