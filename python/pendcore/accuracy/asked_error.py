"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

Two kinds of runs are made in a loop. A *trial* is what was asked for, at some tolerance; the first at
one that is loose for the error. A *second run* is better than the trials: its tolerance is a
twentieth or less of theirs, its constants and start are moved by some last bits, and its steps are
others. The distance of a trial from it says how the error follows the tolerance on this scene, and so
at which tolerance to try next. A trial is returned when its error is at most the one asked for and the
second run is known, not assumed, to be the better of the two:

* by a looser trial, whose error is larger by what the tolerances let expect: then the second run's
  is smaller by as much; or
* by one more second run, whose distance from the first is added (`pendcore.accuracy.estimate`).

Where tolerances are so tight that rounding may matter, three second runs as tight as doubles
allow take the place of these. The loop ends with a run that is kept, with an `AccuracyError` that says
the least error there is, or with a run that ended early, and what is known of it.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from math import inf, log
from time import monotonic
from typing import Any

from pendcore.accuracy.estimate import (
    MORE_STEPS,
    SPARE_OF_SEVERAL,
    ErrorEstimate,
    estimate,
    other_steps,
    second_times,
)
from pendcore.accuracy.methods import (
    ERROR_OVER_RTOL,
    LOOSEST,
    TIGHTEST,
    TIGHTEST_IMPLICIT,
    cheapest,
    rounded,
    series_work,
)
from pendcore.accuracy.report import Accuracy, AccuracyError, Outcome, Paid
from pendcore.accuracy.rounding import moved
from pendcore.accuracy.run import Choice, Start, atol_beside, pair_of, run, silent
from pendcore.arguments import Floats, finite_array, time_limit_of
from pendcore.progress import callback, close
from pendcore.solution import Solution
from pendcore.warning import warn

LOOSE = 1e-3
"""An error that the first trial is to keep at once: a looser one would have little in common."""
FIRST = 5.0
"""What multiple of the error the first trial aims at, if the scene is like most."""
AIM = 0.55
"""What share of it the trials after that aim at."""
FIRST_SECOND = {"taylor": 1e-3}
"""What multiple of the error the first second run aims at; one more digit of a series costs little."""
FIRST_SECOND_ELSE = 1e-2
BETTER = 25.0
"""By what factor the tolerance of a second run is tighter at least than that of a trial."""
MUCH_BETTER = 40.0
"""By what factor it is made tighter."""
BETTER_STILL = 8.0
"""And one more second run, that tells how good the first one is."""
SPARE = 0.1
"""What is added to that share: methods do not all follow their tolerances alike."""
LOOSER = 50.0
"""By what factor the tolerance of a trial is looser that shows how the error follows it."""
SHARE = 0.35
"""What the error of a single second run may be at most, as a share of the distance from it."""
FOLLOWS, MANY = {True: 2.0, False: 1.4}, 50
"""Up to which exponent of the tolerance an error is said to follow it, at many times or at few.

At few times an error may be small by chance, which looks as if it fell faster.
"""
CAUTION = 0.6
"""What share of the exponent that was seen is trusted beyond the tolerances where it was seen."""
NOTHING_IN_COMMON = 0.2
"""A distance beyond says of the error only that it is large: it does not follow the tolerance."""
FARTHER = 100.0
"""By what factor the tolerance is made tighter then at least."""
LEAST_CHANGE = 1.5
"""By what factor it is made tighter at least where the error was too large."""
ROUNDING = 1.5e-12
"""The tolerance that makes an error as large as constants and start that are moved, at most.

Of a typical method, as `ERROR_OVER_RTOL` counts, on three hundred scenes; half of them had 5e-14. What
rounding itself does is an eighth of it and less.
"""
ROUNDING_MATTERS = ((2e-12, 3), (1e-11, 2))
"""The same of a trial, below which so many second runs as tight as doubles allow verify it."""
HOPELESS = 1e-6
"""An error at the tightest tolerances beyond which it is not rounding alone, but its growth."""
LIKELY = 0.9
"""What share of the error a distance is at most for the run to be likely good enough."""
RATIO, RATIO_OF_METHODS = 5.0, 30.0
"""By what factor two tolerances of one method, or of two, differ at least to tell an exponent."""
COMPENSATED_BELOW = 1e-12
"""rtol, from which on what the rounding of the state leaves over is carried on."""
MOST_STEPS, LEAST_STEPS = 300, 100
"""How many times the steps of the first run a later one may take, if that took so many at least."""
IMPLICIT = "radau5"
"""The method for what the first trial found to be stiff."""
FOLLOWED_BADLY = ("step_too_small", "non_finite")
"""Statuses of a run whose tolerances may have been too loose."""
MOST_RUNS = 16
# How much of what is left on the bar a run moves it.
_ADVANCE = 0.35


