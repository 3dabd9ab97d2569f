"""The choices that make a random case come from a seed or from hypothesis; numbers made of them.

`fuzz.drawn_scene` and `fuzz.drawn_run` draw the cases and know of neither source. The campaign runs
a hundred thousand cases from seeds; hypothesis makes a case small on which a property fails.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from math import pi
from typing import Any, Protocol, TypeVar

from hypothesis import strategies as st

Thing = TypeVar("Thing")
REGIMES = ("ordinary", "extreme", "any")
SPECIAL = (5e-324, 2.2250738585072014e-308, 1e-160, 1e-20, 1e20, 1e150, 1e154, 1e200, 1e300)
ROUND = (0.0, 1.0, 0.5, 2.0, 0.1, 3.0, 10.0)
ANGLES = (0.0, pi / 2, -pi / 2, pi, pi / 4, 2 * pi, 1e-9, 3.0, -1.0)


class Choices(Protocol):
    """What a case is made of."""

    def real(self, low: float, high: float) -> float:
        """Return a number of an interval."""

    def integer(self, low: int, high: int) -> int:
        """Return a whole number, both ends included."""

    def one_of(self, things: Sequence[Thing]) -> Thing:
        """Return one of some things; hypothesis prefers the first."""


class FromSeed:
    """The same choices for the same seed, on every machine."""

    def __init__(self, seed: str) -> None:
        self._random = random.Random(seed)

    def real(self, low: float, high: float) -> float:
        return low + (high - low) * self._random.random()

    def integer(self, low: int, high: int) -> int:
        return low + int((high - low + 1) * self._random.random())

    def one_of(self, things: Sequence[Thing]) -> Thing:
        return things[self.integer(0, len(things) - 1)]


class FromHypothesis:
    """Choices that hypothesis makes, and makes small."""

    def __init__(self, draw: Any) -> None:
        self._draw = draw

    def real(self, low: float, high: float) -> float:
        return float(self._draw(st.floats(low, high)))

    def integer(self, low: int, high: int) -> int:
        return int(self._draw(st.integers(low, high)))

    def one_of(self, things: Sequence[Thing]) -> Thing:
        found: Thing = self._draw(st.sampled_from(things))
        return found


def happens(choices: Choices, percent: int) -> bool:
    """Whether something happens that does so in `percent` of all cases."""
    return choices.integer(0, 99) >= 100 - percent


# Numbers as scenes have them: ordinary ones, extreme ones, and any that a double can be -----------


def regime(choices: Choices) -> str:
    """How far from ordinary the numbers of a case are."""
    return choices.one_of(("ordinary",) * 6 + ("extreme",) * 3 + ("any",))


def size(choices: Choices, regime: str) -> float:
    """Return a positive number, around 1 if ordinary."""
    if happens(choices, 3):
        regime = choices.one_of(REGIMES)
    if regime == "ordinary":
        if happens(choices, 25):
            return choices.one_of(ROUND[1:])
        return float(10 ** choices.real(-1, 1))
    if regime == "extreme":
        return float(10 ** choices.real(-12, 12))
    if happens(choices, 30):
        return choices.one_of(SPECIAL)
    return float(10 ** choices.real(-320, 308))


def non_negative(choices: Choices, regime: str) -> float:
    """Return a size, or zero."""
    return 0.0 if happens(choices, 10) else size(choices, regime)


def signed(choices: Choices, regime: str) -> float:
    """Return any number."""
    return choices.one_of((1.0, -1.0)) * non_negative(choices, regime)


def angle(choices: Choices, regime: str) -> float:
    """Return an angle, rad: of a turn or two if ordinary, round ones among them."""
    if regime == "ordinary" and not happens(choices, 2):
        return choices.one_of(ANGLES) if happens(choices, 25) else choices.real(-4, 4)
    return signed(choices, regime)
