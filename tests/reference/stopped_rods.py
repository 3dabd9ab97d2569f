"""Planar chains of uniform rods with stops in their joints, event by event in many digits.

Between impacts, Taylor series of fixed-point integers (taylor_series.py) give the motion, with the
joints that rest at a stop locked. An event is a root of a gap, or of the torque that locks a joint,
to the last digit. Impacts follow docs/background/trust.md; the contacts that act are found by
trial. Bounces that accumulate are all there, at one stop or in turn at several, down to the capture
speed: with 60 digits gaps of 1e-40 rad are gaps.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mpmath

from reference.many_digit_contacts import ManyDigitContacts, Stop, relative
from reference.polynomial_roots import first_root
from reference.taylor_series import SPARE, RodChain, Series, horner, step_share

mpf = mpmath.mpf
MOST_IMPACTS = 100_000


@dataclass(kw_only=True)
class StoppedRods:
    """A run of such rods, from a start that touches no stop."""

    chain: RodChain
    stops: Sequence[Stop]
    digits: int = 60
    impacts: int = 0

    def __post_init__(self) -> None:
        self.bits = int(self.digits * 3.33) + SPARE
        self.series = Series(self.chain, self.bits)
        self.order = int(0.37 * (self.bits - SPARE))
        self.contacts = ManyDigitContacts(self.chain, self.stops, self.digits)
        self.n = len(self.chain.masses)
        self.smallest = mpf(10) ** (-self.digits // 2)  # rad, rad/s
        self.touched: dict[int, int] = {}  # by stop: how many coefficients of its gap are zero
        self.held: frozenset[int] = frozenset()  # stops

    # The motion ---------------------------------------------------------------------------------

    def run(
        self, q0: Sequence[float], qd0: Sequence[float], times: Sequence[float]
    ) -> list[list[float]]:
        """Return q and qd at the times, which begin after 0 and rise."""
        q, qd = ([self.series.whole(Fraction(x)) for x in start] for start in (q0, qd0))
        now, halvings, order, states = 0, 4, self.order, []
        for time in (self.series.whole(Fraction(t)) for t in times):
            while now < time:
                angle, torque = self.series.with_held_joints(
                    q, qd, halvings, order, frozenset(self.stops[s].joint for s in self.held)
                )
                share = min(step_share(angle, order), 2.0)
                x = min(int(share * 2**40) << self.bits - 40, time - now << halvings)
                which, x = self.first_event(angle, torque, x)
                ends = [horner(one, x, self.bits) for one in angle]
                q = [value for value, _ in ends]
                qd = [slope << halvings for _, slope in ends]
                now += x >> halvings
                self.settle(q, qd, which)
                if order == self.order:
                    halvings = max(halvings + (1 if share < 0.6 else -1 if share > 1.0 else 0), 0)
                if which is not None:  # the next may be so near that a shorter series reaches it
                    self.happen(which, q, qd)
                    near = x < int(share * 2**30) << self.bits - 40
                    order = max(8, order // 2) if near else order
                else:
                    self.touched = dict.fromkeys(self.held, 0)
                    order = min(self.order, 2 * order)
            states.append([float(mpmath.ldexp(mpf(v), -self.bits)) for v in [*q, *qd]])
        return states

    def settle(self, q: list[int], qd: list[int], which: int | None) -> None:
        """Put held joints, and the one that has reached its stop, exactly there."""
        reached = {self.stops[s].joint: s for s in self.held}
        if which is not None and which not in self.held:
            reached[self.stops[which].joint] = which
        for j in sorted(reached):
            at = self.series.whole(Fraction(self.stops[reached[j]].at))
            q[j] = at + (q[j - 1] if j else 0)
            if reached[j] in self.held:
                qd[j] = qd[j - 1] if j else 0

    def first_event(
        self, angle: list[list[int]], torque: list[list[int]], x: int
    ) -> tuple[int | None, int]:
        found: tuple[int | None, int] = (None, x)
        held_joints = {self.stops[s].joint for s in self.held}
        for s, stop in enumerate(self.stops):
            if s in self.held:
                guard = [-stop.side * c for c in torque[stop.joint]]
            elif stop.joint in held_joints:
                continue  # its other stop
            else:
                columns = zip(*angle, strict=True)
                guard = [-stop.side * relative(c, stop) for c in columns]
                guard[0] += stop.side * self.series.whole(Fraction(stop.at))
            guard = guard[self.touched.get(s, 0) :]
            root = first_root(guard, found[1], self.bits)
            if root is not None and root < found[1]:
                found = (s, root)
        return found

    # Impacts ------------------------------------------------------------------------------------

    def happen(self, which: int, q: list[int], qd: list[int]) -> None:
        assert self.impacts < MOST_IMPACTS
        with mpmath.workprec(self.bits):
            angles = [mpmath.ldexp(mpf(v), -self.bits) for v in q]
            rates = [mpmath.ldexp(mpf(v), -self.bits) for v in qd]
            near = self.near(which, angles)
            for s in near:  # in turn, the accelerations without a say
                self.put(s, q, angles)
            at = sorted(self.held | {which} | near)
            lets_go = which in self.held
            if not lets_go:
                self.impacts += 1
                rates = self.after_impact(at, angles, rates)
            resting = [s for s in at if not (lets_go and s == which)]
            self.held = self.holding(resting, angles, rates)
            # a gap that opens from rest, without any acceleration yet where a stop lets go
            self.touched = dict.fromkeys(self.held, 0)
            for s in at:
                if s in self.held:
                    continue
                at_rest = abs(relative(rates, self.stops[s])) == 0
                self.touched[s] = 1 if not at_rest else 3 if lets_go and s == which else 2
            qd[:] = [int(mpmath.nint(mpmath.ldexp(v, self.bits))) for v in rates]

    def near(self, which: int, q: Sequence[Any]) -> set[int]:
        """The stops that are nearer than any digit, in a corner: their impacts are at one time."""
        if which in self.held:
            return set()
        gaps = {
            s: stop.side * (mpf(stop.at) - relative(q, stop))
            for s, stop in enumerate(self.stops)
            if s not in self.held and s != which
        }
        return {s for s, gap in gaps.items() if abs(gap) < self.smallest}

    def put(self, s: int, q: list[int], angles: list[Any]) -> None:
        """Turn a joint exactly to its stop."""
        j, at = self.stops[s].joint, self.stops[s].at
        shift = self.series.whole(Fraction(at)) + (q[j - 1] if j else 0) - q[j]
        for i in range(j, self.n):
            q[i] += shift
            angles[i] += mpmath.ldexp(mpf(shift), -self.bits)

    def after_impact(self, at: Sequence[int], q: Sequence[Any], qd: Sequence[Any]) -> list[Any]:
        inverse = self.contacts.mass_matrix(q) ** -1
        tiny = mpf(10) ** (-self.digits * 3 // 4) * max(abs(v) for v in qd) + self.smallest / 100
        bounced: set[int] = set()

        def away(s: int, rates: Sequence[Any]) -> Any:
            rate = -self.stops[s].side * relative(rates, self.stops[s])
            return mpf(0) if abs(rate) < tiny else rate

        held = self.held
        while min(away(s, qd) for s in at) < 0:
            acting = [s for s in at if away(s, qd) < 0 or (away(s, qd) == 0 and s in held)]
            e = {}
            for s in acting:
                speed, stop = -away(s, qd), self.stops[s]
                e[s] = mpf(stop.restitution) if speed > 0 and speed >= stop.capture_speed else 0
            bounced = (bounced - set(acting)) | {s for s in acting if e[s] > 0}
            qd, _ = self.contacts.complementary(
                inverse, qd, acting, [-e[s] * away(s, qd) for s in acting]
            )
            qd = self.stopped(at, qd, tiny)
            held = self.holding(at, q, qd)  # others set out at once
        captured: list[int] = []
        while True:
            qd = self.stopped(at, qd, tiny)
            qdd = self.accelerations(at, q, qd)
            slow = [
                s
                for s in at
                if 0 < away(s, qd) < self.stops[s].capture_speed
                and -self.stops[s].side * relative(qdd, self.stops[s]) < 0
                and s not in bounced
                and s not in captured
            ]
            if not slow:
                return qd
            captured += slow
            qd, _ = self.contacts.complementary(inverse, qd, at, [0] * len(at), captured)

    def stopped(self, at: Sequence[int], qd: Sequence[Any], tiny: Any) -> list[Any]:
        """Rates of joints, exactly 0 where they are rounding."""
        phid = [qd[0], *(b - a for a, b in itertools.pairwise(qd))]
        for s in at:
            if abs(phid[self.stops[s].joint]) < tiny:
                phid[self.stops[s].joint] = mpf(0)
        sums, exact = mpf(0), []
        for j, rate in enumerate(phid):
            sums = sums + rate if rate != 0 else (exact[-1] if j else mpf(0))
            exact.append(sums)
        return exact

    def resting(self, at: Sequence[int], qd: Sequence[Any]) -> list[int]:
        return [s for s in at if relative(qd, self.stops[s]) == 0]

    def solved(self, at: Sequence[int], q: Sequence[Any], qd: Sequence[Any]) -> tuple[Any, Any]:
        inverse = self.contacts.mass_matrix(q) ** -1
        free = inverse * self.contacts.forces(q, qd)
        resting = self.resting(at, qd)
        return self.contacts.complementary(
            inverse, [free[i] for i in range(self.n)], resting, [0] * len(resting)
        )

    def accelerations(self, at: Sequence[int], q: Sequence[Any], qd: Sequence[Any]) -> Any:
        return self.solved(at, q, qd)[0]

    def holding(self, at: Sequence[int], q: Sequence[Any], qd: Sequence[Any]) -> frozenset[int]:
        """The stops whose joints rest there, pushed."""
        return frozenset(self.solved(at, q, qd)[1])
