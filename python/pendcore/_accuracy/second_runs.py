"""The error of a trial from second runs, wherever its defect does not tell it.

A second run takes much tighter tolerances, by the same method unless impacts set its steps. Its
distance from the trial tells how large the error is; one more second run shows that the first one
is indeed better (`pendcore._accuracy.estimate`). Where rounding may matter, two or three second
runs as tight as doubles allow take the place of these.
"""

from __future__ import annotations

from math import inf

from pendcore._accuracy import tuning
from pendcore._accuracy.aim import aimed
from pendcore._accuracy.estimate import SPARE_OF_SEVERAL
from pendcore._accuracy.method_choice import leading
from pendcore._accuracy.rounding import neighbours
from pendcore._accuracy.trials import TrialRun, Trials
from pendcore._run.call import Start
from pendcore._run.error_estimate import ErrorEstimate


class SecondRuns:
    """The strategy that serves every scene."""

    method = ""
    serves_every_trial = True

    @property
    def first_aim(self) -> float:
        return tuning.FIRST

    def correction(self, start: Start, scale: float) -> None:
        """Its trials are made without."""

    def verify(self, runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
        """Return the error of a trial, if better second runs show it."""
        better = better_than(runs, trial)[: tight_runs(trial) or 2]
        if len(better) < (tight_runs(trial) or 2):
            return None
        if tight_runs(trial):
            share = _share_if_tight(runs, trial, better)
            return None if share is None else runs.compared(trial, better, share)
        is_other = better[0].method != trial.method and not runs.is_stiff
        if is_other or better[0].scale * tuning.RATIO > better[1].scale:
            return runs.compared(trial, better, tuning.SPARE)
        return runs.compared(trial, better)

    def next_run(self, runs: Trials) -> TrialRun | None:
        """Make a second run that the tightest trial lacks, or a tighter trial."""
        last = runs.tightest_trial
        better = better_than(runs, last)
        if len(better) < max(tight_runs(last), 1):
            return second_run(runs, last)
        known = self.verify(runs, last)
        distance = runs.compared(last, better[:1], 0.0)
        error = known or distance
        scale = aimed(runs, last, error, distance)
        if known is None and error.largest <= tuning.LIKELY * runs.error and not error.is_lost:
            if not tight_runs(last):
                return second_run(runs, last)
            is_missing = not looser_runs(runs, last, better[0])
            return runs.second(last, tuning.FARTHER * better[0].scale) if is_missing else None
        if last.rtol <= runs.tightest:
            return None
        scale = min(scale, last.scale / tuning.LEAST_CHANGE)
        return runs.trial(scale, runs.method_for(scale))


def second_run(runs: Trials, trial: TrialRun) -> TrialRun:
    """Make a second run that is better than a trial, and than all second runs that verify it."""
    if tight_runs(trial):
        return runs.second(trial, 0.0)
    if better_than(runs, trial):
        best = min(second.scale for second in runs.seconds)
        return runs.second(trial, best / tuning.BETTER_STILL)
    return runs.second(trial, trial.scale / (tuning.SPARED * better_by(trial)))


def _share_if_tight(runs: Trials, trial: TrialRun, seconds: list[TrialRun]) -> float | None:
    """Return the share that is added to the distance from second runs as tight as doubles allow.

    They may all have the same truncation error, which is estimated from looser runs of the method.
    None if there is no such run in a stiff scene, where it is needed.
    """
    own = max(runs.distance(trial, second) for second in seconds)
    truncation = inf
    for other in looser_runs(runs, trial, seconds[0]) if own else []:
        distance = runs.distance(other, seconds[0])
        if distance < tuning.NOTHING_IN_COMMON:
            ratio = seconds[0].scale / other.scale
            truncation = min(truncation, distance * ratio**tuning.CAUTION_IF_TIGHT)
    least = tuning.SHARE_IF_ALIKE if trial.rtol < tuning.ALIKE * runs.tightest else SPARE_OF_SEVERAL
    if truncation == inf:
        return None if runs.is_stiff and own > 0 else least + tuning.SPARE
    return max(least, truncation / own) + tuning.SPARE


def looser_runs(runs: Trials, trial: TrialRun, second: TrialRun) -> list[TrialRun]:
    """Return the runs that tell how the error of a second run's method depends on its tolerance."""
    others = (run for run in (*runs.trials, *runs.seconds) if run is not trial)
    alike = (run for run in others if run.method == second.method and run.solution.success)
    return [run for run in alike if run.scale >= tuning.LEAST_CHANGE * second.scale]


def better_than(runs: Trials, trial: TrialRun) -> list[TrialRun]:
    """Return the second runs that may verify a trial, the best first."""
    if tight_runs(trial):
        better = [run for run in runs.seconds if run.rtol <= runs.tightest]
    else:
        better = [run for run in runs.seconds if run.scale * better_by(run) <= trial.scale * 1.01]
    return sorted(better, key=lambda run: run.scale)


def better_by(trial: TrialRun) -> float:
    """Return the least factor by which a second run of its method is tighter than a trial."""
    return tuning.BETTER_SERIES if leading(trial.method) == "taylor" else tuning.BETTER


def tight_runs(trial: TrialRun) -> int:
    """Return how many second runs as tight as doubles allow a trial needs; 0: looser ones do."""
    return count + 1 if (count := neighbours(trial.scale)) else 0
