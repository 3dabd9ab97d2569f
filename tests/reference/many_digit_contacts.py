"""Accelerations and impacts of rods at their stops, in many digits, by trying out what acts."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath

from reference.taylor_series import RodChain

mpf = mpmath.mpf


class Stop(NamedTuple):
    """At the angle `at` of `joint` (from 0), above it (`side` = 1) or below it (-1)."""

    joint: int
    at: float
    side: int
    restitution: float
    capture_speed: float


def relative(values: Sequence[Any], stop: Stop) -> Any:
    """Return the joint's angle or rate, of those of the links."""
    j = stop.joint
    return values[j] - values[j - 1] if j else values[j]


class ManyDigitContacts:
    """Rods and all their stops, which are told by their numbers."""

    def __init__(self, chain: RodChain, stops: Sequence[Stop], digits: int) -> None:
        self.stops, self.digits, self.n = stops, digits, len(chain.masses)
        self.gravity = chain.gravity
        self.matrix, self.moments = chain.inertia()

    def mass_matrix(self, q: Sequence[Any]) -> Any:
        return mpmath.matrix([
            [number(x) * mpmath.cos(a - b) for x, b in zip(row, q, strict=True)]
            for row, a in zip(self.matrix, q, strict=True)
        ])  # fmt: skip

    def forces(self, q: Sequence[Any], qd: Sequence[Any]) -> Any:
        spun = [
            sum(number(x) * mpmath.sin(a - b) * w**2 for x, b, w in zip(row, q, qd, strict=True))
            for row, a in zip(self.matrix, q, strict=True)
        ]
        weights = [number(moment) * self.gravity for moment in self.moments]
        turned = zip(weights, q, spun, strict=True)
        return mpmath.matrix([weight * mpmath.cos(a) - s for weight, a, s in turned])

    def opening(self, stops: Sequence[int]) -> list[Any]:
        """Rows J: how fast gaps open is J qd."""
        rows = []
        for s in stops:
            row = mpmath.zeros(1, self.n)
            row[self.stops[s].joint] = -self.stops[s].side
            if self.stops[s].joint:
                row[self.stops[s].joint - 1] = self.stops[s].side
            rows.append(row)
        return rows

    def complementary(
        self, inverse: Any, values: Any, stops: Sequence[int], wanted: Sequence[Any],
        always: Sequence[int] = (),
    ) -> tuple[Any, list[int]]:  # fmt: skip
        """Return x + M^-1 J^T Lam, with 0 <= Lam against J x >= wanted, and which stops act.

        The stops in `always` act in any case, with impulses of any sign.
        """
        rows = dict(zip(stops, self.opening(stops), strict=True))
        want = dict(zip(stops, wanted, strict=True))
        size = max(abs(v) for v in values) + mpf(10) ** (-self.digits)
        best: tuple[Any, Any, Any] = (mpmath.inf, None, None)
        others = [s for s in stops if s not in always]
        for acting in subsets(others):
            chosen = [*always, *acting]
            after = mpmath.matrix(values)
            least = mpf(0)
            if chosen:
                j = mpmath.matrix([list(rows[s]) for s in chosen])
                short = mpmath.matrix([want[s] - (rows[s] * after)[0] for s in chosen])
                impulses = mpmath.lu_solve(j * inverse * j.T, short)
                after = after + inverse * j.T * impulses
                least = min([mpf(0), *(impulses[i] for i in range(len(always), len(chosen)))])
            slack = min([mpf(0), *((rows[s] * after)[0] - want[s] for s in stops)])
            wrong = max(-least, -slack)
            if wrong < best[0]:
                best = (wrong, after, chosen)
        assert best[0] < size * mpf(10) ** (-self.digits // 2)
        return [best[1][i] for i in range(self.n)], best[2]


def number(exact: Fraction) -> Any:
    return mpf(exact.numerator) / exact.denominator


def subsets(items: Sequence[int]) -> Iterator[tuple[int, ...]]:
    for size in range(len(items) + 1):
        yield from itertools.combinations(items, size)
