"""Fifty chaotic motions in many digits, and how the distance of a neighbour grows.

`python tests/models/chaotic_starts.py` computes anew what tests/data/chaotic_starts.json holds,
from its starts, with the Taylor series of reference/taylor_series.py; it takes half an hour.
tests/data/README.md says what a case holds, and how the starts were drawn.
"""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from fractions import Fraction
from functools import cache
from pathlib import Path

import mpmath
import numpy as np
import pendcore as pc
from numpy.typing import NDArray
from reference.taylor_series import RodChain, motion
from tqdm import tqdm

DATA = Path(__file__).parents[1] / "data/chaotic_starts.json"

T_END = 14
EACH = 20
"""Times per second."""
DECIMALS = 9
"""The digits of the angles that count, because tests ask when an error passes a tenth."""
DIGITS = 46
DISPLACED = Fraction(1, 10**24)
"""The difference of the neighbour's first angle, rad."""


@dataclass(frozen=True, slots=True, kw_only=True)
class ChaoticStart:
    """A chain of uniform rods, where it begins, and what becomes of it."""

    masses: list[float]
    lengths: list[float]
    q0: list[float]
    qd0: list[float]
    q: list[list[float]]
    """Angles every 1/EACH s from 0 on, rad."""
    growth: list[float]
    """ln(distance / first distance) of the neighbour, every half second from 0.5 s on."""

    @property
    def scene(self) -> pc.Scene:
        return scene_of(self.masses, self.lengths)

    def last_right(self, sol: pc.Solution, limit: float) -> float:
        """Return the last time of the record until which no angle is off by more than the limit."""
        t, q = times(), np.array(self.q)
        reached = t <= sol.t[-1]
        off = np.abs(sol(t[reached])[: q.shape[1]].T - q[reached]).max(axis=1) > limit
        return float(t[max(0, int(off.argmax()) - 1)] if off.any() else t[reached][-1])


GRAVITY = 9.807


def scene_of(masses: list[float], lengths: list[float]) -> pc.Scene:
    links = [pc.Link(mass=m, length=length) for m, length in zip(masses, lengths, strict=True)]
    return pc.Scene(links=links, gravity=GRAVITY)


def times() -> NDArray[np.float64]:
    """Return the times of the angles, s."""
    return np.arange(T_END * EACH + 1) / EACH


@cache
def chaotic_starts() -> list[ChaoticStart]:
    """Read them."""
    return [ChaoticStart(**case) for case in json.loads(DATA.read_text(encoding="utf-8"))]


def computed(
    masses: list[float], lengths: list[float], q0: list[float], qd0: list[float], digits: int
) -> ChaoticStart:
    """Compute a case."""
    chain = RodChain(masses, lengths, GRAVITY)
    grid = [Fraction(k, EACH) for k in range(T_END * EACH + 1)]
    here = motion(chain, q0, qd0, grid, digits)
    halves = grid[:: EACH // 2]
    there = motion(chain, [Fraction(q0[0]) + DISPLACED, *q0[1:]], qd0, halves, digits)
    growth = []
    for one, other in zip(here[:: EACH // 2][1:], there[1:], strict=True):
        squares = sum(((a - b) / DISPLACED) ** 2 for a, b in zip(one, other, strict=True))
        square = mpmath.mpf(squares.numerator) / squares.denominator
        growth.append(round(float(mpmath.log(square)) / 2, 12))
    q = [[round(float(x), DECIMALS) for x in row[: len(masses)]] for row in here]
    return ChaoticStart(masses=masses, lengths=lengths, q0=q0, qd0=qd0, q=q, growth=growth)


def record() -> None:
    """Compute all anew, from the starts that stand in the file."""
    cases = [
        computed(case.masses, case.lengths, case.q0, case.qd0, DIGITS)
        for case in tqdm(chaotic_starts())
    ]
    rows = ",\n".join(json.dumps(asdict(case)) for case in cases)
    DATA.write_text(f"[\n{rows}\n]\n", encoding="utf-8")


if __name__ == "__main__":
    record()
