"""Chains that bounce on the stop of one joint until they lean on it, bounce by bounce in NumPy.

Nothing of the core is here. The angle of that joint is replaced by its gap, so that the smallest
bounce is as exact as the first, however large the angles are. Gragg's method, extrapolated
(hybrid_chain.py), solves the motion between impacts; Newton's method finds an impact as a root of
the gap.

Infinitely many bounces end in a finite time. From the first impact that is slower than `SMALLEST`
on they are summed up. An acceleration a, constant for the rest of them, presses the gap shut, so
that they take 2 e w/(a (1 - e)) after an impact at the speed w. The error is the change of a in
this time, which is of second order in w. To that order the chain meanwhile moves as if it leant on
the stop, because the mean of the impulses holds the joint.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from dense_chain import Array, DenseChain, joints
from hybrid_chain import extrapolated_step, first_below_zero

SMALLEST = 1e-9  # rad/s


class Strike(NamedTuple):
    """When and how fast the gap closed, the energy lost, and the acceleration that presses it shut.

    `to_go` is the time of all bounces after this one, if nothing changed any more.
    """

    t: float
    speed: float
    loss: float
    pressed: float
    to_go: float


@dataclass(kw_only=True)
class BouncingChain:
    """A stop at angle `bound` of `joint` (from 0), above it (`side` = 1) or below it (-1).

    `torques(t)` are those of the motors. `run` notes the strikes, when the last of infinitely many
    is over, and when the chain is let go after that.
    """

    chain: DenseChain
    joint: int
    bound: float
    side: int
    restitution: float
    torques: Callable[[float], Array]
    strikes: list[Strike] = field(default_factory=list)
    held_from: float = np.inf
    held_to: float = np.inf

    def of_links(self, values: Array, bound: float = 0.0) -> Array:
        """Angles, rates or accelerations of the links, from those of joints and gap."""
        of_joints = values.copy()
        of_joints[self.joint] = bound - self.side * values[self.joint]
        return np.cumsum(of_joints)

    def of_gap(self, values: Array, bound: float = 0.0) -> Array:
        """Return the values of joints and gap from the values of the links."""
        of_joints = joints(self.chain.n) @ values
        of_joints[self.joint] = self.side * (bound - of_joints[self.joint])
        return of_joints

    def response(self, y: Array) -> tuple[Array, float]:
        """M^-1 J^T in joints and gap, and J M^-1 J^T; J qd is the rate of the gap."""
        m = self.chain.mass_matrix(self.of_links(y[: self.chain.n], self.bound))
        opening = -self.side * joints(self.chain.n)[self.joint]
        found = self.of_gap(np.linalg.solve(m, opening))
        return found, float(found[self.joint])

    def accelerations(self, t: float, y: Array) -> Array:
        """Return the accelerations of joints and gap, as if there was no stop."""
        n = self.chain.n
        q, qd = self.of_links(y[:n], self.bound), self.of_links(y[n:])
        forces = self.chain.forces(q, qd, self.torques(t))
        return self.of_gap(np.linalg.solve(self.chain.mass_matrix(q), forces))

    def pressed(self, t: float, y: Array) -> float:
        return -float(self.accelerations(t, y)[self.joint])

    def step(self, held: bool, t: float, y: Array, h: float) -> Array:
        def rates(t: float, y: Array) -> Array:
            accelerations = self.accelerations(t, y)
            if held:
                response, mobility = self.response(y)
                accelerations -= accelerations[self.joint] / mobility * response
                accelerations[self.joint] = 0.0
            return np.append(y[self.chain.n :], accelerations)

        return extrapolated_step(rates, t, y, h)

    def run(self, q: Array, times: Array, h: float = 0.01) -> Array:
        """The states (q, qd) at these times, from rest at q at time 0."""
        n = self.chain.n
        t, y, held = 0.0, np.append(self.of_gap(q, self.bound), np.zeros(n)), False
        states = []
        for time in times:
            while t < time:
                t, y, held = (self.leant if held else self.flown)(t, y, min(h, time - t))
            states.append(np.append(self.of_links(y[:n], self.bound), self.of_links(y[n:])))
        return np.array(states)

    def leant(self, t: float, y: Array, h: float) -> tuple[float, Array, bool]:
        """A step in contact, or the part of it up to where the stop would have to pull."""
        after = self.step(True, t, y, h)
        if self.pressed(t + h, after) >= 0:
            return t + h, after, True
        end = first_below_zero(lambda s: self.pressed(t + s, self.step(True, t, y, s)), h)
        self.held_to = float(t + end)
        return t + end, self.step(True, t, y, end), False

    def flown(self, t: float, y: Array, h: float) -> tuple[float, Array, bool]:
        """A step without contact, or the part of it up to an impact, and the impact."""
        n, j = self.chain.n, self.joint
        if y[j] == 0 < y[n + j]:  # no step is much longer than the bounce
            h = min(h, 3 * y[n + j] / self.pressed(t, y))
        after = self.step(False, t, y, h)
        if after[j] >= 0:
            return t + h, after, False
        s, change = h, -np.inf
        while change < -1e-15 * s:  # from the right, where the gap falls ever faster
            at = self.step(False, t, y, s)
            change = min(0.0, -at[j] / at[n + j])
            s += change
        return self.struck(t + s, self.step(False, t, y, s))

    def struck(self, t: float, y: Array) -> tuple[float, Array, bool]:
        """v+ = v- + M^-1 J^T Lam with Lam = -(1 + e) J v- / (J M^-1 J^T)."""
        n, j = self.chain.n, self.joint
        speed, (response, mobility) = -y[n + j], self.response(y)
        is_last = speed < SMALLEST
        e = 0.0 if is_last else self.restitution
        y[j] = 0.0
        y[n:] += (1 + e) * speed / mobility * response
        y[n + j] = e * speed
        pressed = self.pressed(t, y)
        to_go = 2 * self.restitution * speed / (pressed * (1 - self.restitution))
        loss = (1 - e**2) * speed**2 / (2 * mobility)
        self.strikes.append(Strike(float(t), float(speed), float(loss), pressed, float(to_go)))
        if is_last:
            self.held_from = float(t + to_go)
        return t, y, is_last
