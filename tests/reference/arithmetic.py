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
    """Gaussian elimination with row pivoting, which passes over the many zeros.

    It begins with the last unknown: those of a chain that stand there are forces in the joints,
    which few of its rows have.
    """
    rows = [[*row, side] for row, side in zip(matrix, right, strict=True)]
    n = len(rows)
    for k in reversed(range(n)):
        pivot = max((i for i in range(k + 1) if rows[i][k]), key=lambda i: abs(rows[i][k]))
        rows[k], rows[pivot] = rows[pivot], rows[k]
        filled = [j for j in (*range(k), n) if rows[k][j]]
        for row in rows[:k]:
            if row[k]:
                share = row[k] / rows[k][k]
                for j in filled:
                    row[j] -= share * rows[k][j]
    unknowns: list[Number] = []
    for row, k in zip(rows, range(n), strict=True):
        known = sum(a * x for a, x in zip(row, unknowns, strict=False) if a)
        unknowns.append((row[n] - known) / row[k])
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
