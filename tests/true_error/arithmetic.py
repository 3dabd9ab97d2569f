"""The kinds of numbers that references are computed in, each for judging the one before."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import heyoka as hy
import numpy as np
import numpy.typing as npt

from true_error.arrays import Longs


@dataclass(frozen=True)
class Arithmetic:
    """Numbers of one kind, and how many bits they hold."""

    name: str
    type: Any
    bits: int

    def number(self, exact: Fraction) -> Any:
        """Return the number next to a fraction: the sum of the doubles that make it up."""
        value = self.type(0.0)
        for part in reversed(_doubles(exact, -(-self.bits // 53))):
            value = value + self.type(part)
        return value

    def array(self, doubles: npt.ArrayLike) -> npt.NDArray[Any]:
        return np.asarray(doubles, dtype=np.float64).astype(self.type)


DOUBLE = Arithmetic("double", float, 53)
LONG = Arithmetic("long double", np.longdouble, 64)
QUAD = Arithmetic("quadruple", hy.real128, 113)
LADDER = (DOUBLE, LONG, QUAD)


def as_longs(values: npt.NDArray[Any]) -> Longs:
    """Return numbers of any kind as long doubles."""
    if values.dtype != np.dtype(hy.real128):
        return values.astype(np.longdouble)
    high = values.astype(np.float64)
    low = (values - high.astype(hy.real128)).astype(np.float64)
    return high.astype(np.longdouble) + low.astype(np.longdouble)


def _doubles(exact: Fraction, count: int) -> list[float]:
    parts = []
    for _ in range(count):
        parts.append(float(exact))
        exact -= Fraction(parts[-1])
    return parts
