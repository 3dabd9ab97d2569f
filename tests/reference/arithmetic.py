"""The numbers that the reference computes with: doubles, or as many digits as a check asks for."""

from __future__ import annotations

import cmath
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import gmpy2
import numpy as np

Number = Any  # a float or a number of gmpy2: whatever the arithmetic at hand makes


@dataclass(frozen=True, slots=True, kw_only=True)
class Arithmetic:
    """Numbers, functions of them, and the solution of a linear system."""

    number: Callable[[float | str], Number]
    sin: Callable[[Number], Number]
    cos: Callable[[Number], Number]
    exp: Callable[[Number], Number]
    solve: Callable[[list[list[Number]], list[Number]], list[Number]]


def _solve_doubles(matrix: list[list[Number]], right: list[Number]) -> list[Number]:
    return list(np.linalg.solve(np.array(matrix), np.array(right)).tolist())


DOUBLE = Arithmetic(number=float, sin=math.sin, cos=math.cos, exp=math.exp, solve=_solve_doubles)


COMPLEX = Arithmetic(
    number=complex, sin=cmath.sin, cos=cmath.cos, exp=cmath.exp, solve=_solve_doubles
)
"""Doubles with an imaginary part: f(x + i e) has e f'(x) for its own, without a difference."""


def eliminate(matrix: list[list[Number]], right: list[Number]) -> list[Number]:
    """Gaussian elimination with row pivoting, which passes over the many zeros."""
    rows = [[*row, side] for row, side in zip(matrix, right, strict=True)]
    n = len(rows)
    for k in range(n):
        pivot = max(range(k, n), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        filled = [j for j in range(k, n + 1) if rows[k][j]]
        for row in rows[k + 1 :]:
            if row[k]:
                share = row[k] / rows[k][k]
                for j in filled:
                    row[j] -= share * rows[k][j]
    unknowns: list[Number] = [0] * n
    for k in reversed(range(n)):
        known = sum(rows[k][j] * unknowns[j] for j in range(k + 1, n) if rows[k][j])
        unknowns[k] = (rows[k][n] - known) / rows[k][k]
    return unknowns


def multiple_precision(digits: int) -> Arithmetic:
    """Arithmetic with at least so many decimal digits; doubles are taken as they stand.

    All that is computed in this thread has as many digits as anything in it has asked for; another
    thread has doubles.
    """
    context = gmpy2.get_context()
    context.precision = max(context.precision, math.ceil(digits * math.log2(10)) + 4)
    return Arithmetic(
        number=gmpy2.mpfr, sin=gmpy2.sin, cos=gmpy2.cos, exp=gmpy2.exp, solve=eliminate
    )
