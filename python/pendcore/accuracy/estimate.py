"""The error of a run over its whole curve: the one estimate behind all that is said of errors.

`Solution.error`, `Solution.valid_until` and what ``simulate(error=...)`` verifies come from here.
The run is compared with second runs that are better by a factor which is known, for they
are compared with each other as well. Those of `Solution.error` take another method where one can
carry the scene, at tolerances a hundredth and less, as far as doubles allow; those of
``simulate(error=...)`` take the trial's own (`pendcore.accuracy.target_error`). All take other
steps, and each has its constants and its start moved by a few last bits of its own
(`pendcore.accuracy.rounding`). With runs r_1, r_2, ... the error is at most

    (1 + share) max_i |run - r_i| + max_ij |r_i - r_j|

(the first part times ``BETWEEN`` on a dense curve) if the best is no worse than the distance
of the others from it; and what the chain moves in half of the last bit of a time, as a state of the
run is kept under the double next to its time. In a chaotic motion all that is off is off along one
direction, so that two errors of one size may cancel; several runs, each moved another way, do not
all agree with one that is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from math import inf
from time import monotonic
from typing import TypeAlias

import numpy as np

from pendcore.accuracy.method_choice import TIGHTEST, second_methods
from pendcore.accuracy.position_error import (
    angles_at,
    distances,
    kept_times,
    reached,
    states_at,
    times_within_steps,
)
from pendcore.accuracy.rounding import moved
from pendcore.messages.arguments import Floats, time_limit_of
from pendcore.messages.progress import Progress, callback, close
from pendcore.run.call import Choice, Start, resumed, run, start_of, tightened
from pendcore.run.error_estimate import ErrorEstimate
from pendcore.run.result import RunResult

Report: TypeAlias = Callable[[float], object]

TIGHTER = (100.0, 1000.0, 1000.0)
"""By what factors the tolerances of the second runs are tighter."""
ROUNDING_MATTERS = 1e-11
"""rtol below which a third second run tells what rounding does: truncation may be less."""
FOR_FIXED_STEPS = 1e-10
"""What counts as the tolerance of a run in fixed steps."""
MORE_STEPS = 10
"""How many times the steps that were allowed to the first run they may take."""
OTHER_STEPS = 0.6
"""How long their steps are at most, in mean steps of a run that tolerances did not limit."""
LEAST_STEPS = 5
"""So many steps a run may take until they are as long as the tolerance lets them be."""
LOST = np.pi
"""rad; runs that are farther apart have nothing to do with each other."""
LEGS, STEPS_A_LEG = 32, 200
"""In as many parts at most a second run is made; it ends with that in which it is lost."""
SPARE_OF_SEVERAL = 0.05
"""What share is added to a distance from several second runs: none of them is exact."""
BETWEEN = 1.1
"""By what factor the error between the times that are compared may be larger than at them."""
AT_ONCE = 100_000
"""Times that are compared at once, which bounds the memory."""


def estimate(
    solution: RunResult,
    seconds: Sequence[RunResult],
    verified_by: str,
    share: float = SPARE_OF_SEVERAL,
) -> ErrorEstimate:
    """Compare a run with second runs, as far as all of them came.

    Parameters
    ----------
    solution : RunResult
        Whose error is estimated.
    seconds : sequence of RunResult
        Better runs of the same, dense or with the times that the solution kept.
    verified_by : str
        How they were made.
    share : float
        What the error of a single second run is at most, as a share of the distance from it.
    """
    angles, positions = [np.empty(0)], [np.empty(0)]
    t = _common_times(solution, seconds)
    factor = (1 + share) * (BETWEEN if solution.store == "dense" else 1.0)
    for some in np.array_split(t, len(t) // AT_ONCE + 1):
        q, qd = np.hsplit(states_at(solution, some), 2)
        others = [angles_at(second, some) for second in seconds]
        angle = factor * np.max([_apart(q, r) for r in others], axis=0)
        position = factor * np.max([distances(solution.scene, q, r) for r in others], axis=0)
        pairs = [*combinations(others, 2)]
        if pairs:
            angle += np.max([_apart(r, s) for r, s in pairs], axis=0)
            position += np.max([distances(solution.scene, r, s) for r, s in pairs], axis=0)
        rounding = np.finfo(np.float64).eps * np.abs(q).max(axis=-1)  # the state is a double
        rounding += np.spacing(np.abs(some)) / 2 * np.abs(qd).max(axis=-1)  # and so is its time
        angles.append(angle + rounding)
        positions.append(position + rounding)
    angle, position = np.concatenate(angles), np.concatenate(positions)
    lost = np.flatnonzero(~(angle < LOST))
    count = int(lost[0]) + 1 if len(lost) else len(t)
    end = solution.run.t_reached
    last = end if solution.store == "dense" or not len(solution.t) else solution.t[-1]
    return ErrorEstimate(
        begin=float(solution.run.arguments["t_start"]),
        t=t[:count],
        angle=angle[:count],
        position=position[:count],
        verified_by=verified_by,
        is_lost=len(lost) > 0,
        is_complete=len(lost) > 0 or bool(len(t) and t[-1] == last),
        is_dense=solution.store == "dense",
    )


def error_of(
    solution: RunResult, *, time_limit: float | None = None, progress: Progress = None
) -> ErrorEstimate:
    """Return the error of a run, estimated when first asked for; see `pendcore.Solution.error`."""
    time_limit_of(time_limit)  # also where it is known already
    if solution.known_error is None:
        found = error_estimate(solution, time_limit=time_limit, progress=progress)
        if not found.is_complete:
            return found  # another time there may be more time
        solution.known_error = found
    return solution.known_error


def error_estimate(
    solution: RunResult, *, time_limit: float | None = None, progress: Progress = None
) -> ErrorEstimate:
    """Estimate the error of a solution; see `Solution.error`."""
    if solution.store != "dense" and not len(solution.t):
        raise ValueError(
            "error: the run ended before the first of its t_eval and kept no state to compare: "
            "ask for earlier times, or for none"
        )
    until = monotonic() + time_limit_of(time_limit)
    report = callback(progress, "estimating the error")
    farthest: ErrorEstimate | None = None
    try:
        for method in second_methods(start_of(solution), solution.method, solution.stats.stiff):
            found = _compared(solution, method, until, report)
            if farthest is None or len(found.t) > len(farthest.t):
                farthest = found
            if found.is_complete or monotonic() > until:
                break
    except BaseException as stop:
        stop.solution = solution  # type: ignore[attr-defined]
        raise
    finally:
        close(report)
    assert farthest is not None, "an explicit Runge-Kutta method supports every scene"
    return farthest


def other_steps(solution: RunResult, max_step: float) -> float:
    """Return a max_step, s, with which a second run takes other steps than the first.

    Tighter tolerances see to that where they set the steps, but not where max_step does, or points
    at which laws change, or where a run is over before its steps have grown.
    """
    stats, run = solution.stats, solution.run
    if stats.limited_by_max_step:
        max_step = min(max_step, OTHER_STEPS * stats.max_step)
    span = float(abs(run.t_reached - run.arguments["t_start"]))
    if 2 * stats.limited_by_tolerance > stats.accepted >= LEAST_STEPS or not span:
        return max_step
    return min(max_step, OTHER_STEPS * span / max(stats.accepted, 1))


def second_times(solution: RunResult) -> Floats | None:
    """Return the times that a second run is to keep, s; None for all, densely."""
    if solution.store in ("dense", "steps"):
        return None
    return kept_times(solution) if len(solution.t) else np.array([solution.run.t_reached])


def _compared(
    solution: RunResult, method: str, until: float, report: Report | None
) -> ErrorEstimate:
    """Compare with second runs by a method, until they and the solution are lost."""
    asked, first = solution.run.arguments, _choice_of(solution)
    tight = float(np.min(first.rtol)) < ROUNDING_MATTERS or asked["step"] is not None
    tight |= other_steps(solution, inf) < inf
    start = start_of(solution)
    seconds: list[RunResult] = []
    count = 3 if tight else 2
    first = first._replace(method=method, compensated=True)
    used = [float(np.min(tightened(first, by, TIGHTEST).rtol)) for by in TIGHTER[:count]]
    text = f"{method} at rtol {used[0]:.0e}" + " and tighter" * (min(used) < used[0])
    try:
        for seed in range(count):
            choice = tightened(first, TIGHTER[seed], TIGHTEST)
            begin = moved(start, seed)

            def share(fraction: float, done: int = seed) -> None:
                if report is not None:
                    report((done + fraction) / count)

            second: RunResult | None = None
            for second in _legs(solution, begin, choice, until, share):
                if _is_lost(solution, second):
                    break
            assert second is not None
            seconds.append(second)
            start = start._replace(t_end=second.run.t_reached)
            if not second.success:
                break
    except BaseException as stop:
        if isinstance(partly := getattr(stop, "solution", second), RunResult):
            seconds.append(partly)
        if seconds:
            stop.estimate = estimate(solution, seconds, text)  # type: ignore[attr-defined]
        raise
    return estimate(solution, seconds, text)


def _legs(
    solution: RunResult, start: Start, choice: Choice, until: float, report: Report
) -> Iterator[RunResult]:
    """Yield a second run as it gets on, part by part."""
    asked = solution.run.arguments
    max_steps = MORE_STEPS * asked["max_steps"]
    max_step = other_steps(solution, asked["max_step"])
    count = int(np.clip(solution.stats.accepted / STEPS_A_LEG, 1, LEGS))
    times = second_times(solution)
    ends = np.linspace(start.t_start, start.t_end, count + 1)[1:]
    ends[-1] = start.t_end
    parts = [None] * count if times is None else np.array_split(times, count)
    second: RunResult | None = None
    for done, (end, part) in enumerate(zip(ends, parts, strict=True)):
        left = None if until == inf else max(1e-3, until - monotonic())

        def share(fraction: float, done: int = done) -> None:
            report((done + fraction) / count)

        share(0.0)  # parts may be shorter than what the core calls after
        if part is not None:
            if not len(part):
                return
            end = part[-1]
        if second is None:
            second = run(
                start._replace(t_end=end), choice, part, max_step=max_step, max_steps=max_steps,
                time_limit=left, progress=share,
            )  # fmt: skip
        else:
            second = resumed(
                second, end, part, max_steps=max_steps, time_limit=left, progress=share
            )
        yield second
        if not second.success:
            return


def _choice_of(solution: RunResult) -> Choice:
    """Return how a solution was made; a fixed step counts as a tight tolerance."""
    asked = solution.run.arguments
    if asked["step"] is not None:
        return Choice(solution.method, FOR_FIXED_STEPS, FOR_FIXED_STEPS)
    return Choice(solution.method, asked["rtol"], asked["atol"])


def _common_times(solution: RunResult, seconds: Sequence[RunResult]) -> Floats:
    """Return the times at which to compare: in all steps, or those kept that all came to."""
    if solution.store == "dense":
        return times_within_steps([solution, *seconds])
    times = kept_times(solution)
    if not len(times):
        times = np.array([solution.run.t_reached])
    return times[np.all([reached(second, times) for second in seconds], axis=0)]


def _is_lost(solution: RunResult, second: RunResult) -> bool:
    """Whether they have nothing to do with each other any more where the second one ended."""
    last = np.array([second.run.t_reached])
    if solution.store != "dense":
        last = kept_times(solution)
        last = last[reached(second, last)][-1:]
    if not len(last):
        return False
    return not bool((_apart(angles_at(solution, last), angles_at(second, last)) < LOST).all())


def _apart(q: Floats, reference: Floats) -> Floats:
    """Return the largest difference over the links, rad."""
    largest: Floats = np.abs(q - reference).max(axis=-1, initial=0.0)
    return largest
