"""A joint that does not turn; the state says at which angle it is."""

from __future__ import annotations

from dataclasses import dataclass

from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads


@dataclass(frozen=True, kw_only=True)
class Lock(Law):
    joint: int
    angle: float | None = None

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.locked.add(self.joint)
