"""The verdict on a drawn scene: pendcore's answers beside the truth."""

from __future__ import annotations

import signal
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from math import isfinite
from time import monotonic
from typing import Any

import numpy as np
import pendcore as pc

from true_error import reference as ref
from true_error.asked import Drawn
from true_error.drawing import Dice
from true_error.reference import Reference, Truth
from true_error.trajectory import NoReferenceError

SECONDS = 10.0
"""The time limit of a run, of its error estimate and of the reference, each, s."""
PATIENCE = 4.0
"""The factor by which an answer may exceed its time limit before it counts as hung."""
SURE = 1 / 20
"""The largest uncertainty of a reference, as a share of the error or limit that is asked for."""

Simulate = Callable[..., pc.Solution]


@dataclass
class Verdict:
    """The verdict on a scene; errors are shares of the total length, times are in s."""

    family: str
    seed: int
    n: int
    """The number of links."""
    asked: float
    """The error that was asked for."""
    method: str = ""
    outcome: str = ""
    """kept, refused (`AccuracyError`), ended early, unverified, or exception."""
    says: str = ""
    """The verification, or the message."""
    achieved: float | None = None
    """The error that the run says it reached."""
    true: float | None = None
    """The error that it has; None where the reference is not good enough."""
    unsure: float = 0.0
    """The largest uncertainty of `true`."""
    estimated: float | None = None
    """The error by ``sol.estimate_error()``."""
    is_one_estimate: bool = True
    """Whether ``accuracy.until`` of a run that is kept is its end, and the estimate's as well."""
    exception: str = ""
    """The exception that was raised, if it is not an `AccuracyError`."""
    doubles: float | None = None
    """The error of an independent integrator in doubles: above `asked`, a refusal is needed."""
    limit: float | None = None
    """The limit of the run without ``error=``, rad."""
    valid_until: float | None = None
    """The time until which that run claims to keep the limit."""
    first_past: float | None = None
    """The time before that at which the truth first passed the limit."""
    limit_known: bool = False
    """Whether the reference could tell."""
    work: float = 0.0
    """Right-hand sides of all runs."""
    seconds: float = 0.0
    reference_seconds: float = 0.0
    no_reference: str = ""
    """Why there is no reference."""

    @property
    def faults(self) -> list[str]:
        """Return which claims the scene breaks."""
        is_kept = self.outcome == "kept"
        is_said_again = self.estimated in (None, self.achieved) and self.is_one_estimate
        found = {
            "above": is_kept and self.true is not None and self.true > self.asked,
            "late": self.first_past is not None,
            "contradicted": is_kept and not is_said_again,
            "exceptions": bool(self.exception),
        }
        return [name for name, is_so in found.items() if is_so]

    @property
    def rarities(self) -> list[str]:
        """Return what is no fault of a scene, but must not happen in many."""
        is_kept = self.outcome == "kept"
        is_known = is_kept and self.true is not None and self.achieved is not None
        found = {
            "unverified": self.outcome == "unverified",
            "told_too_little": is_known and self.true - self.unsure > self.achieved,
            "no_reference": is_kept and self.true is None,
            "limit_not_known": not self.limit_known,
        }
        return [name for name, is_so in found.items() if is_so]

    def record(self) -> dict[str, Any]:
        """Return the same for JSON."""
        values = {
            name: None if isinstance(value, float) and not isfinite(value) else value
            for name, value in asdict(self).items()
        }
        return values | {"faults": self.faults}


class UnexpectedError(Exception):
    """An exception that pendcore should not have raised."""


def judged(drawn: Drawn, simulate: Simulate = pc.simulate, seconds: float = SECONDS) -> Verdict:
    """Return what became of a scene; what raises anything but `AccuracyError` is an exception."""
    verdict = Verdict(drawn.family, drawn.seed, len(drawn.scene.links), drawn.error)
    reference = Reference(drawn, seconds)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        for question in (_asked_error, _valid_until):
            try:
                question(drawn, verdict, simulate, reference, seconds)
            except UnexpectedError as stop:
                verdict.exception = f"{stop}"[:300]
                verdict.outcome = verdict.outcome or "exception"
    return verdict


@contextmanager
def answering(verdict: Verdict, seconds: float) -> Iterator[None]:
    """Take the time of an answer of pendcore's, and turn what it raises into `UnexpectedError`."""
    began = monotonic()
    former = signal.signal(signal.SIGALRM, _hung)
    signal.setitimer(signal.ITIMER_REAL, PATIENCE * seconds)
    try:
        yield
    except pc.AccuracyError:
        raise
    except Exception as stop:
        raise UnexpectedError(f"{type(stop).__name__}: {stop}") from stop
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0.0)
        signal.signal(signal.SIGALRM, former)
        verdict.seconds += monotonic() - began


