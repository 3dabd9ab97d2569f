"""Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), w the rate of the joint."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class ViscousJoint(Law):
    joint: int
    damping: float
    damping2: float = 0.0
    damping3: float = 0.0

    def terms(self, instant: Instant) -> list[Number]:
        number, w = instant.arithmetic.number, instant.relative_rate(self.joint)
        return [
            -number(self.damping) * w,
            -number(self.damping2) * w * abs(w),
            -number(self.damping3) * w**3,
        ]

    def act(self, instant: Instant, loads: Loads) -> None:
        for term in self.terms(instant):
            loads.couple_at_joint(self.joint, term)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"viscous": -sum(self.terms(instant)) * instant.relative_rate(self.joint)}
