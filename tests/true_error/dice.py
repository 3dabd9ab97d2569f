"""What families draw with: the same numbers for the same family and seed."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeVar
from zlib import crc32

import numpy as np

from true_error.arrays import Floats

T = TypeVar("T")


class Dice:
    """Random numbers of a family's seed."""

    def __init__(self, family: str, seed: int) -> None:
        self.rng = np.random.default_rng([crc32(family.encode()), seed])

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def uniform(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def decades(self, low: float, high: float) -> float:
        """Return 10 to a power between two."""
        return float(10 ** self.rng.uniform(low, high))

    def whole(self, low: int, high: int) -> int:
        """Return a number from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def one_of(self, values: Sequence[T]) -> T:
        return values[self.whole(0, len(values) - 1)]

    def spread(self, count: int, width: float) -> Floats:
        """Return `count` numbers between -width and width."""
        return self.rng.uniform(-width, width, count)
