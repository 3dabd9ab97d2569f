"""Ends of smooth runs that begin beside one another, for differences in many digits.

Between two bends, where abs() or a limit changes its branch, the laws are analytic. All runs take
the same steps, but a step to a bend ends at that run's own bend: so an end is a smooth function of
what is changed, and so is its error.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from hybrid_chain import midpoint_rules
from numpy.typing import NDArray

from reference.rig import Rig

NEAR = 1e-28
"""A number this small is zero."""
LITTLE = 1e-18
"""The time over which a bend is differentiated, s."""


class Side:
    """One of the runs, at a time, and the signs that the bends of each of its laws have there."""

    def __init__(self, rig: Rig, t: Any, y: NDArray[Any]) -> None:
        self.rig, self.t, self.y = rig, t, y
        self.in_force = rig
        self.take_signs([1 if x > 0 else -1 for x in self.bends(t, y)])

    def take_signs(self, signs: Sequence[int]) -> None:
        self.signs = np.array(signs)
        rest = iter(signs)
        instant = self.rig.instant(self.t, *np.split(self.y, 2))
        of_each = [[next(rest) for _ in law.bends(instant)] for law in self.rig.effects]
        laws = [law.between_bends(one) for law, one in zip(self.rig.effects, of_each, strict=True)]
        self.in_force = replace(self.rig, effects=laws)
        self.last: Any = None

    def rates(self, t: Any, y: Any) -> NDArray[Any]:
        q, qd = np.split(y, 2)
        return np.array([*qd, *self.in_force.accelerations(t, q, qd)])

    def bends(self, t: Any, y: Any) -> NDArray[Any]:
        """Return the numbers whose signs say which law is in force."""
        instant = self.rig.instant(t, *np.split(y, 2))
        return np.array([x for law in self.rig.effects for x in law.bends(instant)])

    def slopes(self, t: Any, y: Any, little: float = LITTLE) -> NDArray[Any]:
        """Return the slopes of the bends in time, over a little time ahead or before."""
        beside = y + little * self.rates(t, y)
        return (self.bends(t + little, beside) - self.bends(t, y)) / little

    def after(self, h: Any) -> NDArray[Any]:
        """Return the state after a step."""
        return self.rules(h)[-1]

    def rules(self, h: Any) -> Any:
        """Return what all rules make of a step, and keep it for the next call."""
        if self.last is None or self.last[0] != h:
            self.last = h, midpoint_rules(self.rates, self.t, self.y, h, stages=8)
        return self.last[1]

    def error(self, h: Any) -> float:
        """Return by how much the rules of order 16 and 14 differ; infinite where numbers end."""
        try:
            *_, before, end = self.rules(h)
        except OverflowError:  # of a double in a sum of sizes
            return np.inf
        return float(np.abs(end - before).max() / max(1, np.abs(end).max()))

    def to_bend(self, k: int, h: Any) -> Any:
        """Return how far away the zero of a bend is, by Newton's rule from h."""
        for _ in range(12):
            y = self.after(h)
            here = self.bends(self.t + h, y)[k]
            if abs(here) < NEAR:
                return h
            h -= here / self.slopes(self.t + h, y)[k]
        raise AssertionError("a bend is not found: it may only be touched")

    def move(self, to: Any) -> None:
        """Go on to a time."""
        self.y, self.t, self.last = self.after(to - self.t), to, None

    def move_to_bend(self, k: int, h: Any) -> None:
        """Go on to the zero of a bend that is about h away, where it changes its sign."""
        self.move(self.t + self.to_bend(k, h))
        self.signs[k] *= -1
        self.take_signs(self.signs)


def ends_beside(
    starts: Sequence[tuple[Rig, NDArray[Any]]],
    span: tuple[Any, Any],
    tolerance: float,
    longest: float,
) -> list[NDArray[Any]]:
    """Return the states at the end of runs of some rig, from some state each.

    A bend that changes its sign twice within a step is seen where it comes nearer at its start, and
    goes away at its end.
    """
    begin, end = span
    sides = [Side(rig, begin, y) for rig, y in starts]
    first = sides[0]
    breaks = {x for law in first.rig.effects for x in law.break_times() if begin < x < end}
    step: Any = longest
    for stop in [*map(first.rig.arithmetic.number, sorted(breaks)), end]:
        while first.t < stop:
            to = min(first.t + step, stop)
            share = (tolerance / max(first.error(to - first.t), tolerance * 1e-6)) ** (1 / 15)
            if not share >= 0.8:
                step = (0.9 * share if share > 0.2 else 0.2) * (to - first.t)
                continue
            to, k = first_bend(first, to)
            h = to - first.t
            for side in sides:
                if k is None:
                    side.move(to)
                else:
                    side.move_to_bend(k, h)
            step = min(min(0.9 * share, 2.0) * step, longest)
    return [side.y for side in sides]


def first_bend(side: Side, to: Any) -> tuple[Any, int | None]:
    """Return the time and the number of the first bend up to a time; that time if there is none."""
    k, before = None, side.bends(side.t, side.y)
    for _ in range(60):
        h = to - side.t
        after = side.bends(to, side.after(h))
        crossed = np.flatnonzero((after * side.signs < 0) & (abs(after) > NEAR))
        if not len(crossed):
            if k is not None or (share_between := _share_between(side, h)) is None:
                return to, k
            to = side.t + h * share_between
            continue
        share = {j: before[j] / (before[j] - after[j]) for j in crossed}
        k = min(share, key=lambda j: share[j])
        if abs(before[k]) < NEAR:  # just passed, and once more within the step
            to, k = side.t + h / 2, None
        else:
            to = side.t + side.to_bend(k, h * share[k])
    raise AssertionError("a step has too many bends")


def _share_between(side: Side, h: Any) -> Any:
    """Return a share of a step at which a bend has the other sign than at both ends, if one has."""
    end = side.after(h)
    before, after = side.bends(side.t, side.y), side.bends(side.t + h, end)
    first, last = side.slopes(side.t, side.y), side.slopes(side.t + h, end, -LITTLE)
    comes_and_goes = (before * after > 0) & (before * first < 0) & (after * last > 0)
    for j in np.flatnonzero(comes_and_goes & (abs(before) > NEAR) & (abs(after) > NEAR)):
        share = first[j] / (first[j] - last[j])
        there = side.bends(side.t + h * share, side.after(h * share))[j]
        if there * side.signs[j] < -NEAR:
            return share
    return None
