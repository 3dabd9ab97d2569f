"""What second runs, or its defect, tell of the error of a trial."""

from __future__ import annotations

from math import inf

from pendcore._accuracy.estimate import SPARE_OF_SEVERAL
from pendcore._accuracy.method_choice import leading
from pendcore._accuracy.rounding import neighbours
from pendcore._accuracy.trials import TrialRun, Trials
from pendcore._run.error_estimate import ErrorEstimate

LEAST_CHANGE, FARTHER = 1.5, 100.0
"""Factors by which the next trial is tighter: at least, and after a failed or chaotic one."""
BETTER, BETTER_SERIES, SPARED = 25.0, 100.0, 1.6
"""The least factors by which a second run is tighter than its trial. BETTER_SERIES is for `taylor`,
to which a digit more costs little, and whose order changes with the tolerance. SPARED is a further
factor that most second runs are tighter by, which lets them verify slightly tighter trials too."""
NOTHING_IN_COMMON = 0.2
"""Beyond this distance of two runs, the error is known only to be large."""
RATIO, SPARE = 5.0, 0.35
"""Two second runs whose scales differ by less than RATIO may be off alike, and by how much another
method than the trial's is better is not known: then SPARE is added."""
ALIKE, SHARE_IF_ALIKE = 20.0, 1.0
"""A trial whose rtol is less than ALIKE times the tightest may share errors with second runs as
tight as doubles allow: an implicit step's remainder, or that of steps which stability limits. Then
at least SHARE_IF_ALIKE times the distance is added."""
CAUTION_IF_TIGHT = 0.5
"""The exponent by which the error of looser runs is scaled down to that of these second runs."""


def known_error(runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
    """Return the error of a trial, if its defect or better second runs show it; else None."""
    if (error := runs.error_from_defect(trial)) is not None:
        return error
    better = better_than(runs, trial)[: tight_runs(trial) or 2]
    if len(better) < (tight_runs(trial) or 2):
        return None
    if tight_runs(trial):
        share = _share_if_tight(runs, trial, better)
        return None if share is None else runs.compared(trial, better, share)
    is_other = better[0].method != trial.method and not runs.is_stiff
    if is_other or better[0].scale * RATIO > better[1].scale:
        return runs.compared(trial, better, SPARE)
    return runs.compared(trial, better)


def _share_if_tight(runs: Trials, trial: TrialRun, seconds: list[TrialRun]) -> float | None:
    """Return the share that is added to the distance from second runs as tight as doubles allow.

    They may all have the same truncation error, which is estimated from looser runs of the method.
    None if there is no such run in a stiff scene, where it is needed.
    """
    own = max(runs.distance(trial, second) for second in seconds)
    truncation = inf
    for other in looser_runs(runs, trial, seconds[0]) if own else []:
        distance = runs.distance(other, seconds[0])
        if distance < NOTHING_IN_COMMON:
            ratio = seconds[0].scale / other.scale
            truncation = min(truncation, distance * ratio**CAUTION_IF_TIGHT)
    least = SHARE_IF_ALIKE if trial.rtol < ALIKE * runs.tightest else SPARE_OF_SEVERAL
    if truncation == inf:
        return None if runs.is_stiff and own > 0 else least + SPARE
    return max(least, truncation / own) + SPARE


def looser_runs(runs: Trials, trial: TrialRun, second: TrialRun) -> list[TrialRun]:
    """Return the runs that tell how the error of a second run's method depends on its tolerance."""
    others = (run for run in (*runs.trials, *runs.seconds) if run is not trial)
    alike = (run for run in others if run.method == second.method and run.solution.success)
    return [run for run in alike if run.scale >= LEAST_CHANGE * second.scale]


def better_than(runs: Trials, trial: TrialRun) -> list[TrialRun]:
    """Return the second runs that may verify a trial, the best first."""
    if tight_runs(trial):
        better = [run for run in runs.seconds if run.rtol <= runs.tightest]
    else:
        better = [run for run in runs.seconds if run.scale * better_by(run) <= trial.scale * 1.01]
    return sorted(better, key=lambda run: run.scale)


def better_by(trial: TrialRun) -> float:
    """Return the least factor by which a second run of its method is tighter than a trial."""
    return BETTER_SERIES if leading(trial.method) == "taylor" else BETTER


def tight_runs(trial: TrialRun) -> int:
    """Return how many second runs as tight as doubles allow a trial needs; 0: looser ones do."""
    return count + 1 if (count := neighbours(trial.scale)) else 0
