"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

A *trial* is a run of what was asked for, at some tolerance. A strategy verifies it: it tells how
large its error is (`pendcore._accuracy.strategies`), and from this which tolerance to try next. If
one strategy cannot be trusted, the next one may be.
"""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context, Decimal
from math import inf
from time import monotonic
from typing import Any, NamedTuple

import numpy as np

from pendcore._accuracy import tuning
from pendcore._accuracy.second_runs import second_run, tight_runs
from pendcore._accuracy.strategies import strategies
from pendcore._accuracy.trials import Strategy, TrialRun, Trials
from pendcore._messages.arguments import finite_array
from pendcore._messages.handed_over import hand_over
from pendcore._messages.progress import callback, close
from pendcore._run.accuracy import AccuracyError
from pendcore._run.call import Start
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution

FOLLOWED_BADLY = ("step_too_small", "non_finite")
"""The statuses that loose tolerances may cause."""


class Refusal(NamedTuple):
    """Why no run was accepted, the most accurate one, and the least error that is kept."""

    message: str
    solution: Solution
    least: float = inf


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
    runs = Trials(start, error, options, report, strategies(start, error))
    try:
        found = search(runs)
    except BaseException as stop:
        best = runs.refused or runs.best()
        if isinstance(partly := getattr(stop, "solution", None), Solution):
            best = best or (partly if partly.scene is start.scene else None)
            del vars(stop)["solution"]
        if best is not None and best is not runs.refused:
            during = "while it was verified" if best.success else "during the run itself"
            runs.concluded(best, "ended early", None, f"interrupted {during}")
        if best is not None:
            hand_over(stop, solution=best)
        raise
    finally:
        close(report)
    if isinstance(found, Refusal):
        raise hand_over(AccuracyError(found.message), solution=found.solution, least=found.least)
    return found


def search(runs: Trials) -> Solution | Refusal:
    """Return a run that keeps the error, or one that ended early; or why there is none."""
    for strategy in runs.strategies:
        if (found := _accepted(runs, strategy)) is not None:
            return found
    return _refusal(runs)


def _accepted(runs: Trials, strategy: Strategy) -> Solution | Refusal | None:
    """Return what a strategy finds; None if it does not tell how large the error is."""
    runs.is_stiff = any(trial.solution.stats.stiff for trial in runs.trials)
    if runs.is_stiff and not strategy.serves_every_trial:
        return None
    latest = _first_trial(runs, strategy)
    while True:
        if latest.solution.stats.stiff and not strategy.serves_every_trial:
            return None
        if latest.solution.success:
            for trial in sorted(runs.trials, key=lambda trial: -trial.scale):
                error = strategy.verify(runs, trial)
                if error is not None and error.tells_the_end and error.largest <= runs.error:
                    return runs.concluded(trial.solution, "kept", error)
        elif latest in runs.trials and latest is not runs.tightest_trial:
            runs.drop(latest)  # a tighter trial came to the end, so this one shows nothing
        else:
            return _not_finished(runs, latest)
        next_one = strategy.next_run(runs) if len(runs.paid) < tuning.MOST_RUNS else None
        if next_one is None:
            is_told = strategy.verify(runs, runs.tightest_trial) is not None
            return _refusal(runs) if is_told or len(runs.paid) >= tuning.MOST_RUNS else None
        latest = next_one


def _first_scale(runs: Trials, factor: float) -> float:
    """Return the scale of a first trial: a factor times the error asked for, or looser."""
    if runs.keeps_few_times:
        factor *= tuning.AT_FEW_TIMES
    if runs.any_effect(lambda effect: effect.damps_small_motions):
        factor *= tuning.IF_DAMPED
    return factor * runs.error


def _not_finished(runs: Trials, latest: TrialRun) -> Solution | Refusal:
    """Return a trial that did not get to its end, or why that ends the search."""
    status, is_first = latest.solution.status, latest in runs.trials[:1]
    is_end = latest in runs.trials and (is_first or status != "max_steps")
    if status == "time_limit" or is_end:
        return _ended_early(runs, latest)
    why = f"{latest.text}: {latest.solution.message}"
    if latest.solution._run.arguments["max_steps"] < runs.options["max_steps"]:
        why = (
            f"{latest.text} takes more than {tuning.MOST_STEPS} times the steps of the first trial"
        )
    return _refusal(runs, why)


def _first_trial(runs: Trials, strategy: Strategy) -> TrialRun:
    """Return the first trial of a strategy, or the last one of those before, if it serves.

    A trial that is too loose to follow the motion to its end is made again.
    """
    runs.strategy = strategy
    if runs.trials and strategy.serves_every_trial:
        return runs.trials[-1]
    if runs.trials:
        scale = runs.trials[-1].scale
        runs.trials.clear()
    else:
        scale = _first_scale(runs, strategy.first_aim)
    trial = runs.trial(scale, runs.method_for(runs.error))
    while trial.solution.status in FOLLOWED_BADLY and trial.rtol > runs.tightest:
        before = trial.solution.t_reached
        runs.drop(trial)
        trial = runs.trial(trial.scale / tuning.FARTHER, trial.method)
        if abs(trial.solution.t_reached - before) <= 1e-3 * abs(before - runs.start.t_start):
            break  # both say that the motion ends there
    return trial


def _ended_early(runs: Trials, latest: TrialRun) -> Solution:
    """Return a trial that did not get to its end, with what is known of its error.

    At the time limit it is the tightest complete trial, if there is one, which is not verified.
    """
    if latest.solution.status == "time_limit":
        whole, why = runs.best(), "the time limit was reached before it was verified"
        if whole is None:
            why = "the run ended early: time_limit"
        return runs.concluded(whole or latest.solution, "ended early", None, why)
    error = runs.strategy.verify(runs, latest)
    if error is None:
        seconds = [second_run(runs, latest) for _ in range(tight_runs(latest) or 2)]
        error = runs.compared(latest, seconds)
    solution = runs.concluded(latest.solution, "ended early", error)
    if not error.is_complete and monotonic() - runs.began >= runs.time_limit:
        solution.known_error = None  # a later call with more time may complete the estimate
    return solution


def _refusal(runs: Trials, why: str = "") -> Refusal:
    """Say which error was reached, and why not a smaller one."""
    asked, verify = f"error = {runs.error:g}", runs.strategy.verify
    complete = [trial for trial in runs.trials if trial.solution.success] or runs.trials
    complete.sort(key=lambda trial: trial.scale)
    last = next((one for one in complete if verify(runs, one) is not None), complete[0])
    error = verify(runs, last)
    if len(runs.paid) >= tuning.MOST_RUNS:
        why = why or f"the search ended after {tuning.MOST_RUNS} runs: a larger error may be kept"
    why = why or _in_the_way(runs, last, error)
    if error is None or not error.is_complete:
        runs.concluded(last.solution, "refused", None, why)
        return Refusal(f"{asked}: {last.text} could not be verified: {why}", last.solution)
    runs.refused = runs.concluded(last.solution, "refused", error)
    least = inf if error.is_lost else _least_accepted(runs, error.largest)
    runs.concluded(last.solution, "refused", error)  # with all that was paid
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
    return Refusal(message.removesuffix(": "), last.solution, least)


def _least_accepted(runs: Trials, least: float) -> float:
    """Return an error of two digits, the known one or a larger, that a search for it keeps.

    For a larger error the trials are looser, and their verification may give a larger error.
    Infinite if no such error was found.
    """
    if not runs.tries_the_least:
        return least
    for _ in range(tuning.MOST_SEARCHES):
        least = float(_rounded(min(least, 1.0), 2, ROUND_CEILING))
        if least == 1:
            break  # no error can be asked for that is not below 1
        again = runs.for_least(least, strategies(runs.start, least))
        try:
            found = search(again)
        finally:
            runs.add(again)
        if not isinstance(found, Refusal):
            told = found.accuracy
            return least if told is not None and told.reached else inf
        least = found.least
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
    begin, end, n = error.begin, solution.t_reached, len(solution.scene.links)
    last_bit = np.spacing(max(abs(begin), abs(end)))
    rates = np.vstack([solution.qd, solution.y_reached[n : 2 * n]])
    turned = last_bit / 2 * np.abs(rates).max()
    if abs(begin) > abs(end - begin) and turned > tuning.LATE * error.largest:
        return f"times from {begin:g} s on are rounded to {last_bit:.0e} s; begin nearer to 0"
    angle = np.abs(solution._run.arguments["q0"]).max()
    if angle > tuning.LARGE_ANGLE and not error.is_lost and error.largest < tuning.HOPELESS * angle:
        bit = np.spacing(angle)
        return f"angles of {angle:.0e} rad are rounded to {bit:.0e} rad; begin with fewer turns"
    if error.is_lost or error.largest > tuning.HOPELESS:
        return "neighbouring motions part too fast for double precision"
    return "tighter tolerances are lost in the rounding of doubles"
