"""Stops at the ends of a joint's range: nothing between them, which is where states are drawn."""

from __future__ import annotations

from dataclasses import dataclass

from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads


@dataclass(frozen=True, kw_only=True)
class JointStop(Law):
    joint: int
    range: tuple[float, float]
    restitution: float = 0.0
    capture_speed: float | None = None

    def act(self, instant: Instant, loads: Loads) -> None:
        """Do nothing: the joint is not at a stop."""
