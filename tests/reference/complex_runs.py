"""Derivatives of runs by complex numbers: what is moved by 1e-30 i moves the end by as much.

The imaginary part of the state is the derivative, without a difference. Times of events are
complex, too: the zero of a guard moves with what the guard depends on, and every later step begins
there. What is held, and on which side a joint slides, the real parts decide. There is no formula of
a saltation.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from hybrid_chain import midpoint_rules

from reference.rig import Rig

LITTLE = 1e-30j
NEAR = 1e-14
"""No smaller gap between a joint and its stop is told from none, rad."""
ROUNDING = 2e-15
"""By as much may a guard be below zero where a joint has just begun to move from it."""


def midpoint_rule(f: Callable[..., Any], t: Any, y: Any, h: Any) -> Any:
    """One step of Gragg's rule, extrapolated to order 16."""
    return midpoint_rules(f, t, y, h, stages=8)[-1]


@dataclass(frozen=True, slots=True, kw_only=True)
class Friction:
    """Dry friction with Stribeck's effect; numbers may be complex."""

    coulomb: Any
    static: Any
    stribeck_velocity: Any = 0.1
    exponent: Any = 2.0

    def sliding(self, rate: Any, sign: int) -> Any:
        """The torque on a joint that slides in the direction of `sign`, N m."""
        share = np.exp(-((sign * rate / self.stribeck_velocity) ** self.exponent)) if rate else 1
        return -sign * (self.coulomb + (self.static - self.coulomb) * share)


@dataclass(frozen=True, slots=True, kw_only=True)
class Range:
    """Stops at both ends of the range of a joint."""

    lower: Any
    upper: Any
    restitution: Any
    capture_speed: float


