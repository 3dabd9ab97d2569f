"""Rates of a chain after an impact at its stops, with capture: the law of trust.md in NumPy.

Nothing of the core is here: the contacts that act are found by trial, as in dense_chain.py.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np
from dense_chain import Array, DenseChain, joints, rates_after_one_impact, resting


@dataclass(frozen=True, kw_only=True)
class TouchedStops:
    """Joint j is at its lower (`sides[j]` = -1) or upper (1) stop, or at none (0), at angles q."""

    chain: DenseChain
    q: Array
    sides: Array
    restitution: Array
    capture_speed: Array

    def after_impact(self, qd: Array) -> tuple[Array, set[int]]:
        """The rates after it, and the joints that were captured."""
        m = self.chain.mass_matrix(self.q)
        captured: set[int] = set()
        rounding = 1e-13 * np.abs(qd).max()
        if self.away(qd, rounding).min() >= 0:
            return qd, captured
        qd, bounced = self.after_bounces(m, qd, rounding)
        while slow := self.slow(m, qd, rounding) - bounced - captured:
            captured |= slow
            qd = self.stopped(m, qd, captured)
        return qd, captured

    def away(self, qd: Array, rounding: float) -> Array:
        """How fast joints leave their stops; exactly 0 where that is rounding."""
        rates = -self.sides * (joints(self.chain.n) @ qd)
        return np.where(np.abs(rates) <= rounding, 0.0, rates)

    def after_bounces(self, m: Array, qd: Array, rounding: float) -> tuple[Array, set[int]]:
        normals, touching = -self.sides[:, None] * joints(self.chain.n), self.sides != 0
        bounced = np.zeros(self.chain.n, dtype=bool)
        while (away := self.away(qd, rounding)).min() < 0:
            acting = touching & (away <= 0)
            bounces = (away < 0) & (-away >= self.capture_speed) & (self.restitution > 0)
            e = np.where(bounces, self.restitution, 0.0)
            qd, _ = rates_after_one_impact(m, qd, normals[acting], e[acting])
            bounced[acting] = bounces[acting]
        return qd, {int(j) for j in np.flatnonzero(bounced)}

    def slow(self, m: Array, qd: Array, rounding: float) -> set[int]:
        """The joints that leave slower than their capture speed, and are pushed back."""
        away, no_torque = self.away(qd, rounding), np.zeros(self.chain.n)
        ends = {-1: (0.0, np.inf), 1: (-np.inf, 0.0)}
        at_rest = {
            j: ends[int(self.sides[j])]
            for j in range(self.chain.n)
            if self.sides[j] != 0 and away[j] == 0
        }
        qdd, _ = resting(m, self.chain.forces(self.q, qd, no_torque), at_rest)
        back = self.sides * (joints(self.chain.n) @ qdd)
        slow = (away > 0) & (away < self.capture_speed) & (back > 0)
        return {int(j) for j in np.flatnonzero(slow)}

    def stopped(self, m: Array, qd: Array, captured: set[int]) -> Array:
        """The nearest rates, by the energy of the difference, that leave no stop's range."""
        rows = -self.sides[:, None] * joints(self.chain.n)
        others = [j for j in range(self.chain.n) if self.sides[j] != 0 and j not in captured]
        best: tuple[float, Any] = (np.inf, None)
        for size in range(len(others) + 1):
            for stop in itertools.combinations(others, size):
                kept = rows[[*captured, *stop]]
                mobility = np.linalg.solve(m, kept.T)
                after = qd - mobility @ np.linalg.solve(kept @ mobility, kept @ qd)
                away = rows[others] @ after
                cost = (after - qd) @ m @ (after - qd)
                if away.min(initial=0.0) >= -1e-11 * np.abs(qd).max() and cost < best[0]:
                    best = (cost, after)
        assert best[1] is not None
        return np.asarray(best[1])
