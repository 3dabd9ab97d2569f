"""Numbers a + b sqrt(6) with fractions a and b, for tables that need them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

ROOT = 6


@dataclass(frozen=True, slots=True, eq=False)
class Quadratic:
    """``rational`` + ``root`` sqrt(6)."""

    rational: Fraction
    root: Fraction

    def __add__(self, other: Number) -> Quadratic:
        more = of(other)
        return Quadratic(self.rational + more.rational, self.root + more.root)

    __radd__ = __add__

    def __neg__(self) -> Quadratic:
        return Quadratic(-self.rational, -self.root)

    def __sub__(self, other: Number) -> Quadratic:
        return self + -of(other)

    def __rsub__(self, other: Number) -> Quadratic:
        return of(other) - self

    def __mul__(self, other: Number) -> Quadratic:
        by = of(other)
        return Quadratic(
            self.rational * by.rational + ROOT * self.root * by.root,
            self.rational * by.root + self.root * by.rational,
        )

    __rmul__ = __mul__

    def __bool__(self) -> bool:
        return bool(self.rational or self.root)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Quadratic | Fraction | int) and not self - other

    def __hash__(self) -> int:
        return hash((self.rational, self.root)) if self.root else hash(self.rational)


Number = Quadratic | Fraction | int


def of(number: Number) -> Quadratic:
    """Return the same as a number of the field."""
    return number if isinstance(number, Quadratic) else Quadratic(Fraction(number), Fraction(0))
