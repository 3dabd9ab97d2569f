"""The interface of the reference laws; most laws define one of its parts."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Arithmetic, Number
from reference.instant import Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True)
class Law:
    """An effect that does nothing."""

    def pivot(self, t: Number, arithmetic: Arithmetic) -> PivotMotion | None:
        """How the pivot moves, if the effect moves it."""
        return None

    def act(self, instant: Instant, loads: Loads) -> None:
        """Add forces and couples, inertia, constraints."""

    def kinetic(self, instant: Instant) -> Number:
        """Kinetic energy besides that of the links, J."""
        return 0

    def potential(self, instant: Instant) -> Number:
        """Potential energy besides that of the links, J."""
        return 0

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        """Power of each entry of the ledger, W; losses count as positive."""
        return {}
