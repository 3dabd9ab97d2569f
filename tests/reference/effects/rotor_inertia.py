"""A rotor that turns with the relative angle of a joint: it takes the couple J phidd to turn."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads


@dataclass(frozen=True, kw_only=True)
class RotorInertia(Law):
    joint: int
    armature: float

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.armatures[self.joint - 1] += instant.arithmetic.number(self.armature)

    def kinetic(self, instant: Instant) -> Number:
        return instant.arithmetic.number(self.armature) * instant.relative_rate(self.joint) ** 2 / 2
