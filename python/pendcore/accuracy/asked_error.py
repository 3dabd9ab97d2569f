"""A run that keeps an error: method and tolerance are chosen, and what comes out is verified.

1. Pilots: two methods, both loose, tell by their distance how the error follows the tolerance here.
   Where they have nothing in common, tighter ones.
2. The run: by the method that is expected to take the least work for the error, at the tolerance
   that follows from the proportionality of error and tolerance.
3. The verification: by another method, tighter; where the two would take far more work than the
   cheapest run, and tolerances set the steps, by the same one at a twelfth. The distance is the
   error that is told. If it is larger than asked, the run is made again at the tolerance that
   follows from this measurement, or by another method where that is expected to take less by now,
   until the error is kept or nothing is left to tighten.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import Any

import numpy as np

from pendcore.accuracy.forecast import LAWS, MEASURED_AIM, Forecast, rounded
from pendcore.accuracy.purse import TIGHTER, Comparison, Made, Purse
from pendcore.accuracy.report import Accuracy, AccuracyError
from pendcore.accuracy.run import Start, carries, pair_of
from pendcore.accuracy.second_run import TIGHTEST, second_choices
from pendcore.arguments import finite_array
from pendcore.progress import callback, close
from pendcore.solution import Solution

PILOTS = ("dopri5", "dop853")
FIRST_PILOT = pair_of("dopri5")
"""Gets through a stiff scene as well."""
IMPLICIT: tuple[str, ...] = ("radau5",)
PILOT = 5.0
"""rtol of the first pilot over the square root of the error."""
NOTHING_IN_COMMON = 0.02
"""A distance beyond says of the error only that it is large: it does not follow the tolerance."""
FARTHEST = 10.0
"""By what factor a tolerance is made tighter at most from such a distance."""
WHOLE = 2.8
"""How many times the work of the cheapest run the run and a verification by another method take."""
VERIFYING_STEP = 12.0
"""By what factor the same method is tighter where it verifies itself."""
LEAST, UNTOLD = 1.5, 100.0
"""By what factor a tolerance is made tighter at least; and where it does not set the steps."""
HOPELESS = 1e-6
"""An error at the tightest tolerances beyond which it is not rounding alone, but its growth."""
WORTH_A_CHANGE = 0.9
"""What share of the work another method is to be expected to take to be taken where one failed."""
MOST_ROUNDS = 10
DURING = {
    "choose": "while method and tolerance were sought: this is a loose run, a pilot",
    "run": "during the run itself",
    "verify": "while it was verified",
}
STEPS_OF_AN_IMPLICIT_ONE = 10
"""How many steps of dopri5 take as long as one of radau5."""


def run_to_error(start: Start, error: float, options: dict[str, Any]) -> Solution:
    """Return a run whose error is verified to be at most ``error``.

    Parameters
    ----------
    start : Start
        What is run.
    error : float
        Largest distance of a joint or the tip from the truth, over the times that the run keeps
        (over `POINTS` times where it is dense), as a share of the total length.
    options : dict
        Further keywords of `run`, for the run that is returned; ``time_limit`` holds for all runs
        together.

    Raises
    ------
    AccuracyError
        If the error could not be kept, or not be verified.
    KeyboardInterrupt, or any exception of ``progress`` or of a function of the user's
        With the best run so far as the attribute ``solution``: the one that was asked for, complete
        or as far as it came, else a pilot. Its ``accuracy`` says that it is not verified.
    """
    finite_array("t_span", (start.t_start, start.t_end), "s")
    report = callback(options.pop("progress", None))
    search = _Search(Purse(start, options, report), error)
    try:
        return search.solution()
    except _TimeIsUp as stop:
        return search.unverified(stop.pilot, f"the time was up {DURING['choose']}")
    except BaseException as stop:
        best, purpose = (getattr(stop, name, None) for name in ("solution", "purpose"))
        if purpose is not None and isinstance(best, Solution):
            search.unverified(best, f"interrupted {DURING[purpose]}")
        raise
    finally:
        close(report)


class _TimeIsUp(Exception):
    """A pilot did not get to the end."""

    def __init__(self, pilot: Solution) -> None:
        super().__init__()
        self.pilot = pilot


def explicit_methods(start: Start) -> tuple[str, ...]:
    """Return the methods for what is not stiff, the one that gets most accurate last."""
    return (*PILOTS, "taylor") if carries("taylor", start) else PILOTS


class _Search:
    """What is tried for one error."""

    def __init__(self, purse: Purse, error: float) -> None:
        self.purse = purse
        self.error = error
        self.methods = explicit_methods(purse.start)
        self.forecast = Forecast(purse.start.scene)

    def solution(self) -> Solution:
        self.pilots()
        made = self.made(*self.forecast.cheapest(self.methods, self.error))
        verifying: Made | None = None
        trusted = True
        for _ in range(MOST_ROUNDS):
            if not made.solution.success:
                return self.unverified(
                    made.solution, f"the run ended early: {made.solution.message}"
                )
            if verifying is None:
                verifying = self.verification(made)
            judged = made, verifying
            if not verifying.solution.success:
                break
            found = self.purse.compared(made, verifying)
            if found.largest <= self.error:
                made.solution._accuracy = self.account(found, verifying)
                return made.solution
            if made.rtol > TIGHTEST and trusted:
                made = self.tightened(made, found.largest)
                trusted = not self.purse.comparable(made, verifying)
                verifying = None if trusted else verifying
            elif verifying.rtol > TIGHTEST:  # what verifies may be the worse of the two
                self.forecast.at_least(verifying.method, verifying.rtol, found.largest)
                verifying, trusted = None, True
            else:
                break
        raise self.refusal(*judged)

    def pilots(self) -> None:
        """Measure how error and work follow the tolerance."""
        rtol = rounded(PILOT * sqrt(self.error))
        loose = self.pilot(FIRST_PILOT, rtol)
        if loose.stats.stiff:
            loose = self.stiff_pilot(loose)
        tight = self.tighter_pilot(loose)
        apart = self.purse.compared(loose, tight).largest
        while apart > max(NOTHING_IN_COMMON, self.error) and tight.rtol > TIGHTEST:
            loose, tight = tight, self.tighter_pilot(tight)
            apart = self.purse.compared(loose, tight).largest
        self.forecast.measured_distance(
            (loose.method, loose.rtol), (tight.method, tight.rtol), apart
        )

    def tighter_pilot(self, tight: Made) -> Made:
        """Run the other method at a tenth of the tolerance."""
        rtol = tight.rtol / 10
        if self.methods != IMPLICIT:
            return self.pilot(PILOTS[tight.method == PILOTS[0]], rtol)
        if len(self.purse.paid) > 4:  # a fast swing seems stiff where the tolerance ignores it
            explicit = self.pilot(FIRST_PILOT, rtol)
            if explicit.method in PILOTS:
                self.methods = explicit_methods(self.purse.start)
                return explicit
        return self.pilot(IMPLICIT[0], rtol)

    def stiff_pilot(self, pair: Made) -> Made:
        """Find out whether the scene is stiff enough for an implicit method to pay."""
        implicit = self.pilot("radau5", pair.rtol)
        steps = STEPS_OF_AN_IMPLICIT_ONE * implicit.stats.accepted + 100
        explicit = self.pilot("dopri5", pair.rtol, max_steps=steps)
        if explicit.solution.success or not implicit.solution.success:
            return explicit
        self.methods = IMPLICIT
        return implicit

    def pilot(self, method: str, rtol: float, **options: int) -> Made:
        made = self.purse.pilot(method, rounded(rtol), **options)
        if made.solution.status == "time_limit":
            raise _TimeIsUp(made.solution)
        if method == FIRST_PILOT and not made.stats.stiff:
            made = made._replace(method=PILOTS[0])  # to the last bit
        if made.method in LAWS:
            self.forecast.measured_work(made.method, made.rtol, made.work)
        return made

    def made(self, method: str, rtol: float) -> Made:
        made = self.purse.run(method, rtol)
        self.forecast.measured_work(method, made.rtol, made.work)
        return made

    def verification(self, made: Made) -> Made:
        """Run what is verified once more, independently."""
        second = self.second(made)
        if second.solution.success and second.method in LAWS:
            self.forecast.measured_work(second.method, second.rtol, second.work)
        return second

    def second(self, made: Made) -> Made:
        own = self.forecast.rtol_for(made.method, self.error, LAWS[made.method].check)
        own = rounded(min(own, made.rtol / VERIFYING_STEP))
        tighter = made.rtol / TIGHTER
        others = [
            (m, rounded(min(self.forecast.rtol_for(m, self.error, LAWS[m].check), tighter)))
            for m in self.methods
            if m != made.method
        ]
        if others:
            method, rtol = min(others, key=lambda other: self.forecast.work_for(*other))
            least = self.forecast.least_work(self.methods, self.error)
            left = WHOLE * min(made.work, least) - made.work
            if not self.purse.takes_other_steps(made):  # tolerances tell little, and cost little
                return self.purse.verification(method, rounded(rtol / UNTOLD), made)
            if own >= made.rtol or self.forecast.work_for(method, rtol) <= left:
                return self.purse.verification(method, rtol, made)
        if own < made.rtol:
            return self.purse.verification(made.method, own, made)
        choice = next(second_choices(self.purse.start, made.choice, stiff=True))
        return self.purse.verification(choice.method, TIGHTEST, made)

    def tightened(self, made: Made, apart: float) -> Made:
        """Run again at the tolerance that follows from a measured error, or by another method."""
        self.forecast.measured_error(made.method, made.rtol, apart)
        aimed = self.forecast.rtol_for(made.method, self.error, MEASURED_AIM)
        if apart > NOTHING_IN_COMMON:
            aimed = max(aimed, made.rtol / FARTHEST)
        least = LEAST if self.purse.takes_other_steps(made) else UNTOLD
        rtol = rounded(min(aimed, made.rtol / least))
        if rtol <= TIGHTEST:
            return self.made(self.methods[-1], rtol)
        others = [m for m in self.methods if m != made.method]
        if others and apart <= NOTHING_IN_COMMON:
            other = self.forecast.cheapest(others, self.error)
            same = self.forecast.work_for(made.method, rtol)
            if self.forecast.work_for(*other) < WORTH_A_CHANGE * same:
                return self.made(*other)
        return self.made(made.method, rtol)

    def account(self, found: Comparison, verifying: Made) -> Accuracy:
        beyond = np.flatnonzero(~(found.apart <= self.error))
        last = beyond[0] - 1 if len(beyond) else len(found.times) - 1
        until = found.times[last] if last >= 0 else self.purse.start.t_start
        return Accuracy(
            asked=self.error,
            achieved=found.largest,
            reached=not len(beyond),
            until=float(until),
            times=len(found.times),
            verified_by=verifying.text,
            paid=tuple(self.purse.paid),
            seconds=self.purse.seconds(),
        )

    def unverified(self, solution: Solution, why: str) -> Solution:
        """Label a run that nothing was compared with."""
        solution._accuracy = Accuracy(
            asked=self.error,
            achieved=inf,
            reached=False,
            until=self.purse.start.t_start,
            times=0,
            verified_by=why,
            paid=tuple(self.purse.paid),
            seconds=self.purse.seconds(),
        )
        return solution

    def refusal(self, made: Made, verifying: Made) -> AccuracyError:
        """Return the error that says what was reached and why not more."""
        asked = f"error = {self.error:g}"
        if not verifying.solution.success:
            why = f"{verifying.text}: {verifying.solution.message}"
            self.unverified(made.solution, why)
            message = f"{asked}: the run by {made.text} could not be verified: {why}"
            return AccuracyError(message, made.solution)
        found = self.account(self.purse.compared(made, verifying), verifying)
        made.solution._accuracy = found
        reached = (
            f"{asked}: not reached: {made.text} and {verifying.text} are {found.achieved:.1e} of "
            f"the length apart"
        )
        if made.rtol > TIGHTEST:
            why = "the error does not follow the tolerances: is a law of your own not smooth?"
        elif found.achieved > HOPELESS:
            why = "neighbouring motions part too fast for double precision (chaos)"
        else:
            why = "tighter tolerances are lost in the rounding of doubles"
        held = found.until != self.purse.start.t_start
        until = f"; it holds until t = {found.until:.6g} s" if held else ""
        return AccuracyError(f"{reached}: {why}{until}", made.solution)
