"""The numbers that the reference computes with: doubles, or as many digits as a check asks for."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np

Number = Any  # a float or a number of mpmath: whatever the arithmetic at hand makes


@dataclass(frozen=True, slots=True, kw_only=True)
class Arithmetic:
    """Numbers, their sine and cosine, and the solution of a linear system of them."""

    number: Callable[[float | str], Number]
    sin: Callable[[Number], Number]
    cos: Callable[[Number], Number]
    solve: Callable[[list[list[Number]], list[Number]], list[Number]]


def _solve_doubles(matrix: list[list[Number]], right: list[Number]) -> list[Number]:
    return list(np.linalg.solve(np.array(matrix), np.array(right)).tolist())


DOUBLE = Arithmetic(number=float, sin=math.sin, cos=math.cos, solve=_solve_doubles)


def multiple_precision(digits: int) -> Arithmetic:
    """Arithmetic with the given number of decimal digits; doubles are taken as they stand."""
    context = mpmath.mp.clone()
    context.dps = digits

    def solve(matrix: list[list[Number]], right: list[Number]) -> list[Number]:
        return list(context.lu_solve(context.matrix(matrix), context.matrix(right)))

    return Arithmetic(number=context.mpf, sin=context.sin, cos=context.cos, solve=solve)
