"""What a free chain keeps: energy, and without gravity angular momentum; summed link by link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from reference.arithmetic import DOUBLE, Arithmetic, Number
from reference.newton_euler import Body


class Energy(NamedTuple):
    """Kinetic and potential energy, J; the potential is zero at the height of the pivot."""

    kinetic: Number
    potential: Number


def mass_centers(
    bodies: Sequence[Body],
    q: Sequence[float],
    qd: Sequence[float],
    arithmetic: Arithmetic = DOUBLE,
) -> list[tuple[Number, Number, Number, Number]]:
    """Return position and velocity (x, y, vx, vy) of every mass centre, y downward."""
    number = arithmetic.number
    x = y = vx = vy = number(0)
    centers = []
    for body, angle, rate in zip(bodies, q, qd, strict=True):
        cosine, sine = arithmetic.cos(number(angle)), arithmetic.sin(number(angle))
        w, center, length = number(rate), number(body.center), number(body.length)
        centers.append(
            (
                x + center * cosine,
                y + center * sine,
                vx - center * w * sine,
                vy + center * w * cosine,
            )
        )
        x, y = x + length * cosine, y + length * sine
        vx, vy = vx - length * w * sine, vy + length * w * cosine
    return centers


def energy(
    bodies: Sequence[Body],
    gravity: float,
    q: Sequence[float],
    qd: Sequence[float],
    arithmetic: Arithmetic = DOUBLE,
) -> Energy:
    """Sum m v^2/2 + I w^2/2 and -m g y over the links."""
    number = arithmetic.number
    kinetic = potential = number(0)
    centers = mass_centers(bodies, q, qd, arithmetic)
    for body, rate, (_, y, vx, vy) in zip(bodies, qd, centers, strict=True):
        mass, w = number(body.mass), number(rate)
        kinetic += mass * (vx * vx + vy * vy) / 2 + number(body.inertia) * w * w / 2
        potential -= mass * number(gravity) * y
    return Energy(kinetic, potential)


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
