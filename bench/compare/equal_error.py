"""Best against best at equal achieved error: the time at an error that no tolerance hits.

A contender's points are (error, time) pairs, one for each setting. Its envelope keeps the points
that no other point beats in both; between them, log time is linear in log error.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

from contenders.contender import COMPILED, COMPILED_V3, PYTHON

DECADES = [10.0**-k for k in range(2, 14)]

Pair = tuple[float, float]
Contender = dict[str, Any]
Entrants = list[Contender]
"""The contenders that take part in a case; `Record.taking_part` lists them."""


def envelope(points: Iterable[Pair]) -> list[Pair]:
    """Keep the unbeaten points, from the loosest and quickest to the most accurate and slowest."""
    kept: list[Pair] = []
    cheapest = math.inf
    for error, time in sorted(points):  # from the most accurate: a looser one must be cheaper
        if time < cheapest:
            kept.append((error, time))
            cheapest = time
    return kept[::-1]


def time_at(points: Iterable[Pair], error: float) -> float | None:
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


def curve(contender: Contender, kind: str = "minimum_us") -> list[Pair]:
    """List (error, a kind of cost) of every setting that succeeded and has it."""
    return [(p["error"], p[kind]) for p in contender["points"] if "error" in p and kind in p]


@dataclass(frozen=True, slots=True, kw_only=True)
class Side:
    """The two that are compared: our side, and the side of the peers, which may be another."""

    title: str
    ours: str
    peers: str
    loose_bar: float


SIDES = (
    Side(title="in C++", ours=COMPILED, peers=COMPILED, loose_bar=0.6),
    Side(
        title="in C++, pendcore held back to x86-64-v3",
        ours=COMPILED_V3,
        peers=COMPILED,
        loose_bar=0.6,
    ),
    Side(title="called from Python", ours=PYTHON, peers=PYTHON, loose_bar=0.5),
)
OUTER_SIDES = (SIDES[0], SIDES[2])
BAR, LOOSE = 0.5, 1.5e-5  # at errors above 1e-5 the best peer has the same table of coefficients


def bar(side: Side, error: float) -> float:
    """Return the share of the best peer's time that pendcore should take at most."""
    return side.loose_bar if error > LOOSE else BAR


def on(entrants: Entrants, side: str, *, ours: bool) -> Entrants:
    return [one for one in entrants if side in one["sides"] and one["ours"] == ours]


def best(who: Entrants, error: float, kind: str = "minimum_us") -> tuple[float, str] | None:
    """Find the least time at an achieved error, and the contender that takes it."""
    times = [(time_at(curve(one, kind), error), one["label"]) for one in who]
    return min(((time, label) for time, label in times if time is not None), default=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Best against best at an achieved error; None if a side does not reach it."""

    error: float
    bar: float
    own: tuple[float, str] | None
    peer: tuple[float, str] | None
    of_medians: float | None

    @property
    def ratio(self) -> float | None:
        return self.own[0] / self.peer[0] if self.own and self.peer else None

    @property
    def reached(self) -> bool:
        """Whether pendcore stays under the bar, or is alone in reaching the error."""
        if self.own is None:
            return False
        return self.ratio is None or self.ratio <= self.bar

    @property
    def lost(self) -> bool:
        """Whether a peer is quicker, or alone in reaching the error."""
        return self.peer is not None and (self.ratio is None or self.ratio > 1)


def compare(entrants: Entrants, side: Side, errors: Iterable[float] = DECADES) -> list[Comparison]:
    """Compare best with best at each error; the list is empty if one side did not take part."""
    ours, peers = on(entrants, side.ours, ours=True), on(entrants, side.peers, ours=False)
    if not ours or not peers:
        return []
    found = []
    for error in errors:
        medians = [best(each, error, "median_us") for each in (ours, peers)]
        found.append(
            Comparison(
                error=error,
                bar=bar(side, error),
                own=best(ours, error),
                peer=best(peers, error),
                of_medians=medians[0][0] / medians[1][0] if medians[0] and medians[1] else None,
            )
        )
    return found