def run_to_error(start: Start, error: float, options: dict[str, Any]) -> Solution:
    """Return a run whose error is verified to be at most ``error``.

    Parameters
    ----------
    start : Start
        What is run.
    error : float
        Largest distance of a joint or the tip from the truth, as a share of the total length: over
        the whole curve of a run with dense output, else over the times that it keeps.
    options : dict
        Further keywords of `run`, for the run that is returned; ``time_limit`` holds for all runs
        together.

    Raises
    ------
    AccuracyError
        If the error could not be kept, or not be verified.
    KeyboardInterrupt, or any exception of ``progress`` or of a function of the user's
        With the best run so far as the attribute ``solution``: one that was asked for, complete or
        as far as it came. Its ``accuracy`` says that it is not verified.
    """
    finite_array("t_span", (start.t_start, start.t_end), "s")
    report = callback(options.pop("progress", None))
    search = _Search(start, error, options, report)
    try:
        return search.solution()
    except AccuracyError:
        raise
    except BaseException as stop:
        partly = getattr(stop, "solution", None)
        if isinstance(partly, Solution):
            best = search.best() or (partly if partly.scene is start.scene else None)
            if best is None:
                del stop.solution  # type: ignore[attr-defined]
            else:
                during = "while it was verified" if best.success else "during the run itself"
                search.unverified(best, "refused", f"interrupted {during}")
                stop.solution = best  # type: ignore[attr-defined]
        raise
    finally:
        close(report)


@dataclass(frozen=True, slots=True, eq=False)
class _Made:
    """A run: how it was made, and what it took in right-hand sides."""

    number: int
    method: str
    rtol: float
    scale: float
    """Its error where the scene is like most: makes tolerances of methods comparable."""
    solution: Solution
    work: float

    @property
    def text(self) -> str:
        return f"{self.method} at rtol {self.rtol:g}"


def _leading(method: str) -> str:
    """Return the first method of a pair."""
    return method.partition("-")[0]


def _tight_runs(trial: _Made) -> int:
    """Return how many second runs as tight as doubles allow a trial needs; 0 if looser ones do."""
    return next((count for below, count in ROUNDING_MATTERS if trial.scale < below), 0)


