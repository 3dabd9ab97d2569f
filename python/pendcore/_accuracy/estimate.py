"""The estimate of a run's error over its whole curve.

`Solution.estimate_error` and `Solution.valid_until` come from here, and what
``simulate(error=...)`` tells where it does not know the error from the defect
(`pendcore._accuracy.defect_correction`). The run is compared with better second runs: by another
method for `Solution.estimate_error`, mostly by the trial's own for ``simulate(error=...)``. Their
steps are others, and their constants and starts are moved by a few last bits
(`pendcore._accuracy.rounding`). With the second runs r_1, r_2, ... the error is at most

    (1 + share) max_i |run - r_i| + max_ij |r_i - r_j|

(the first part times ``BETWEEN`` on a dense curve), if the error of the best second run is at most
its distance from the others. To this is added how far the chain moves in half of the last bit of a
time, as the time of a kept state is rounded to a double. In a chaotic motion all errors lie along
one direction, so that two errors of one size may cancel; several runs, each moved another way, do
not all agree with a run that is wrong.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import combinations
from math import inf
from time import monotonic
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from pendcore._accuracy.method_choice import second_methods
from pendcore._accuracy.position_error import (
    angles_at,
    kept_times,
    largest_difference,
    reached,
    states_at,
    times_within_steps,
)
from pendcore._accuracy.rounding import moved
from pendcore._messages.arguments import Floats, time_limit_of
from pendcore._messages.handed_over import hand_over
from pendcore._messages.progress import Progress, part_of, reporting
from pendcore._run.call import Choice, Start, resumed, run, start_of, tightened
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution
from pendcore.methods import TIGHTEST

Report: TypeAlias = Callable[[float], object]

TIGHTER = (100.0, 1000.0, 1000.0)
"""The factors by which the tolerances of the second runs are tighter than the run's."""
THIRD_RUN_BELOW = 1e-11
"""The rtol below which a third second run is made, as rounding may exceed truncation."""
FOR_FIXED_STEPS = 1e-10
"""The rtol and atol that a run in fixed steps is taken to have."""
MORE_STEPS = 10
"""The factor by which a second run's max_steps is larger than the run's."""
OTHER_STEPS = 0.6
"""The longest step of a second run in mean steps of the run, if tolerances did not limit these."""
STEPS_TO_GROW = 5
"""A run of fewer steps may be over before its steps have grown to what the tolerance allows."""
LOST = np.pi
"""rad; runs that are farther apart have nothing to do with each other."""
LEGS, STEPS_A_LEG = 32, 200
"""The most legs of a second run, and the run's steps in each; a lost run ends with its leg."""
SPARE_OF_SEVERAL = 0.05
"""The share that is added to a distance from several second runs, as none of them is exact."""
BETWEEN = 1.1
"""The factor by which the error may be larger between the compared times than at them."""
AT_ONCE = 100_000
"""The number of times that are compared at once, which bounds the memory."""


def estimate(
    solution: Solution,
    seconds: Sequence[Solution],
    verified_by: str,
    share: float = SPARE_OF_SEVERAL,
) -> ErrorEstimate:
    """Return the error of a run, compared with second runs up to the first end among them all.

    These are better runs of the same motion, dense or with the times that the solution kept;
    ``verified_by`` says how they were made. ``share`` is the largest error of a single second run,
    as a share of the distance from it.
    """
    factor = (1 + share) * (BETWEEN if solution.store == "dense" else 1.0)
    t = _common_times(solution, seconds)
    found = apart(solution, t, lambda at: [angles_at(second, t[at]) for second in seconds])
    angle = factor * found.angle_from_run + found.angle + found.rounding
    position = factor * found.position_from_run + found.position + found.rounding
    return error_over(solution, t, angle, position, verified_by)


class Apart(NamedTuple):
    """How far other motions are from a run, and from each other, at times; (n_t,) each.

    Angles in rad, the largest over the links; positions as shares of the total length. ``rounding``
    is what the rounding of states and times to doubles adds to both.
    """

    angle_from_run: Floats
    angle: Floats
    position_from_run: Floats
    position: Floats
    rounding: Floats


