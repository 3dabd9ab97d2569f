"""The choices that make a random case come from a seed or from hypothesis.

`fuzz.drawn_scene` and `fuzz.drawn_run` draw the cases and know of neither source. The campaign runs
a hundred thousand cases from seeds; hypothesis makes a case small on which a property fails.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from typing import Any, Protocol, TypeVar

from hypothesis import strategies as st

Thing = TypeVar("Thing")


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
