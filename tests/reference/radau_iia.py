"""Radau IIA of order 5, derived from its definition in many digits.

It is the collocation method whose nodes are the zeros of d^2/dx^2 (x^2 (x - 1)^3). With l_j their
Lagrange polynomials, a_ij is the integral of l_j from 0 to c_i (Hairer and Wanner, Solving
Ordinary Differential Equations II, IV.5). The transformation of IV.8 takes A^-1 to a real number
and a rotation with stretching, alpha +- i beta; an eigenvector may have any length: here the last
component of each is 1.
"""

from __future__ import annotations

from functools import cache
from typing import Any

import mpmath  # type: ignore[import-untyped]

DIGITS = 60
Rows = list[list[Any]]


@cache
def coefficients() -> dict[str, Any]:
    """Return the nodes, the matrix, its transformation, and what else a step needs."""
    mp = mpmath.mp.clone()
    mp.dps = DIGITS
    root = mp.sqrt(6)
    c = [(4 - root) / 10, (4 + root) / 10, mp.mpf(1)]

    def integrals(j: int) -> list[Any]:
        """Coefficients of the integral of l_j, from theta^1 to theta^3."""
        p, q = (c[k] for k in range(3) if k != j)
        scale = 1 / ((c[j] - p) * (c[j] - q))
        return [scale * p * q, -scale * (p + q) / 2, scale / 3]

    a = [[sum(k * x**p for p, k in enumerate(integrals(j), 1)) for j in range(3)] for x in c]
    inverse = mp.matrix(a) ** -1
    values, vectors = mp.eig(inverse)
    real = min(range(3), key=lambda k: abs(mp.im(values[k])))
    upper = max(range(3), key=lambda k: mp.im(values[k]))
    one = [mp.re(vectors[i, real] / vectors[2, real]) for i in range(3)]
    other = [vectors[i, upper] / vectors[2, upper] for i in range(3)]
    # A^-1 (u + i v) = (alpha + i beta)(u + i v): in the basis (u, -v), with w_2 + i w_3 as the
    # unknown, A^-1 multiplies by alpha + i beta.
    t = mp.matrix([[one[i], mp.re(other[i]), -mp.im(other[i])] for i in range(3)])
    # The integral of (x - c_1)(x - c_2)(x - c_3), over its slope at 0.
    sums, product = c[0] + c[1] + c[2], c[0] * c[1] * c[2]
    pairs = c[0] * c[1] + (c[0] + c[1]) * c[2]
    correction = [mp.mpf(1), -pairs / (2 * product), sums / (3 * product), -1 / (4 * product)]
    powers = mp.matrix([[x**p for p in (1, 2, 3)] for x in c])
    return {
        "c": c,
        "a": a,
        "real": mp.re(values[real]),
        "alpha": mp.re(values[upper]),
        "beta": mp.im(values[upper]),
        "t": _rows(t),
        "t_inverse": _rows(t**-1),
        "interpolant": _rows(powers**-1),
        "correction": correction,
    }


def _rows(matrix: Any) -> Rows:
    return [[matrix[i, j] for j in range(3)] for i in range(3)]
