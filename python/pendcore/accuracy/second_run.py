"""An independent second run: another method, at a tighter tolerance.

What one method gets wrong, such as a step size that is fooled or a wrong coefficient, another does
not get wrong in the same way. So their distance is an estimate of the error of the looser one. A
pair that changed over is compared with its second method, as explicit ones would take too long.
"""

from __future__ import annotations

from collections.abc import Iterator

from pendcore.accuracy.run import (
    Choice,
    Start,
    carries,
    known_methods,
    pair_of,
    run,
    start_of,
    tightened,
)
from pendcore.arguments import Floats
from pendcore.progress import Progress
from pendcore.solution import Solution

TIGHTEST = 1e-14
"""Below, smaller steps add more rounding than they take away truncation."""
FOR_FIXED_STEPS = 1e-12
"""The tolerance of a second run where the first had none."""

# Whom to ask for a second opinion: the first of these that can carry the scene and is another. A
# pair is its first, until it is stiff.
MOST_ACCURATE = ("taylor", "dop853", "dopri5", "radau5")
# The same where stability limits the steps of an explicit method: an implicit one, itself perhaps.
OF_AN_EXPLICIT_ONE_IF_STIFF = ("radau5", pair_of("dopri5"))
OF_RADAU5_IF_STIFF = (pair_of("dopri5"), "radau5")


def second_choices(
    start: Start, first: Choice, *, stiff: bool = False, tighter: float = 100.0
) -> Iterator[Choice]:
    """Yield how a second run may be made, the best one first.

    Parameters
    ----------
    start : Start
        What is run.
    first : Choice
        How the first run was made.
    stiff : bool
        Whether stability limited its steps, so that an explicit method may take too many.
    tighter : float
        By what factor the tolerances shrink, as far as doubles allow.
    """
    known = known_methods()[first.method]
    begins, goes_on = known["first"], known["second"]
    methods = tuple(method for method in MOST_ACCURATE if method != begins)
    if stiff and goes_on:  # which made most of the first run: the tolerances differ, no more
        methods = (goes_on,)
    elif stiff:
        methods = OF_RADAU5_IF_STIFF if begins == "radau5" else OF_AN_EXPLICIT_ONE_IF_STIFF
    choice = tightened(first, tighter, TIGHTEST)
    for method in methods:
        if carries(method, start):
            yield choice._replace(method=method, compensated=True)


def choice_of(solution: Solution) -> Choice:
    """Return how a solution was made; a fixed step counts as a tight tolerance."""
    asked = solution._run.arguments
    if asked["step"] is not None:
        fixed = FOR_FIXED_STEPS * 100
        return Choice(solution.method, fixed, fixed, asked["compensated"])
    return Choice(solution.method, asked["rtol"], asked["atol"], asked["compensated"])


def second_run(
    solution: Solution,
    t_eval: Floats | None = None,
    *,
    tighter: float = 100.0,
    time_limit: float | None = None,
    progress: Progress = False,
) -> Solution:
    """Run once more what a solution ran, with another method and at a tighter tolerance.

    Parameters
    ----------
    solution : Solution
        The first run. The second goes as far as that came.
    t_eval : ndarray, (k,), optional
        Times to keep, s. Default: all, densely.
    tighter : float
        By what factor the tolerances shrink, as far as doubles allow.
    time_limit : float, optional
        s of the clock for each attempt.
    progress
        As in `simulate`.

    Returns
    -------
    Solution
        Of the first method that got through; else of the one that came farthest.
    """
    asked, start = solution._run.arguments, start_of(solution)
    farthest: Solution | None = None
    for choice in second_choices(
        start, choice_of(solution), stiff=solution.stats.stiff, tighter=tighter
    ):
        made = run(
            start, choice, t_eval, max_step=asked["max_step"], max_steps=asked["max_steps"],
            time_limit=time_limit, progress=progress,
        )  # fmt: skip
        if made.success:
            return made
        if farthest is None or _left(made, start) < _left(farthest, start):
            farthest = made
    assert farthest is not None, "an explicit Runge-Kutta method carries every scene"
    return farthest


def _left(solution: Solution, start: Start) -> float:
    """Return how far from the end a run stopped, s."""
    return abs(start.t_end - solution._run.t_reached)
