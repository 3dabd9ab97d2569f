"""How far rounding moves a step of an explicit Runge-Kutta method, from its table.

Weights of both signs, far larger than one, cancel in the sum that they make; each of them and each
partial sum is rounded, by at most u = 2^-53 of its size.
"""

from __future__ import annotations

from itertools import accumulate
from math import hypot, sqrt, ulp
from typing import Any

from pendcore import _core

U = 2.0**-53


def _value(number: Any) -> float:
    numerator, denominator, root = number
    return float((numerator + root * sqrt(6)) / denominator)


def _sizes(row: Any) -> list[float]:
    """Return the sizes of the weights and of their partial sums."""
    weights = [_value(number) for number in row]
    return [*map(abs, weights), *map(abs, accumulate(weights))]


def of_new_state(method: str) -> float:
    """Return the most that rounding moves y_new, in units of h times the largest stage.

    In a Taylor series the first terms are by far the largest, and are rounded twice.
    """
    if method == "taylor":
        return 2 * U
    return U * sum(_sizes(_core.tableau(method)["b"]))


def of_late_times(method: str, t: float) -> float:
    """Return the most that rounded times move a law as late as t: s, in the mean of a step.

    A stage sees its own time rounded, and the beginning of its step too, each by at most half a bit
    of t. The method weights the first; the second is the same in all stages. Before time 0 the core
    computes a line from its value at 0, by a product and a sum of the size of slope times t.
    """
    weights = sum(abs(_value(number)) for number in _core.tableau(method)["b"])
    half_a_bit = ulp(t) / 2
    return (weights + 1) * half_a_bit + (2 * U * -t if t < 0 else 0.0)


def of_dense_output(method: str) -> float:
    """Return the same for y(t + theta h) at the worst theta, for independent roundings."""
    table = _core.tableau(method)
    of_functions = [hypot(*_sizes(row)) for row in table["functions"]]
    basis = [[_value(number) for number in row] for row in table["basis"]]

    def at(theta: float) -> float:
        return hypot(
            *(
                size * sum(x * theta ** (p + 1) for p, x in enumerate(row))
                for size, row in zip(of_functions, basis, strict=True)
            )
        )

    return U * max(at(k / 32) for k in range(33))
