"""A spring in a joint: tau = -k (phi - phi_0), V = k (phi - phi_0)^2 / 2."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads


@dataclass(frozen=True, kw_only=True)
class TorsionalSpring(Law):
    joint: int
    stiffness: float
    rest_angle: float = 0.0

    def act(self, instant: Instant, loads: Loads) -> None:
        number = instant.arithmetic.number
        stiffness = number(self.stiffness)
        loads.couple_at_joint(self.joint, -stiffness * instant.relative_angle(self.joint))
        loads.couple_at_joint(self.joint, stiffness * number(self.rest_angle))

    def potential(self, instant: Instant) -> Number:
        number = instant.arithmetic.number
        turned = instant.relative_angle(self.joint) - number(self.rest_angle)
        return number(self.stiffness) * turned**2 / 2
