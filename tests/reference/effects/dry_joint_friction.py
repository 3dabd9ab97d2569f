"""Dry friction in sliding: tau = -(tc + (ts - tc) exp(-abs(w/ws)^p)) sgn w (Stribeck's law)."""

from __future__ import annotations

from dataclasses import dataclass

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class DryJointFriction(Law):
    joint: int
    coulomb: float
    static: float | None = None
    stribeck_velocity: float = 0.1
    exponent: float = 2.0

    def couple(self, instant: Instant) -> Number:
        number, w = instant.arithmetic.number, instant.relative_rate(self.joint)
        coulomb = number(self.coulomb)
        static = coulomb if self.static is None else number(self.static)
        near_rest = instant.arithmetic.exp(
            -(abs(w / number(self.stribeck_velocity)) ** number(self.exponent))
        )
        against = (w < 0) - (w > 0)
        return (coulomb + (static - coulomb) * near_rest) * against

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.couple_at_joint(self.joint, self.couple(instant))

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"dry": -self.couple(instant) * instant.relative_rate(self.joint)}
