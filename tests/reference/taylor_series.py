"""Motions of planar chains of uniform rods by Taylor series in many digits.

With u_i = (cos q_i, sin q_i) along each link and n_i = (-sin q_i, cos q_i) across it, the equations
of motion are

    n_i . sum_j A_ij u_j'' = a_i g cos q_i + Q_i,      Q_i = tau_i - tau_(i+1)

as u_j'' = n_j q_j'' - u_j q_j'^2. Taylor coefficients of q follow one after the other: those of
cosine and sine from  (cos q)' = -q' sin q,  (sin q)' = q' cos q,  so that the unknown coefficient
of q enters each order linearly, with the mass matrix at the start of the step.

All numbers are integers, in units of 2^-bits: a sum of products is exact and is rounded once.
Coefficients are those of q(t_0 + s x) in x, with s a power of two near the step, so that none is
large or lost. The step is where the last four coefficients, not the last two (symmetry makes every
other one vanish), come down to the unit.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from operator import mul
from typing import NamedTuple

import mpmath

SPARE = 24
"""Bits below which a coefficient counts for nothing: what rounding may cost on the way."""


class RodChain(NamedTuple):
    """Uniform rods; every number is the very double that is written."""

    masses: Sequence[float]
    lengths: Sequence[float]
    gravity: float
    damping: Sequence[float] = ()
    """The damping of each joint, N m s/rad; none if it is empty."""

    def inertia(self) -> tuple[list[list[Fraction]], list[Fraction]]:
        """Return A_ij and a_i, exactly."""
        m, length = [Fraction(x) for x in self.masses], [Fraction(x) for x in self.lengths]
        n = len(m)
        beyond = [sum(m[i + 1 :], Fraction(0)) for i in range(n)]
        a = [m[i] * length[i] / 2 + length[i] * beyond[i] for i in range(n)]
        matrix = [
            [length[min(i, j)] * a[max(i, j)] if i != j else length[i] ** 2 * (m[i] / 3 + beyond[i])
             for j in range(n)]
            for i in range(n)
        ]  # fmt: skip
        return matrix, a


class Series:
    """The Taylor coefficients of one step, as integers."""

    def __init__(self, chain: RodChain, bits: int) -> None:
        self.bits = bits
        matrix, moments = chain.inertia()
        self.n = len(moments)
        self.matrix = [[self.whole(x) for x in row] for row in matrix]
        self.weight = [self.whole(a * Fraction(chain.gravity)) for a in moments]
        self.damping = [self.whole(Fraction(b)) for b in chain.damping] or [0] * self.n

    def whole(self, x: Fraction) -> int:
        return (x.numerator << self.bits) // x.denominator

    def coefficients(
        self, q: Sequence[int], qd: Sequence[int], halvings: int, order: int
    ) -> list[list[int]]:
        """Return those of each angle in x, where t = t_0 + 2^-halvings x."""
        return self.with_held_joints(q, qd, halvings, order, frozenset())[0]

    def with_held_joints(
        self,
        q: Sequence[int],
        qd: Sequence[int],
        halvings: int,
        order: int,
        locked: frozenset[int],
    ) -> tuple[list[list[int]], list[list[int]]]:
        """Return the same, and for each joint the torque that locks it, per 4^halvings.

        A link behind a joint in `locked` (from 0) turns as the link before it, or not at all.
        """
        n, bits, links = self.n, self.bits, range(self.n)
        bodies = self.bodies(locked)
        angle = [[q[i], qd[i] >> halvings] for i in links]
        u, v, mq = [], [], []  # cosines, sines, and m times coefficient m of the angle
        for i in links:
            cosine, sine = self.cosine_sine(q[i])
            u.append([cosine, -sine * angle[i][1] >> bits])
            v.append([sine, cosine * angle[i][1] >> bits])
            mq.append([0, angle[i][1]])
        mass = [
            [self.matrix[i][j] * (u[i][0] * u[j][0] + v[i][0] * v[j][0]) >> 2 * bits
             for j in links] for i in links
        ]  # fmt: skip
        inverse = self.inverse(
            [[sum(mass[i][j] for i in one for j in other) for other in bodies] for one in bodies]
        )
        forces: list[list[int]] = [[] for _ in links]  # that hold the links
        bx: list[list[int]] = [[] for _ in links]  # sum_j A_ij u_j'', and its second component
        by: list[list[int]] = [[] for _ in links]
        for k in range(order - 1):
            of_two = (k + 1) * (k + 2)
            ex, ey = [], []
            for i in links:  # but for the unknown coefficient
                u[i].append((-sum(map(mul, mq[i][1:], v[i][:0:-1])) >> bits) // (k + 2))
                v[i].append((sum(map(mul, mq[i][1:], u[i][k + 1 : 0 : -1])) >> bits) // (k + 2))
                ex.append(of_two * u[i][-1])
                ey.append(of_two * v[i][-1])
            torque = [self.damping[j] * (mq[j][-1] - (mq[j - 1][-1] if j else 0)) for j in links]
            right = []
            for i in links:
                bx[i].append(sum(map(mul, self.matrix[i], ex)) >> bits)
                by[i].append(sum(map(mul, self.matrix[i], ey)) >> bits)
                known = sum(map(mul, u[i][k::-1], by[i])) - sum(map(mul, v[i][k::-1], bx[i]))
                pull = self.weight[i] * u[i][k] >> 2 * halvings
                held = (torque[i + 1] if i + 1 < n else 0) - torque[i] >> halvings
                right.append(pull + held - known >> bits)
            of_bodies = [sum(right[i] for i in body) for body in bodies]
            found = [0] * n
            for body, row in zip(bodies, inverse, strict=True):
                for i in body:
                    found[i] = (sum(map(mul, row, of_bodies)) >> bits) // of_two
            for i, next_one in enumerate(found):
                angle[i].append(next_one)
                mq[i].append((k + 2) * next_one)
                u[i][-1] -= v[i][0] * next_one >> bits
                v[i][-1] += u[i][0] * next_one >> bits
            for i in links:
                new_x = (of_two * -v[j][0] * angle[j][-1] for j in links)
                new_y = (of_two * u[j][0] * angle[j][-1] for j in links)
                bx[i][-1] += sum(map(mul, self.matrix[i], new_x)) >> 2 * bits
                by[i][-1] += sum(map(mul, self.matrix[i], new_y)) >> 2 * bits
                pushed = (mass_row * x for mass_row, x in zip(mass[i], found, strict=True))
                forces[i].append((of_two * sum(pushed) >> bits) - right[i])
        return angle, [[sum(at) for at in zip(*forces[j:], strict=True)] for j in links]

    def bodies(self, locked: frozenset[int]) -> list[list[int]]:
        """Return the links that turn as one; none of those that do not turn at all."""
        bodies: list[list[int]] = [[]]
        for i in range(self.n):
            if i not in locked:
                bodies.append([])
            bodies[-1].append(i)
        return bodies[1:]

    def cosine_sine(self, q: int) -> tuple[int, int]:
        with mpmath.workprec(self.bits + 32):
            cosine, sine = mpmath.cos_sin(mpmath.ldexp(mpmath.mpf(q), -self.bits))
            return tuple(int(mpmath.nint(mpmath.ldexp(x, self.bits))) for x in (cosine, sine))

    def inverse(self, matrix: list[list[int]]) -> list[list[int]]:
        """Invert by Gauss and Jordan; the mass matrix is positive definite and needs no pivots."""
        n, one = len(matrix), 1 << self.bits
        rows = [[*row, *(one * (i == j) for j in range(n))] for i, row in enumerate(matrix)]
        for i in range(n):
            rows[i] = [(x << self.bits) // rows[i][i] for x in rows[i]]
            for j in range(n):
                if j != i:
                    factor = rows[j][i]
                    pairs = zip(rows[j], rows[i], strict=True)
                    rows[j] = [x - (factor * y >> self.bits) for x, y in pairs]
        return [row[n:] for row in rows]


def motion(
    chain: RodChain,
    q0: Sequence[Fraction | float],
    qd0: Sequence[Fraction | float],
    times: Sequence[Fraction | float],
    digits: int = 60,
) -> list[list[Fraction]]:
    """Return q_1..q_n, qd_1..qd_n at each of the times, which begin at 0 and rise."""
    bits = int(digits * 3.33) + SPARE
    series = Series(chain, bits)
    order = int(0.37 * (bits - SPARE))
    q, qd = ([series.whole(Fraction(x)) for x in start] for start in (q0, qd0))
    wanted = [series.whole(Fraction(t)) for t in times]
    now, halvings = 0, 4
    result = []
    taken = 0
    while taken < len(wanted):
        angle = series.coefficients(q, qd, halvings, order)
        shares = step_share(angle, order)
        step = int(shares * 2**40) << bits - 40  # in x
        while taken < len(wanted) and wanted[taken] - now << halvings <= step:
            x = wanted[taken] - now << halvings
            ends = [horner(one, x, bits) for one in angle]
            state = [*(value for value, _ in ends), *(slope << halvings for _, slope in ends)]
            result.append([Fraction(value, 1 << bits) for value in state])
            taken += 1
        ends = [horner(one, step, bits) for one in angle]
        q = [value for value, _ in ends]
        qd = [slope << halvings for _, slope in ends]
        now += step >> halvings
        # A shorter unit hides how far the series reach: their last coefficients are rounding.
        halvings += 1 if shares < 0.6 else -1 if shares > 1.0 else 0
    return result


def step_share(angle: list[list[int]], order: int) -> float:
    """Return how far the series reach, in x."""
    last = [(k, abs(one[k]).bit_length()) for one in angle for k in range(order - 3, order + 1)]
    return min(2.0 ** ((SPARE - 8 - size) / k) for k, size in last)


def horner(coefficients: list[int], x: int, bits: int) -> tuple[int, int]:
    """Return the polynomial and its slope."""
    value = slope = 0
    for c in reversed(coefficients):
        slope = (slope * x >> bits) + value
        value = (value * x >> bits) + c
    return value, slope
