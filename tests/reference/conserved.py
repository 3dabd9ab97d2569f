"""What a free chain keeps: energy, and without gravity angular momentum; summed link by link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from reference.arithmetic import DOUBLE, Arithmetic, Number
from reference.instant import Instant
from reference.newton_euler import Body


class Energy(NamedTuple):
    """Kinetic and potential energy, J; the potential is zero at the height of the pivot."""

    kinetic: Number
    potential: Number


def energy_of_links(instant: Instant) -> Energy:
    """Sum m v^2/2 + I w^2/2 and -m g y over the links."""
    number = instant.arithmetic.number
    kinetic = potential = number(0)
    for link, body in enumerate(instant.bodies, start=1):
        center = instant.mass_center(link)
        mass, w = number(body.mass), number(instant.qd[link - 1])
        kinetic += mass * (center.vx**2 + center.vy**2) / 2 + number(body.inertia) * w * w / 2
        potential -= mass * number(instant.gravity) * center.y
    return Energy(kinetic, potential)


def mass_centers(
    bodies: Sequence[Body],
    q: Sequence[float],
    qd: Sequence[float],
    arithmetic: Arithmetic = DOUBLE,
) -> list[tuple[Number, Number, Number, Number]]:
    """Return position and velocity (x, y, vx, vy) of every mass centre, y downward."""
    instant = Instant(bodies=bodies, gravity=0.0, q=q, qd=qd, arithmetic=arithmetic)
    return [instant.mass_center(link) for link in range(1, len(bodies) + 1)]


def energy(
    bodies: Sequence[Body],
    gravity: float,
    q: Sequence[float],
    qd: Sequence[float],
    arithmetic: Arithmetic = DOUBLE,
) -> Energy:
    """Sum m v^2/2 + I w^2/2 and -m g y over the links of a chain with a fixed pivot."""
    return energy_of_links(
        Instant(bodies=bodies, gravity=gravity, q=q, qd=qd, arithmetic=arithmetic)
    )


def angular_momentum(
    bodies: Sequence[Body],
    q: Sequence[float],
    qd: Sequence[float],
    arithmetic: Arithmetic = DOUBLE,
) -> Number:
    """Sum m (x vy - y vx) + I w over the links: the momentum about the pivot, from x towards y."""
    number = arithmetic.number
    total = number(0)
    centers = mass_centers(bodies, q, qd, arithmetic)
    for body, rate, (x, y, vx, vy) in zip(bodies, qd, centers, strict=True):
        total += number(body.mass) * (x * vy - y * vx) + number(body.inertia) * number(rate)
    return total
