"""Chains with dry friction and stops, solved mode by mode in NumPy: nothing of the core is here.

A mode says of each joint whether it is held (0), by friction, a stop or both, or which way it
turns (1, -1). Within a mode the equations are smooth, and Gragg's method, extrapolated to high
order, solves them. A mode ends where the rate of a sliding joint reaches zero, the angle of a free
joint reaches a stop, or the torque that holds a joint reaches the end of its range. Secants within
the step find this time. The next mode is the pattern without contradiction among all patterns
(dense_chain.py). Impacts are plastic.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from dense_chain import Array, DenseChain, joints, rates_after_impact, resting

STAGES = 6  # of the extrapolation: order 12
TOUCHING = 1e-9  # rad; far above rounding, far below any gap that these runs leave


def midpoint_rules(f: Callable[..., Any], t: Any, y: Any, h: Any, stages: int) -> list[Any]:
    """One step of Gragg's modified midpoint rule, extrapolated to the orders 2, 4, ..., 2 stages.

    The numbers are doubles, complex, or of many digits.
    """
    row: list[Any] = []
    for j in range(1, stages + 1):
        substeps, rows = 2 * j, row
        step, before, here = h / substeps, y, y + h / substeps * f(t, y)
        for k in range(1, substeps):
            before, here = here, before + 2 * step * f(t + k * step, here)
        row = [(before + here + step * f(t + h, here)) / 2]
        for k, earlier in enumerate(rows, 1):
            row.append(row[-1] + (row[-1] - earlier) * (j - k) ** 2 / (k * (2 * j - k)))
    return row


def extrapolated_step(
    rates: Callable[[float, Array], Array], t: float, y: Array, h: float
) -> Array:
    return midpoint_rules(rates, t, y, h, STAGES)[-1]


def first_below_zero(margin: Callable[[float], float], h: float) -> float:
    """Return a time up to h by which the margin has become negative, to its last bits.

    This is the Illinois method; no time is tried nearer to a known one than the last bits.
    """
    last_bits = h * 2.0**-46
    low, at_low, high, at_high, before = 0.0, 0.0, h, margin(h), 0
    while high - low > 2 * last_bits:
        s = (low + high) / 2
        if at_low > 0:
            s = (low * at_high - high * at_low) / (at_high - at_low)
            s = min(max(s, low + last_bits), high - last_bits)
        at = margin(s)
        if at < 0:
            high, at_high, at_low = s, at, at_low / 2 if before < 0 else at_low
        else:
            low, at_low, at_high = s, at, at_high / 2 if before > 0 else at_high
        before = -1 if at < 0 else 1
    return high


@dataclass(kw_only=True)
class HybridChain:
    """`friction` is that of each joint, sliding or at rest; `torques(t)` are those of the motors.

    `stops`, if there are any, are the least and the largest angle of each joint, (n, 2).
    """

    chain: DenseChain
    friction: Array
    torques: Callable[[float], Array]
    stops: Array | None = None
    switches: list[tuple[float, Array, tuple[int, ...]]] = field(default_factory=list)

    def gaps(self, y: Array) -> Array:
        """The distance to each stop, (n, 2), rad."""
        if self.stops is None:
            return np.full((self.chain.n, 2), np.inf)
        phi = joints(self.chain.n) @ y[: self.chain.n]
        return np.column_stack([phi - self.stops[:, 0], self.stops[:, 1] - phi])

    def ranges(self, y: Array) -> Array:
        """The range of torques that can hold each joint, (n, 2); a stop pushes without bound."""
        friction = np.column_stack([-self.friction, self.friction])
        touches = self.gaps(y)[:, ::-1] < TOUCHING  # the lower stop pushes upward
        return np.where(touches, [-np.inf, np.inf], friction)

    def solved(self, mode: Array, t: float, y: Array) -> tuple[Array, Array]:
        """Accelerations in a mode, and the holding torque of each joint that is held (else 0)."""
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
        """Return for each joint a margin that is positive as long as the mode lasts."""
        n = self.chain.n
        _, holding = self.solved(mode, t, y)
        least, most = self.ranges(y).T
        rates = np.where(self.friction > 0, mode * (joints(n) @ y[n:]), np.inf)
        free = np.minimum(rates, self.gaps(y).min(axis=1))
        return np.where(mode == 0, np.minimum(holding - least, most - holding), free)

    def after_impact(self, y: Array) -> Array:
        """The rates of the joints after a plastic impact on all stops that are touched."""
        n, d = self.chain.n, joints(self.chain.n)
        joint, upper = np.nonzero(self.gaps(y) < TOUCHING)
        normals = d[joint] * (1 - 2 * upper[:, None])
        m = self.chain.mass_matrix(y[:n])
        qd, _ = rates_after_impact(m, y[n:], normals, np.zeros(len(joint)).tolist())
        phid = d @ qd
        phid[joint[np.abs(phid[joint]) < 1e-12]] = 0.0
        return phid

    def next_mode(self, mode: Array, which: int, t: float, y: Array) -> tuple[Array, Array]:
        """The mode after joint `which` was let go, came to rest or struck, and its first state."""
        n = self.chain.n
        after, y = mode.copy(), y.copy()
        if mode[which] == 0:
            after[which] = -np.sign(self.solved(mode, t, y)[1][which])
            return after, y
        if self.gaps(y)[which].min() < 0:
            phid = self.after_impact(y)
        else:
            phid = joints(n) @ y[n:]
            phid[(mode == 0) | (np.arange(n) == which)] = 0.0
        y[n:] = np.cumsum(phid)
        return self.mode_at(t, y, phid), y

    def mode_at(self, t: float, y: Array, phid: Array) -> Array:
        """The mode that begins at a state whose joints turn at these rates, some of them at 0."""
        n = self.chain.n
        at_rest = {int(j): tuple(self.ranges(y)[j]) for j in np.flatnonzero(phid == 0)}
        mode = np.sign(phid)
        forces = self.chain.forces(y[:n], y[n:], self.torques(t) - mode * self.friction)
        for j, sign in resting(self.chain.mass_matrix(y[:n]), forces, at_rest)[1].items():
            mode[j] = sign
        return mode

    def run(self, q: Array, times: Array, h: float = 0.02) -> Array:
        """The states at these times, from rest at q at time 0; `switches` has what is between."""
        n = self.chain.n
        t, y, states = 0.0, np.append(q, np.zeros(n)), []
        mode = self.mode_at(t, y, np.zeros(n))
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

        def margins(s: float) -> Array:
            return self.margins(mode, t + s, extrapolated_step(rates, t, y, s))

        after = extrapolated_step(rates, t, y, h)
        if (self.margins(mode, t + h, after) >= 0).all():
            return t + h, after, mode
        high = first_below_zero(lambda s: float(margins(s).min()), h)
        which, end = int(np.flatnonzero(margins(high) < 0)[0]), t + high
        mode, after = self.next_mode(mode, which, end, extrapolated_step(rates, t, y, high))
        self.switches.append((end, after, tuple(int(sign) for sign in mode)))
        return end, after, mode
