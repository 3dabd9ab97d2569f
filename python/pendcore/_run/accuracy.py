"""The error that was asked for, the error that was reached, how it was checked, and the cost."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from math import inf
from typing import Any, Literal, NamedTuple, TypeAlias

from pendcore._messages.html import table

Outcome: TypeAlias = Literal["kept", "refused", "ended early"]


DEFECT = "defect of "
"""With this the method of a `Paid` begins if a defect was integrated and no run made."""


class Paid(NamedTuple):
    """A run that was made, or the integration of its defect.

    Attributes
    ----------
    purpose : str
        ``"run"`` for the run that is returned, ``"verify"`` for what verifies it, ``"choose"`` for
        all else.
    method : str
        That of the run; ``"defect of ..."`` for the integration of its defect.
    rtol : float
    nfev : int
        The number of right-hand sides, or of series for a run by ``taylor``.
    work : float
        The same in right-hand sides of a run; a series, and a right-hand side of an integration of
        the defect, count as the number of these that take as long.
    """

    purpose: str
    method: str
    rtol: float
    nfev: int
    work: float


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class Accuracy:
    """The error that was asked for, and what was reached.

    An error is the largest distance of a joint or the tip from its true place, as a share of the
    total length: over the whole curve of a run with dense output, otherwise over the times that the
    run kept.

    Attributes
    ----------
    asked : float
        The error that was asked for.
    achieved : float
        The error of the run, estimated from above: the true one is larger in about 1 of 300 runs,
        and mostly where both are far below the error asked for. Infinite where nothing verified the
        run, and where it is lost before its end.
    outcome : {"kept", "refused", "ended early"}
        ``"kept"``: the error is kept. ``"refused"``: that could not be shown. ``"ended early"``:
        the run did not reach its end, and ``achieved`` and ``until`` describe the part that there
        is; or it was not verified before the time was up.
    until : float
        The time until which the error is kept, s.
    times : int
        The number of times at which the error is known.
    everywhere : bool
        Whether these times lie within every step, so that the error is that of the whole curve.
    verified_by : str
        What verified the run, or why nothing did if ``times`` is 0. The defect is how far the curve
        of the run misses the equations of motion, which bounds its error:
        ``docs/background/defect.md``.
    paid : tuple of Paid
        All that was computed, in its order.
    seconds : float
        The time that the whole search took, s.

    Examples
    --------
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, error=1e-6)
    >>> sol.accuracy.asked, sol.accuracy.outcome
    (1e-06, 'kept')
    >>> sol.accuracy.achieved <= 1e-6
    True
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

    @property
    def runs(self) -> int:
        """How many runs were made."""
        return sum(not paid.method.startswith(DEFECT) for paid in self.paid)

    def work(self, purpose: str | None = None) -> float:
        """Return the work of all that was computed, or of that with a purpose, in right-hand sides.

        Each series counts as the number of right-hand sides that take as long, and so does each
        right-hand side in the integration of a defect.
        """
        return sum(p.work for p in self.paid if purpose in (None, p.purpose))

    def to_dict(self) -> dict[str, Any]:
        """Return the fields as JSON can hold them."""
        achieved = self.achieved if self.achieved < inf else None
        return asdict(self) | {"achieved": achieved, "paid": [p._asdict() for p in self.paid]}

    @classmethod
    def from_dict(cls, values: dict[str, Any]) -> Accuracy:
        """Return the object that `to_dict` described."""
        achieved = inf if values["achieved"] is None else values["achieved"]
        paid = tuple(Paid(**p) for p in values["paid"])
        return cls(**(values | {"achieved": achieved, "paid": paid}))

    def text(self) -> str:
        """Return what was asked for and what was reached, without the cost."""
        asked = f"asked {self.asked:.1e}"
        if not self.times:
            return f"{asked}, not verified: {self.verified_by}"
        verdict = {
            "kept": "",
            "refused": ", not reached",
            "ended early": f" as far as it is known (kept until t = {self.until:.10g} s)",
        }[self.outcome]
        where = f"at {self.times} time{'s'[: self.times != 1]}"
        if self.everywhere:
            where = "over the curve" if self.outcome == "ended early" else "over the whole curve"
        achieved = f"achieved {self.achieved:.1e} of the total length {where}"
        if self.achieved == inf:
            achieved = f"kept until t = {self.until:.10g} s and lost before the end"
            verdict = ""
        return f"{asked}, {achieved}{verdict}: verified by {self.verified_by}"

    @property
    def _runs(self) -> str:
        return f"{self.runs} run{'s'[: self.runs != 1]}"

    def _repr_html_(self) -> str:
        reached = f"{self.achieved:.1e}" if self.times else "not known"
        rows = [
            ("asked", f"{self.asked:.1e} of the total length"),
            ("achieved", reached),
            ("outcome", self.outcome),
            ("verified by", self.verified_by),
            ("paid", f"{self._runs}, {self.work():.0f} right-hand sides in all, "
             f"{self.work('run'):.0f} of them in this run; {self.seconds:.2g} s"),
        ]  # fmt: skip
        return table(rows)

    def __repr__(self) -> str:
        return (
            f"{self.text()}; paid {self._runs}, as long as "
            f"{self.work():.0f} right-hand sides: {self.work('run'):.0f} the run, "
            f"{self.work('verify'):.0f} to verify it, {self.work('choose'):.0f} to choose it"
        )


class AccuracyError(ArithmeticError):
    """The error that was asked for could not be reached, or not be verified.

    Attributes
    ----------
    solution : Solution
        The most accurate run that was made; its ``accuracy`` says what was reached.
    least : float
        The least error, as a share of the total length, that was found to be kept when it is asked
        for; infinite if none was.

    Examples
    --------
    >>> try:
    ...     pc.simulate(pc.Scene.textbook(), (0, 5), 0.5, error=1e-20)
    ... except pc.AccuracyError as refused:
    ...     print(1e-20 < refused.least < 1e-12, refused.solution.success)
    True True
    """

    solution: Any
    least: float
