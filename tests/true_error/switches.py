"""What changes at an event: laws of several pieces, dry friction, stops; and at given times.

Each law is in one of its states, says what that makes of the parameters of `switched_equations`,
and which event ends it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from math import inf
from typing import Any

import numpy as np
import pendcore as pc
from reference.arithmetic import eliminate
from reference.curves import second_derivatives

from true_error.constants import Parameters
from true_error.own_laws import OwnLaw

ONE = Fraction(1)


@dataclass
class Line:
    """x = weights . (angles, rates, holding torques), as parameters of an event without its slot.

    ``low < x < high`` holds until the event.
    """

    weights: dict[str, Fraction]
    low: float | Fraction
    high: float | Fraction

    def parameters(self, slot: int, n: int) -> Parameters:
        """Return the parameters of the event in a slot, of n joints."""
        found = {f"{kind}{slot}{j}": Fraction(0) for kind in ("ef", "ew", "el") for j in range(n)}
        if self.low == -inf and self.high == inf:
            return found | {f"ea{slot}": ONE, f"eb{slot}": ONE, f"ed{slot}": Fraction(0)}
        found |= {f"{name[:2]}{slot}{name[2:]}": value for name, value in self.weights.items()}
        bounds = [bound for bound in (self.low, self.high) if abs(bound) < inf]
        found[f"ea{slot}"] = Fraction(bounds[0])
        found[f"ed{slot}"] = ONE if len(bounds) == 2 else Fraction(0)
        found[f"eb{slot}"] = Fraction(bounds[-1]) if len(bounds) == 2 else ONE
        return found


NEVER = Line({}, -inf, inf)


@dataclass
class Pieces:
    """A law that is another one on each side of some values of x; it is in one of its pieces."""

    weights: dict[str, Fraction]
    """What x is."""
    bounds: tuple[Fraction, ...]
    """Between the pieces, rising."""
    laws: tuple[Parameters, ...]
    """The parameters of each piece: one more than bounds."""
    piece: int = 0

    def parameters(self) -> Parameters:
        return self.laws[self.piece]

    def line(self) -> Line:
        ends = (-inf, *self.bounds, inf)
        return Line(self.weights, ends[self.piece], ends[self.piece + 1])

    def value(self, phi: Any, w: Any) -> Any:
        """Return x at angles and rates of the joints."""
        of = {"ef": phi, "ew": w}
        return sum(float(weight) * of[name[:2]][int(name[2:])]
                   for name, weight in self.weights.items())  # fmt: skip


@dataclass
class Friction:
    """Dry friction in a joint: sliding with a sign, or stuck (0).

    Where Stribeck's exponential is nothing beside 1, ``is_far``, it is left out: a series that
    begins there does not see it, and would take its step across the peak.
    """

    joint: int
    coulomb: Fraction
    static: Fraction
    velocity: Fraction
    exponent: int
    nothing: float
    sign: int = 0
    is_far: bool = False

    @property
    def far(self) -> float:
        """From which rate on it is far, rad/s."""
        if self.static == self.coulomb:
            return inf
        return float(self.velocity) * self.nothing ** (1 / self.exponent)

    def slide(self, rate: float) -> None:
        """Slide at a rate, rad/s."""
        self.sign = int(np.sign(rate))
        self.is_far = abs(rate) > self.far

    def parameters(self) -> Parameters:
        """Return those of its sign; a joint that sticks is held."""
        j, slope = self.joint - 1, 1 / self.velocity**self.exponent
        peak = Fraction(0) if self.is_far else self.static - self.coulomb
        is_linear = self.exponent == 1
        return {
            f"fc{j}": self.sign * self.coulomb,
            f"fd{j}": self.sign * peak,
            f"fe{j}": self.sign * slope * is_linear,
            f"ff{j}": abs(self.sign) * slope * (not is_linear),
        }

    def line(self) -> Line:
        j = self.joint - 1
        if not self.sign:
            return Line({f"el{j}": ONE}, -self.static, self.static)
        rate = {f"ew{j}": Fraction(self.sign)}
        return Line(rate, self.far, inf) if self.is_far else Line(rate, Fraction(0), self.far)


@dataclass
class Stop:
    """The stops of a joint: free, or held at the lower (-1) or the upper one (1)."""

    joint: int
    low: float
    high: float
    restitution: Fraction
    capture_speed: float
    held: int = 0

    def parameters(self) -> Parameters:
        return {}

    def line(self) -> Line:
        j = self.joint - 1
        if self.held:
            return Line({f"el{j}": ONE}, Fraction(0), inf)
        return Line({f"ef{j}": ONE}, self.low, self.high)


Switch = Pieces | Friction | Stop


def switches_of(scene: pc.Scene, nothing: float) -> list[Switch]:
    """Return all of a scene's laws that change at events."""
    return [switch for effect in scene.effects for switch in _of(effect, nothing)]


