"""What became of an error that was asked for: what was reached, how it was checked, the cost."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

if TYPE_CHECKING:
    from pendcore.solution import Solution


class Paid(NamedTuple):
    """A run that was made.

    Attributes
    ----------
    purpose : str
        ``"choose"``, ``"run"``, ``"verify"``; what is not the last of its kind was not good enough.
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

    Errors are the largest distance of a joint or the tip, over the times that were compared, as a
    share of the total length.

    Attributes
    ----------
    asked : float
        The error that was asked for.
    achieved : float
        The distance from the verifying run; infinite where there is none.
    reached : bool
        Whether that is as small as asked.
    until : float
        Until when it is, s.
    times : int
        At how many times the two runs were compared.
    verified_by : str
        How the verifying run was made; why there is none, where ``times`` is 0.
    paid : tuple of Paid
        All the runs, in their order.
    seconds : float
        What all of it took, s.
    """

    asked: float
    achieved: float
    reached: bool
    until: float
    times: int
    verified_by: str
    paid: tuple[Paid, ...]
    seconds: float

    def work(self, purpose: str | None = None) -> float:
        """Return the work of all runs in right-hand sides, or that of the last of a purpose.

        A series of ``taylor`` counts as the many right-hand sides that take as long.
        """
        if purpose == "choose":
            return self.work() - self.work("run") - self.work("verify")
        if purpose is not None:
            return next((p.work for p in reversed(self.paid) if p.purpose == purpose), 0.0)
        return sum(p.work for p in self.paid)

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

    def outcome(self) -> str:
        """Return what was asked for and what came of it, without what it took."""
        verdict = "" if self.reached else ", not reached"
        found = (
            f"achieved {self.achieved:.1e} of the total length{verdict}: the distance from "
            f"{self.verified_by} at {self.times} times"
        )
        if not self.times:
            found = f"not verified: {self.verified_by}"
        return f"asked {self.asked:.1e}, {found}"

    def __repr__(self) -> str:
        return (
            f"{self.outcome()}; paid {len(self.paid)} runs, as long as "
            f"{self.work():.0f} right-hand sides: {self.work('run'):.0f} the run, "
            f"{self.work('verify'):.0f} to verify it, {self.work('choose'):.0f} to choose it"
        )


class AccuracyError(ArithmeticError):
    """An error was asked for that could not be reached, or not be verified.

    Attributes
    ----------
    solution : Solution
        The most accurate run that was made; its ``accuracy`` says what was reached.
    """

    def __init__(self, message: str, solution: Solution | None = None) -> None:
        super().__init__(message)
        self.solution = solution

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (str(self), self.solution)
