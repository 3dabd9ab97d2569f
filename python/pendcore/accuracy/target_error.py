"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

Two kinds of runs are made in a loop. A *trial* is what was asked for, at some tolerance. A *second
run* is better: it takes the same method at a twenty-fifth of the tolerance or less (`taylor` at a
hundredth), its constants and start are moved by some last bits, and its steps are others. The
distance of the two says how the error follows the tolerance on this scene, and so at which
tolerance to try next. A trial is returned when its error is at most the one asked for, and the
second run is known to be the better of the two:

* by another trial, at a different tolerance, whose error is to the first one's as their tolerances
  let expect: then the second run's is smaller by as much; or
* by one more second run, whose distance from the first is added (`pendcore.accuracy.estimate`).

Where tolerances are so tight that rounding may matter, two or three second runs as tight as doubles
allow take the place of these. The loop ends with a run that is kept, with an `AccuracyError` that
says the least error there is, or with a run that ended early, and what is known of it.
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

# What tolerances aim at.
FIRST, LOOSE = 3.0, 1e-3
"""What multiple of the error the first trial aims at; the error above which it aims to keep it."""
AIM = 0.65
"""What share of the error the trials after that aim at."""
LEAST_CHANGE, FARTHER = 1.5, 100.0
"""By what factor a trial is tighter at least than one that was too loose, or that was lost."""
LOOSER, NEXT_LOOSER, APART = 50.0, 8.0, 1.9
"""By what factor a trial is looser that shows how the error follows the tolerance; by what another
is, if that one did not show it; how far it is from those that were made, at least."""
BETTER, BETTER_SERIES, SPARED = 25.0, 100.0, 1.6
"""By what factor a second run is better than a trial at least; by what one of `taylor` is, to which
a digit more costs little, and whose order changes with the tolerance; what it has to spare."""
FAR_BETTER = 1000.0
"""By what factor the first second run of `taylor` is better: it may verify a tighter trial too."""
BETTER_STILL = 8.0
"""By what factor one more second run is better, which tells how good the first one is."""
# When something counts as known.
NOTHING_IN_COMMON = 0.2
"""A distance beyond says of the error only that it is large."""
LIKELY = 0.9
"""What share of the error a distance is at most for the run to be likely good enough."""
RATIO = 5.0
"""By what factor two tolerances differ at least to tell an exponent."""
FOLLOWS, FOLLOWS_AT_FEW_TIMES, FEW = 2.0, 1.4, 50
"""Up to which exponent of the tolerance an error is said to follow it.

At few times an error may be small by chance, which looks as if it fell faster.
"""
CAUTION = 0.6
"""What share of the exponent is trusted beyond the tolerances where it was seen."""
SHARE, SPARE = 0.35, 0.35
"""What the error of a single second run may be, as a share of the distance from it, at most; and
what is added to that, as methods do not all follow their tolerances alike."""
ALIKE, SHARE_IF_ALIKE = 20.0, 1.0
"""If second runs as tight as doubles allow are less than this factor tighter than the trial, they
have in common with it as much as they differ by: what an implicit step leaves over, or steps that
stability sets."""
CAUTION_IF_TIGHT = 0.5
"""The exponent with which the error of looser runs is carried over to these second runs."""
ROUNDING = 1.5e-12
"""The scale of an error that constants and start make that are moved, at most.

On three hundred scenes; on half of them 5e-14. What rounding itself does is an eighth and less.
"""
ROUNDING_MATTERS = ((1e-12, 3), (5e-12, 2))
"""The scale of a trial below which so many second runs as tight as doubles allow verify it."""
HOPELESS = 1e-6
"""An error at the tightest tolerances beyond which it is not rounding alone, but its growth."""
FOLLOWED_BADLY = ("step_too_small", "non_finite")
"""Statuses of a run whose tolerances may have been too loose."""
MOST_RUNS = 16


