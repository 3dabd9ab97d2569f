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

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from pendcore import _core
from pendcore._accuracy import tuning
from pendcore._accuracy.aim import aimed
from pendcore._accuracy.estimate import apart, error_over
from pendcore._accuracy.position_error import angles_at
from pendcore._accuracy.rounding import moved, neighbours
from pendcore._accuracy.trials import TrialRun, Trials
from pendcore._run.accuracy import DEFECT
from pendcore._run.call import Start
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution
from pendcore._run.work import series_work


@dataclass(frozen=True, slots=True, kw_only=True)
class FromDefect:
    """The strategy that takes the error of a trial from the defect of its own curve."""

    method: str
    """The method of its trials."""
    points: tuple[int, int]
    """The numbers of points in a step with which the scene itself is integrated."""
    agree: float
    """The two are trusted if their largest distance is at most this share of the largest error, up
    to where the run is lost. They differ by more where a motion is strongly damped, and after
    thousands of steps."""
    share: float
    """The share of the largest correction so far that is added to the error."""
    errors: tuple[float, float]
    """The errors asked for that it serves: from the first on, and below the second."""
    series_are_expensive: bool = False
    """Whether it serves scenes alone whose series take as long as many right-hand sides."""
    serves_every_trial: ClassVar[bool] = False

    @property
    def first_aim(self) -> float:
        return tuning.FIRST_BY_DEFECT

    def serves(self, start: Start, error: float) -> bool:
        """Whether it is tried for an error of a smooth scene."""
        least, most = self.errors
        if not least <= error < most:
            return False
        if not self.series_are_expensive:
            return True
        return series_work(start.scene, 1e-3) > tuning.EXPENSIVE

    def correction(self, start: Start, scale: float) -> _core.DefectCorrection:
        """Return what is to look on while a trial of a typical error, ``scale``, is made."""
        motions: list[tuple[Start, tuple[int, ...]]] = [(start, self.points)]
        motions += [(moved(start, seed), self.points[1:]) for seed in range(neighbours(scale))]
        return _core.DefectCorrection([(x.scene._compiled, x.q0, points) for x, points in motions])

    def verify(self, runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
        """Return the error of a trial as its correction shows it; None if it cannot be trusted."""
        correction, text = trial.correction, f"the {DEFECT}{trial.text}"
        if correction is None or trial.solution.stats.stiff:
            return None
        return runs.remembered(trial, lambda: self.error(trial.solution, correction, text))

    def next_run(self, runs: Trials) -> TrialRun | None:
        """Make a tighter trial; None where the defect of the last one did not tell its error."""
        last = runs.tightest_trial
        error = self.verify(runs, last)
        if error is None or last.rtol <= runs.tightest:
            return None
        scale = min(aimed(runs, last, error), last.scale / tuning.LEAST_CHANGE)
        return runs.trial(scale, last.method)

    def error(
        self, solution: Solution, correction: _core.DefectCorrection, verified_by: str
    ) -> ErrorEstimate | None:
        """Return the error of a run; one that is lost has no known error from there on."""
        between, largest, at_loss, t_known = correction.agreement
        if not (between <= self.agree * largest and at_loss < tuning.UNSTABLE):
            return None
        t, corrections = correction.t, np.moveaxis(correction.errors, 1, 0)
        if not len(t):
            t, corrections = np.array([solution._run.t_reached]), correction.errors_at_end
        with np.errstate(all="ignore"):
            corrected = corrections + angles_at(solution, t)
            found = apart(solution, t, lambda at: [*corrected[:, at]])
            angle, position = (
                from_run + self.share * np.maximum.accumulate(from_run) + rest + found.rounding
                for from_run, rest in (
                    (found.angle_from_run, found.angle),
                    (found.position_from_run, found.position),
                )
            )
        if at_loss:
            t_start = solution._run.arguments["t_start"]
            is_lost = np.abs(t - t_start) > abs(t_known - t_start)
            angle[is_lost] = position[is_lost] = np.inf
        return error_over(solution, t, angle, position, verified_by)
