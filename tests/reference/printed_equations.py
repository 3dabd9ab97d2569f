"""The equations of the textbook's section 2.1 as printed, and those of its MATLAB program.

Every function returns the left-hand side of an equation minus its right-hand side, for any angles,
rates, accelerations and forces: the equation holds where that is zero. The text says that y points
downward. An equation that holds only for y upward is one that agrees with a motion under -g.

(2.10) and (2.11) can be mended by three `Repairs`; `printed_accelerations` solves them.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import cos, sin

import numpy as np

Force = tuple[float, float]


@dataclass(frozen=True, slots=True, kw_only=True)
class Pendulum:
    """The two uniform rods of section 2.1; (2.5) prints m_2 as m, which is read as m_2 here."""

    m1: float = 1.0
    m2: float = 1.0
    L1: float = 1.0
    L2: float = 1.0
    g: float = 9.807


@dataclass(frozen=True, slots=True, kw_only=True)
class Repairs:
    """The repairs of (2.10) and (2.11) that are made; none by default."""

    weight_of_link_1: bool = False  # (2.10): +m_1 g L_1/2 cos q_1 for y downward
    mass_of_link_1: bool = False  # (2.10): m_1 L_1^2/3
    sign_of_moment: bool = False  # (2.11): both terms on the right change sign


AS_PRINTED = Repairs()
ALL_REPAIRS = Repairs(weight_of_link_1=True, mass_of_link_1=True, sign_of_moment=True)


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """Angles, rates and accelerations of the two links, and the force of link 2 on link 1."""

    q1: float
    q2: float
    w1: float
    w2: float
    a1: float
    a2: float
    F21: Force = (0.0, 0.0)


Equation = Callable[[Pendulum, Instant], float]


def center_2_acceleration(p: Pendulum, s: Instant) -> tuple[float, float]:
    """Return the acceleration of C_2 as in the text, which prints it without error."""
    x = -p.L1 * (s.a1 * sin(s.q1) + s.w1**2 * cos(s.q1))
    x -= p.L2 / 2 * (s.a2 * sin(s.q2) + s.w2**2 * cos(s.q2))
    y = p.L1 * (s.a1 * cos(s.q1) - s.w1**2 * sin(s.q1))
    y += p.L2 / 2 * (s.a2 * cos(s.q2) - s.w2**2 * sin(s.q2))
    return x, y


def cross(a: tuple[float, float], b: tuple[float, float]) -> float:
    """Return the z component of a x b."""
    return a[0] * b[1] - a[1] * b[0]


def determinant_of_2_1(p: Pendulum, s: Instant) -> float:
    """Moments about A, as the determinants under (2.1) have them."""
    center = (p.L1 / 2 * cos(s.q1), p.L1 / 2 * sin(s.q1))
    joint = (p.L1 * cos(s.q1), p.L1 * sin(s.q1))
    return p.m1 * p.L1**2 / 3 * s.a1 - (cross(center, (0, -p.m1 * p.g)) + cross(joint, s.F21))


def equation_2_2(p: Pendulum, s: Instant) -> float:
    """Link 1."""
    moment = -p.m1 * p.g * p.L1 / 2 * cos(s.q1)
    moment += s.F21[1] * p.L1 * cos(s.q1) - s.F21[0] * p.L1 * sin(s.q1)
    return p.m1 * p.L1**2 / 3 * s.a1 - moment


def x_line_of_2_5(p: Pendulum, s: Instant) -> float:
    """Forces on link 2 along x; (2.6) is the same with the acceleration written out."""
    return p.m2 * center_2_acceleration(p, s)[0] + s.F21[0]


def y_line_of_2_5(p: Pendulum, s: Instant) -> float:
    """Forces on link 2 along y; (2.7) is the same with the acceleration written out."""
    return p.m2 * center_2_acceleration(p, s)[1] - (-s.F21[1] - p.m2 * p.g)


def determinant_of_2_5(p: Pendulum, s: Instant) -> float:
    """Moments about C_2, as the determinant in (2.5) has them."""
    arm = (-p.L2 / 2 * cos(s.q2), -p.L2 / 2 * sin(s.q2))
    return p.m2 * p.L2**2 / 12 * s.a2 - cross(arm, (-s.F21[0], -s.F21[1]))


def equation_2_8(p: Pendulum, s: Instant) -> float:
    """Moments about C_2, written out."""
    moment = p.L2 / 2 * (-s.F21[1] * cos(s.q2) + s.F21[0] * sin(s.q2))
    return p.m2 * p.L2**2 / 12 * s.a2 - moment


def x_line_of_2_9(p: Pendulum, s: Instant) -> float:
    """The force between the links along x."""
    return s.F21[0] + p.m2 * center_2_acceleration(p, s)[0]


def y_line_of_2_9(p: Pendulum, s: Instant) -> float:
    """The force between the links along y."""
    return s.F21[1] - (-p.m2 * center_2_acceleration(p, s)[1] + p.m2 * p.g)


def equation_2_10(p: Pendulum, s: Instant, repairs: Repairs = AS_PRINTED) -> float:
    """Link 1 with the force between the links put in."""
    x, y = center_2_acceleration(p, s)
    mass = p.m1 if repairs.mass_of_link_1 else p.m2
    weight = -p.m1 * p.g * p.L1 / 2 * cos(s.q1)
    if repairs.weight_of_link_1:
        weight = -weight
    right = weight - p.m2 * (y - p.g) * p.L1 * cos(s.q1) - p.m2 * -x * p.L1 * sin(s.q1)
    return mass * p.L1**2 / 3 * s.a1 - right


def equation_2_11(p: Pendulum, s: Instant, repairs: Repairs = AS_PRINTED) -> float:
    """Link 2 with the force between the links put in."""
    x, y = center_2_acceleration(p, s)
    right = p.m2 * p.L2 / 2 * ((y - p.g) * cos(s.q2) + -x * sin(s.q2))
    if repairs.sign_of_moment:
        right = -right
    return p.m2 * p.L2**2 / 12 * s.a2 - right


def program_link_1(p: Pendulum, s: Instant) -> float:
    """EqA of the program, with its F21 and G1."""
    x, y = center_2_acceleration(p, s)
    F21 = (-p.m2 * x, -p.m2 * y + p.m2 * p.g)
    joint = (p.L1 * cos(s.q1), p.L1 * sin(s.q1))
    center = (joint[0] / 2, joint[1] / 2)
    inertia = p.m1 * p.L1**2 / 12 + p.m1 * (p.L1 / 2) ** 2
    return -inertia * s.a1 + cross(joint, F21) + cross(center, (0, p.m1 * p.g))


def program_link_2(p: Pendulum, s: Instant) -> float:
    """Eq2 of the program."""
    x, y = center_2_acceleration(p, s)
    minus_F21 = (p.m2 * x, p.m2 * y - p.m2 * p.g)
    arm = (-p.L2 / 2 * cos(s.q2), -p.L2 / 2 * sin(s.q2))
    return -p.m2 * p.L2**2 / 12 * s.a2 + cross(arm, minus_F21)


Residuals = Callable[[Instant], tuple[float, float]]
Matrix = list[list[float]]


def _linear_system(residuals: Residuals, q: Force, qd: Force) -> tuple[Matrix, list[float]]:
    """Matrix and right-hand side of two equations that are linear in the accelerations."""

    def at(a1: float, a2: float) -> tuple[float, float]:
        return residuals(Instant(q1=q[0], q2=q[1], w1=qd[0], w2=qd[1], a1=a1, a2=a2))

    constant, first, second = at(0, 0), at(1, 0), at(0, 1)
    matrix = [[first[i] - constant[i], second[i] - constant[i]] for i in (0, 1)]
    return matrix, [-constant[0], -constant[1]]


def printed_accelerations(
    p: Pendulum, q: Force, qd: Force, repairs: Repairs = AS_PRINTED
) -> tuple[float, float]:
    """Solve (2.10) and (2.11) for the angular accelerations."""
    system = _linear_system(
        lambda s: (equation_2_10(p, s, repairs), equation_2_11(p, s, repairs)), q, qd
    )
    a1, a2 = np.linalg.solve(*system)
    return float(a1), float(a2)


def program_accelerations(p: Pendulum, q: Force, qd: Force) -> tuple[float, float]:
    """Solve EqA and Eq2 of the program for the angular accelerations."""
    system = _linear_system(lambda s: (program_link_1(p, s), program_link_2(p, s)), q, qd)
    a1, a2 = np.linalg.solve(*system)
    return float(a1), float(a2)
