"""What became of an error that was asked for: what was reached, how it was checked, the cost."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import inf
from typing import Any, Literal, NamedTuple, TypeAlias

Outcome: TypeAlias = Literal["kept", "refused", "ended early"]


class Paid(NamedTuple):
    """A run that was made.

    Attributes
    ----------
    purpose : str
        ``"run"`` for the run that is returned, ``"verify"`` for those that it is compared with,
        ``"choose"`` for the others.
    method : str
    rtol : float
    nfev : int
        Right-hand sides; of ``taylor``, series.
    work : float
        In right-hand sides, a series counted as the many that take as long.
    """

    purpose: str
    method: str
    rtol: float
    nfev: int
    work: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Accuracy:
    """The error that was asked for, and what came of it.

    Errors are the largest distance of a joint or the tip from where it ought to be, as a share of
    the total length: over the whole curve of a run with dense output, else over the times it kept.

    Attributes
    ----------
    asked : float
        The error that was asked for.
    achieved : float
        The error of the run, estimated from above; infinite where nothing verified it.
    outcome : {"kept", "refused", "ended early"}
        Whether the error is kept; could not be shown to be kept; or the run did not get to its end,
        and ``achieved`` and ``until`` tell of what there is.
    until : float
        Until when the error is kept, s.
    times : int
        At how many times the runs were compared.
    everywhere : bool
        Whether these lie within every step, so that the error is that of the whole curve.
    verified_by : str
        How the verifying runs were made; why there is none, where ``times`` is 0.
    paid : tuple of Paid
        All the runs, in their order.
    seconds : float
        What all of it took, s.
    """

    asked: float
    achieved: float
    outcome: Outcome
    until: float
    times: int
    everywhere: bool
    verified_by: str
    paid: tuple[Paid, ...]
    seconds: float

    @property
    def reached(self) -> bool:
        """Whether the error is as small as asked."""
        return self.outcome == "kept"

    def work(self, purpose: str | None = None) -> float:
        """Return the work of all runs, or of those with a purpose, in right-hand sides.

        A series of ``taylor`` counts as the many right-hand sides that take as long.
        """
        return sum(p.work for p in self.paid if purpose in (None, p.purpose))

    def to_dict(self) -> dict[str, Any]:
        """Return the same for JSON."""
        achieved = self.achieved if self.achieved < inf else None
        return asdict(self) | {"achieved": achieved, "paid": [p._asdict() for p in self.paid]}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Accuracy:
        """Make it again from what `to_dict` returned."""
        achieved = inf if values["achieved"] is None else values["achieved"]
        paid = tuple(Paid(**p) for p in values["paid"])
        return cls(**(values | {"achieved": achieved, "paid": paid}))

    def text(self) -> str:
        """Return what was asked for and what came of it, without what it took."""
        asked = f"asked {self.asked:.1e}"
        if not self.times:
            return f"{asked}, not verified: {self.verified_by}"
        verdict = {
            "kept": "",
            "refused": ", not reached",
            "ended early": f" as far as it is known (kept until t = {self.until:.6g} s)",
        }[self.outcome]
        where = f"at {self.times} times"
        if self.everywhere:
            where = "over the curve" if self.outcome == "ended early" else "over the whole curve"
        return (
            f"{asked}, achieved {self.achieved:.1e} of the total length {where}{verdict}: "
            f"verified by {self.verified_by}"
        )

    def __repr__(self) -> str:
        return (
            f"{self.text()}; paid {len(self.paid)} runs, as long as "
            f"{self.work():.0f} right-hand sides: {self.work('run'):.0f} the run, "
            f"{self.work('verify'):.0f} to verify it, {self.work('choose'):.0f} to choose it"
        )


class AccuracyError(ArithmeticError):
    """An error was asked for that could not be reached, or not be verified.

    Attributes
    ----------
    solution : Solution
        The most accurate run that was made; its ``accuracy`` says what was reached.
    least : float
        The least error that can be verified here, as a share of the total length; infinite where
        none can.
    """

    def __init__(self, message: str, solution: Any = None, least: float = inf) -> None:
        super().__init__(message)
        self.solution = solution
        self.least = least

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.solution, self.least)
