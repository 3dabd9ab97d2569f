"""Kinematics of the chain: positions, velocities and accelerations of its joints and mass centres.

    P_0 = (x_0, y_0),  P_i = P_(i-1) + L_i u_i,  C_i = P_(i-1) + c_i u_i,  u_i = (cos q_i, sin q_i)

x points right and y down. Velocities and accelerations are the derivatives of the positions with
respect to time, nothing else: the textbook's ``diff(rC1, t)``.
"""

from __future__ import annotations

from functools import cached_property
from itertools import pairwise

from sympy import Expr, Integer, Symbol, cos, diff, expand, sin
from sympy.simplify.fu import TR8

from pendcore.derive.notation import Notation
from pendcore.derive.writing import ACCELERATION, ANGLE, RATE

Vector = tuple[Expr, Expr]
"""Components along x (right) and y (down)."""


def cross(a: Vector, b: Vector) -> Expr:
    """Return the z component of a x b."""
    return a[0] * b[1] - a[1] * b[0]


def dot(a: Vector, b: Vector) -> Expr:
    """Return the scalar product."""
    return a[0] * b[0] + a[1] * b[1]


def minus(a: Vector, b: Vector) -> Vector:
    """Return the difference."""
    return a[0] - b[0], a[1] - b[1]


def of_differences(expression: Expr) -> Expr:
    """Write products of sines and cosines as sines and cosines of sums: a normal form."""
    return expand(TR8(expand(expression)))


class Chain:
    """Where the links are and how they move, as expressions.

    Parameters
    ----------
    notation : Notation
        The symbols.
    path : (sympy.Expr, sympy.Expr)
        Position of the pivot, a function of time alone, m.

    Attributes
    ----------
    pivot : (sympy.Expr, sympy.Expr)
        The pivot's position as symbols, ``x_A`` and ``y_A``; 0 along an axis on which the pivot
        does not move.
    path : dict
        These symbols and their rates, ``xd_A`` to ``ydd_A``, each with its function of time.
    """

    def __init__(self, notation: Notation, path: Vector) -> None:
        self.notation = notation
        self.path: dict[Symbol, Expr] = {}
        self._rates: dict[Symbol, Expr] = {}
        x, y = (self._along(axis, law) for axis, law in zip("xy", path, strict=True))
        self.pivot: Vector = (x, y)

    def _along(self, axis: str, law: Expr) -> Expr:
        if law == 0:
            return law
        dots = {0: axis, 1: rf"\dot{{{axis}}}", 2: rf"\ddot{{{axis}}}"}
        symbols = [
            self.notation.symbol(
                f"{axis}{'d' * k}_A", f"{shown}_{{A}}", (ANGLE, RATE, ACCELERATION)[k]
            )
            for k, shown in dots.items()
        ]
        for k, symbol in enumerate(symbols):
            self.path[symbol] = law.diff(self.notation.t, k)
        self._rates |= dict(pairwise(symbols))
        return symbols[0]

    def rate(self, expression: Expr) -> Expr:
        """Differentiate with respect to time, of which angles, rates and pivot are functions."""
        s = self.notation
        moving = {s.t: Integer(1), **self._rates}
        moving |= {**dict(zip(s.q, s.qd, strict=True)), **dict(zip(s.qd, s.qdd, strict=True))}
        return sum((diff(expression, x) * rate for x, rate in moving.items()), Integer(0))

    def velocity(self, point: Vector) -> Vector:
        """Return the velocity of a point, m/s."""
        return expand(self.rate(point[0])), expand(self.rate(point[1]))

    def acceleration(self, point: Vector) -> Vector:
        """Return the acceleration of a point, m/s^2."""
        return self.velocity(self.velocity(point))

    @property
    def pivot_is_fixed(self) -> bool:
        """Whether the pivot stays at the origin."""
        return self.pivot == (0, 0)

    def along(self, link: int) -> Vector:
        """Return the unit vector along a link, u_i; links count from 1."""
        angle = self.notation.q[link - 1]
        return cos(angle), sin(angle)

    def across(self, link: int) -> Vector:
        """Return the unit vector across a link, n_i = du_i/dq_i."""
        angle = self.notation.q[link - 1]
        return -sin(angle), cos(angle)

    def joint_angle(self, joint: int) -> Expr:
        """Return the angle of a joint, phi_j = q_j - q_(j-1), rad."""
        return self._relative(self.notation.q, joint)

    def joint_rate(self, joint: int) -> Expr:
        """Return the rate of a joint, w_j = qd_j - qd_(j-1), rad/s."""
        return self._relative(self.notation.qd, joint)

    def joint_acceleration(self, joint: int) -> Expr:
        """Return the acceleration of a joint, rad/s^2."""
        return self._relative(self.notation.qdd, joint)

    @cached_property
    def joints(self) -> tuple[Vector, ...]:
        """P_0, ..., P_n: pivot, joints and tip, m."""
        points = [self.pivot]
        for i, length in enumerate(self.notation.lengths, start=1):
            points.append(self._beyond(points[-1], i, length))
        return tuple(points)

    @cached_property
    def centers(self) -> tuple[Vector, ...]:
        """C_1, ..., C_n: mass centres of the links, m."""
        return tuple(
            self._beyond(self.joints[i - 1], i, distance)
            for i, distance in enumerate(self.notation.centers, start=1)
        )

    @cached_property
    def joint_velocities(self) -> tuple[Vector, ...]:
        """The velocities of P_0, ..., P_n, m/s."""
        return tuple(map(self.velocity, self.joints))

    @cached_property
    def center_velocities(self) -> tuple[Vector, ...]:
        """The velocities of C_1, ..., C_n, m/s."""
        return tuple(map(self.velocity, self.centers))

    @cached_property
    def center_accelerations(self) -> tuple[Vector, ...]:
        """The accelerations of C_1, ..., C_n, m/s^2."""
        return tuple(map(self.velocity, self.center_velocities))

    @cached_property
    def tip_acceleration(self) -> Vector:
        """The acceleration of P_n, where a payload is, m/s^2."""
        return self.velocity(self.joint_velocities[-1])

    def _beyond(self, point: Vector, link: int, distance: Expr) -> Vector:
        along = self.along(link)
        return point[0] + distance * along[0], point[1] + distance * along[1]

    @staticmethod
    def _relative(absolute: tuple[Symbol, ...], joint: int) -> Expr:
        return absolute[joint - 1] - (absolute[joint - 2] if joint > 1 else 0)
