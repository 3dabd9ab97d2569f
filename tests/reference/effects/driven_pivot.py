"""A pivot that is moved: sinusoids along x and y, or a natural cubic spline through points.

The work of the drive is that of the force which holds the pivot: W = F_01 . v_0.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from reference.arithmetic import Arithmetic, Number
from reference.effects.law import Law
from reference.effects.natural_spline import natural_spline
from reference.effects.sinusoid import sinusoid
from reference.instant import Instant, PivotMotion
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class DrivenPivot(Law):
    x: Mapping[str, float] | None = None
    y: Mapping[str, float] | None = None
    spline: Mapping[str, Sequence[float]] | None = None

    def pivot(self, t: Number, arithmetic: Arithmetic) -> PivotMotion:
        if self.spline is not None:
            knots = self.spline["t"]
            axes = [natural_spline(t, knots, self.spline[axis], arithmetic) for axis in "xy"]
            gap = min(after - before for before, after in pairwise(knots))
            size = 12 * max(abs(x) for axis in "xy" for x in self.spline[axis]) / gap**2
        else:
            zero = (arithmetic.number(0),) * 3
            axes = [
                zero if axis is None else sinusoid(t, axis, arithmetic) for axis in (self.x, self.y)
            ]
            driven = [axis for axis in (self.x, self.y) if axis is not None]
            size = max(abs(a["amplitude"]) * a["angular_frequency"] ** 2 for a in driven)
        return PivotMotion(*zip(*axes, strict=True), size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        (fx, fy), (vx, vy) = motion.reactions[0], instant.pivot.velocity
        return {"drive": fx * vx + fy * vy}
