"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

A *trial* is a run of what was asked for, at some tolerance. Its error tells which tolerance to try
next. There are two ways to know the error.

**From the defect** of the trial's own curve, for smooth scenes that have Taylor series and errors
that are not too large (`pendcore._accuracy.defect_correction`). If one way to integrate it cannot
be trusted, another one may be.

**From second runs**, wherever the defect does not tell. A second run takes much tighter tolerances,
by the same method unless impacts set its steps. Its distance from the trial tells how large the
error is; one more second run shows that the first one is indeed better
(`pendcore._accuracy.estimate`). Where rounding may matter, two or three second runs as tight as
doubles allow take the place of these.
"""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from math import inf
from typing import Any

import numpy as np

from pendcore._accuracy.known_error import (
    FARTHER,
    LEAST_CHANGE,
    NOTHING_IN_COMMON,
    SPARED,
    better_by,
    better_than,
    known_error,
    looser_runs,
    tight_runs,
)
from pendcore._accuracy.trials import MOST_STEPS, TrialRun, Trials
from pendcore._messages.arguments import finite_array
from pendcore._messages.progress import callback, close
from pendcore._run.accuracy import AccuracyError
from pendcore._run.call import Start
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution

# Where trials and second runs aim: factors of the error asked for, or of another run's scale.
FIRST_BY_DEFECT, FIRST = 0.5, 3.0
"""The multiples of the error asked for at which the first trial aims: if its defect is to be known,
after which most runs need no other trial, and if not."""
AT_FEW_TIMES, IF_DAMPED = 4.0, 100.0
"""Both are multiplied by these where few times are kept, as the error is hardly largest there, and
where dampers make the motion forget its errors."""
AIM = 0.65
"""Later trials aim at this multiple of the error asked for."""
BETTER_STILL = 8.0
"""One more second run is tighter than all others by this factor."""
# When something counts as known: bounds of distances and ratios.
LIKELY = 0.9
"""A trial no farther from a second run than this share of the error is likely good enough."""
HOPELESS = 1e-6
"""A larger error at the tightest tolerances is not rounding alone, but its growth."""
LATE, LARGE_ANGLE = 0.1, 100.0
"""A late start is to blame where the rounding of times makes the share LATE of the error; angles
above LARGE_ANGLE, rad, unless without them the error would be hopeless too."""
FOLLOWED_BADLY = ("step_too_small", "non_finite")
"""The statuses that loose tolerances may cause."""
MOST_RUNS, MOST_SEARCHES = 16, 3
"""The number of runs after which a search ends, and of searches for the least error."""


def run_to_error(start: Start, error: float, options: dict[str, Any]) -> Solution:
    """Return a run whose error is verified to be at most ``error``; see `pendcore.simulate`.

    ``options`` are further keywords of `run`; ``time_limit`` holds for all runs together.

    Raises
    ------
    AccuracyError
        If the error could not be kept, or not be verified.
    KeyboardInterrupt, or any exception of ``progress`` or of a function of the user's
        With the tightest trial so far as the attribute ``solution``, complete or as far as it came.
        Its ``accuracy`` says that it is not verified.
    """
    finite_array("t_span", (start.t_start, start.t_end), "s")
    report = callback(options.pop("progress", None))
    runs = Trials(start, error, options, report)
    try:
        return kept_run(runs)
    except AccuracyError:
        raise
    except BaseException as stop:
        best = runs.refused or runs.best()
        if isinstance(partly := getattr(stop, "solution", None), Solution):
            best = best or (partly if partly.scene is start.scene else None)
            del stop.solution  # type: ignore[attr-defined]
        if best is not None and best is not runs.refused:
            during = "while it was verified" if best.success else "during the run itself"
            runs.labelled(best, "ended early", None, f"interrupted {during}")
        if best is not None:
            stop.solution = best  # type: ignore[attr-defined]
        raise
    finally:
        close(report)


def kept_run(runs: Trials) -> Solution:
    """Return a run that keeps the error, or one that ended early."""
    scale = _first_scale(runs, FIRST_BY_DEFECT)
    while runs.ways:
        trial = _first_trial(runs, scale)
        kept = _kept_by_defect(runs, trial)
        if kept is not None:
            return kept
        if any(trial.solution.stats.stiff for trial in runs.trials):
            break
        scale = runs.trials[-1].scale
        runs.next_way()
    return _kept_by_second_runs(runs)


def _first_scale(runs: Trials, factor: float) -> float:
    """Return the scale of a first trial: a factor times the error asked for, or looser."""
    if runs.keeps_few_times:
        factor *= AT_FEW_TIMES
    if runs.any_effect(lambda effect: effect.damps_small_motions):
        factor *= IF_DAMPED
    return factor * runs.error


def _kept_by_defect(runs: Trials, trial: TrialRun) -> Solution | None:
    """Return a run whose defect shows how large its error is; None if the defect does not."""
    while not trial.solution.stats.stiff:
        if not trial.solution.success:
            return _not_finished(runs, trial)
        error = runs.error_from_defect(trial)
        if error is None:
            return None
        if error.tells_the_end and error.largest <= runs.error:
            return runs.labelled(trial.solution, "kept", error)
        if trial.rtol <= runs.tightest or len(runs.paid) >= MOST_RUNS:
            raise _refusal(runs)
        aimed = min(_aimed(runs, trial, error), trial.scale / LEAST_CHANGE)
        trial = runs.trial(aimed, trial.method)
    return None


def _kept_by_second_runs(runs: Trials) -> Solution:
    if not runs.trials:
        _first_trial(runs, _first_scale(runs, FIRST))
    if not runs.trials[0].solution.success:
        return _ended_early(runs, runs.trials[0])
    runs.is_stiff = any(trial.solution.stats.stiff for trial in runs.trials)
    while len(runs.paid) < MOST_RUNS:
        latest = _next_run(runs)
        if latest is None:
            break
        if not latest.solution.success:
            if latest in runs.trials and latest.scale > min(trial.scale for trial in runs.trials):
                runs.drop(latest)  # a tighter trial came to the end, so this one shows nothing
                continue
            return _not_finished(runs, latest)
        for trial in sorted(runs.trials, key=lambda trial: -trial.scale):
            error = known_error(runs, trial)
            if error is not None and error.tells_the_end and error.largest <= runs.error:
                return runs.labelled(trial.solution, "kept", error)
    raise _refusal(runs)


def _not_finished(runs: Trials, latest: TrialRun) -> Solution:
    """Return a trial that did not get to its end, or raise why that ends the search."""
    status, is_first = latest.solution.status, latest in runs.trials[:1]
    is_end = latest in runs.trials and (is_first or status != "max_steps")
    if status == "time_limit" or is_end:
        return _ended_early(runs, latest)
    why = f"{latest.text}: {latest.solution.message}"
    if latest.solution._run.arguments["max_steps"] < runs.options["max_steps"]:
        why = f"{latest.text} takes more than {MOST_STEPS} times the steps of the first trial"
    raise _refusal(runs, why)


def _first_trial(runs: Trials, scale: float) -> TrialRun:
    """Run at a tolerance that is not too loose to follow the motion to its end."""
    trial = runs.trial(scale, runs.method_for(runs.error))
    while trial.solution.status in FOLLOWED_BADLY and trial.rtol > runs.tightest:
        before = trial.solution._run.t_reached
        runs.drop(trial)
        trial = runs.trial(trial.scale / FARTHER, trial.method)
        if abs(trial.solution._run.t_reached - before) <= 1e-3 * abs(before - runs.start.t_start):
            break  # both say that the motion ends there
    return trial


def _next_run(runs: Trials) -> TrialRun | None:
    """Make the run that is expected to verify a trial; None where no run can."""
    last = min(runs.trials, key=lambda trial: trial.scale)
    better = better_than(runs, last)
    if len(better) < max(tight_runs(last), 1):
        return _second(runs, last)
    known = known_error(runs, last)
    distance = runs.compared(last, better[:1], 0.0)
    error = known or distance
    aimed = _aimed(runs, last, error, distance)
    if known is None and error.largest <= LIKELY * runs.error and not error.is_lost:
        if not tight_runs(last):
            return _second(runs, last)
        is_missing = not looser_runs(runs, last, better[0])
        return runs.second(last, FARTHER * better[0].scale) if is_missing else None
    if last.rtol <= runs.tightest:
        return None
    aimed = min(aimed, last.scale / LEAST_CHANGE)
    return runs.trial(aimed, runs.method_for(aimed))


def _second(runs: Trials, trial: TrialRun) -> TrialRun:
    """Make a second run that is better than a trial, and than all second runs that verify it."""
    if tight_runs(trial):
        return runs.second(trial, 0.0)
    if better_than(runs, trial):
        return runs.second(trial, min(second.scale for second in runs.seconds) / BETTER_STILL)
    return runs.second(trial, trial.scale / (SPARED * better_by(trial)))


def _aimed(
    runs: Trials, trial: TrialRun, error: ErrorEstimate, distance: ErrorEstimate | None = None
) -> float:
    """Return the scale at which a run likely keeps the error, as the error of a trial tells."""
    if error.is_lost or error.largest > max(NOTHING_IN_COMMON, runs.error):
        return _scale_before_it_grew(runs, trial, distance or error)
    return trial.scale * AIM * runs.error / max(error.largest, 1e-9 * runs.error)


def _scale_before_it_grew(runs: Trials, trial: TrialRun, distance: ErrorEstimate) -> float:
    """Return the scale at which a chaotic motion keeps the error to its end.

    Errors grow as exp(rate t); the rate follows from the time at which the error becomes large.
    """
    begin = runs.start.t_start
    until = distance.valid_until(NOTHING_IN_COMMON, of="position") - begin
    farther = trial.scale / FARTHER
    if not until or trial.scale >= NOTHING_IN_COMMON:
        return farther
    whole = trial.solution._run.t_reached - begin
    grown: float = (trial.scale / NOTHING_IN_COMMON) ** float(whole / until)
    return min(farther, max(AIM * runs.error * grown, farther / FARTHER))


def _ended_early(runs: Trials, latest: TrialRun) -> Solution:
    """Return a trial that did not get to its end, with what is known of its error.

    At the time limit it is the tightest complete trial, if there is one, which is not verified.
    """
    if latest.solution.status == "time_limit":
        whole, why = runs.best(), "the time limit was reached before it was verified"
        if whole is None:
            why = "the run ended early: time_limit"
        return runs.labelled(whole or latest.solution, "ended early", None, why)
    error = runs.error_from_defect(latest)
    if error is None:
        seconds = [_second(runs, latest) for _ in range(tight_runs(latest) or 2)]
        error = runs.compared(latest, seconds)
    solution = runs.labelled(latest.solution, "ended early", error)
    if not error.is_complete and runs.is_out_of_time:
        solution.known_error = None  # a later call with more time may complete the estimate
    return solution


def _refusal(runs: Trials, why: str = "") -> AccuracyError:
    """Return the exception that says which error was reached, and why not a smaller one."""
    asked = f"error = {runs.error:g}"
    complete = [trial for trial in runs.trials if trial.solution.success] or runs.trials
    complete.sort(key=lambda trial: trial.scale)
    last = next((one for one in complete if known_error(runs, one) is not None), complete[0])
    error = known_error(runs, last)
    if len(runs.paid) >= MOST_RUNS:
        why = why or f"the search ended after {MOST_RUNS} runs: a larger error may be kept"
    why = why or _in_the_way(runs, last, error)
    if error is None or not error.is_complete:
        runs.labelled(last.solution, "refused", None, why)
        return AccuracyError(f"{asked}: {last.text} could not be verified: {why}", last.solution)
    runs.refused = runs.labelled(last.solution, "refused", error)
    least = inf if error.is_lost else _least_kept(runs, error.largest)
    runs.labelled(last.solution, "refused", error)  # with all that was paid
    reached, remedies = "no error can be kept to the end", []
    if least < inf:
        reached = f"the least that could be verified is {least:.1e}"
        remedies = [f"ask for error = {least:.1e} or more"]
    elif not error.is_lost:
        reached = f"{error.largest:.1e} was reached, but no search kept an error so small"
    until, begin = error.valid_until(runs.error, of="position"), runs.start.t_start
    if until != begin:
        not_past = ROUND_FLOOR if until > begin else ROUND_CEILING
        digits = 8 + round(np.log10(max(1.0, abs(until / (until - begin)))))
        why += f"; the error is kept until t = {_rounded(until, digits, not_past):f} s"
        remedies.append("end t_span well before that")
    message = ": ".join((asked, "not reached", reached, why, ", or ".join(remedies)))
    return AccuracyError(message.removesuffix(": "), last.solution, least)


def _least_kept(runs: Trials, least: float) -> float:
    """Return an error of two digits, the known one or a larger, that a search for it keeps.

    For a larger error the trials are looser, and their verification may give a larger error.
    Infinite if no such error was found.
    """
    if not runs.tries_the_least:
        return least
    for _ in range(MOST_SEARCHES):
        least = float(_rounded(min(least, 1.0), 2, ROUND_CEILING))
        if least == 1:
            break  # no error can be asked for that is not below 1
        again = runs.for_least(least)
        try:
            told = kept_run(again).accuracy
            return least if told is not None and told.reached else inf
        except AccuracyError as larger:
            least = larger.least
        finally:
            runs.add(again)
    return inf


def _rounded(x: float, digits: int, rounding: str) -> Decimal:
    return Context(prec=digits, rounding=rounding).create_decimal_from_float(x)


def _in_the_way(runs: Trials, trial: TrialRun, error: ErrorEstimate | None) -> str:
    """Return what keeps the error from becoming smaller, as far as this is known."""
    if error is None or trial.rtol > runs.tightest:
        is_own = runs.any_effect(lambda effect: effect.is_function)
        question = ": is a law of your own not smooth?" if is_own else ""
        return f"the error does not follow the tolerances{question}"
    solution = trial.solution
    begin, end, n = error.begin, solution._run.t_reached, len(solution.scene.links)
    last_bit = np.spacing(max(abs(begin), abs(end)))
    rates = np.vstack([solution.qd, solution._run.y_reached[n : 2 * n]])
    turned = last_bit / 2 * np.abs(rates).max()
    if abs(begin) > abs(end - begin) and turned > LATE * error.largest:
        return f"times from {begin:g} s on are rounded to {last_bit:.0e} s; begin nearer to 0"
    angle = np.abs(solution._run.arguments["q0"]).max()
    if angle > LARGE_ANGLE and not error.is_lost and error.largest < HOPELESS * angle:
        bit = np.spacing(angle)
        return f"angles of {angle:.0e} rad are rounded to {bit:.0e} rad; begin with fewer turns"
    if error.is_lost or error.largest > HOPELESS:
        return "neighbouring motions part too fast for double precision"
    return "tighter tolerances are lost in the rounding of doubles"