def apart(solution: Solution, t: Floats, others: Callable[[slice], list[Floats]]) -> Apart:
    """Compare a run with other motions at times; ``others`` returns the angles of these, (k, n).

    It is asked for the angles at some of the times at once, which bounds the memory.
    """
    found = [np.empty((5, 0))]
    for first in range(0, len(t), AT_ONCE):
        some = slice(first, first + AT_ONCE)
        q, qd = np.hsplit(states_at(solution, t[some]), 2)
        motions = others(some)
        rounding = np.finfo(np.float64).eps * largest_difference(q)  # the state is a double
        rounding += np.spacing(np.abs(t[some])) / 2 * largest_difference(qd)  # so is its time
        from_run = [(q, motion) for motion in motions]
        from_each_other = [*combinations(motions, 2)] or [(q, q)]  # one alone is 0 apart
        largest = [
            np.max([measure(r, s) for r, s in pairs], axis=0)
            for measure in (largest_difference, solution.scene.distances)
            for pairs in (from_run, from_each_other)
        ]
        found.append(np.array([*largest, rounding]))
    return Apart(*np.concatenate(found, axis=1))


def error_over(
    solution: Solution, t: Floats, angle: Floats, position: Floats, verified_by: str
) -> ErrorEstimate:
    """Return errors at times as an estimate, up to where the run is lost."""
    lost = np.flatnonzero(~(angle < LOST))
    count = int(lost[0]) + 1 if len(lost) else len(t)
    end = solution._run.t_reached
    last = end if solution.store == "dense" or not len(solution.t) else solution.t[-1]
    return ErrorEstimate(
        begin=float(solution._run.arguments["t_start"]),
        t=t[:count],
        angle=angle[:count],
        position=position[:count],
        verified_by=verified_by,
        is_lost=len(lost) > 0,
        is_complete=len(lost) > 0 or bool(len(t) and t[-1] == last),
        is_dense=solution.store == "dense",
    )


def error_of(
    solution: Solution, *, time_limit: float | None = None, progress: Progress = None
) -> ErrorEstimate:
    """Return the error of a run, estimated when first asked for."""
    time_limit_of(time_limit)  # a wrong one is refused even where the error is known already
    if solution.known_error is None:
        error = error_estimate(solution, time_limit=time_limit, progress=progress)
        if not error.is_complete:
            return error  # a later call with more time may complete it
        solution.known_error = error
    return solution.known_error


def error_estimate(
    solution: Solution, *, time_limit: float | None = None, progress: Progress = None
) -> ErrorEstimate:
    """Estimate the error of a solution; see `Solution.estimate_error`."""
    if solution.store != "dense" and not len(solution.t):
        raise ValueError(
            "error: the run ended before the first of its t_eval and kept no state to compare: "
            "ask for earlier times, or for none"
        )
    until = monotonic() + time_limit_of(time_limit)
    methods = second_methods(start_of(solution), solution.method, solution.stats.stiff)
    found: list[ErrorEstimate] = []
    try:
        with reporting(progress, "estimating the error") as report:
            for method in methods:
                found.append(_compared(solution, method, until, report))
                if found[-1].is_complete or monotonic() > until:
                    break
    except BaseException as stop:
        hand_over(stop, solution=solution)
        raise
    return max(found, key=lambda error: len(error.t))  # some method supports every scene


def other_steps(solution: Solution, max_step: float) -> float:
    """Return a max_step, s, with which a second run takes other steps than the run.

    Tighter tolerances suffice where tolerances set the steps, but not where max_step sets them, or
    points at which laws change, nor where a run is over before its steps have grown.
    """
    stats, run = solution.stats, solution._run
    if stats.limited_by_max_step:
        max_step = min(max_step, OTHER_STEPS * stats.max_step)
    span = float(abs(run.t_reached - run.arguments["t_start"]))
    if 2 * stats.limited_by_tolerance > stats.accepted >= STEPS_TO_GROW or not span:
        return max_step
    return min(max_step, OTHER_STEPS * span / max(stats.accepted, 1))