class _Search:
    """What is tried for one error."""

    def __init__(
        self,
        start: Start,
        error: float,
        options: dict[str, Any],
        report: Callable[[float], object] | None,
    ) -> None:
        self.start = start
        self.error = error
        self.options = options
        self.report = report
        self.began = monotonic()
        self.time_limit = time_limit_of(options.pop("time_limit", None))
        self.compensated: bool = options.pop("compensated", False)
        self.paid: list[_Made] = []
        self.estimates: dict[tuple[Any, ...], ErrorEstimate] = {}
        self.is_stiff = False
        self.trials: list[_Made] = []
        self.seconds: list[_Made] = []
        self.done = 0.0

    def solution(self) -> Solution:
        method = cheapest(self.start, self.error)
        aim = FIRST if self.error < LOOSE else AIM
        first = self.first_trial(aim * self.error, pair_of(method))
        if not first.solution.success:
            return self.ended_early(first)
        self.is_stiff = first.solution.stats.stiff
        while len(self.paid) < MOST_RUNS:
            latest = self.next_run()
            if latest is None:
                break
            if not latest.solution.success:
                if latest in self.trials and latest.solution.status != "max_steps":
                    return self.ended_early(latest)
                raise self.refusal(f"{latest.text}: {latest.solution.message}")
            for trial in sorted(self.trials, key=lambda one: -one.rtol):
                found = self.known_error(trial)
                if found is not None and found.largest <= self.error:
                    return self.labelled(trial, found, "kept")
        raise self.refusal()

    def first_trial(self, scale: float, method: str) -> _Made:
        """Run at a tolerance that is not too loose to follow the motion to its end."""
        made = self.trial(scale, method)
        while made.solution.status in FOLLOWED_BADLY and made.rtol > self.tightest:
            before = made.solution._run.t_reached
            self.trials.clear()
            made = self.trial(made.scale / FARTHER, method)
            if abs(made.solution._run.t_reached - before) <= 1e-3 * abs(before - self.start.t_start):
                break  # both say that the motion ends there
        return made

    @property
    def tightest(self) -> float:
        return TIGHTEST_IMPLICIT if self.is_stiff else TIGHTEST

    def method_for(self, scale: float) -> str:
        """Return the method that takes the least work for an error of that size in most scenes."""
        return IMPLICIT if self.is_stiff else pair_of(cheapest(self.start, scale))

    def next_run(self) -> _Made | None:
        """Make the run that is expected to settle the matter; None where nothing can."""
        last = min(self.trials, key=lambda one: one.rtol)
        better = self.better_than(last)
        if len(better) < max(_tight_runs(last), 1):
            return self.second(last)
        known = self.known_error(last)
        apart = self.distance(last, better[0]) if known is None else known.largest
        if apart > max(NOTHING_IN_COMMON, self.error):
            aimed = self.scale_before_it_grew(last, better[0])
        else:
            aimed = last.scale * AIM * self.error / max(apart, 1e-9 * self.error)
        if known is None and apart <= LIKELY * self.error:
            looser = aimed if aimed > BETTER * last.scale else LOOSER * last.scale
            looser = min(looser, LOOSEST * last.scale / last.rtol)
            if looser > RATIO * max(one.scale for one in self.trials):
                return self.trial(looser, last.method)
            return self.second(last)
        if last.rtol <= self.tightest:
            return None
        aimed = min(aimed, last.scale / LEAST_CHANGE)
        return self.trial(aimed, self.method_for(aimed))

    def scale_before_it_grew(self, trial: _Made, second: _Made) -> float:
        """Return the scale at which a chaotic motion comes to its end with the error.

        Two runs have nothing in common after a share of the time: errors grow as exp(rate t).
        """
        found = self.compared(trial, [second], 0.0)
        until = found.valid_until(NOTHING_IN_COMMON, of="position") - self.start.t_start
        whole = trial.solution._run.t_reached - self.start.t_start
        farther = trial.scale / FARTHER
        if not until or trial.scale >= NOTHING_IN_COMMON:
            return farther
        grown = (trial.scale / NOTHING_IN_COMMON) ** (whole / until)
        return min(farther, max(AIM * self.error * grown, farther / FARTHER))

    def known_error(self, trial: _Made) -> ErrorEstimate | None:
        """Return the error of a trial, if what it is compared with is known to be better."""
        better = self.better_than(trial)
        count = _tight_runs(trial) or 2
        if len(better) >= count:
            return self.compared(trial, better[:count])
        if _tight_runs(trial) or not better:
            return None
        share = self.share(trial, better[0])
        return self.compared(trial, better[:1], share + SPARE) if share <= SHARE else None

    def share(self, trial: _Made, second: _Made) -> float:
        """Return what share of a trial's error a second run's is at most, as other trials tell."""
        found = inf
        own = self.distance(trial, second)
        for other in self.trials:
            ratio = other.scale / trial.scale
            least = RATIO if other.method == trial.method else RATIO_OF_METHODS
            if 1 / least < ratio < least:
                continue
            if second not in self.better_than(other):
                continue
            apart = self.distance(other, second)
            if 0 < min(own, apart) and max(own, apart) < NOTHING_IN_COMMON:
                exponent = log(apart / own) / log(ratio)
                are_many = len(self.compared(trial, [second], 0.0).t) >= MANY
                if 0 < exponent <= FOLLOWS[are_many]:
                    trusted = CAUTION * min(exponent, 1.0)
                    found = min(found, (max(second.scale, ROUNDING) / trial.scale) ** trusted)
        return found

    def distance(self, trial: _Made, second: _Made) -> float:
        return self.compared(trial, [second], 0.0).largest

    def compared(
        self, trial: _Made, seconds: list[_Made], share: float = SPARE_OF_SEVERAL
    ) -> ErrorEstimate:
        key = (trial, *seconds, share)
        if key not in self.estimates:
            text = " and ".join(dict.fromkeys(one.text for one in seconds))
            solutions = [one.solution for one in seconds]
            self.estimates[key] = estimate(trial.solution, solutions, text, share)
        return self.estimates[key]

    def better_than(self, trial: _Made) -> list[_Made]:
        """Return the second runs that may verify a trial, the tightest first."""
        if _tight_runs(trial):
            found = [one for one in self.seconds if one.rtol <= self.tightest]
        else:
            found = [one for one in self.seconds if one.scale * BETTER <= trial.scale * 1.01]
        return sorted(found, key=lambda one: one.scale)

    def trial(self, scale: float, method: str) -> _Made:
        """Run with all that was asked for."""
        rtol = rounded(scale / ERROR_OVER_RTOL[_leading(method)], self.tightest)
        options = self.options
        if self.trials:
            options = options | {"max_steps": self.most_steps()}
        made = self.run(self.start, method, rtol, options)
        self.trials.append(made)
        self.seconds = [self.as_far_as(made, one) for one in self.seconds]
        return made

    def second(self, trial: _Made) -> _Made:
        """Run better than a trial, and than all second runs before, from a start of its own."""
        if _tight_runs(trial):
            scale = 0.0
        elif self.better_than(trial):
            scale = min(one.scale for one in self.seconds) / BETTER_STILL
        else:
            scale = trial.scale / MUCH_BETTER
            if not self.seconds:
                usual = FIRST_SECOND.get(_leading(trial.method), FIRST_SECOND_ELSE)
                scale = min(scale, usual * self.error)
        method = self.method_for(scale)
        rtol = rounded(scale / ERROR_OVER_RTOL[_leading(method)], self.tightest)
        start = self.start._replace(t_end=trial.solution._run.t_reached)
        options = {
            "t_eval": self.second_times(trial),
            "max_step": other_steps(trial.solution, self.options["max_step"]),
            "max_steps": self.most_steps(MORE_STEPS),
        }
        made = self.run(moved(start, len(self.seconds)), method, rtol, options)
        self.seconds.append(made)
        return made

    def second_times(self, trial: _Made) -> Floats | None:
        """Return the times that a second run keeps, s; None for all: trials may end at others."""
        ends = any(values.get("terminal") for _, values in self.options["wanted"])
        return None if ends else second_times(trial.solution)

    def most_steps(self, times: int = 1) -> int:
        """Return how many steps a run may take: not many times more than the first one took."""
        enough = MOST_STEPS * max(self.trials[0].solution.stats.accepted, LEAST_STEPS)
        return min(times * int(self.options["max_steps"]), enough)

    def as_far_as(self, trial: _Made, second: _Made) -> _Made:
        """Let a second run go on to where a trial came: a terminal event may come a bit later."""
        end = trial.solution._run.t_reached
        run = second.solution._run
        if abs(end - self.start.t_start) <= abs(run.t_reached - self.start.t_start):
            return second
        if second.solution.store != "dense" or not second.solution.success:
            return second
        longer = second.solution.resume(end, max_steps=MORE_STEPS * self.options["max_steps"])
        return replace(second, solution=longer)

    def run(self, start: Start, method: str, rtol: float, options: dict[str, Any]) -> _Made:
        is_second = start.scene is not self.start.scene
        compensated = is_second or self.compensated or rtol < COMPENSATED_BELOW
        left = None
        if self.time_limit < inf:
            left = max(self.time_limit - (monotonic() - self.began), 1e-6)
        solution = run(
            start, Choice(method, rtol, atol_beside(rtol), compensated), **options,
            time_limit=left, progress=self.progress(), warn=silent if self.paid else warn,
        )  # fmt: skip
        nfev = solution.stats.nfev
        is_series = _leading(method) == "taylor" and not solution.stats.stiff
        work = nfev * (series_work(start.scene, rtol) if is_series else 1.0)
        scale = rtol * ERROR_OVER_RTOL[_leading(method)]
        made = _Made(len(self.paid), method, rtol, scale, solution, work)
        self.paid.append(made)
        self.done += _ADVANCE * (1 - self.done)
        return made

    def progress(self) -> Callable[[float], object] | bool:
        report, done = self.report, self.done
        if report is None:
            return False
        return lambda fraction: report(done + _ADVANCE * (1 - done) * fraction)

    def best(self) -> Solution | None:
        """Return the tightest of the trials that are whole."""
        whole = [one for one in self.trials if one.solution.success]
        return min(whole, key=lambda one: one.rtol).solution if whole else None

    def ended_early(self, trial: _Made) -> Solution:
        """Return a run that did not get to its end, with what is known of it."""
        why = f"the run ended early: {trial.solution.status}"
        if trial.solution.status == "time_limit":
            return self.unverified(trial.solution, "ended early", why)
        seconds = [self.second(trial) for _ in range(_tight_runs(trial) or 2)]
        found = self.compared(trial, seconds)
        return self.labelled(trial, found, "ended early")

    def labelled(self, trial: _Made, found: ErrorEstimate, outcome: Outcome) -> Solution:
        """Attach to a trial what is known of its error."""
        compared = next(key for key, one in self.estimates.items() if one is found)
        trial.solution._error = found
        trial.solution._accuracy = Accuracy(
            asked=self.error,
            achieved=found.largest,
            outcome=outcome,
            until=found.valid_until(self.error, of="position"),
            times=len(found.t),
            everywhere=found.is_dense,
            verified_by=found.verified_by,
            paid=self.bill(trial, compared),
            seconds=monotonic() - self.began,
        )
        return trial.solution

    def bill(self, returned: _Made | None, compared: tuple[Any, ...]) -> tuple[Paid, ...]:
        paid = []
        for one in self.paid:
            purpose = "choose"
            if returned is not None and one.solution is returned.solution:
                purpose = "run"
            elif any(one.number == other.number for other in compared if isinstance(other, _Made)):
                purpose = "verify"
            paid.append(Paid(purpose, one.method, one.rtol, one.solution.stats.nfev, one.work))
        return tuple(paid)

    def unverified(self, solution: Solution, outcome: Outcome, why: str) -> Solution:
        """Label a run that nothing was compared with."""
        made = next((one for one in self.trials if one.solution is solution), None)
        solution._accuracy = Accuracy(
            asked=self.error,
            achieved=inf,
            outcome=outcome,
            until=self.start.t_start,
            times=0,
            everywhere=False,
            verified_by=why,
            paid=self.bill(made, ()),
            seconds=monotonic() - self.began,
        )
        return solution

    def refusal(self, why: str = "") -> AccuracyError:
        """Return the error that says what was reached and why not more."""
        asked = f"error = {self.error:g}"
        last = min(self.trials, key=lambda one: one.rtol)
        found = self.known_error(last)
        if found is None:
            if not why:
                why = "its error does not follow the tolerances: is a law of your own not smooth?"
            self.unverified(last.solution, "refused", why)
            message = f"{asked}: the run by {last.text} could not be verified: {why}"
            return AccuracyError(message, last.solution)
        self.labelled(last, found, "refused")
        least = found.largest
        if last.rtol > self.tightest:
            why = "the error does not follow the tolerances: is a law of your own not smooth?"
        elif least > HOPELESS:
            why = "neighbouring motions part too fast for double precision (chaos)"
        else:
            why = "tighter tolerances are lost in the rounding of doubles"
        until = found.valid_until(self.error, of="position")
        held = f"; it holds until t = {until:.6g} s" if until != self.start.t_start else ""
        if found.is_lost:
            least = inf
            reached = "no error can be kept to the end"
        else:
            reached = f"the least that can be kept is {least:.1e}"
        return AccuracyError(f"{asked}: not reached: {reached}: {why}{held}", last.solution, least)
