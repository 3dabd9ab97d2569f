"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

Two kinds of runs are made in a loop. A *trial* is what was asked for, at some tolerance. A *second
run* is better: it takes the same method at a twenty-fifth of the tolerance or less (`taylor` at a
hundredth), its constants and start are moved by some last bits, and its steps are others. The
distance of the two tells how large the error is on this scene, and so which tolerance to try next.
A trial is returned when its error is at most the one asked for, and the second run is known to be
the better of the two. Either of these shows that:

* another trial at a different tolerance, if the errors of both trials are in about the ratio of
  their tolerances: then the error of the second run is smaller in proportion too; or
* one more second run, whose distance from the first is added (`pendcore.accuracy.estimate`).

Where tolerances are so tight that rounding may matter, two or three second runs as tight as doubles
allow take the place of these. The loop ends with a trial whose error is small enough, with an
`AccuracyError` that says the least error that can be reached, or with a run that ended early.
"""

from __future__ import annotations

from math import inf, log
from typing import Any

from pendcore.accuracy.estimate import SPARE_OF_SEVERAL
from pendcore.accuracy.method_choice import LOOSEST
from pendcore.accuracy.trials import TrialRun, Trials, leading
from pendcore.messages.arguments import finite_array
from pendcore.messages.progress import callback, close
from pendcore.run.accuracy import AccuracyError
from pendcore.run.call import Start
from pendcore.run.error_estimate import ErrorEstimate
from pendcore.run.result import RunResult

# Where trials and second runs aim: factors of the error asked for, or of another run's scale.
FIRST, LOOSE = 3.0, 1e-3
"""The first trial aims at FIRST times an error asked for below LOOSE, else at AIM times it."""
AIM = 0.65
"""Later trials aim at this multiple of the error asked for."""
LEAST_CHANGE, FARTHER = 1.5, 100.0
"""Factors by which the next trial is tighter: at least, and after a failed or chaotic one."""
LOOSER, NEXT_LOOSER, APART = 50.0, 8.0, 1.9
"""A trial that measures an exponent is looser by the factor LOOSER, or else NEXT_LOOSER. Its scale
differs from that of every other trial by at least the factor APART."""
BETTER, BETTER_SERIES, SPARED = 25.0, 100.0, 1.6
"""The least factors by which a second run is tighter than its trial. BETTER_SERIES is for `taylor`,
to which a digit more costs little, and whose order changes with the tolerance. SPARED is a further
factor that most second runs are tighter by, which lets them verify slightly tighter trials too."""
FAR_BETTER = 1000.0
"""The same factor for the first second run of `taylor`, which can verify tighter trials too."""
BETTER_STILL = 8.0
"""One more second run is tighter than all others by this factor."""
# When something counts as known: bounds of distances, ratios and exponents.
NOTHING_IN_COMMON = 0.2
"""Beyond this distance of two runs, the error is known only to be large."""
LIKELY = 0.9
"""A trial no farther from a second run than this share of the error is likely good enough."""
RATIO = 5.0
"""The least ratio of two scales from which an exponent is measured."""
FOLLOWS, FOLLOWS_AT_FEW_TIMES, FEW = 2.0, 1.4, 50
"""The largest exponents of the tolerance with which an error may seem to fall. The second is for
fewer than FEW times, where an error that is small by chance looks as if it fell faster."""
CAUTION = 0.6
"""The share of a measured exponent that is trusted at tolerances beyond those measured."""
SHARE, SPARE = 0.35, 0.35
"""SHARE is the largest share of their distance that the error of a single second run may be. SPARE
is added to the share, as methods do not all follow their tolerances alike."""
ALIKE, SHARE_IF_ALIKE = 20.0, 1.0
"""Second runs as tight as doubles allow, but not tighter than the trial by the factor ALIKE, may
share errors with it: an implicit step's remainder, or that of steps which stability limits. Then at
least SHARE_IF_ALIKE times the distance is added."""
CAUTION_IF_TIGHT = 0.5
"""The exponent by which the error of looser runs is scaled down to that of these second runs."""
ROUNDING = 1.5e-12
"""The largest scale of the error that moved constants and starts made on three hundred scenes.

