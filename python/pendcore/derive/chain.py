"""Kinematics of the chain: positions, velocities and accelerations of its joints and mass centres.

    P_0 = (x_0, y_0),  P_i = P_(i-1) + L_i u_i,  C_i = P_(i-1) + c_i u_i,  u_i = (cos q_i, sin q_i)

x points right and y down. Velocities and accelerations are the derivatives of the positions with
respect to time, nothing else: the textbook's ``diff(rC1, t)``.
"""

from __future__ import annotations

from itertools import pairwise

from sympy import Expr, Integer, Symbol, cos, diff, expand, sin
from sympy.simplify.fu import TR8

from pendcore.derive.notation import Notation

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


def across(angle: Expr) -> Vector:
    """Return the unit vector across a link, n = du/dq."""
    return -sin(angle), cos(angle)


def of_differences(expression: Expr) -> Expr:
    """Write products of sines and cosines as sines and cosines of sums: a normal form."""
    return expand(TR8(expand(expression)))


class Chain:
    """Where the links are and how they move, as expressions.

    ``path`` is the position of the pivot, a function of time alone, m. The pivot itself is given by
    symbols, ``x_A`` and ``y_A``, or 0 along an axis on which it does not move; the attribute
    ``path`` holds these symbols and those of their rates, each with its function of time.

    Attributes
    ----------
    pivot_is_fixed : bool
        Whether the pivot stays at the origin.
    joints, joint_velocities : list of (Expr, Expr)
        P_0, ..., P_n, the pivot, joints and tip, m, and their velocities, m/s.
    centers, center_velocities, center_accelerations : list of (Expr, Expr)
        C_1, ..., C_n, the mass centres, m, their velocities, m/s, and accelerations, m/s^2.
    """

    def __init__(self, notation: Notation, path: Vector) -> None:
        self.notation = s = notation
        self.path: dict[Symbol, Expr] = {}
        self._rates: dict[Symbol, Expr] = {s.t: Integer(1)}
        self._rates |= zip((*s.q, *s.qd), (*s.qd, *s.qdd), strict=True)
        pivot: Vector = self._along("x", path[0]), self._along("y", path[1])
        self.pivot_is_fixed = pivot == (0, 0)
        self.joints, self.centers = [pivot], list[Vector]()
        for angle, length, center in zip(s.q, s.lengths, s.centers, strict=True):
            x, y = self.joints[-1]
            for points, distance in ((self.joints, length), (self.centers, center)):
                points.append((x + distance * cos(angle), y + distance * sin(angle)))
        self.joint_velocities = [*map(self.velocity, self.joints)]
        self.center_velocities = [*map(self.velocity, self.centers)]
        self.center_accelerations = [*map(self.velocity, self.center_velocities)]

    def _along(self, axis: str, law: Expr) -> Expr:
        if law == 0:
            return law
        symbols = self.notation.moving(axis, "_A", "A")
        for k, (symbol, unit) in enumerate(zip(symbols, ("m", "m/s", "m/s^2"), strict=True)):
            self.path[symbol] = law.diff(self.notation.t, k)
            self.notation.meanings[symbol] = f"motion of the pivot, {unit}"
        self._rates |= dict(pairwise(symbols))
        return symbols[0]

    def rate(self, expression: Expr) -> Expr:
        """Differentiate with respect to time, of which angles, rates and pivot are functions."""
        return sum((diff(expression, x) * rate for x, rate in self._rates.items()), Integer(0))

    def velocity(self, point: Vector) -> Vector:
        """Return the velocity of a point, m/s."""
        return expand(self.rate(point[0])), expand(self.rate(point[1]))

    def joint(self, joint: int) -> tuple[Expr, Expr, Expr]:
        """Return phi_j = q_j - q_(j-1) of a joint, rad, its rate, and its acceleration."""
        s, i = self.notation, joint - 1
        phi, w, a = (x[i] - (x[i - 1] if i else 0) for x in (s.q, s.qd, s.qdd))
        return phi, w, a
