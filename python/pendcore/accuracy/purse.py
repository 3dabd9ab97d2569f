"""The runs that are made for one answer: each is written down, and the clock runs for all."""

from __future__ import annotations

from collections.abc import Callable
from math import inf
from time import monotonic
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from pendcore.accuracy.forecast import COMPENSATED_BELOW, series_work
from pendcore.accuracy.position_error import distances, reached, time_grid
from pendcore.accuracy.report import Paid
from pendcore.accuracy.run import Choice, Start, atol_beside, run, silent
from pendcore.arguments import Floats, time_limit_of
from pendcore.solution import Solution
from pendcore.statistics import Statistics
from pendcore.warning import warn

TIGHTER = 4.0
"""By what factor a run is to be tighter than another, to say something of it.

Of another method too: what it reaches at a tolerance is known within a decade.
"""
SHORTER = 0.6
"""How long the steps of the same method are at most, where the tolerance does not set them.

The error of order five and more is then a twelfth.
"""
FEW_STEPS = 5
"""So many steps it may take until they are as long as the tolerance lets them be."""
# How much of what is left on the bar a run of each purpose moves it.
_ADVANCE = {"choose": 0.05, "run": 0.4, "verify": 0.9}


class Comparison(NamedTuple):
    """How far apart two runs are at the times that both have, s, (n_t,), and at most."""

    times: Floats
    apart: Floats
    largest: float


NOTHING = Comparison(np.empty(0), np.empty(0), inf)


class Made(NamedTuple):
    """A run, what for and how it was made, what it took, and the same in right-hand sides."""

    purpose: str
    method: str
    rtol: float
    choice: Choice
    solution: Solution
    stats: Statistics
    work: float

    @property
    def text(self) -> str:
        return f"{self.method} at rtol {self.rtol:g}"