The median was 5e-14. Rounding itself makes at most an eighth of that error.
"""
ROUNDING_MATTERS = ((1e-12, 3), (5e-12, 2))
"""Pairs: a trial below this scale needs this many second runs as tight as doubles allow."""
HOPELESS = 1e-6
"""A larger error at the tightest tolerances is not rounding alone, but its growth (chaos)."""
FOLLOWED_BADLY = ("step_too_small", "non_finite")
"""The statuses that loose tolerances may cause."""
MOST_RUNS = 16
"""The number of runs after which the search ends."""


def run_to_error(start: Start, error: float, options: dict[str, Any]) -> RunResult:
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
        return _kept(runs)
    except AccuracyError:
        raise
    except BaseException as stop:
        best = runs.best()
        if isinstance(partly := getattr(stop, "solution", None), RunResult):
            best = best or (partly if partly.scene is start.scene else None)
            del stop.solution  # type: ignore[attr-defined]
        if best is not None:
            during = "while it was verified" if best.success else "during the run itself"
            runs.labelled(best, "ended early", None, f"interrupted {during}")
            stop.solution = best  # type: ignore[attr-defined]
        raise
    finally:
        close(report)


def _kept(runs: Trials) -> RunResult:
    first = _first_trial(runs)
    if not first.solution.success:
        return _ended_early(runs, first)
    runs.is_stiff = first.solution.stats.stiff
    while len(runs.paid) < MOST_RUNS:
        latest = _next_run(runs)
        if latest is None:
            break
        if not latest.solution.success:
            status = latest.solution.status
            if latest in runs.trials and latest.scale > min(trial.scale for trial in runs.trials):
                runs.drop(latest)  # a tighter trial came to the end, so this one shows nothing
                continue
            if status == "time_limit" or (latest in runs.trials and status != "max_steps"):
                return _ended_early(runs, latest)
            raise _refusal(runs, f"{latest.text}: {latest.solution.message}")
        for trial in sorted(runs.trials, key=lambda trial: -trial.scale):
            error = _known_error(runs, trial)
            if error is not None and error.tells_the_end and error.largest <= runs.error:
                return runs.labelled(trial.solution, "kept", error)
    raise _refusal(runs)


def _first_trial(runs: Trials) -> TrialRun:
    """Run at a tolerance that is not too loose to follow the motion to its end."""
    scale = runs.error * (FIRST if runs.error < LOOSE else AIM)
    trial = runs.trial(scale, runs.method_for(runs.error))
    while trial.solution.status in FOLLOWED_BADLY and trial.rtol > runs.tightest:
        before = trial.solution.run.t_reached
        runs.drop(trial)
        trial = runs.trial(trial.scale / FARTHER, trial.method)
        if abs(trial.solution.run.t_reached - before) <= 1e-3 * abs(before - runs.start.t_start):
            break  # both say that the motion ends there
    return trial


def _next_run(runs: Trials) -> TrialRun | None:
    """Make the run that is expected to verify a trial; None where no run can."""
    last = min(runs.trials, key=lambda trial: trial.scale)
    better = _better_than(runs, last)
    if len(better) < max(_tight_runs(last), 1):
        return _second(runs, last)
    known = _known_error(runs, last)
    error = known or runs.compared(last, better[:1], 0.0)
    if error.is_lost or error.largest > max(NOTHING_IN_COMMON, runs.error):
        aimed = _scale_before_it_grew(runs, last, better[0])
    else:
        aimed = last.scale * AIM * runs.error / max(error.largest, 1e-9 * runs.error)
    if known is None and error.largest <= LIKELY * runs.error and not error.is_lost:
        looser = _looser(runs, last, aimed)
        if looser is not None:
            return runs.trial(looser, last.method)
        return None if _tight_runs(last) else _second(runs, last)
    if last.rtol <= runs.tightest:
        return None
    aimed = min(aimed, last.scale / LEAST_CHANGE)
    return runs.trial(aimed, runs.method_for(aimed))


def _looser(runs: Trials, trial: TrialRun, aimed: float) -> float | None:
    """Return the scale of a looser trial from which an exponent can be measured, if any."""
    scales = [LOOSER * trial.scale, NEXT_LOOSER * trial.scale]
    if aimed > RATIO * trial.scale:
        scales.insert(0, aimed)
    loosest = LOOSEST * trial.scale / trial.rtol
    for scale in (min(scale, loosest) for scale in scales):
        ratios = [scale / other.scale for other in runs.trials]
        is_useful = RATIO * trial.scale <= scale < runs.too_loose
        if is_useful and not any(1 / APART < r < APART for r in ratios):
            return scale
    return None


def _second(runs: Trials, trial: TrialRun) -> TrialRun:
    """Make a second run that is better than a trial, and than all second runs that verify it."""
    if _tight_runs(trial):
        return runs.second(trial, 0.0)
    if _better_than(runs, trial):
        return runs.second(trial, min(second.scale for second in runs.seconds) / BETTER_STILL)
    is_first_of_series = not runs.seconds and leading(trial.method) == "taylor"
    better_by = FAR_BETTER if is_first_of_series else SPARED * _better_by(trial)
    return runs.second(trial, trial.scale / better_by)


def _better_by(trial: TrialRun) -> float:
    """Return the least factor by which a second run of its method is tighter than a trial."""
    return BETTER_SERIES if leading(trial.method) == "taylor" else BETTER


def _scale_before_it_grew(runs: Trials, trial: TrialRun, second: TrialRun) -> float:
    """Return the scale at which a chaotic motion keeps the error to its end.

    Errors grow as exp(rate t); the rate follows from the time at which the two runs part.
    """
    begin = runs.start.t_start
    distance = runs.compared(trial, [second], 0.0)
    until = distance.valid_until(NOTHING_IN_COMMON, of="position") - begin
    farther = trial.scale / FARTHER
    if not until or trial.scale >= NOTHING_IN_COMMON:
        return farther
    whole = trial.solution.run.t_reached - begin
    grown: float = (trial.scale / NOTHING_IN_COMMON) ** float(whole / until)
    return min(farther, max(AIM * runs.error * grown, farther / FARTHER))


def _known_error(runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
    """Return the error of a trial, if its second runs are known to be better; else None."""
    better = _better_than(runs, trial)
    count = _tight_runs(trial) or 2
    if len(better) >= count:
        if _tight_runs(trial):
            share = _share_if_tight(runs, trial, better[:count])
            return None if share is None else runs.compared(trial, better[:count], share)
        if better[0].scale * RATIO > better[1].scale:
            return runs.compared(trial, better[:count], SPARE)  # they may be off alike
        return runs.compared(trial, better[:count])
    if _tight_runs(trial) or not better:
        return None
    share = _share(runs, trial, better[0])
    return runs.compared(trial, better[:1], share + SPARE) if share <= SHARE else None


def _share(runs: Trials, trial: TrialRun, second: TrialRun) -> float:
    """Return a bound of a second run's error as a share of its trial's, from other trials."""
    least = inf
    own = runs.distance(trial, second)
    times = len(runs.compared(trial, [second], 0.0).t)
    most = FOLLOWS if times >= FEW else FOLLOWS_AT_FEW_TIMES
    for other in runs.trials:
        ratio = other.scale / trial.scale
        if 1 / RATIO < ratio < RATIO or second not in _better_than(runs, other):
            continue
        if not other.method == trial.method == second.method:
            continue  # a scene may suit one method and not the other
        distance = runs.distance(other, second)
        if min(own, distance) > 0 and max(own, distance) < NOTHING_IN_COMMON:
            exponent = log(distance / own) / log(ratio)
            if 0 < exponent <= most:
                trusted = CAUTION * min(exponent, 1.0)
                least = min(least, (second.scale / trial.scale) ** trusted)
    return least + ROUNDING / trial.scale


def _share_if_tight(runs: Trials, trial: TrialRun, seconds: list[TrialRun]) -> float | None:
    """Return the share that is added to the distance from second runs as tight as doubles allow.

    They may all have the same truncation error, which is estimated from looser runs of the method.
    None if there is no such run in a stiff scene, where it is needed.
    """
    own = max(runs.distance(trial, second) for second in seconds)
    truncation = inf
    for other in (*runs.trials, *runs.seconds):
        is_looser = other is not trial and other.scale >= LEAST_CHANGE * seconds[0].scale
        if not (is_looser and other.method == seconds[0].method and other.solution.success and own):
            continue
        distance = runs.distance(other, seconds[0])
        if distance < NOTHING_IN_COMMON:
            ratio = seconds[0].scale / other.scale
            truncation = min(truncation, distance * ratio**CAUTION_IF_TIGHT)
    least = SHARE_IF_ALIKE if trial.rtol < ALIKE * runs.tightest else SPARE_OF_SEVERAL
    if truncation == inf:
        return None if runs.is_stiff and own > 0 else least + SPARE
    return max(least, truncation / own) + SPARE


def _better_than(runs: Trials, trial: TrialRun) -> list[TrialRun]:
    """Return the second runs that may verify a trial, the best first."""
    if _tight_runs(trial):
        better = [run for run in runs.seconds if run.rtol <= runs.tightest]
    else:
        better = [run for run in runs.seconds if run.scale * _better_by(run) <= trial.scale * 1.01]
    return sorted(better, key=lambda run: run.scale)


def _tight_runs(trial: TrialRun) -> int:
    """Return how many second runs as tight as doubles allow a trial needs; 0: looser ones do."""
    return next((count for below, count in ROUNDING_MATTERS if trial.scale < below), 0)


def _ended_early(runs: Trials, latest: TrialRun) -> RunResult:
    """Return a trial that did not get to its end, with what is known of its error.

    At the time limit it is the tightest complete trial, if there is one, which is not verified.
    """
    if latest.solution.status == "time_limit":
        why = "the run ended early: time_limit"
        if whole := runs.best():
            why = "the time limit was reached before it was verified"
        return runs.labelled(whole or latest.solution, "ended early", None, why)
    seconds = [_second(runs, latest) for _ in range(_tight_runs(latest) or 2)]
    error = runs.compared(latest, seconds)
    solution = runs.labelled(latest.solution, "ended early", error)
    if not error.is_complete:
        solution.known_error = None  # a later call with more time may complete the estimate
    return solution


def _refusal(runs: Trials, why: str = "") -> AccuracyError:
    """Return the exception that says which error was reached, and why not a smaller one."""
    asked = f"error = {runs.error:g}"
    complete = [trial for trial in runs.trials if trial.solution.success]
    last = min(complete or runs.trials, key=lambda trial: trial.scale)
    error = _known_error(runs, last)
    if len(runs.paid) >= MOST_RUNS:
        why = why or f"the search ended after {MOST_RUNS} runs: another error may be kept"
    if error is None or why:
        why = why or _does_not_follow(runs)
        runs.labelled(last.solution, "refused", None, why)
        message = f"{asked}: the run by {last.text} could not be verified: {why}"
        return AccuracyError(message, last.solution)
    runs.labelled(last.solution, "refused", error)
    if last.rtol > runs.tightest:
        why = _does_not_follow(runs)
    elif error.is_lost or error.largest > HOPELESS:
        why = "neighbouring motions part too fast for double precision (chaos)"
    else:
        why = "tighter tolerances are lost in the rounding of doubles"
    least = inf if error.is_lost else error.largest
    reached = f"the least that can be kept is {least:.1e}"
    if error.is_lost:
        reached = "no error can be kept to the end"
    until = error.valid_until(runs.error, of="position")
    held = f"; it holds until t = {until:.6g} s" if until != runs.start.t_start else ""
    return AccuracyError(f"{asked}: not reached: {reached}: {why}{held}", last.solution, least)


def _does_not_follow(runs: Trials) -> str:
    """Return why no tolerance was found, as far as this is known."""
    has_own_law = any(effect.kind == "user" for effect in runs.start.scene.effects)
    question = ": is a law of your own not smooth?" if has_own_law else ""
    return f"the error does not follow the tolerances{question}"
