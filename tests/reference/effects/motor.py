"""The couple of a motor at a joint, never more than its limit.

Constant; a sinusoid of time; a table of time, linear between its points or held from each to the
next; or tau = kp (reference - phi) - kd phid.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.effects.sinusoid import sinusoid
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class Motor(Law):
    joint: int
    constant: float | None = None
    sinusoid: Mapping[str, float] | None = None
    table: Mapping[str, Any] | None = None
    pd: Mapping[str, float] | None = None
    limit: float = math.inf

    def wanted(self, instant: Instant) -> list[Number]:
        number, t = instant.arithmetic.number, instant.t
        if self.constant is not None:
            return [number(self.constant)]
        if self.sinusoid is not None:
            return [sinusoid(t, self.sinusoid, instant.arithmetic)[0]]
        if self.table is not None:
            knots = [number(k) for k in self.table["t"]]
            i = max(k for k in range(len(knots) - 1) if knots[k] <= t or k == 0)
            before, after = map(number, self.table["torque"][i : i + 2])
            if self.table.get("hold"):
                return [before]
            on = (number(t) - knots[i]) / (knots[i + 1] - knots[i])
            return [(1 - on) * before, on * after]
        assert self.pd is not None
        kp, kd, reference = (number(self.pd[name]) for name in ("kp", "kd", "reference"))
        phi, w = instant.relative_angle(self.joint), instant.relative_rate(self.joint)
        return [kp * reference, -kp * phi, -kd * w]

    def terms(self, instant: Instant) -> list[Number]:
        wanted, limit = self.wanted(instant), instant.arithmetic.number(self.limit)
        if abs(sum(wanted)) > limit:
            return [limit if sum(wanted) > 0 else -limit]
        return wanted

    def act(self, instant: Instant, loads: Loads) -> None:
        size = abs(self.sinusoid["amplitude"]) if self.sinusoid is not None else None
        for term in self.terms(instant):
            loads.couple_at_joint(self.joint, term, size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"motor": sum(self.terms(instant)) * instant.relative_rate(self.joint)}