def _hung(*_: object) -> None:
    raise TimeoutError("the time limit was passed long ago")


def outcome_of(sol: pc.Solution) -> str:
    """Return in a word what became of an error that was asked for and not refused."""
    told = sol.accuracy
    return told.outcome if told.outcome == "kept" or told.times else "unverified"


def _asked_error(
    drawn: Drawn, verdict: Verdict, simulate: Simulate, reference: Reference, seconds: float
) -> None:
    """Ask for the error, and see whether it was kept."""
    try:
        with answering(verdict, seconds):
            sol = simulate(
                drawn.scene, drawn.span, drawn.q0, drawn.qd0,
                error=drawn.error, time_limit=seconds, **drawn.options,
            )  # fmt: skip
        verdict.outcome = outcome_of(sol)
    except pc.AccuracyError as refusal:
        sol = refusal.solution
        verdict.outcome = "refused"
    verdict.method = sol.method
    verdict.says = f"{sol.status}; {sol.accuracy.verified_by}"
    verdict.achieved = float(sol.accuracy.achieved)
    verdict.work = float(sum(paid.work for paid in sol.accuracy.paid))
    is_kept = verdict.outcome == "kept"
    if is_kept and len(sol.t):
        with answering(verdict, seconds):
            estimate = sol.estimate_error(time_limit=seconds)
            verdict.estimated = estimate.largest
            ends = sol.accuracy.until, estimate.valid_until(drawn.error, of="position")
            last = float(sol.t[-1])
            verdict.is_one_estimate = all(end == last for end in ends)
    dense = is_kept and drawn.is_dense
    with answering(verdict, seconds):
        t = ref.times_of(sol, dense, Dice(drawn.family, drawn.seed).rng)
        q = ref.angles_of(sol, t, dense)
    began = monotonic()
    try:
        _compare(drawn, verdict, t, q, reference)
    except NoReferenceError as reason:
        verdict.no_reference = str(reason)
    verdict.reference_seconds += monotonic() - began


def _compare(drawn: Drawn, verdict: Verdict, t: Any, q: Any, reference: Reference) -> None:
    """Hold the run that was asked for against the reference, if it is said to keep the error."""
    if not len(t):
        raise NoReferenceError("the run kept no state")
    truth = reference.angles(t)
    verdict.doubles = float(truth.coarse.max())
    if verdict.outcome != "kept":
        return
    verdict.true = _true_error(drawn, q, truth)
    if verdict.true is None:
        truth = reference.angles(t, finest=True)
        verdict.true = _true_error(drawn, q, truth)
    verdict.unsure = float(truth.unsure.max())
    if verdict.true is None:
        verdict.no_reference = "more digits than quadruple precision has would be needed"


def _true_error(drawn: Drawn, q: Any, truth: Truth) -> float | None:
    """Return the true error, if the reference knows that, or that it is above what was asked."""
    apart = ref.positions_apart(drawn.scene, q, truth.angles)
    if not np.isfinite(apart).all():
        return np.inf
    known = truth.unsure <= SURE * drawn.error
    if known.all() or apart[known].max(initial=0.0) > drawn.error:
        return float(apart[known].max(initial=0.0))
    return None


def _valid_until(
    drawn: Drawn, verdict: Verdict, simulate: Simulate, reference: Reference, seconds: float
) -> None:
    """Run without asking for an error, and see whether the run knows how long it is right."""
    with answering(verdict, seconds):
        sol = simulate(
            drawn.scene, drawn.span, drawn.q0, drawn.qd0, rtol=drawn.rtol, time_limit=seconds
        )
        verdict.limit = drawn.limit
        verdict.valid_until = sol.valid_until(drawn.limit, time_limit=seconds)
    began = monotonic()
    t = ref.times_of(sol, True, Dice(drawn.family, drawn.seed).rng)
    sign = np.sign(drawn.t_end - drawn.t_start)
    t = t[sign * t <= sign * verdict.valid_until]
    if len(t):
        q = ref.angles_of(sol, t, True)
        try:
            truth = reference.angles(t)
            if not _limit_known(drawn, verdict, q, t, truth):
                _limit_known(drawn, verdict, q, t, reference.angles(t, finest=True))
        except NoReferenceError as reason:
            verdict.no_reference = verdict.no_reference or str(reason)
    verdict.reference_seconds += monotonic() - began


def _limit_known(drawn: Drawn, verdict: Verdict, q: Any, t: Any, truth: Truth) -> bool:
    known = truth.unsure_angle <= SURE * drawn.limit
    past = np.flatnonzero(known & ~(ref.angles_apart(q, truth.angles) <= drawn.limit))
    if len(past):
        verdict.first_past = float(t[past[0]])
    verdict.limit_known = bool(known.all() or len(past))
    return verdict.limit_known
