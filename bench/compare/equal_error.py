"""Best against best at equal achieved error: pendcore's methods and its peers' methods."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from contenders.contender import COMPILED, COMPILED_V3, PYTHON
from work_precision import Point, time_at

DECADES = [10.0**-k for k in range(2, 14)]

Record = dict[str, Any]
Contender = dict[str, Any]


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
BAR, LOOSE = 0.5, 1.5e-5  # at errors above 1e-5 the best peer has the same table of coefficients


def bar(side: Side, error: float) -> float:
    """Return the share of the best peer's time that pendcore should take at most."""
    return side.loose_bar if error > LOOSE else BAR


def on(record: Record, side: str, *, ours: bool) -> list[Contender]:
    return [one for one in record["contenders"] if side in one["sides"] and one["ours"] == ours]


def curve(contender: Contender, kind: str = "minimum_us") -> list[Point]:
    """List (error, microseconds) of every setting that succeeded."""
    return [(p["error"], p[kind]) for p in contender["points"] if "failure" not in p]


def best(
    all_of: Iterable[Contender], error: float, kind: str = "minimum_us"
) -> tuple[float, str] | None:
    """Find the least time at an achieved error, and the contender that takes it."""
    times = [(time_at(curve(one, kind), error), one["label"]) for one in all_of]
    return min(((time, who) for time, who in times if time is not None), default=None)


@dataclass(frozen=True, slots=True, kw_only=True)
class Comparison:
    """Best against best at an achieved error; None if a side does not reach it."""

    error: float
    bar: float
    own: tuple[float, str] | None
    peer: tuple[float, str] | None
    ratio: float | None
    of_medians: float | None

    @property
    def reached(self) -> bool:
        """Whether pendcore stays under the bar, or is alone in reaching the error."""
        if self.own is None:
            return False
        return self.peer is None or (self.ratio is not None and self.ratio <= self.bar)


def compare(record: Record, side: Side, errors: Iterable[float] = DECADES) -> list[Comparison]:
    """Compare best with best at each error; the list is empty if one side did not take part."""
    ours, peers = on(record, side.ours, ours=True), on(record, side.peers, ours=False)
    if not ours or not peers:
        return []
    result = []
    for error in errors:
        own, peer = best(ours, error), best(peers, error)
        medians = [best(each, error, "median_us") for each in (ours, peers)]
        result.append(
            Comparison(
                error=error,
                bar=bar(side, error),
                own=own,
                peer=peer,
                ratio=own[0] / peer[0] if own and peer else None,
                of_medians=medians[0][0] / medians[1][0] if medians[0] and medians[1] else None,
            )
        )
    return result
