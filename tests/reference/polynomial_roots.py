"""The first zero of a polynomial with fixed-point coefficients, to the last bit."""

from __future__ import annotations

from fractions import Fraction

import mpmath

from reference.taylor_series import horner

NEAR = 180
"""Halvings of the interval that are looked at near 0, where all is steep in a small bounce."""
FAR = 48
"""Equal parts of it that are looked at besides; least values in between are looked for."""


def first_root(guard: list[int], end: int, bits: int) -> int | None:
    """Where a polynomial first falls below 0 in (0, end]."""
    x_end = float(Fraction(end, 1 << bits))
    floats = [float(Fraction(c, 1 << bits)) for c in guard]
    while floats and floats[-1] == 0:
        floats.pop()

    def value(x: float) -> tuple[float, float]:
        v = s = 0.0
        for c in reversed(floats):
            s = s * x + v
            v = v * x + c
        return v, s

    if not floats:
        return None
    grid = sorted(
        {x_end * 2.0**-k for k in range(1, NEAR)} | {x_end * k / FAR for k in range(1, FAR + 1)}
    )
    before = 0.0
    slope_before = value(0.0)[1]
    for x in grid:
        now, slope = value(x)
        low = None
        if now < 0:
            low = x
        elif slope_before < 0 < slope:  # a least value in between
            a, b = before, x
            for _ in range(60):
                c = (a + b) / 2
                a, b = (c, b) if value(c)[1] < 0 else (a, c)
            if value(b)[0] < 0:
                low = b
        if low is not None:
            return bisected(guard, before, low, bits)
        before, slope_before = x, slope
    return None


def bisected(guard: list[int], low: float, high: float, bits: int) -> int:
    """A zero between these, found by halving at first and then by Newton's method."""
    a, b = (int(mpmath.ldexp(mpmath.mpf(x), bits)) for x in (low, high))
    fa, fb = horner(guard, a, bits)[0], horner(guard, b, bits)[0]
    if fb >= 0:
        return b  # it falls below 0 by less than a double can tell
    if fa < 0:
        return a
    for _ in range(20):
        c = a + b >> 1
        if horner(guard, c, bits)[0] >= 0:
            a = c
        else:
            b = c
    x = b
    for _ in range(200):
        if b - a <= 1:
            break
        f, slope = horner(guard, x, bits)
        a, b = (x, b) if f >= 0 else (a, x)
        step = (f << bits) // slope if slope else 0
        if abs(step) <= 2:
            break
        x = x - step if a < x - step < b else a + b >> 1
    return x
