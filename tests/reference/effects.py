"""The law of every effect, written in the most direct form; `LAWS` has them by kind."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from compiled_functions import DOUBLES, FORCES

from reference.arithmetic import Arithmetic, Number
from reference.curves import natural_spline, sinusoid
from reference.instant import Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Motion
from reference.rig import Law


@dataclass(frozen=True, kw_only=True)
class TorsionalSpring(Law):
    """A spring in a joint: tau = -k (phi - phi_0), V = k (phi - phi_0)^2 / 2."""

    joint: int
    stiffness: float
    rest_angle: float = 0.0

    def act(self, instant: Instant, loads: Loads) -> None:
        number = instant.arithmetic.number
        stiffness = number(self.stiffness)
        loads.couple_at_joint(self.joint, -stiffness * instant.relative_angle(self.joint))
        loads.couple_at_joint(self.joint, stiffness * number(self.rest_angle))

    def potential(self, instant: Instant) -> Number:
        number = instant.arithmetic.number
        turned = instant.relative_angle(self.joint) - number(self.rest_angle)
        return number(self.stiffness) * turned**2 / 2


@dataclass(frozen=True, kw_only=True)
class ViscousJoint(Law):
    """Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), w the rate of the joint."""

    joint: int
    damping: float
    damping2: float = 0.0
    damping3: float = 0.0
    sign: int | None = None
    """The sign that w keeps, where the law is to be analytic."""

    def terms(self, instant: Instant) -> list[Number]:
        number, w = instant.arithmetic.number, instant.relative_rate(self.joint)
        return [
            -number(self.damping) * w,
            -number(self.damping2) * w * (abs(w) if self.sign is None else self.sign * w),
            -number(self.damping3) * w**3,
        ]

    def bends(self, instant: Instant) -> list[Number]:
        return [instant.relative_rate(self.joint)]

    def between_bends(self, signs: Sequence[int]) -> Law:
        return replace(self, sign=signs[0])

    def act(self, instant: Instant, loads: Loads) -> None:
        for term in self.terms(instant):
            loads.couple_at_joint(self.joint, term)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"viscous": -sum(self.terms(instant)) * instant.relative_rate(self.joint)}


@dataclass(frozen=True, kw_only=True)
class DryJointFriction(Law):
    """Stribeck's dry friction in sliding: tau = -(tc + (ts - tc) exp(-abs(w/ws)^p)) sgn w."""

    joint: int
    coulomb: float
    static: float | None = None
    stribeck_velocity: float = 0.1
    exponent: float = 2.0

    def couple(self, instant: Instant) -> Number:
        number, w = instant.arithmetic.number, instant.relative_rate(self.joint)
        coulomb = number(self.coulomb)
        static = coulomb if self.static is None else number(self.static)
        near_rest = instant.arithmetic.exp(
            -(abs(w / number(self.stribeck_velocity)) ** number(self.exponent))
        )
        against = (w < 0) - (w > 0)
        return (coulomb + (static - coulomb) * near_rest) * against

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.couple_at_joint(self.joint, self.couple(instant))

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"dry": -self.couple(instant) * instant.relative_rate(self.joint)}


