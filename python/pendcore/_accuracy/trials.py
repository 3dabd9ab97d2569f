"""The runs that are made for one error: trials of what was asked for, and better second runs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import inf
from time import monotonic
from typing import Any, Protocol

import numpy as np

from pendcore import methods
from pendcore._accuracy import tuning
from pendcore._accuracy.estimate import (
    MORE_STEPS,
    SPARE_OF_SEVERAL,
    estimate,
    other_steps,
    second_times,
)
from pendcore._accuracy.method_choice import (
    TIGHTEST_SECOND,
    cheapest,
    leading,
    rounded,
    same_or_other,
)
from pendcore._accuracy.rounding import moved
from pendcore._core import DefectCorrection
from pendcore._messages.arguments import time_limit_of
from pendcore._messages.progress import part_of
from pendcore._messages.warning import warn
from pendcore._run.accuracy import DEFECT, Accuracy, Outcome, Paid
from pendcore._run.call import Choice, Start, resumed, run, silent
from pendcore._run.error_estimate import ErrorEstimate
from pendcore._run.solution import Solution
from pendcore._run.work import correction_work, series_work
from pendcore._scene.effect_description import Description
from pendcore.options import atol_beside

_ADVANCE = 0.35
"""The share of what is left of the progress bar that a run fills."""


@dataclass(frozen=True, slots=True, eq=False)
class TrialRun:
    """A run: how it was made, and its work in right-hand sides.

    Its ``scale`` is its typical error, which makes tolerances of different methods comparable. Its
    ``correction`` was integrated along with it, if the scene and the method allow that.
    """

    method: str
    rtol: float
    scale: float
    work: float
    solution: Solution
    correction: DefectCorrection | None = None

    @property
    def text(self) -> str:
        return f"{self.method} at rtol {self.rtol:g}"


class Strategy(Protocol):
    """How the error of a trial is verified; `pendcore._accuracy.strategies` has the table."""

    @property
    def method(self) -> str:
        """The method of its trials; empty where the error that is asked for chooses it."""

    @property
    def first_aim(self) -> float:
        """The multiple of the error asked for at which its first trial aims."""

    @property
    def serves_every_trial(self) -> bool:
        """Whether it verifies trials of stiff scenes, and those of the strategies before it."""

    def correction(self, start: Start, scale: float) -> DefectCorrection | None:
        """Return what is to look on while a trial of a typical error, ``scale``, is made."""

    def verify(self, runs: Trials, trial: TrialRun) -> ErrorEstimate | None:
        """Return the error of a trial, if what was computed so far shows it."""

    def next_run(self, runs: Trials) -> TrialRun | None:
        """Make the run that is expected to verify a trial; None where no run can."""


class Trials:
    """Makes the runs for one error, compares them and keeps count of them."""

    def __init__(
        self,
        start: Start,
        error: float,
        options: dict[str, Any],
        report: Callable[[float], object] | None,
        strategies: Sequence[Strategy],
    ) -> None:
        self.strategies, self.strategy = strategies, strategies[0]
        self.start = start
        self.error = error
        self.options = options
        self.report = report
        self.began = monotonic()
        self.time_limit = time_limit_of(options.pop("time_limit", None))
        self.compensated: bool = options.pop("compensated", False)
        self.is_stiff = False
        self.tries_the_least = True
        self.refused: Solution | None = None
        self.trials: list[TrialRun] = []
        self.seconds: list[TrialRun] = []
        self.paid: list[TrialRun] = []
        self._estimates: dict[tuple[Any, ...], ErrorEstimate] = {}
        self._done = 0.0

    @property
    def tightest(self) -> float:
        return methods.TIGHTEST_IMPLICIT if self.is_stiff else methods.TIGHTEST

    @property
    def tightest_trial(self) -> TrialRun:
        return min(self.trials, key=lambda trial: trial.scale)

    @property
    def keeps_few_times(self) -> bool:
        store, t_eval = self.options["store"], self.options["t_eval"]
        few = t_eval is not None and np.size(t_eval) < tuning.FEW
        return store == "end" or (few and store != "dense")

    def any_effect(self, has: Callable[[Description], bool]) -> bool:
        """Whether some effect of the scene has a property."""
        return any(has(effect.description) for effect in self.start.scene.effects)

    def method_for(self, scale: float) -> str:
        """Return the method that typically takes the least work to reach an error and verify it."""
        if self.is_stiff:
            return methods.implicit_method()
        method = self.strategy.method or cheapest(self.start, scale / tuning.FOR_BOTH)
        return methods.pair_of(method)

    def trial(self, scale: float, method: str) -> TrialRun:
        """Make a run with all the options that the user gave."""
        rtol = rounded(scale / methods.error_over_rtol(leading(method)), self.tightest)
        options = self.options
        if self.trials:
            options = options | {"max_steps": self._most_steps()}
        correction = None
        if not self.is_stiff:
            scale = rtol * methods.error_over_rtol(leading(method))
            correction = self.strategy.correction(self.start, scale)
        trial = self._run(self.start, method, rtol, options, correction)
        self.trials.append(trial)
        self.seconds = [self._as_far_as(trial, second) for second in self.seconds]
        return trial

    def for_least(self, error: float, strategies: Sequence[Strategy]) -> Trials:
        """Return a search for another error, in the time that is left, which tries no other one."""
        options = {**self.options, "compensated": self.compensated}
        other = Trials(self.start, error, options, self.report, strategies)
        other.began, other.time_limit, other.tries_the_least = self.began, self.time_limit, False
        other._done = self._done
        return other

    def add(self, other: Trials) -> None:
        """Count the runs of another search as paid for by this one."""
        self.paid += other.paid
        self._done = other._done

    def drop(self, trial: TrialRun) -> None:
        """Forget a trial that was too loose to come to its end."""
        self.trials.remove(trial)

    def second(self, trial: TrialRun, scale: float) -> TrialRun:
        """Make a run that is better than a trial, with other steps, constants and start."""
        method = methods.implicit_method()
        if not self.is_stiff:
            method = same_or_other(trial.method, trial.solution.stats)
        tightest = TIGHTEST_SECOND.get(leading(method), self.tightest)
        rtol = rounded(scale / methods.error_over_rtol(leading(method)), tightest)
        ends_anywhere = any(values.get("terminal") for _, values in self.options["events"])
        options = {
            "t_eval": None if ends_anywhere else second_times(trial.solution),
            "max_step": other_steps(trial.solution, self.options["max_step"]),
            "max_steps": self._most_steps(MORE_STEPS),
        }
        # each trial has its own terminal event
        ends = [each.solution._run.t_reached for each in self.trials]
        start = self.start._replace(t_end=max(ends, key=lambda t: abs(t - self.start.t_start)))
        second = self._run(moved(start, len(self.seconds)), method, rtol, options)
        self.seconds.append(second)
        return second

    def compared(
        self, trial: TrialRun, seconds: list[TrialRun], share: float = SPARE_OF_SEVERAL
    ) -> ErrorEstimate:
        """Return the error of a trial as estimated from second runs; see `estimate`."""
        key = (trial, *seconds, share)
        if key not in self._estimates:
            text = " and ".join(dict.fromkeys(second.text for second in seconds))
            solutions = [second.solution for second in seconds]
            self._estimates[key] = estimate(trial.solution, solutions, text, share)
        return self._estimates[key]

    def remembered(
        self, trial: TrialRun, found: Callable[[], ErrorEstimate | None]
    ) -> ErrorEstimate | None:
        """Return the error that a trial's own defect shows, found once."""
        if (trial,) not in self._estimates and (error := found()) is not None:
            self._estimates[trial,] = error
        return self._estimates.get((trial,))

    def distance(self, trial: TrialRun, second: TrialRun) -> float:
        """Return how far a trial is at most from one second run, as a share of the length."""
        return self.compared(trial, [second], 0.0).largest

    def best(self) -> Solution | None:
        """Return the tightest of all trials, forgotten ones too, that came to their end."""
        own = [run for run in self.paid if run.solution.scene is self.start.scene]
        complete = [run for run in own if run.solution.success]
        return min(complete, key=lambda run: run.scale).solution if complete else None

    def concluded(
        self, solution: Solution, outcome: Outcome, error: ErrorEstimate | None, why: str = ""
    ) -> Solution:
        """Return a trial with what is known of its error, or ``why`` nothing is known."""
        begin = self.start.t_start
        solution.known_error = error
        solution.accuracy = Accuracy(
            asked=self.error,
            achieved=inf if error is None or error.is_lost else error.largest,
            outcome=outcome,
            until=begin if error is None else error.valid_until(self.error, of="position"),
            times=0 if error is None else len(error.t),
            everywhere=error is not None and error.is_dense and error.tells_the_end,
            verified_by=why if error is None else error.verified_by,
            paid=self._bill(solution, error),
            seconds=monotonic() - self.began,
        )
        return solution

    def _bill(self, solution: Solution, error: ErrorEstimate | None) -> tuple[Paid, ...]:
        estimates = self._estimates.items()
        verifying = next((key[1:-1] for key, value in estimates if value is error), ())
        paid = []
        for made in self.paid:
            is_own = made.solution is solution
            purpose = "run" if is_own else "verify" if made in verifying else "choose"
            paid.append(Paid(purpose, made.method, made.rtol, made.solution.stats.nfev, made.work))
            if made.correction is not None:
                is_known_by_it = error is not None and self._estimates.get((made,)) is error
                purpose = "verify" if is_known_by_it else "choose"
                nfev = made.correction.nfev
                work = correction_work(self.start.scene) * nfev
                paid.append(Paid(purpose, DEFECT + made.method, made.rtol, nfev, work))
        return tuple(paid)

    def _most_steps(self, times: int = 1) -> int:
        first = max(self.trials[0].solution.stats.accepted, tuning.FIRST_COUNTS_AS)
        return min(times * int(self.options["max_steps"]), tuning.MOST_STEPS * first)

    def _as_far_as(self, trial: TrialRun, second: TrialRun) -> TrialRun:
        """Continue a second run to the end of a trial: a terminal event may come a bit later."""
        end, begin, run = trial.solution._run.t_reached, self.start.t_start, second.solution._run
        is_behind = abs(end - begin) > abs(run.t_reached - begin)
        if not (is_behind and second.solution.store == "dense" and second.solution.success):
            return second
        longer = resumed(
            second.solution, end, max_steps=self._most_steps(MORE_STEPS),
            time_limit=self._time_left(), progress=self._progress(),
        )  # fmt: skip
        work = second.work * longer.stats.nfev / max(second.solution.stats.nfev, 1)
        went_on = replace(second, solution=longer, work=work)
        self.paid[self.paid.index(second)] = went_on
        return went_on

    def _run(
        self,
        start: Start,
        method: str,
        rtol: float,
        options: dict[str, Any],
        correction: DefectCorrection | None = None,
    ) -> TrialRun:
        is_second = start.scene is not self.start.scene
        compensated = is_second or self.compensated or rtol < tuning.COMPENSATED_BELOW
        is_first = self.tries_the_least and not self.paid  # it warns of the start
        solution = run(
            start, Choice(method, rtol, atol_beside(rtol), compensated), **options,
            time_limit=self._time_left(), progress=self._progress(),
            warn=warn if is_first else silent, watch=correction,
        )  # fmt: skip
        work = float(solution.stats.nfev)
        if leading(method) == "taylor" and not solution.stats.stiff:
            work *= series_work(start.scene, rtol)
        scale = rtol * methods.error_over_rtol(leading(method))
        trial = TrialRun(method, rtol, scale, work, solution, correction)
        self.paid.append(trial)
        self._done += _ADVANCE * (1 - self._done)
        return trial

    def _time_left(self) -> float:
        return max(self.time_limit - (monotonic() - self.began), 1e-6)

    def _progress(self) -> Callable[[float], object] | bool:
        if self.report is None:
            return False
        return part_of(self.report, self._done, _ADVANCE * (1 - self._done))
