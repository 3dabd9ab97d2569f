"""The error of a run, from the defect of its own curve.

While the run is made, the core integrates the equation that its error obeys
(cpp/src/analysis/defect_correction.hpp). This takes the right-hand side of the
equations of motion, which shares no code with a Taylor series, a few times in each step. It is done
twice, with different numbers of points: the distance of the two is the error of the correction
itself. Where rounding may matter, it is also done for neighbours of the scene, whose constants and
starts are some last bits off (`pendcore._accuracy.rounding`). With all errors e_1, e_2, ... the
error is at most

    max_i |e_i| + share (the largest max_i |e_i| so far) + max_ij |e_i - e_j|

and what the rounding of states and times to doubles adds.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pendcore import _core
from pendcore._accuracy.estimate import apart, error_over
from pendcore._accuracy.position_error import angles_at
from pendcore._accuracy.rounding import moved, neighbours
from pendcore._run.call import Start, supports
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution
from pendcore._run.work import series_work


class Way(NamedTuple):
    """How the defect of a run tells its error.

    Attributes
    ----------
    method : str
        The method of the run.
    points : (int, int)
        The numbers of points in a step with which the scene itself is integrated.
    agree : float
        The two are trusted if their largest distance is at most this share of the largest error,
        up to where the run is lost. They differ by more where a motion is strongly damped, and
        after thousands of steps.
    share : float
        The share of the largest correction so far that is added to the error.
    parts : int
        The number of parts of a step that are integrated one after the other.
    """

    method: str
    points: tuple[int, int]
    agree: float
    share: float
    parts: int = 1


# Each way told too small an error of at most 5 of 7,200 runs (seeds 200 to 999 of
# tests/models/regular_scenes.py, nine tolerances); no search for an error returned one of these.
SERIES_6_5 = Way("taylor", (6, 5), agree=0.15, share=0.35)
SERIES_7_6 = Way("taylor", (7, 6), agree=0.2, share=0.35)
SERIES_8_7 = Way("taylor", (8, 7), agree=0.2, share=0.25)
SERIES_6_5_TWICE = Way("taylor", (6, 5), agree=0.2, share=0.5, parts=2)
SERIES_7_6_TWICE = Way("taylor", (7, 6), agree=0.3, share=0.4, parts=2)
RUNGE_KUTTA = Way("dop853", (9, 8), agree=0.1, share=1.0)
MANY_POINTS_BELOW = 1e-8
"""The error asked for below which a series has so many terms that it needs many points."""
EXPENSIVE, LOOSE = 18.0, 1e-5
"""Where a series takes as long as more than EXPENSIVE right-hand sides, and the error asked for is
larger than LOOSE, dop853 takes less work."""
LARGE = 0.1
"""A larger error asked for is left to second runs: from 0.2 on, a correction counts as lost."""
UNSTABLE = 5.0
"""A run that is lost with a larger error than this is not chaotic; its correction is unstable."""


def ways(start: Start, error: float) -> list[Way]:
    """Return the ways to know the error of a run from its defect, the first one to be tried first.

    There is none for an error above LARGE, and none where a law switches or has no series, or
    where a joint may be held.
    """
    if error > LARGE or not (
        _core.has_defect_correction(start.scene._compiled) and supports("taylor", start)
    ):
        return []
    if error < MANY_POINTS_BELOW:
        return [SERIES_8_7, SERIES_7_6_TWICE]
    by_series = [SERIES_6_5, SERIES_7_6, SERIES_6_5_TWICE]
    if error > LOOSE and series_work(start.scene, 1e-3) > EXPENSIVE:
        return [RUNGE_KUTTA, *by_series]
    return by_series


def correction_along(start: Start, way: Way, scale: float) -> _core.DefectCorrection:
    """Return what is to look on while a run of a typical error, ``scale``, is made."""
    motions: list[tuple[Start, tuple[int, ...]]] = [(start, way.points)]
    motions += [(moved(start, seed), way.points[1:]) for seed in range(neighbours(scale))]
    return _core.DefectCorrection(
        [(one.scene._compiled, one.q0, points) for one, points in motions], way.parts
    )


def error_from_defect(
    solution: Solution, correction: _core.DefectCorrection, way: Way, verified_by: str
) -> ErrorEstimate | None:
    """Return the error of a run as its correction shows it; None if this cannot be trusted.

    A run that is lost has no known error from there on.
    """
    between, largest, at_loss, t_known = correction.agreement
    if not (between <= way.agree * largest and at_loss < UNSTABLE):
        return None
    t, corrections = correction.t, np.moveaxis(correction.errors, 1, 0)
    if not len(t):
        t, corrections = np.array([solution._run.t_reached]), correction.errors_at_end
    with np.errstate(all="ignore"):
        corrected = corrections + angles_at(solution, t)
        found = apart(solution, t, lambda at: [*corrected[:, at]])
        angle, position = (
            from_run + way.share * np.maximum.accumulate(from_run) + from_others + found.rounding
            for from_run, from_others in (
                (found.angle_from_run, found.angle),
                (found.position_from_run, found.position),
            )
        )
    if at_loss:
        t_start = solution._run.arguments["t_start"]
        is_lost = np.abs(t - t_start) > abs(t_known - t_start)
        angle[is_lost] = position[is_lost] = np.inf
    return error_over(solution, t, angle, position, verified_by)
