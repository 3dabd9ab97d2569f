"""Curves over time, with their first two derivatives: sinusoids and natural cubic splines."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import lru_cache
from itertools import pairwise

import gmpy2

from reference.arithmetic import Arithmetic, Number


def sinusoid(
    t: Number, described: Mapping[str, float], arithmetic: Arithmetic
) -> tuple[Number, Number, Number]:
    """Return amplitude sin(angular_frequency t + phase), its rate and its acceleration."""
    number = arithmetic.number
    amplitude, w = number(described["amplitude"]), number(described["angular_frequency"])
    argument = w * number(t) + number(described.get("phase", 0.0))
    sine, cosine = arithmetic.sin(argument), arithmetic.cos(argument)
    return amplitude * sine, amplitude * w * cosine, -amplitude * w * w * sine


def second_derivatives(
    knots: Sequence[Number],
    values: Sequence[Number],
    solve: Callable[[list[list[Number]], list[Number]], list[Number]],
) -> list[Number]:
    """Return c_i, the second derivatives of the natural spline at all knots; 0 at the ends.

    They follow from the continuity of the first derivative, with h_i = t_(i+1) - t_i:

        h_(i-1) c_(i-1) + 2 (h_(i-1) + h_i) c_i + h_i c_(i+1)
            = 6 ((x_(i+1) - x_i)/h_i - (x_i - x_(i-1))/h_(i-1))
    """
    zero, inner = 0 * knots[0], range(1, len(knots) - 1)
    h = [after - before for before, after in pairwise(knots)]
    slopes = [(b - a) / d for (a, b), d in zip(pairwise(values), h, strict=True)]
    matrix = [[zero] * len(knots) for _ in knots]
    right = [zero] * len(knots)
    for end in (0, -1):
        matrix[end][end] = zero + 1
    for i in inner:
        matrix[i][i - 1], matrix[i][i], matrix[i][i + 1] = h[i - 1], 2 * (h[i - 1] + h[i]), h[i]
        right[i] = 6 * (slopes[i] - slopes[i - 1])
    return solve(matrix, right)


@lru_cache(maxsize=64)
def _curvatures(
    knots: tuple[Number, ...], values: tuple[Number, ...], arithmetic: Arithmetic, bits: int
) -> list[Number]:
    return second_derivatives(knots, values, arithmetic.solve)


def natural_spline(
    t: Number, knots: Sequence[float], values: Sequence[float], arithmetic: Arithmetic
) -> tuple[Number, Number, Number]:
    """Return value, rate and acceleration at a time between the first knot and the last."""
    number = arithmetic.number
    t, knots, values = number(t), (*map(number, knots),), (*map(number, values),)
    curvatures = _curvatures(knots, values, arithmetic, gmpy2.get_context().precision)
    i = max(k for k in range(len(knots) - 1) if knots[k] <= t or k == 0)
    h, before, after = knots[i + 1] - knots[i], t - knots[i], knots[i + 1] - t
    c0, c1 = curvatures[i], curvatures[i + 1]
    from_left, from_right = values[i] / h - c0 * h / 6, values[i + 1] / h - c1 * h / 6
    return (
        (c0 * after**3 + c1 * before**3) / (6 * h) + from_left * after + from_right * before,
        (c1 * before**2 - c0 * after**2) / (2 * h) - from_left + from_right,
        (c0 * after + c1 * before) / h,
    )
