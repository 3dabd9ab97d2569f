"""Generalised forces that a function of t, q and qd returns.

The generalised force of a link's absolute angle is a couple on that link from outside the chain:
it does work as that angle turns, and only then.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class User(Law):
    function: Callable[[Any, Any, Any], Any]
    breaks: Sequence[float] = ()

    def forces(self, instant: Instant) -> list[Number]:
        number = instant.arithmetic.number
        q, qd = (np.array([number(x) for x in values]) for values in (instant.q, instant.qd))
        return list(self.function(number(instant.t), q, qd))

    def act(self, instant: Instant, loads: Loads) -> None:
        forces = self.forces(instant)
        # A function rounds too: one that cancels says how large its terms are.
        sizes = getattr(self.function, "sizes", lambda t, q, qd: [abs(force) for force in forces])
        each = sizes(float(instant.t), *(np.array(x, float) for x in (instant.q, instant.qd)))
        for link, (force, size) in enumerate(zip(forces, each, strict=True), start=1):
            loads.couple_on_link(link, force, size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        number = instant.arithmetic.number
        forces = zip(self.forces(instant), instant.qd, strict=True)
        return {"user": sum(force * number(rate) for force, rate in forces)}
