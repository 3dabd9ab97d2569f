"""A rigid body welded to the tip, with its mass centre there."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads


@dataclass(frozen=True, kw_only=True)
class Payload(Law):
    mass: float
    inertia: float = 0.0

    def act(self, instant: Instant, loads: Loads) -> None:
        number = instant.arithmetic.number
        loads.payloads.append((number(self.mass), number(self.inertia)))

    def kinetic(self, instant: Instant) -> Number:
        number, tip = instant.arithmetic.number, instant.joints[-1]
        translation = number(self.mass) * (tip.vx**2 + tip.vy**2) / 2
        return translation + number(self.inertia) * number(instant.qd[-1]) ** 2 / 2

    def potential(self, instant: Instant) -> Number:
        number = instant.arithmetic.number
        return -number(self.mass) * number(instant.gravity) * instant.joints[-1].y
