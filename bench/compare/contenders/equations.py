"""The rates of change of two unit rods, for contenders that bring no mechanics.

The textbook's closed form with its constants in place, as its reader would write it, and written
twice, since each is the quickest for its caller: on Python's floats for the interpreter, into a
given array for compilers.
"""

from __future__ import annotations

import math
from typing import Any

from cases import Array, Case

from contenders.contender import Unsupported

GRAVITY = 9.807


def require_unit_rods(case: Case) -> None:
    """Raise Unsupported unless the case is two rods of 1 kg and 1 m under 9.807 m/s^2."""
    if (case.masses, case.lengths, case.gravity) != ((1.0, 1.0), (1.0, 1.0), GRAVITY):
        raise Unsupported("its right-hand side is written for two rods of 1 kg and 1 m")


def rates(t: float, y: Array) -> list[float]:
    """Return (qd, qdd), for the interpreter."""
    q1, q2, w1, w2 = y.tolist()
    a12 = 0.5 * math.cos(q1 - q2)
    h = 0.5 * math.sin(q1 - q2)
    r1 = 1.5 * GRAVITY * math.cos(q1) - h * w2 * w2
    r2 = 0.5 * GRAVITY * math.cos(q2) + h * w1 * w1
    determinant = 4 / 9 - a12 * a12
    return [w1, w2, (r1 / 3 - a12 * r2) / determinant, (4 / 3 * r2 - a12 * r1) / determinant]


def fill(out: Any, y: Any) -> None:
    """Write (qd, qdd) into `out`, for numba."""
    a12 = 0.5 * math.cos(y[0] - y[1])
    h = 0.5 * math.sin(y[0] - y[1])
    r1 = 1.5 * GRAVITY * math.cos(y[0]) - h * y[3] * y[3]
    r2 = 0.5 * GRAVITY * math.cos(y[1]) + h * y[2] * y[2]
    share = 1 / (4 / 9 - a12 * a12)
    out[0] = y[2]
    out[1] = y[3]
    out[2] = (r1 / 3 - a12 * r2) * share
    out[3] = (4 / 3 * r2 - a12 * r1) * share
