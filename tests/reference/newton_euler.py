"""The equations of motion of a planar chain, link by link, with the joint forces as unknowns.

For every link i of the chain, as in the textbook's Eqs. (2.3) and (2.4), with y downward:

    m_i a_Ci     = F_(i-1,i) - F_(i,i+1) + m_i g e_y
    I_i alpha_i  = r_(Ci,P(i-1)) x F_(i-1,i) - r_(Ci,P(i)) x F_(i,i+1) + tau_i - tau_(i+1)

F_(i-1,i) is the force on link i from link i-1 (the ground, for i = 1); beyond the tip it is zero.
The mass-centre accelerations follow from the angles by differentiating the positions twice. That
makes 3 n linear equations for the n angular accelerations and the 2 n force components. They are
solved as they stand: nothing is eliminated by hand, so there is no algebra here to get wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from reference.arithmetic import DOUBLE, Arithmetic, Number

Vector = tuple[Number, Number]


class Body(NamedTuple):
    """A link: its mass, its length, and its mass centre and inertia about that centre."""

    mass: float
    length: float
    center: float
    inertia: float


def uniform_rod(mass: float, length: float) -> Body:
    """A slender uniform rod."""
    return Body(mass, length, length / 2, mass * length * length / 12)


class Motion(NamedTuple):
    """What the equations determine at one instant; a vector is (x, y), y downward."""

    accelerations: list[Number]
    """Angular accelerations of the links, rad/s^2."""
    reactions: list[Vector]
    """Force on each link at the joint nearer to the ground, N."""
    center_accelerations: list[Vector]
    """Accelerations of the mass centres, m/s^2."""


def newton_euler(
    bodies: Sequence[Body],
    gravity: float,
    q: Sequence[float],
    qd: Sequence[float],
    *,
    couples: Sequence[float] | None = None,
    arithmetic: Arithmetic = DOUBLE,
) -> Motion:
    """Solve the Newton-Euler equations of a chain.

    Parameters
    ----------
    bodies
        The links, from the ground to the tip.
    gravity
        Acceleration of gravity towards +y, m/s^2.
    q, qd
        Absolute angles from +x towards +y, rad, and their rates, rad/s.
    couples
        Couple at each joint on the link beyond it (its opposite acts on the link before), N m.
    arithmetic
        Doubles or multiple precision.

    Returns
    -------
    Motion
        Angular accelerations, joint forces and mass-centre accelerations.
    """
    number, zero = arithmetic.number, arithmetic.number(0)
    links = [Body(*map(number, body)) for body in bodies]
    n, g = len(links), number(gravity)
    rates = [number(w) for w in qd]
    along = [(arithmetic.cos(number(angle)), arithmetic.sin(number(angle))) for angle in q]
    across = [(-sine, cosine) for cosine, sine in along]
    torques = [number(c) for c in (couples if couples is not None else [0] * n)] + [zero]

    def arm(i: int, k: int) -> Number:
        """How far along link k the mass centre of link i lies."""
        return links[k].length if k < i else links[i].center

    def force(i: int, axis: int) -> int:
        """The column of a component of the force on link i at its nearer joint."""
        return n + 2 * i + axis

    matrix: list[list[Number]] = []
    right: list[Number] = []
    for i, link in enumerate(links):
        for axis in (0, 1):
            row = [zero] * (3 * n)
            for k in range(i + 1):
                row[k] = link.mass * arm(i, k) * across[k][axis]
            row[force(i, axis)] = -number(1)
            if i + 1 < n:
                row[force(i + 1, axis)] = number(1)
            towards_axis = [arm(i, k) * along[k][axis] * rates[k] ** 2 for k in range(i + 1)]
            weight = link.mass * g if axis == 1 else zero
            matrix.append(row)
            right.append(weight + link.mass * sum(towards_axis, zero))

        # The two arms from the mass centre: back to the nearer joint, on to the farther one.
        back, on = -link.center, link.length - link.center
        row = [zero] * (3 * n)
        row[i] = link.inertia
        row[force(i, 0)], row[force(i, 1)] = back * along[i][1], -back * along[i][0]
        if i + 1 < n:
            row[force(i + 1, 0)], row[force(i + 1, 1)] = -on * along[i][1], on * along[i][0]
        matrix.append(row)
        right.append(torques[i] - torques[i + 1])

    unknowns = arithmetic.solve(matrix, right)
    accelerations = unknowns[:n]
    reactions = [(unknowns[force(i, 0)], unknowns[force(i, 1)]) for i in range(n)]

    def center_acceleration(i: int, axis: int) -> Number:
        terms = (
            arm(i, k) * (across[k][axis] * accelerations[k] - along[k][axis] * rates[k] ** 2)
            for k in range(i + 1)
        )
        return sum(terms, zero)

    centers = [(center_acceleration(i, 0), center_acceleration(i, 1)) for i in range(n)]
    return Motion(accelerations, reactions, centers)