@dataclass(slots=True, kw_only=True)
class HybridRun:
    """A rig whose joints, from 0, may have friction or stops; its smooth effects are the rig's."""

    rig: Rig
    later: list[tuple[Any, Rig]] = field(default_factory=list)
    """What it is from other times on."""
    friction: dict[int, Friction]
    stops: dict[int, Range]
    held: set[int] = field(default_factory=set)
    sign: dict[int, int] = field(default_factory=dict)
    """The direction in which a joint with friction slides."""
    events: list[str] = field(default_factory=list)

    def end(self, y: Any, t_end: float, step: float = 0.02) -> Any:
        """Return the state at t_end from that at 0."""
        self.hold_and_slide(0.0, y)
        t: Any = 0.0
        most = step
        later = [one for one in self.later if one[0].real < t_end]
        while True:
            last = later[0][0] if later else t_end
            h = min(step, most, last.real - t.real)
            is_last = h == last.real - t.real
            if is_last:
                h = last - t
            with np.errstate(all="ignore"):  # beyond rest, Stribeck's law grows like an exponential
                there = midpoint_rule(self.rates, t, y, h)
                while not np.isfinite(there).all():
                    assert h.real > 1e-9
                    h, is_last = h.real / 2, False
                    there = midpoint_rule(self.rates, t, y, h)
            roots = [
                (self.root(g, t, y, h), name, j, g)
                for name, j, g in self.guards()
                if g(t + h, there).real < -ROUNDING
            ]
            if not roots:
                t, y, most = t + h, there, 4 * most
                if is_last and not later:
                    return y
                if is_last:
                    self.rig = later.pop(0)[1]
                    self.events.append(f"table at {t.real:.6f}")
                    self.hold_and_slide(t, y)
                continue
            h, name, j, _ = min(roots, key=lambda one: one[0].real)
            y, t = midpoint_rule(self.rates, t, y, h), t + h
            most = 1e-5  # where stops meet, the next event may follow at once
            self.events.append(f"{name} {j} at {t.real:.6f}")
            assert len(self.events) < 200
            y = self.change(name, j, t, y)

    def relative(self, x: Any, j: int) -> Any:
        return x[j] - x[j - 1] if j else x[0]

    def row(self, j: int) -> Any:
        row = np.zeros(len(self.rig.bodies))
        row[j] = 1
        if j:
            row[j - 1] = -1
        return row

    def solved(self, t: Any, y: Any, held: set[int], sign: dict[int, int]) -> tuple[Any, Any]:
        """The accelerations, and the torques that hold joints."""
        n = len(y) // 2
        q, qd = y[:n], y[n:]
        free = np.array(self.rig.motion(t, list(q), list(qd)).accelerations)
        M = np.array(self.rig.mass_matrix(list(q)))
        torque = M @ free
        for j, direction in sign.items():
            if j not in held:
                slides = self.friction[j].sliding(self.relative(qd, j), direction)
                torque = torque + slides * self.row(j)
        order = sorted(held)
        rows = np.array([self.row(j) for j in order]).reshape(len(order), n)
        system = np.block([[M, -rows.T], [rows, np.zeros((len(order), len(order)))]])
        found = np.linalg.solve(system, np.append(torque, np.zeros(len(order))))
        return found[:n], dict(zip(order, found[n:], strict=True))

    def rates(self, t: Any, y: Any) -> Any:
        return np.append(y[len(y) // 2 :], self.solved(t, y, self.held, self.sign)[0])

    def side(self, j: int, y: Any, near: float = 1e-9) -> int:
        """Which stop a joint is at: -1, 0 or 1."""
        if j not in self.stops:
            return 0
        phi = self.relative(y[: len(y) // 2], j).real
        stop = self.stops[j]
        return int(abs(phi - stop.upper.real) < near) - int(abs(phi - stop.lower.real) < near)

    def guards(self) -> Iterator[tuple[str, int, Callable[[Any, Any], Any]]]:
        def half(y: Any) -> int:
            return len(y) // 2

        for j, sign in self.sign.items():
            if j not in self.held:
                yield "rest", j, lambda t, y, j=j, s=sign: s * self.relative(y[half(y) :], j)
        for j, stop in self.stops.items():
            if j not in self.held:
                yield "lower", j, lambda t, y, j=j, at=stop.lower: self.relative(y, j) - at
                yield "upper", j, lambda t, y, j=j, at=stop.upper: at - self.relative(y, j)
        for j in self.held:

            def torque(t: Any, y: Any, j: int = j) -> Any:
                return self.solved(t, y, self.held, self.sign)[1][j]

            if j in self.friction:
                most = self.friction[j].static
                yield "most", j, lambda t, y, f=torque, most=most: most - f(t, y)
                yield "least", j, lambda t, y, f=torque, most=most: most + f(t, y)
            else:
                yield "leave", j, lambda t, y, f=torque, j=j: -self.side(j, y) * f(t, y)

    def root(self, g: Callable[[Any, Any], Any], t: Any, y: Any, h: Any) -> Any:
        """The complex share of a step at which a guard is zero, by the secant rule."""

        def value(x: Any) -> Any:
            return g(t + x, midpoint_rule(self.rates, t, y, x))

        low, high = 0.0, h.real
        for _ in range(40):  # it may begin at a zero, where a joint leaves its stop
            if value(low).real >= 1e-11:
                break
            low = 0.5 * (low or h.real)
        a, b = low, high
        g_a, g_b = value(low).real, value(high).real
        for _ in range(60):
            x = b - g_b * (b - a) / (g_b - g_a) if g_b != g_a else 0.5 * (low + high)
            if not low < x < high:
                x = 0.5 * (low + high)
            a, g_a, b, g_b = b, g_b, x, value(x).real
            low, high = (x, high) if g_b > 0 else (low, x)
            if abs(b - a) < 1e-14 or high - low < 1e-15 or g_b == 0:
                break
        by = 1e-4 * h.real
        slope = (value(b + by).real - value(b - by).real) / (2 * by)
        root = complex(b)
        for _ in range(6):  # the slope has some eight digits, and each round has as many more
            root -= value(root) / slope
        return root

    def change(self, name: str, j: int, t: Any, y: Any) -> Any:
        if name == "rest":
            self.hold_and_slide(t, y)
        elif name in {"most", "least"}:
            self.held.remove(j)
            self.sign[j] = -1 if name == "most" else 1
        elif name == "leave":
            self.held.remove(j)
        else:
            y = self.strike(j, t, y)
        return y

    def strike(self, j: int, t: Any, y: Any) -> Any:
        """Let a joint strike its stop, and those that this throws back to theirs at once."""
        n = len(y) // 2
        bounced: set[int] = set()
        for _ in range(2000):
            stop = self.stops[j]
            at = stop.upper if self.side(j, y) > 0 else stop.lower
            y = y + np.append(np.arange(n) >= j, np.zeros(n)) * (at - self.relative(y, j))
            # A joint that comes near or has hardly left strikes in turn, be it after 1e-24 s.
            touching = [k for k in self.stops if k == j or (self.side(k, y) and k in self.held)]
            bounces = abs(self.into(j, y)) >= stop.capture_speed and stop.restitution != 0
            bounced = (bounced - {*touching}) | ({j} if bounces else set())
            y = self.struck(y, touching, {j: stop.restitution} if bounces else {})
            self.held = set()
            self.hold_and_slide(t, y)
            again = [k for k in self.stops if self.into(k, y) > 1e-12]
            if not again:
                return self.captured(t, y, bounced)
            assert len(again) == 1  # otherwise their order is unknown
            j = again[0]
        raise AssertionError

    def captured(self, t: Any, y: Any, bounced: set[int]) -> Any:
        """Stop the joints that others throw off too slowly, while they are pushed back."""
        n = len(y) // 2
        caught: list[int] = []
        while True:
            qdd = self.rates(t, y)[n:]
            slow = [
                j
                for j, stop in self.stops.items()
                if j not in bounced
                and j not in caught
                and 1e-9 < -self.into(j, y) < stop.capture_speed
                and self.side(j, y) * self.relative(qdd, j).real > 0
            ]
            if not slow:
                return y
            caught += slow
            touching = [j for j in self.stops if self.side(j, y, NEAR)]
            y = self.struck(y, touching, {}, caught)
            self.held = set()
            self.hold_and_slide(t, y)

    def into(self, j: int, y: Any) -> float:
        """How fast a joint moves into a stop from which it is no farther than rounding."""
        return float(self.side(j, y, NEAR) * self.relative(y[len(y) // 2 :], j).real)

    def struck(
        self, y: Any, touching: list[int], bounces: dict[int, Any], always: Sequence[int] = ()
    ) -> Any:
        """The state after an impact, by trying out which stops push; some hold in any case."""
        n = len(y) // 2
        M = np.array(self.rig.mass_matrix(list(y[:n])))
        qd = y[n:]
        e = dict.fromkeys(touching, 0.0) | bounces
        others = [j for j in touching if j not in always]
        for count in range(len(others) + 1):
            for more in itertools.combinations(others, count):
                acting = [*always, *more]
                rows = np.array([self.row(j) for j in acting]).reshape(len(acting), n)
                wanted = -np.array([(1 + e[j]) * self.relative(qd, j) for j in acting])
                response = np.linalg.solve(M, rows.T)
                impulses = np.linalg.solve(rows @ response, wanted)
                after = qd + response @ impulses
                pushes = all(
                    -self.side(j, y) * impulse.real >= 0
                    for j, impulse in zip(acting, impulses, strict=True)
                    if j not in always
                )
                opens = all(
                    -self.side(j, y) * (self.relative(after, j) + e[j] * self.relative(qd, j)).real
                    >= -1e-10
                    for j in others
                )
                if pushes and opens:
                    return np.append(y[:n], after)
        raise AssertionError

    def hold_and_slide(self, t: Any, y: Any) -> None:
        """Decide for joints at rest whether they are held, by trying out."""
        n = len(y) // 2
        rates = {j: self.relative(y[n:], j).real for j in (*self.friction, *self.stops)}
        at_rest = [j for j in self.friction if abs(rates[j]) < 1e-9]
        touching = [j for j in self.stops if self.side(j, y) and abs(rates[j]) < 1e-9]
        moving = {j: (1 if rates[j] > 0 else -1) for j in self.friction if j not in at_rest}
        choices = [*([0, 1, -1] for _ in at_rest), *([0, 1] for _ in touching)]
        for choice in itertools.product(*choices):
            chosen = dict(zip([*at_rest, *touching], choice, strict=True))
            held = {j for j, way in chosen.items() if way == 0}
            sign = moving | {j: chosen[j] for j in at_rest if chosen[j]}
            qdd, torques = self.solved(t, y, held, sign)
            fits = all(
                abs(torques[j].real) <= self.friction[j].static.real
                if chosen[j] == 0
                else chosen[j] * self.relative(qdd, j).real > 0
                for j in at_rest
            ) and all(
                -self.side(j, y) * (torques[j] if chosen[j] == 0 else self.relative(qdd, j)).real
                >= 0
                for j in touching
            )
            if fits:
                self.held, self.sign = held, sign
                return
        raise AssertionError