class Purse:
    """Makes runs of one scene, and keeps count."""

    def __init__(
        self,
        start: Start,
        options: dict[str, Any],
        report: Callable[[float], object] | None,
    ) -> None:
        self.start = start
        self.options = options
        self.report = report
        self.began = monotonic()
        limit = options.pop("time_limit", None)
        self.time_limit = time_limit_of(limit)
        self.compensated: bool = options.pop("compensated", False)
        self.paid: list[Paid] = []
        self.done = 0.0
        self.best: Made | None = None

    def pilot(self, method: str, rtol: float, **limits: int) -> Made:
        """Run loosely, on the times that count, to where a terminal event ends it."""
        ending = [event for event in self.options["wanted"] if event[1].get("terminal")]
        options = {"t_eval": self._times(), "wanted": ending, **limits}
        # What looks wrong with the start is said by the first run, and once.
        return self._make("choose", self.start, method, rtol, options, warns=not self.paid)

    def run(self, method: str, rtol: float) -> Made:
        """Run with all that was asked for."""
        return self._make("run", self.start, method, rtol, self.options)

    def verification(self, method: str, rtol: float, made: Made) -> Made:
        """Run to where another run ended, on the times at which it is compared."""
        start = self.start._replace(t_end=made.solution._run.t_reached)
        steps = 10 * self.options["max_steps"]
        options = {"t_eval": self._kept_times(made), "max_steps": steps}
        if method == made.method:
            options["max_step"] = self._shorter_steps(made)
        return self._make("verify", start, method, rtol, options)

    def takes_other_steps(self, made: Made) -> bool:
        """Whether the same method takes other steps where it is tighter.

        It does so where tolerances set most steps, but not where max_step does, or points at which
        laws change, or where a run is over, or at rest, before its steps have grown.
        """
        stats = made.stats
        return stats.accepted >= FEW_STEPS and 2 * stats.limited_by_tolerance > stats.accepted

    def _shorter_steps(self, made: Made) -> float:
        """Return a max_step, s, with which the same method takes other steps in any case."""
        span = abs(made.solution._run.t_reached - self.start.t_start)
        if self.takes_other_steps(made) or not (made.stats.accepted and span):
            return float(self.options["max_step"])
        return SHORTER * span / made.stats.accepted

    def comparable(self, made: Made, other: Made) -> bool:
        """Whether the other run says something of the one: it is tighter, and has its times."""
        if other.rtol > made.rtol / TIGHTER:
            return False
        return self.is_dense() or np.array_equal(self._kept_times(made), other.solution.t)

    def compared(self, made: Made, other: Made) -> Comparison:
        """Return how far the one is from the truth, as the other tells.

        That is their distance; where both are of one method, its errors being as its tolerances,
        the distance divided by 1 - rtol_other / rtol. Where a terminal event came before the first
        of the t_eval, the two ends are compared.
        """
        if not (made.solution.success and other.solution.success):
            return NOTHING
        times = other.solution.t
        if made.purpose == "run" and self.is_dense():
            times = times[reached(made.solution, times)]
            q = made.solution(times)[: len(self.start.scene.links)].T
        else:
            q = made.solution.q
            if made.purpose == "run" and self.options["t_eval"] is None:
                q = q[_first_of_each(made.solution.t)]
            times = times[: len(q)]
            q = q[: len(times)]
        known = other.solution.q[: len(times)]
        if not len(q):
            times, q, known = self._end(made), _last_angles(made), _last_angles(other)
        apart = distances(self.start.scene, q, known)
        if other.method == made.method:
            apart /= 1 - other.rtol / made.rtol
        largest = float(apart.max(initial=0.0))
        return Comparison(times, apart, largest if largest == largest else inf)

    def is_dense(self) -> bool:
        """Whether what is asked for is a run that can be compared at any time."""
        return self.options["t_eval"] is None and self.options["store"] in (None, "dense")

    def seconds(self) -> float:
        """Return the time since the beginning, s."""
        return monotonic() - self.began

    def _kept_times(self, made: Made) -> Floats:
        """Return the times at which to compare a run: a grid if it is dense, else its own."""
        if self.is_dense():
            return time_grid(self.start.t_start, made.solution._run.t_reached)
        times = made.solution.t
        if not len(times):
            return self._end(made)
        return times if self.options["t_eval"] is not None else times[_first_of_each(times)]

    def _end(self, made: Made) -> Floats:
        return np.array([made.solution._run.t_reached])

    def _make(
        self,
        purpose: str,
        start: Start,
        method: str,
        rtol: float,
        options: dict[str, Any],
        warns: bool = False,
    ) -> Made:
        compensated = self.compensated or rtol < COMPENSATED_BELOW
        choice = Choice(method, rtol, atol_beside(rtol), compensated)
        shared = {key: self.options[key] for key in ("max_step", "max_steps")}
        left = None
        if self.time_limit < inf:
            left = max(self.time_limit - self.seconds(), 1e-6)
        try:
            solution = run(
                start, choice, **(shared | options), time_limit=left,
                progress=self._progress(_ADVANCE[purpose]), warn=warn if warns else silent,
            )  # fmt: skip
        except BaseException as stop:
            if isinstance(partly := getattr(stop, "solution", None), Solution):
                stop.solution = self._best_or(partly, purpose)  # type: ignore[attr-defined]
                stop.purpose = purpose  # type: ignore[attr-defined]
            raise
        stats = solution.stats
        each = series_work(start.scene, rtol) if method == "taylor" else 1.0
        self.paid.append(Paid(purpose, method, rtol, stats.nfev, each * stats.nfev))
        self.done += _ADVANCE[purpose] * (1 - self.done)
        made = Made(purpose, method, rtol, choice, solution, stats, each * stats.nfev)
        if purpose != "verify" and solution.success:
            self.best = made
        return made

    def _best_or(self, partly: Solution, purpose: str) -> Solution:
        """Return what is worth most when a run is interrupted.

        That is the last that was asked for, even if a later one was to be better; else what there
        is of it; else the tightest pilot.
        """
        if self.best is None or (purpose == "run" and self.best.purpose != "run"):
            return partly
        return self.best.solution

    def _progress(self, share: float) -> Callable[[float], object] | bool:
        report, done = self.report, self.done
        if report is None:
            return False
        return lambda fraction: report(done + share * (1 - done) * fraction)

    def _times(self) -> Any:
        """Return the times on which pilots are compared."""
        if self.options["t_eval"] is not None:
            return self.options["t_eval"]
        if self.options["store"] == "end":
            return [self.start.t_end]
        return time_grid(self.start.t_start, self.start.t_end)


def _last_angles(made: Made) -> Floats:
    """Return the angles at which a run ended, rad, (1, n)."""
    y = np.asarray(made.solution._run.y_reached)
    return y[np.newaxis, : len(y) // 2]


def _first_of_each(t: Floats) -> npt.NDArray[np.bool]:
    """Return where a time stands first: at a jump it stands twice, at the same place."""
    return np.append(True, np.diff(t) != 0)[: len(t)]