@dataclass(frozen=True, kw_only=True)
class Motor(Law):
    """The couple of a motor at a joint, never more than its limit.

    It is constant; a sinusoid of time; a table of time, linear between its points or held from each
    to the next; or tau = kp (reference - phi) - kd phid.
    """

    joint: int
    constant: float | None = None
    sinusoid: Mapping[str, float] | None = None
    table: Mapping[str, Any] | None = None
    pd: Mapping[str, float] | None = None
    limit: float = math.inf

    def break_times(self) -> Sequence[float]:
        return self.table["t"] if self.table is not None else ()

    def bends(self, instant: Instant) -> list[Number]:
        wanted, limit = sum(self.wanted(instant)), instant.arithmetic.number(self.limit)
        return [limit - wanted, limit + wanted]

    def between_bends(self, signs: Sequence[int]) -> Law:
        if min(signs) > 0:
            return replace(self, limit=math.inf)
        return Motor(joint=self.joint, constant=self.limit * (1 if signs[0] < 0 else -1))

    def wanted(self, instant: Instant) -> list[Number]:
        number, t = instant.arithmetic.number, instant.t
        if self.constant is not None:
            return [number(self.constant)]
        if self.sinusoid is not None:
            return [sinusoid(t, self.sinusoid, instant.arithmetic)[0]]
        if self.table is not None:
            knots = [number(k) for k in self.table["t"]]
            i = max(k for k in range(len(knots) - 1) if k == 0 or knots[k] <= t)
            before, after = map(number, self.table["torque"][i : i + 2])
            if self.table.get("hold"):
                return [before]
            on = (number(t) - knots[i]) / (knots[i + 1] - knots[i])
            return [(1 - on) * before, on * after]
        assert self.pd is not None
        kp, kd, reference = (number(self.pd[name]) for name in ("kp", "kd", "reference"))
        phi, w = instant.relative_angle(self.joint), instant.relative_rate(self.joint)
        return [kp * reference, -kp * phi, -kd * w]

    def terms(self, instant: Instant) -> list[Number]:
        wanted, limit = self.wanted(instant), instant.arithmetic.number(self.limit)
        if abs(sum(wanted)) > abs(limit):
            return [limit if sum(wanted) > 0 else -limit]
        return wanted

    def act(self, instant: Instant, loads: Loads) -> None:
        size = abs(self.sinusoid["amplitude"]) if self.sinusoid is not None else None
        for term in self.terms(instant):
            loads.couple_at_joint(self.joint, term, size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        return {"motor": sum(self.terms(instant)) * instant.relative_rate(self.joint)}


@dataclass(frozen=True, kw_only=True)
class RodDrag(Law):
    """Air drag on a thin rod: -k w abs(w) per length, across the rod.

    w is the speed across the rod of its points against the wind, k = rho Cd d / 2. The force, its
    moment and its power are integrals along the rod, done by Gauss-Legendre quadrature with three
    points on each side of where w changes sign: exact, as w is linear along the rod.
    """

    link: int
    drag_coefficient: float
    diameter: float
    air_density: float = 1.225
    wind: tuple[float, float] = (0.0, 0.0)
    signs: Sequence[int] | None = None
    """The signs that w keeps at both ends of the rod, where the law is to be analytic."""

    def speed(self, instant: Instant, s: Number) -> Number:
        """Speed of a point of the rod against the wind, across the rod."""
        number, point = instant.arithmetic.number, instant.point(self.link, s)
        nx, ny = instant.across(self.link)
        return nx * (point.vx - number(self.wind[0])) + ny * (point.vy - number(self.wind[1]))

    def bends(self, instant: Instant) -> list[Number]:
        return [self.speed(instant, 0), self.speed(instant, instant.bodies[self.link - 1].length)]

    def between_bends(self, signs: Sequence[int]) -> Law:
        return replace(self, signs=signs)

    def points(self, instant: Instant) -> Iterator[tuple[Number, Number]]:
        """Points of the rod and their weights in an integral along it, with the sign of w there."""
        number, (start, end) = instant.arithmetic.number, self.bends(instant)
        ends = [number(0), number(instant.bodies[self.link - 1].length)]
        signs = self.signs or [(w > 0) - (w < 0) for w in (start, end)]
        if signs[0] * signs[1] < 0:
            ends.insert(1, ends[1] * start / (start - end))
        else:
            signs = [signs[0] or signs[1]]
        offset = (number(3) / 5) ** number("0.5")
        for (a, b), sign in zip(pairwise(ends), signs, strict=True):
            for x, weight in ((-offset, 5), (0, 8), (offset, 5)):
                yield (a + b) / 2 + x * (b - a) / 2, sign * number(weight) / 18 * (b - a)

    def force(self, instant: Instant, s: Number) -> Number:
        """Force across the rod per length, but for the sign of w, which the weights have."""
        number, w = instant.arithmetic.number, self.speed(instant, s)
        product = number(self.air_density) * number(self.drag_coefficient) * number(self.diameter)
        return -product / 2 * w**2

    def integral(self, instant: Instant, f: Callable[[Number], Number]) -> Number:
        """Integrate a function of the place along the rod."""
        return sum(weight * f(s) for s, weight in self.points(instant))

    def act(self, instant: Instant, loads: Loads) -> None:
        body, (nx, ny) = instant.bodies[self.link - 1], instant.across(self.link)
        center = instant.arithmetic.number(body.center)
        # The speeds that cancel in w, however small it is in the end.
        passing = [
            *self.wind,
            *(L.length * w for L, w in zip(instant.bodies, instant.qd, strict=True)),
        ]
        passing += instant.pivot.velocity
        product = self.air_density * self.drag_coefficient * self.diameter
        size = abs(product) * body.length * sum(abs(float(v)) for v in passing) ** 2
        total = self.integral(instant, lambda s: self.force(instant, s))
        moment = self.integral(instant, lambda s: (s - center) * self.force(instant, s))
        loads.force_on_link(self.link, (nx * total, ny * total), size)
        loads.couple_on_link(self.link, moment, size * body.length)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        nx, ny = instant.across(self.link)

        def power(s: Number) -> Number:
            point = instant.point(self.link, s)
            return self.force(instant, s) * (nx * point.vx + ny * point.vy)

        lost = -self.integral(instant, lambda s: self.force(instant, s) * self.speed(instant, s))
        return {"drag": lost, "wind": self.integral(instant, power) + lost}


@dataclass(frozen=True, kw_only=True)
class RotorInertia(Law):
    """A rotor that turns with the angle of a joint: it takes the couple J phidd to turn."""

    joint: int
    armature: float

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.armatures[self.joint - 1] += instant.arithmetic.number(self.armature)

    def kinetic(self, instant: Instant) -> Number:
        return instant.arithmetic.number(self.armature) * instant.relative_rate(self.joint) ** 2 / 2


@dataclass(frozen=True, kw_only=True)
class Payload(Law):
    """A rigid body welded to the tip, with its mass centre there."""

    mass: float
    inertia: float = 0.0

    def act(self, instant: Instant, loads: Loads) -> None:
        number = instant.arithmetic.number
        loads.payloads.append((number(self.mass), number(self.inertia)))

    def kinetic(self, instant: Instant) -> Number:
        number, tip = instant.arithmetic.number, instant.joints[-1]
        translation = number(self.mass) * (tip.vx**2 + tip.vy**2) / 2
        return translation + number(self.inertia) * number(instant.qd[-1]) ** 2 / 2

    def potential(self, instant: Instant) -> Number:
        number = instant.arithmetic.number
        return -number(self.mass) * number(instant.gravity) * instant.joints[-1].y


@dataclass(frozen=True, kw_only=True)
class Lock(Law):
    """A joint that does not turn; the state says at which angle it is."""

    joint: int
    angle: float | None = None

    def act(self, instant: Instant, loads: Loads) -> None:
        loads.locked.add(self.joint)


@dataclass(frozen=True, kw_only=True)
class JointStop(Law):
    """Stops at the ends of a joint's range: they do nothing between, where states are drawn."""

    joint: int
    range: tuple[float, float]
    restitution: float = 0.0
    capture_speed: float | None = None


@dataclass(frozen=True, kw_only=True)
class DrivenPivot(Law):
    """A pivot that is moved: sinusoids along x and y, or a natural cubic spline through points.

    The work of the drive is that of the force which holds the pivot: W = F_01 . v_0.
    """

    x: Mapping[str, float] | None = None
    y: Mapping[str, float] | None = None
    spline: Mapping[str, Sequence[float]] | None = None

    def break_times(self) -> Sequence[float]:
        return self.spline["t"] if self.spline is not None else ()

    def pivot(self, t: Number, arithmetic: Arithmetic) -> PivotMotion:
        if self.spline is not None:
            knots = self.spline["t"]
            axes = [natural_spline(t, knots, self.spline[axis], arithmetic) for axis in "xy"]
            gap = min(after - before for before, after in pairwise(knots))
            size = 12 * max(abs(x) for axis in "xy" for x in self.spline[axis]) / gap**2
        else:
            zero = (arithmetic.number(0),) * 3
            axes = [
                zero if axis is None else sinusoid(t, axis, arithmetic) for axis in (self.x, self.y)
            ]
            driven = [axis for axis in (self.x, self.y) if axis is not None]
            size = max(abs(a["amplitude"]) * a["angular_frequency"] ** 2 for a in driven)
        return PivotMotion(*zip(*axes, strict=True), size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        (fx, fy), (vx, vy) = motion.reactions[0], instant.pivot.velocity
        return {"drive": fx * vx + fy * vy}


@dataclass(frozen=True, kw_only=True)
class User(Law):
    """Generalised forces that a function of t, q and qd returns.

    The generalised force of a link's absolute angle is a couple on that link from outside the
    chain: it does work as that angle turns, and only then.
    """

    function: Callable[[Any, Any, Any], Any]
    breaks: Sequence[float] = ()

    def forces(self, instant: Instant) -> list[Number]:
        number = instant.arithmetic.number
        q, qd = (np.array([number(x) for x in values]) for values in (instant.q, instant.qd))
        return list(self.function(number(instant.t), q, qd))

    def act(self, instant: Instant, loads: Loads) -> None:
        forces = self.forces(instant)
        # A function rounds too: one that cancels says how large its terms are.
        sizes = getattr(self.function, "sizes", lambda t, q, qd: [abs(force) for force in forces])
        each = sizes(float(instant.t), *(np.array(x, float) for x in (instant.q, instant.qd)))
        for link, (force, size) in enumerate(zip(forces, each, strict=True), start=1):
            loads.couple_on_link(link, force, size)

    def shares(self, instant: Instant, motion: Motion) -> dict[str, Number]:
        number = instant.arithmetic.number
        forces = zip(self.forces(instant), instant.qd, strict=True)
        return {"user": sum(force * number(rate) for force, rate in forces)}


def compiled_user(address: int, data: int = 0, breaks: Sequence[float] = ()) -> User:
    """Return the law of forces that the function at an address writes, called with doubles."""

    def function(t: Number, q: object, qd: object) -> list[float]:
        q, qd = np.asarray(q, dtype=float), np.asarray(qd, dtype=float)
        forces = np.zeros(len(q))
        pointers = [array.ctypes.data_as(DOUBLES) for array in (q, qd, forces)]
        FORCES(address)(float(t), len(q), *pointers, data)
        return list(forces.tolist())

    return User(function=function, breaks=breaks)


LAWS: dict[str, Callable[..., Law]] = {
    "compiled_user": compiled_user,
    "driven_pivot": DrivenPivot,
    "dry_joint_friction": DryJointFriction,
    "joint_stop": JointStop,
    "lock": Lock,
    "motor": Motor,
    "payload": Payload,
    "rod_drag": RodDrag,
    "rotor_inertia": RotorInertia,
    "torsional_spring": TorsionalSpring,
    "user": User,
    "viscous_joint": ViscousJoint,
}

Described = tuple[str, dict[str, Any]]
"""An effect: its kind and its parameters; what is an object of its own there is a dict here."""


def law(described: Described) -> Law:
    """Return the law of an effect."""
    kind, parameters = described
    return LAWS[kind](**parameters)