def run_to_error(start: Start, error: float, options: dict[str, Any]) -> RunResult:
    """Return a run whose error is verified to be at most ``error``; see `pendcore.simulate`.

    ``options`` are further keywords of `run`, for the run that is returned; ``time_limit`` holds
    for all runs together.

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
            if latest in runs.trials and latest.scale > min(one.scale for one in runs.trials):
                runs.drop(latest)  # looser than one that came to the end: it shows nothing
                continue
            if status == "time_limit" or (latest in runs.trials and status != "max_steps"):
                return _ended_early(runs, latest)
            raise _refusal(runs, f"{latest.text}: {latest.solution.message}")
        for trial in sorted(runs.trials, key=lambda one: -one.scale):
            found = _known_error(runs, trial)
            if found is not None and found.tells_the_end and found.largest <= runs.error:
                return runs.labelled(trial.solution, "kept", found)
    raise _refusal(runs)


def _first_trial(runs: Trials) -> TrialRun:
    """Run at a tolerance that is not too loose to follow the motion to its end."""
    scale = runs.error * (FIRST if runs.error < LOOSE else AIM)
    made = runs.trial(scale, runs.method_for(runs.error))
    while made.solution.status in FOLLOWED_BADLY and made.rtol > runs.tightest:
        before = made.solution.run.t_reached
        runs.drop(made)
        made = runs.trial(made.scale / FARTHER, made.method)
        if abs(made.solution.run.t_reached - before) <= 1e-3 * abs(before - runs.start.t_start):
            break  # both say that the motion ends there
    return made


def _next_run(runs: Trials) -> TrialRun | None:
    """Make the run that is expected to settle the matter; None where nothing can."""
    last = min(runs.trials, key=lambda one: one.scale)
    better = _better_than(runs, last)
    if len(better) < max(_tight_runs(last), 1):
        return _second(runs, last)
    known = _known_error(runs, last)
    found = known or runs.compared(last, better[:1], 0.0)
    apart = found.largest
    if found.is_lost or apart > max(NOTHING_IN_COMMON, runs.error):
        aimed = _scale_before_it_grew(runs, last, better[0])
    else:
        aimed = last.scale * AIM * runs.error / max(apart, 1e-9 * runs.error)
    if known is None and apart <= LIKELY * runs.error and not found.is_lost:
        looser = _looser(runs, last, aimed)
        if looser is not None:
            return runs.trial(looser, last.method)
        return None if _tight_runs(last) else _second(runs, last)
    if last.rtol <= runs.tightest:
        return None
    aimed = min(aimed, last.scale / LEAST_CHANGE)
    return runs.trial(aimed, runs.method_for(aimed))


def _looser(runs: Trials, trial: TrialRun, aimed: float) -> float | None:
    """Return the scale of a trial that may show how the error follows the tolerance."""
    scales = [LOOSER * trial.scale, NEXT_LOOSER * trial.scale]
    if aimed > RATIO * trial.scale:
        scales.insert(0, aimed)
    loosest = LOOSEST * trial.scale / trial.rtol
    for scale in (min(one, loosest) for one in scales):
        ratios = [scale / one.scale for one in runs.trials]
        is_likely = RATIO * trial.scale <= scale < runs.too_loose
        if is_likely and not any(1 / APART < r < APART for r in ratios):
            return scale
    return None


def _second(runs: Trials, trial: TrialRun) -> TrialRun:
    """Run better than a trial, and than all second runs that verify it."""
    if _tight_runs(trial):
        return runs.second(trial, 0.0)
    if _better_than(runs, trial):
        return runs.second(trial, min(one.scale for one in runs.seconds) / BETTER_STILL)
    is_first_of_series = not runs.seconds and leading(trial.method) == "taylor"
    better_by = FAR_BETTER if is_first_of_series else SPARED * _better_by(trial)
    return runs.second(trial, trial.scale / better_by)


def _better_by(trial: TrialRun) -> float:
    """Return by what factor a second run of its method is better than a trial at least."""
    return BETTER_SERIES if leading(trial.method) == "taylor" else BETTER


def _scale_before_it_grew(runs: Trials, trial: TrialRun, second: TrialRun) -> float:
    """Return the scale at which a chaotic motion comes to its end with the error.

    Two runs have nothing in common after a share of the time: errors grow as exp(rate t).
    """
    begin, found = runs.start.t_start, runs.compared(trial, [second], 0.0)
    until = found.valid_until(NOTHING_IN_COMMON, of="position") - begin
    farther = trial.scale / FARTHER
    if not until or trial.scale >= NOTHING_IN_COMMON:
        return farther
    whole = trial.solution.run.t_reached - begin
    grown: float = (trial.scale / NOTHING_IN_COMMON) ** float(whole / until)
    return min(farther, max(AIM * runs.error * grown, farther / FARTHER))


def _known_error(runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
    """Return the error of a trial, if what it is compared with is known to be better."""
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
    """Return what share of a trial's error a second run's is at most, as other trials tell."""
    found = inf
    own = runs.distance(trial, second)
    times = len(runs.compared(trial, [second], 0.0).t)
    most = FOLLOWS if times >= FEW else FOLLOWS_AT_FEW_TIMES
    for other in runs.trials:
        ratio = other.scale / trial.scale
        if 1 / RATIO < ratio < RATIO or second not in _better_than(runs, other):
            continue
        if not other.method == trial.method == second.method:
            continue  # a scene may suit one method and not the other
        apart = runs.distance(other, second)
        if min(own, apart) > 0 and max(own, apart) < NOTHING_IN_COMMON:
            exponent = log(apart / own) / log(ratio)
            if 0 < exponent <= most:
                trusted = CAUTION * min(exponent, 1.0)
                found = min(found, (second.scale / trial.scale) ** trusted)
    return found + ROUNDING / trial.scale


def _share_if_tight(runs: Trials, trial: TrialRun, seconds: list[TrialRun]) -> float | None:
    """Return what is added to the distance from second runs as tight as doubles allow, as a share.

    They may be off alike, by their truncation: looser runs of the method tell it. None if there are
    none where it takes them, in a stiff scene.
    """
    own = max(runs.distance(trial, one) for one in seconds)
    left = inf
    for other in (*runs.trials, *runs.seconds):
        is_looser = other is not trial and other.scale >= LEAST_CHANGE * seconds[0].scale
        if not (is_looser and other.method == seconds[0].method and other.solution.success and own):
            continue
        apart = runs.distance(other, seconds[0])
        if apart < NOTHING_IN_COMMON:
            left = min(left, apart * (seconds[0].scale / other.scale) ** CAUTION_IF_TIGHT)
    least = SHARE_IF_ALIKE if trial.rtol < ALIKE * runs.tightest else SPARE_OF_SEVERAL
    if left == inf:
        return None if runs.is_stiff and own > 0 else least + SPARE
    return max(least, left / own) + SPARE


def _better_than(runs: Trials, trial: TrialRun) -> list[TrialRun]:
    """Return the second runs that may verify a trial, the best first."""
    if _tight_runs(trial):
        found = [one for one in runs.seconds if one.rtol <= runs.tightest]
    else:
        found = [one for one in runs.seconds if one.scale * _better_by(one) <= trial.scale * 1.01]
    return sorted(found, key=lambda one: one.scale)


def _tight_runs(trial: TrialRun) -> int:
    """Return how many second runs as tight as doubles allow a trial needs; 0 if looser ones do."""
    return next((count for below, count in ROUNDING_MATTERS if trial.scale < below), 0)


def _ended_early(runs: Trials, latest: TrialRun) -> RunResult:
    """Return a trial that did not get to its end, with what is known of it.

    When the time is up it is the tightest whole trial, if there is one: nothing has verified it.
    """
    if latest.solution.status == "time_limit":
        why = "the run ended early: time_limit"
        if whole := runs.best():
            why = "the time limit was reached before it was verified"
        return runs.labelled(whole or latest.solution, "ended early", None, why)
    seconds = [_second(runs, latest) for _ in range(_tight_runs(latest) or 2)]
    found = runs.compared(latest, seconds)
    solution = runs.labelled(latest.solution, "ended early", found)
    if not found.is_complete:
        solution.known_error = None  # another time there may be more time
    return solution


def _refusal(runs: Trials, why: str = "") -> AccuracyError:
    """Return the error that says what was reached and why not more."""
    asked = f"error = {runs.error:g}"
    whole = [one for one in runs.trials if one.solution.success]
    last = min(whole or runs.trials, key=lambda one: one.scale)
    found = _known_error(runs, last)
    if len(runs.paid) >= MOST_RUNS:
        why = why or f"not settled after {MOST_RUNS} runs: a smaller error may be kept"
    if found is None or why:
        why = why or _does_not_follow(runs)
        runs.labelled(last.solution, "refused", None, why)
        message = f"{asked}: the run by {last.text} could not be verified: {why}"
        return AccuracyError(message, last.solution)
    runs.labelled(last.solution, "refused", found)
    if last.rtol > runs.tightest:
        why = _does_not_follow(runs)
    elif found.is_lost or found.largest > HOPELESS:
        why = "neighbouring motions part too fast for double precision (chaos)"
    else:
        why = "tighter tolerances are lost in the rounding of doubles"
    least = inf if found.is_lost else found.largest
    reached = f"the least that can be kept is {least:.1e}"
    if found.is_lost:
        reached = "no error can be kept to the end"
    until = found.valid_until(runs.error, of="position")
    held = f"; it holds until t = {until:.6g} s" if until != runs.start.t_start else ""
    return AccuracyError(f"{asked}: not reached: {reached}: {why}{held}", last.solution, least)


def _does_not_follow(runs: Trials) -> str:
    """Return why no tolerance was found, as far as that can be told."""
    has_own_law = any(effect.kind == "user" for effect in runs.start.scene.effects)
    question = ": is a law of your own not smooth?" if has_own_law else ""
    return f"the error does not follow the tolerances{question}"
