"""Chains with dry friction, solved mode by mode in NumPy: nothing is shared with the core.

A mode says of each joint whether it sticks (0) or which way it slides (1, -1). Within a mode the
equations are smooth: Gragg's method, extrapolated to high order. A mode ends where the rate of a
sliding joint, or what a sticking one has left to hold with, reaches zero, found by bisecting the
step; the next one is free of contradiction among all patterns (dense_chain.py).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from dense_chain import Array, DenseChain, held, joints

STAGES = 6  # of the extrapolation: order 12


def extrapolated_step(
    rates: Callable[[float, Array], Array], t: float, y: Array, h: float
) -> Array:
    """Gragg's modified midpoint rule with 2, 4, ..., 12 substeps, extrapolated in their square."""
    table: list[Array] = []
    for k in range(STAGES):
        n = 2 * (k + 1)
        s = h / n
        before, now = y, y + s * rates(t, y)
        for i in range(1, n):
            before, now = now, before + 2 * s * rates(t + i * s, now)
        row = [(now + before + s * rates(t + h, now)) / 2]
        for j in range(1, k + 1):
            ratio = (n / (2 * (k - j + 1))) ** 2
            row.append(row[j - 1] + (row[j - 1] - table[j - 1]) / (ratio - 1))
        table = row
    return table[-1]


@dataclass(kw_only=True)
class HybridChain:
    """`friction` of each joint, in sliding and at rest; `torques(t)` of the motors."""

    chain: DenseChain
    friction: Array
    torques: Callable[[float], Array]
    switches: list[tuple[float, Array, tuple[int, ...]]] = field(default_factory=list)

    def solved(self, mode: Array, t: float, y: Array) -> tuple[Array, Array]:
        """Accelerations in a mode, and the holding torque of each joint that sticks (else 0)."""
        n, d = self.chain.n, joints(self.chain.n)
        q, qd = y[:n], y[n:]
        forces = self.chain.forces(q, qd, self.torques(t) - mode * self.friction)
        stuck = np.flatnonzero(mode == 0)
        rows = d[stuck]
        saddle = np.block(
            [[self.chain.mass_matrix(q), -rows.T], [rows, np.zeros((stuck.size,) * 2)]]
        )
        found = np.linalg.solve(saddle, np.append(forces, np.zeros(stuck.size)))
        holding = np.zeros(n)
        holding[stuck] = found[n:]
        return found[:n], holding

    def margins(self, mode: Array, t: float, y: Array) -> Array:
        """What is positive as long as the mode lasts, for each joint."""
        n = self.chain.n
        _, holding = self.solved(mode, t, y)
        rates = mode * (joints(n) @ y[n:])
        return np.where(mode == 0, self.friction - np.abs(holding), rates)

    def next_mode(self, mode: Array, which: int, t: float, y: Array) -> tuple[Array, Array]:
        """The mode after joint `which` has let go or come to rest, and the state it begins in."""
        n, d = self.chain.n, joints(self.chain.n)
        after, y = mode.copy(), y.copy()
        if mode[which] == 0:
            after[which] = -np.sign(self.solved(mode, t, y)[1][which])
            return after, y
        phid = d @ y[n:]
        phid[(mode == 0) | (np.arange(n) == which)] = 0.0
        y[n:] = np.cumsum(phid)
        resting = {int(j): float(self.friction[j]) for j in np.flatnonzero(phid == 0)}
        sliding = np.where(phid == 0, 0, mode) * self.friction
        forces = self.chain.forces(y[:n], y[n:], self.torques(t) - sliding)
        for j, sign in held(self.chain.mass_matrix(y[:n]), forces, resting)[1].items():
            after[j] = sign
        return after, y

    def run(self, q: Array, times: Array, h: float = 0.02) -> Array:
        """The states at these times, from rest at q at time 0; `switches` has what is between."""
        n = self.chain.n
        t, y, states = 0.0, np.append(q, np.zeros(n)), []
        resting = {j: float(self.friction[j]) for j in range(n)}
        forces = self.chain.forces(q, np.zeros(n), self.torques(0.0))
        signs = held(self.chain.mass_matrix(q), forces, resting)[1]
        mode = np.array([signs[j] for j in range(n)])
        for time in times:
            while t < time:
                t, y, mode = self.advance(mode, t, y, min(h, time - t))
            states.append(y)
        return np.array(states)

    def advance(self, mode: Array, t: float, y: Array, h: float) -> tuple[float, Array, Array]:
        """A step, or the part of it up to where the mode ends, and the mode after it."""
        n = self.chain.n

        def rates(t: float, y: Array) -> Array:
            return np.append(y[n:], self.solved(mode, t, y)[0])

        def broken(s: float) -> Array:
            return np.flatnonzero(self.margins(mode, t + s, extrapolated_step(rates, t, y, s)) < 0)

        after = extrapolated_step(rates, t, y, h)
        if (self.margins(mode, t + h, after) >= 0).all():
            return t + h, after, mode
        low, high = 0.0, h
        for _ in range(46):
            middle = (low + high) / 2
            low, high = (low, middle) if broken(middle).size else (middle, high)
        which, end = int(broken(high)[0]), t + high
        mode, after = self.next_mode(mode, which, end, extrapolated_step(rates, t, y, high))
        self.switches.append((end, after, tuple(int(sign) for sign in mode)))
        return end, after, mode
