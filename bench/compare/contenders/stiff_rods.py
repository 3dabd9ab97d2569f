"""Two unit rods with a linear torque in joint 2, for solvers that bring no mechanics.

    tau = -k (q2 - q1 - rest) - b (w2 - w1)

The textbook's closed form, with its Jacobian differentiated by hand: from M(q) a = r(q, w),
M da = dr - dM a. Written on scalars, for the interpreter and for numba alike.
"""

from __future__ import annotations

import math
from typing import Any

GRAVITY = 9.807


def rates(t: float, y: Any, k: float, b: float, rest: float) -> list[float]:
    """Return (w1, w2, a1, a2) of y = (q1, q2, w1, w2)."""
    q1, q2, w1, w2 = y
    tau = -k * (q2 - q1 - rest) - b * (w2 - w1)
    c, s = 0.5 * math.cos(q1 - q2), 0.5 * math.sin(q1 - q2)
    r1 = 1.5 * GRAVITY * math.cos(q1) - s * w2 * w2 - tau
    r2 = 0.5 * GRAVITY * math.cos(q2) + s * w1 * w1 + tau
    share = 1 / (4 / 9 - c * c)
    return [w1, w2, (r1 / 3 - c * r2) * share, (4 / 3 * r2 - c * r1) * share]


def jacobian(t: float, y: Any, k: float, b: float, rest: float) -> list[list[float]]:
    """Return the derivatives of the rates, (4, 4)."""
    q1, q2, w1, w2 = y
    tau = -k * (q2 - q1 - rest) - b * (w2 - w1)
    c, s = 0.5 * math.cos(q1 - q2), 0.5 * math.sin(q1 - q2)
    r1 = 1.5 * GRAVITY * math.cos(q1) - s * w2 * w2 - tau
    r2 = 0.5 * GRAVITY * math.cos(q2) + s * w1 * w1 + tau
    share = 1 / (4 / 9 - c * c)
    a1, a2 = (r1 / 3 - c * r2) * share, (4 / 3 * r2 - c * r1) * share
    # The right sides of M da = ..., by q1, q2, w1 and w2; dM has -s and s off its diagonal.
    first = [
        -1.5 * GRAVITY * math.sin(q1) - c * w2 * w2 - k + s * a2,
        c * w2 * w2 + k - s * a2,
        -b,
        b - 2 * s * w2,
    ]
    second = [
        c * w1 * w1 + k + s * a1,
        -0.5 * GRAVITY * math.sin(q2) - c * w1 * w1 - k - s * a1,
        b + 2 * s * w1,
        -b,
    ]
    by_1 = [(x / 3 - c * z) * share for x, z in zip(first, second)]  # noqa: B905 (numba)
    by_2 = [(4 / 3 * z - c * x) * share for x, z in zip(first, second)]  # noqa: B905
    return [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], by_1, by_2]
