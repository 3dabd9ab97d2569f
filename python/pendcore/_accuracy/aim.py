"""The scale at which the next trial likely keeps the error, as the error of another one tells."""

from __future__ import annotations

from pendcore._accuracy import tuning
from pendcore._accuracy.trials import TrialRun, Trials
from pendcore._run.error_estimate import ErrorEstimate


def aimed(
    runs: Trials, trial: TrialRun, error: ErrorEstimate, distance: ErrorEstimate | None = None
) -> float:
    """Return the scale at which a run likely keeps the error.

    ``distance`` is that from a second run, where the error of the trial is not verified by it.
    """
    if error.is_lost or error.largest > max(tuning.NOTHING_IN_COMMON, runs.error):
        return _scale_before_it_grew(runs, trial, distance or error)
    return trial.scale * tuning.AIM * runs.error / max(error.largest, 1e-9 * runs.error)


def _scale_before_it_grew(runs: Trials, trial: TrialRun, distance: ErrorEstimate) -> float:
    """Return the scale at which a chaotic motion keeps the error to its end.

    Errors grow as exp(rate t); the rate follows from the time at which the error becomes large.
    """
    begin = runs.start.t_start
    until = distance.valid_until(tuning.NOTHING_IN_COMMON, of="position") - begin
    farther = trial.scale / tuning.FARTHER
    if not until or trial.scale >= tuning.NOTHING_IN_COMMON:
        return farther
    whole = trial.solution.t_reached - begin
    grown: float = (trial.scale / tuning.NOTHING_IN_COMMON) ** float(whole / until)
    return min(farther, max(tuning.AIM * runs.error * grown, farther / tuning.FARTHER))
