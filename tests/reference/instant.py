"""Where a chain is and how fast it moves at one instant: points, velocities, relative angles.

Links and joints count from 1; y points down.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from reference.arithmetic import DOUBLE, Arithmetic, Number
from reference.loads import Vector
from reference.newton_euler import Body


class PivotMotion(NamedTuple):
    """Where the pivot is, its velocity, its acceleration and the size of what makes that up."""

    position: Vector = (0, 0)
    velocity: Vector = (0, 0)
    acceleration: Vector = (0, 0)
    size: Number = 0

    def plus(self, other: PivotMotion) -> PivotMotion:
        """Return both motions, one added to the other."""
        pairs = zip(self[:3], other[:3], strict=True)
        added = [(a[0] + b[0], a[1] + b[1]) for a, b in pairs]
        return PivotMotion(*added, self.size + other.size)


AT_REST = PivotMotion()


class Place(NamedTuple):
    """Position and velocity of a point."""

    x: Number
    y: Number
    vx: Number
    vy: Number


@dataclass(frozen=True, slots=True, kw_only=True)
class Instant:
    """A chain in one state; a joint or link is given by its number."""

    bodies: Sequence[Body]
    gravity: float
    q: Sequence[Number]
    qd: Sequence[Number]
    t: Number = 0.0
    pivot: PivotMotion = AT_REST
    arithmetic: Arithmetic = DOUBLE
    directions: list[Vector] = field(init=False)
    joints: list[Place] = field(init=False)
    """The pivot, the joints, the tip."""

    def __post_init__(self) -> None:
        number, of = self.arithmetic.number, self.arithmetic
        along = [(of.cos(angle), of.sin(angle)) for angle in map(number, self.q)]
        object.__setattr__(self, "directions", along)
        place = Place(*map(number, (*self.pivot.position, *self.pivot.velocity)))
        object.__setattr__(self, "joints", [place])
        for link, body in enumerate(self.bodies, start=1):
            self.joints.append(self.point(link, body.length))

    def along(self, link: int) -> Vector:
        """Unit vector from the nearer joint of a link to the farther one."""
        return self.directions[link - 1]

    def across(self, link: int) -> Vector:
        """Unit vector in which the link moves as its angle grows."""
        cosine, sine = self.along(link)
        return -sine, cosine

    def point(self, link: int, distance: Number) -> Place:
        """Return the point of a link at a distance from its nearer joint."""
        number = self.arithmetic.number
        (ux, uy), (nx, ny) = self.along(link), self.across(link)
        joint, s, w = self.joints[link - 1], number(distance), number(self.qd[link - 1])
        return Place(
            joint.x + s * ux, joint.y + s * uy, joint.vx + s * w * nx, joint.vy + s * w * ny
        )

    def mass_center(self, link: int) -> Place:
        """Return the mass centre of a link."""
        return self.point(link, self.bodies[link - 1].center)

    def mass_centers(self) -> list[Place]:
        """Return those of all links."""
        return [self.mass_center(link) for link in range(1, len(self.bodies) + 1)]

    def relative(self, values: Sequence[Number], joint: int) -> Number:
        """What a joint sees of angles or rates: the difference to the link before."""
        number = self.arithmetic.number
        return number(values[joint - 1]) - (number(values[joint - 2]) if joint > 1 else 0)

    def relative_angle(self, joint: int) -> Number:
        """Angle of a joint, rad."""
        return self.relative(self.q, joint)

    def relative_rate(self, joint: int) -> Number:
        """Rate of a joint, rad/s."""
        return self.relative(self.qd, joint)
