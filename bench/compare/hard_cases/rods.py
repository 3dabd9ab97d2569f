"""Rates of two rods of 1 kg and 1 m with a mass at the tip, for programs without mechanics."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from cases import Array

G = 9.807


def two_rods(
    payload: float = 0.0,
    *,
    from_hanging: bool = False,
    of: Any = math,
    torques: Callable[[float, float, float], tuple[float, float]] | None = None,
) -> Callable[[float, Array], list[float]]:
    """Make the rates; `torques` gives those in both joints, N m, at t, qd_1 and qd_2.

    The determinant is free of terms that cancel. Python's floats are quicker than NumPy's, which
    know infinities: `of` is `math` or `numpy`.
    """
    cos, sin, a = of.cos, of.sin, 0.5 + payload
    weight1, weight2 = (1.5 + payload) * G, a * G
    near, far = 4 / 3 + payload, 1 / 3 + payload
    least = 7 / 36 + 2 * payload / 3

    def rates(t: float, y: Any) -> list[float]:
        q1, q2, w1, w2 = y.tolist() if of is math else y
        c, s = cos(q1 - q2), sin(q1 - q2)
        g1, g2 = (-sin(q1), -sin(q2)) if from_hanging else (cos(q1), cos(q2))
        r1 = weight1 * g1 - a * s * (w2 * w2)
        r2 = weight2 * g2 + a * s * (w1 * w1)
        if torques:
            first, second = torques(t, w1, w2)
            r1, r2 = r1 + first - second, r2 + second
        determinant = least + (a * s) * (a * s)
        a1 = (far * r1 - a * c * r2) / determinant
        return [w1, w2, a1, (near * r2 - a * c * r1) / determinant]

    return rates