def second_times(solution: Solution) -> Floats | None:
    """Return the times that a second run is to keep, s; None for dense output."""
    if solution.store in ("dense", "steps"):
        return None
    return kept_times(solution) if len(solution.t) else np.array([solution._run.t_reached])


def _compared(solution: Solution, method: str, until: float, report: Report) -> ErrorEstimate:
    """Return the error of a solution, compared with second runs by a method."""
    asked, first = solution._run.arguments, _choice_of(solution)
    tight = float(np.min(first.rtol)) < THIRD_RUN_BELOW or asked["step"] is not None
    tight |= other_steps(solution, inf) < inf
    start = start_of(solution)
    seconds: list[Solution] = []
    count = 3 if tight else 2
    first = first._replace(method=method, compensated=True)
    used = [float(np.min(tightened(first, by, TIGHTEST).rtol)) for by in TIGHTER[:count]]
    text = f"{method} at rtol {used[0]:.0e}" + " and tighter" * (min(used) < used[0])
    try:
        for seed in range(count):
            choice = tightened(first, TIGHTER[seed], TIGHTEST)
            share = part_of(report, seed / count, 1 / count)
            second: Solution | None = None
            for second in _legs(solution, moved(start, seed), choice, until, share):
                if _is_lost(solution, second):
                    break
            assert second is not None
            seconds.append(second)
            start = start._replace(t_end=second._run.t_reached)
            if not second.success or monotonic() > until:
                break
    except BaseException as stop:
        if isinstance(partly := getattr(stop, "solution", second), Solution):
            seconds.append(partly)
        if seconds:
            hand_over(stop, estimate=estimate(solution, seconds, text))
        raise
    return estimate(solution, seconds, text)


def _legs(
    solution: Solution, start: Start, choice: Choice, until: float, report: Report
) -> Iterator[Solution]:
    """Yield a second run after each of its legs."""
    asked = solution._run.arguments
    max_steps = MORE_STEPS * asked["max_steps"]
    max_step = other_steps(solution, asked["max_step"])
    count = int(np.clip(solution.stats.accepted / STEPS_A_LEG, 1, LEGS))
    times = second_times(solution)
    ends = np.linspace(start.t_start, start.t_end, count + 1)[1:]
    parts = [None] * count if times is None else np.array_split(times, count)
    second: Solution | None = None
    for done, (end, part) in enumerate(zip(ends, parts, strict=True)):
        left = None if until == inf else max(1e-3, until - monotonic())
        share = part_of(report, done / count, 1 / count)
        share(0.0)  # a leg may be over before the core first reports
        if part is not None:
            if not len(part):
                return
            end = part[-1]
        limits: dict[str, Any] = {"max_steps": max_steps, "time_limit": left, "progress": share}
        if second is None:
            second = run(start._replace(t_end=end), choice, part, max_step=max_step, **limits)
        else:
            second = resumed(second, end, part, **limits)
        yield second
        if not second.success or monotonic() > until:
            return


def _choice_of(solution: Solution) -> Choice:
    """Return the method and tolerances of a solution; a fixed step counts as a tight tolerance."""
    asked = solution._run.arguments
    if asked["step"] is not None:
        return Choice(solution.method, FOR_FIXED_STEPS, FOR_FIXED_STEPS)
    return Choice(solution.method, asked["rtol"], asked["atol"])


def _common_times(solution: Solution, seconds: Sequence[Solution]) -> Floats:
    """Return the times to compare at: some in every step, or the kept ones that all reached."""
    if solution.store == "dense":
        return times_within_steps([solution, *seconds])
    times = kept_times(solution)
    if not len(times):
        times = np.array([solution._run.t_reached])
    return times[np.all([reached(second, times) for second in seconds], axis=0)]


def _is_lost(solution: Solution, second: Solution) -> bool:
    """Return whether two runs have nothing to do with each other where the second one ended."""
    last = np.array([second._run.t_reached])
    if solution.store != "dense":
        last = kept_times(solution)
        last = last[reached(second, last)][-1:]
    if not len(last):
        return False
    difference = largest_difference(angles_at(solution, last), angles_at(second, last))
    return not bool((difference < LOST).all())
