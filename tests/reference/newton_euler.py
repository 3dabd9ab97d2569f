"""The equations of motion of a planar chain, link by link, with the joint forces as unknowns.

For every link i of the chain, as in the textbook's Eqs. (2.3) and (2.4), with y downward:

    m_i a_Ci     = F_(i-1,i) - F_(i,i+1) + m_i g e_y + F_ext,i
    I_i alpha_i  = r_(Ci,P(i-1)) x F_(i-1,i) - r_(Ci,P(i)) x F_(i,i+1) + tau_i - tau_(i+1) + T_ext,i

F_(i-1,i) is the force on link i from link i-1 (the ground, for i = 1); beyond the tip it is zero,
or the force on a payload: a body of its own there, with equations of its own, welded on by an
unknown force and an unknown couple. A locked joint has an unknown couple and one equation more,
alpha_i = alpha_(i-1). A rotor takes the couple J (alpha_i - alpha_(i-1)) to turn.

The mass-centre accelerations follow from the angles by differentiating the positions twice. That
makes a linear system for the angular accelerations and all that is unknown in the joints. It is
solved as it stands: nothing is eliminated by hand, so there is no algebra here to get wrong.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from reference.arithmetic import Arithmetic, Number
from reference.loads import Loads, Sum, Vector


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
    holding: dict[int, Number]
    """Couple of each locked joint on the link beyond it, N m."""


class Equations(NamedTuple):
    """A linear system, and how large the terms are that its right side is added up from.

    The unknowns are the n angular accelerations, the 2 n components of the joint forces, and what
    holds payloads and locked joints.
    """

    matrix: list[list[Number]]
    right: list[Sum]

    def solve(self, arithmetic: Arithmetic) -> list[Number]:
        """Solve the system."""
        return arithmetic.solve(self.matrix, [side.value for side in self.right])

    def sizes(self, unknowns: Sequence[Number]) -> NDArray[np.float64]:
        """How far the unknowns change if every term changes by as much as itself.

        That is |K^-1| (|K| |x| + size of the right side): Skeel's condition. A result
        from terms that are off by a part in 10^12 is off by 10^-12 of these sizes.
        """
        x = np.abs(np.array(unknowns, dtype=float))
        return self.reach(magnitudes(self.matrix) @ x + [float(side.size) for side in self.right])

    def reach(self, terms: NDArray[np.float64]) -> NDArray[np.float64]:
        """How far the unknowns change if the lines change by `terms`, whatever the signs."""
        matrix = magnitudes(self.matrix)
        # Columns and rows of very different units are brought to one size before inverting.
        columns = matrix.max(axis=0)
        rows = (matrix / columns).max(axis=1)
        signed = np.array(self.matrix, dtype=float)
        inverse = np.linalg.inv(signed / columns / rows[:, np.newaxis])
        return np.abs(inverse) @ (terms / rows) / columns


def magnitudes(numbers: Sequence[Sequence[Number]]) -> NDArray[np.float64]:
    """The magnitudes of a matrix of any numbers."""
    return np.abs(np.array(numbers, dtype=float))


def chain_equations(
    bodies: Sequence[Body],
    gravity: float,
    q: Sequence[float],
    qd: Sequence[float],
    loads: Loads,
    arithmetic: Arithmetic,
) -> Equations:
    """Write the equations of every link, payload and locked joint, from the ground to the tip.

    Gravity pulls towards +y, m/s^2; q are absolute angles from +x towards +y, rad, and qd their
    rates, rad/s.
    """
    number, zero, one = arithmetic.number, arithmetic.number(0), arithmetic.number(1)
    links = [Body(*map(number, body)) for body in bodies]
    n, g = len(links), number(gravity)
    along = [(arithmetic.cos(number(angle)), arithmetic.sin(number(angle))) for angle in q]
    across = [(-sine, cosine) for cosine, sine in along]
    towards_pivot = [[x * number(rate) ** 2 for x in u] for u, rate in zip(along, qd, strict=True)]
    payload = 3 * n  # the first of three columns each: force and couple on it
    lock = payload + 3 * len(loads.payloads)
    unknowns = lock + len(loads.locked)
    matrix: list[list[Number]] = []
    right: list[Sum] = []

    def blank() -> tuple[list[Number], Sum]:
        matrix.append([zero] * unknowns)
        right.append(Sum(zero, zero))
        return matrix[-1], right[-1]

    def inertial(row: list[Number], side: Sum, body: Body, last: int, axis: int) -> None:
        """Mass times acceleration of a point on link ``last``, and the weight."""
        for k in range(last + 1):
            moment = body.mass * (links[k].length if k < last else body.center)
            row[k] = moment * across[k][axis]
            side.add(moment * towards_pivot[k][axis])
        side.add(-body.mass * loads.pivot_acceleration[axis], body.mass * loads.pivot_size)
        side.add(body.mass * g * axis)

    for i, link in enumerate(links):
        near = n + 2 * i  # the first column of the force on this link
        beyond = [near + 2] if i + 1 < n else [payload + 3 * p for p in range(len(loads.payloads))]
        for axis in (0, 1):
            row, side = blank()
            inertial(row, side, link, i, axis)
            row[near + axis] = -one
            for column in beyond:
                row[column + axis] = one
            side.add(loads.forces[i][axis].value, loads.forces[i][axis].size)

        # The two arms from the mass centre: back to the nearer joint, on to the farther one.
        back, on = -link.center, link.length - link.center
        row, side = blank()
        row[i] += link.inertia
        row[near], row[near + 1] = back * along[i][1], -back * along[i][0]
        for column in beyond:
            row[column], row[column + 1] = -on * along[i][1], on * along[i][0]
        if i + 1 == n:
            for column in beyond:
                row[column + 2] = one
        side.add(loads.couples[i].value, loads.couples[i].size)
        for joint, sign in ((i, one), (i + 1, -one)):
            if joint == n:
                continue
            row[joint] += sign * loads.armatures[joint]
            if joint > 0:
                row[joint - 1] -= sign * loads.armatures[joint]
            if joint + 1 in loads.locked:
                row[lock + sorted(loads.locked).index(joint + 1)] = -sign

    for p, (mass, inertia) in enumerate(loads.payloads):
        column = payload + 3 * p
        body = Body(number(mass), zero, links[-1].length, number(inertia))
        for axis in (0, 1):
            row, side = blank()
            inertial(row, side, body, n - 1, axis)
            row[column + axis] = -one
        row, _ = blank()
        row[n - 1], row[column + 2] = body.inertia, -one

    for joint in sorted(loads.locked):
        row, _ = blank()
        row[joint - 1] = one
        if joint > 1:
            row[joint - 2] = -one
    return Equations(matrix, right)


def motion_of(
    unknowns: Sequence[Number],
    bodies: Sequence[Body],
    q: Sequence[float],
    qd: Sequence[float],
    loads: Loads,
    arithmetic: Arithmetic,
) -> Motion:
    """Name the unknowns, and differentiate the positions of the mass centres with them."""
    n, number = len(bodies), arithmetic.number
    held = sorted(loads.locked)
    holding = dict(zip(held, unknowns[len(unknowns) - len(held) :], strict=True))
    reactions = [(unknowns[n + 2 * i], unknowns[n + 2 * i + 1]) for i in range(n)]
    centers = []
    x, y = loads.pivot_acceleration
    for body, angle, rate, turning in zip(bodies, q, qd, unknowns[:n], strict=True):
        cosine, sine = arithmetic.cos(number(angle)), arithmetic.sin(number(angle))
        w2 = number(rate) ** 2
        per_metre = (-sine * turning - cosine * w2, cosine * turning - sine * w2)
        center, length = number(body.center), number(body.length)
        centers.append((x + center * per_metre[0], y + center * per_metre[1]))
        x, y = x + length * per_metre[0], y + length * per_metre[1]
    return Motion(list(unknowns[:n]), reactions, centers, holding)