def _of(effect: Any, nothing: float) -> Iterator[Switch]:
    if effect.kind == "dry_joint_friction":
        static = effect.coulomb if effect.static is None else effect.static
        if effect.exponent not in (1.0, 2.0):
            raise NotImplementedError(f"exponent = {effect.exponent}: 1 and 2 are compiled")
        yield Friction(
            effect.joint, Fraction(effect.coulomb), Fraction(static),
            Fraction(effect.stribeck_velocity), int(effect.exponent), nothing,
        )  # fmt: skip
    elif effect.kind == "joint_stop":
        if effect.capture_speed is None:
            raise NotImplementedError("a capture speed that is left to the core")
        low, high = effect.range
        yield Stop(effect.joint, low, high, Fraction(effect.restitution), effect.capture_speed)
    elif effect.kind == "viscous_joint" and effect.damping2:
        yield quadratic(effect.joint, Fraction(effect.damping2))
    elif effect.kind == "motor" and effect.pd is not None and effect.limit < inf:
        yield limited(effect.joint, effect.pd, Fraction(effect.limit))
    elif effect.kind == "user" and isinstance(effect.function, OwnLaw):
        yield from _own(effect.function)


def _own(law: OwnLaw) -> Iterator[Switch]:
    j = law.joint - 1
    values = tuple(map(Fraction, law.values))
    if law.name == "quadratic damper":
        yield quadratic(law.joint, values[0])
    elif law.name == "clipped spring":
        k, most = values
        edges = ({f"c{j}": k * most}, {f"k{j}": k}, {f"c{j}": -k * most})
        yield Pieces({f"ef{j}": ONE}, (-most, most), edges)
    elif law.name == "one-sided spring":
        k, free = values
        yield Pieces({f"ef{j}": ONE}, (free,), ({}, {f"k{j}": k, f"c{j}": k * free}))


def quadratic(joint: int, b2: Fraction) -> Pieces:
    """Return -b2 abs(w) w."""
    j = joint - 1
    return Pieces({f"ew{j}": ONE}, (Fraction(0),), ({f"b2{j}": -b2}, {f"b2{j}": b2}))


def limited(joint: int, pd: pc.effects.PD, limit: Fraction) -> Pieces:
    """Return a controller whose torque, kp (reference - phi) - kd w, is clipped.

    x is  kp phi + kd w.
    """
    j = joint - 1
    kp, kd = Fraction(pd.kp), Fraction(pd.kd)
    middle = kp * Fraction(pd.reference)
    linear = {f"k{j}": kp, f"b{j}": kd, f"c{j}": middle}
    return Pieces(
        {f"ef{j}": kp, f"ew{j}": kd},
        (middle - limit, middle + limit),
        ({f"c{j}": limit}, linear, {f"c{j}": -limit}),
    )


def smooth_own_torques(scene: pc.Scene) -> Parameters:
    """Return the parameters of a user's own laws that are smooth."""
    found: Parameters = {}
    for effect in scene.effects:
        law = getattr(effect, "function", None)
        if not isinstance(law, OwnLaw):
            continue
        j, values = law.joint - 1, tuple(map(Fraction, law.values))
        if law.name == "cubic spring":
            found[f"k3{j}"] = values[0]
        elif law.name == "detent":
            found |= {f"us{j}": values[0], f"ut{j}": values[1]}
    return found


# What begins and ends at given times ------------------------------------------------------------


@dataclass
class Tables:
    """What begins and ends at given times, s: intervals of (begin, end, parameters)."""

    intervals: list[tuple[float, float, Parameters]]


def tables_of(scene: pc.Scene, nothing: float) -> list[Tables]:
    """Return what begins and ends at given times: tables of torque, splines of the pivot, pulses.

    A pulse is one where it is more than nothing: see `Friction.is_far`.
    """
    found = []
    for effect in scene.effects:
        if effect.kind == "motor" and effect.table is not None:
            j = effect.joint - 1
            points = list(zip(effect.table.t, effect.table.torque, strict=True))
            found.append(_linear([(f"c{j}", f"d{j}", points)], effect.table.hold))
        elif effect.kind == "driven_pivot" and effect.spline is not None:
            spline = effect.spline
            found.append(_linear([
                (axis + "c", axis + "d", list(zip(spline.t, bends(spline.t, along), strict=True)))
                for axis, along in (("x", spline.x), ("y", spline.y))
            ]))  # fmt: skip
        elif getattr(getattr(effect, "function", None), "name", "") == "pulse":
            j, (height, middle, width) = effect.function.joint - 1, effect.function.values
            reach = width * nothing**0.5
            ends = middle - reach, middle + reach
            values = {f"gh{j}": height, f"gm{j}": middle, f"gi{j}": 1 / Fraction(width)}
            exact = {name: Fraction(value) for name, value in values.items()}
            found.append(Tables([(*ends, exact)]))
    return found


def _linear(of: list[tuple[str, str, list[tuple[Any, Any]]]], hold: bool = False) -> Tables:
    intervals: dict[tuple[float, float], Parameters] = {}
    for constant, slope, points in of:
        exact = [(Fraction(t), Fraction(value)) for t, value in points]
        for (t0, a), (t1, b) in pairwise(exact):
            if t0 == t1:
                continue
            rise = Fraction(0) if hold else (b - a) / (t1 - t0)
            values = intervals.setdefault((float(t0), float(t1)), {})
            values |= {constant: a - rise * t0, slope: rise}
    return Tables([(*ends, values) for ends, values in intervals.items()])


def bends(t: tuple[float, ...], x: tuple[float, ...]) -> list[Fraction]:
    """Return the second derivatives of the natural cubic spline through points, exactly."""
    return second_derivatives([*map(Fraction, t)], [*map(Fraction, x)], eliminate)
