"""Rates of change of two or three rods of 1 kg and 1 m, for contenders without mechanics.

This is the closed form with its constants in place, as a reader of it would write it for speed. The
elimination begins at the tip and takes as few products as possible; for heyoka these are products
of series. It is written once for any sine and cosine: Python's, which numba compiles too, and
heyoka's. (unit_rods.hpp has the same in C++.)
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

from cases import Array, Case

from contenders.contender import Unsupported

GRAVITY = 9.807


def require_unit_rods(case: Case) -> None:
    """Raise Unsupported unless one of the closed forms below fits the case."""
    rods = {(1.0, 1.0): 2, (1.0, 1.0, 1.0): 3}.get(case.masses)
    unit = rods and case.lengths == case.masses and case.gravity == GRAVITY
    if not unit or (rods == 3 and not case.bare):
        raise Unsupported(
            "its right-hand sides are written for two or three rods of 1 kg and 1 m, the joints of "
            "three without torque"
        )


def accelerations(
    case: Case, sin: Any = math.sin, cos: Any = math.cos, drive: Any = 0.0
) -> Callable[..., Any]:
    """Map q_1..q_n, qd_1..qd_n to (qdd_1, ..., qdd_n), for any type that `sin` and `cos` take.

    `drive` is a torque in joint 1 of two rods, N m.
    """
    require_unit_rods(case)
    if case.n == 3:
        return three_rods(sin, cos)
    return two_rods(sin, cos) if case.bare and not drive else loaded_rods(case, sin, cos, drive)


def two_rods(sin: Any, cos: Any) -> Callable[..., Any]:
    def found(q1: Any, q2: Any, w1: Any, w2: Any) -> Any:
        d = q1 - q2
        c, s = cos(d), sin(d)
        r1 = 1.5 * GRAVITY * cos(q1) - 0.5 * s * (w2 * w2)
        r2 = 0.5 * GRAVITY * cos(q2) + 0.5 * s * (w1 * w1)
        a1 = (4 / 3 * r1 - 2 * (c * r2)) / (16 / 9 - c * c)
        return a1, 3 * r2 - 1.5 * (c * a1)

    return found


def loaded_rods(case: Case, sin: Any, cos: Any, drive: Any = 0.0) -> Callable[..., Any]:
    """The same mapping, with springs and dampers in the joints and a motor in the first."""
    (b1, b2), (k1, k2), (rest1, rest2) = case.damping, case.stiffness, case.rest

    def found(q1: Any, q2: Any, w1: Any, w2: Any) -> Any:
        tau1 = drive - b1 * w1 - k1 * (q1 - rest1)
        tau2 = -b2 * (w2 - w1) - k2 * (q2 - q1 - rest2)
        d = q1 - q2
        c, s = cos(d), sin(d)
        r1 = 1.5 * GRAVITY * cos(q1) - 0.5 * s * (w2 * w2) + (tau1 - tau2)
        r2 = 0.5 * GRAVITY * cos(q2) + 0.5 * s * (w1 * w1) + tau2
        a1 = (4 / 3 * r1 - 2 * (c * r2)) / (16 / 9 - c * c)
        return a1, 3 * r2 - 1.5 * (c * a1)

    return found


def three_rods(sin: Any, cos: Any) -> Callable[..., Any]:
    def found(q1: Any, q2: Any, q3: Any, w1: Any, w2: Any, w3: Any) -> Any:
        d12, d13, d23 = q1 - q2, q1 - q3, q2 - q3
        c12, c13, c23 = cos(d12), cos(d13), cos(d23)
        s12, s13, s23 = sin(d12), sin(d13), sin(d23)
        v1, v2, v3 = w1 * w1, w2 * w2, w3 * w3
        r1 = 2.5 * GRAVITY * cos(q1) - 1.5 * (s12 * v2) - 0.5 * (s13 * v3)
        r2 = 1.5 * GRAVITY * cos(q2) + 1.5 * (s12 * v1) - 0.5 * (s23 * v3)
        r3 = 0.5 * GRAVITY * cos(q3) + 0.5 * (s13 * v1) + 0.5 * (s23 * v2)
        m11, m22 = 7 / 3 - 0.75 * (c13 * c13), 4 / 3 - 0.75 * (c23 * c23)
        m12 = 1.5 * c12 - 0.75 * (c13 * c23)
        p1, p2 = r1 - 1.5 * (c13 * r3), r2 - 1.5 * (c23 * r3)
        ratio = m12 / m22
        a1 = (p1 - ratio * p2) / (m11 - ratio * m12)
        a2 = p2 / m22 - ratio * a1
        return a1, a2, 3 * r3 - 1.5 * (c13 * a1 + c23 * a2)

    return found


def rates(case: Case) -> Callable[[float, Array], list[float]]:
    """Make the function of (t, y) that returns (qd, qdd), for the interpreter.

    It computes with Python's floats, which are quicker there than NumPy's numbers.
    """
    found = accelerations(case)
    n = case.n

    def rates_of(t: float, y: Array) -> list[float]:
        state = y.tolist()
        return [*state[n:], *found(*state)]

    return rates_of


def fill(case: Case, compiler: Callable[[Any], Any]) -> Callable[[Any, Any], None]:
    """Make the function that writes (qd, qdd) of y into `out`; `compiler` is numba's njit."""
    found = compiler(accelerations(case))

    def fill_two(out: Any, y: Any) -> None:
        a1, a2 = found(y[0], y[1], y[2], y[3])
        out[0] = y[2]
        out[1] = y[3]
        out[2] = a1
        out[3] = a2

    def fill_three(out: Any, y: Any) -> None:
        a1, a2, a3 = found(y[0], y[1], y[2], y[3], y[4], y[5])
        out[0] = y[3]
        out[1] = y[4]
        out[2] = y[5]
        out[3] = a1
        out[4] = a2
        out[5] = a3

    return fill_two if case.n == 2 else fill_three


def jacobian(
    case: Case, compiler: Callable[[Any], Any] = lambda function: function
) -> Callable[[float, Array], list[list[float]]] | None:
    """Make the function of (t, y) that returns the rates' derivatives, (4, 4); None for three rods.

    They are derived by hand: M a = r(q, w) gives M da = dr - dM a. The function computes with
    scalars, so that numba can compile it too.
    """
    if case.n != 2:
        return None
    (b1, b2), (k1, k2) = case.damping, case.stiffness
    sin, cos, found = math.sin, math.cos, compiler(accelerations(case))

    def derivatives(t: float, y: Any) -> list[list[float]]:
        q1, q2, w1, w2 = y
        a1, a2 = found(q1, q2, w1, w2)
        c, s = 0.5 * cos(q1 - q2), 0.5 * sin(q1 - q2)
        share = 1 / (4 / 9 - c * c)
        # The right sides of M da = ..., by q1, q2, w1 and w2; dM has -s and s off its diagonal.
        first = [
            -1.5 * GRAVITY * sin(q1) - c * w2 * w2 - k2 - k1 + s * a2,
            c * w2 * w2 + k2 - s * a2,
            -b2 - b1,
            b2 - 2 * s * w2,
        ]
        second = [
            c * w1 * w1 + k2 + s * a1,
            -0.5 * GRAVITY * sin(q2) - c * w1 * w1 - k2 - s * a1,
            b2 + 2 * s * w1,
            -b2,
        ]
        by_1 = [(x / 3 - c * z) * share for x, z in zip(first, second)]  # noqa: B905 (numba)
        by_2 = [(4 / 3 * z - c * x) * share for x, z in zip(first, second)]  # noqa: B905
        return [[0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0], by_1, by_2]

    return derivatives
