"""Generalised forces that a compiled function writes, called at its address with doubles."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.effects.user import User
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion

DOUBLES = ctypes.POINTER(ctypes.c_double)
SIGNATURE = ctypes.CFUNCTYPE(
    None, ctypes.c_double, ctypes.c_int, DOUBLES, DOUBLES, DOUBLES, ctypes.c_void_p
)


@dataclass(frozen=True, kw_only=True)
class CompiledUser(Law):
    address: int
    data: int = 0
    breaks: Sequence[float] = ()

    def called(self) -> User:
        def function(t: Number, q: object, qd: object) -> list[float]:
            q, qd = np.asarray(q, dtype=float), np.asarray(qd, dtype=float)
            forces = np.zeros(len(q))
            pointers = [array.ctypes.data_as(DOUBLES) for array in (q, qd, forces)]
            SIGNATURE(self.address)(float(t), len(q), *pointers, self.data)
            return list(forces.tolist())

        return User(function=function)

    def act(self, instant: Instant, loads: Loads) -> None:
        self.called().act(instant, loads)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return self.called().shares(instant, motion)
