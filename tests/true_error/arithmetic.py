"""The kinds of numbers that references are computed in; each judges the one before it."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from typing import Any, TypeAlias

import heyoka as hy
import numpy as np
import numpy.typing as npt

Floats: TypeAlias = npt.NDArray[np.float64]
Longs: TypeAlias = npt.NDArray[np.longdouble]
"""What references hand out."""


@dataclass(frozen=True)
class Arithmetic:
    """Numbers of one kind, and how many bits they hold."""

    name: str
    type: Any
    bits: int

    def number(self, exact: Fraction) -> Any:
        """Return the number next to a fraction."""
        return _number(exact, self.type, -(-self.bits // 53))

    @property
    def nothing(self) -> float:
        """An exponent; exp of anything below its negative is nothing beside 1."""
        return 0.7 * self.bits

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


@lru_cache(1 << 16)
def _number(exact: Fraction, of: Any, count: int) -> Any:
    """Return a fraction as the sum of `count` doubles, added from the least one on."""
    parts = []
    for _ in range(count):
        parts.append(float(exact))
        exact -= Fraction(parts[-1])
        if not exact:
            break
    value = of(parts.pop())
    while parts:
        value = value + of(parts.pop())
    return value
