"""Work against precision: a contender's time at an error that none of its tolerances hits.

A contender's points are (error, time) pairs, one for each tolerance. Its envelope keeps the points
that no other point beats in both; between them, log time is linear in log error.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from itertools import pairwise

Point = tuple[float, float]


def envelope(points: Iterable[Point]) -> list[Point]:
    """Keep the unbeaten points, from the loosest and quickest to the most accurate and slowest."""
    kept: list[Point] = []
    cheapest = math.inf
    for error, time in sorted(points):  # from the most accurate: a looser one must be cheaper
        if time < cheapest:
            kept.append((error, time))
            cheapest = time
    return kept[::-1]


def time_at(points: Iterable[Point], error: float) -> float | None:
    """Find the time that achieves the error.

    For an error above that of the loosest point it is the time of that point, which is accurate
    enough. For an error below that of the most accurate point it is None.
    """
    curve = envelope(points)
    if not curve or error < curve[-1][0]:
        return None
    if error >= curve[0][0]:
        return curve[0][1]
    for (loose, cheap), (tight, dear) in pairwise(curve):
        if error >= tight:
            share = math.log(loose / error) / math.log(loose / tight)
            return cheap * math.pow(dear / cheap, share)
    raise AssertionError("unreachable: the error lies within the curve")


def reached_at(points: Iterable[Point]) -> float | None:
    """Find the smallest error of all; None if there is no point."""
    return min((error for error, _ in points), default=None)
