"""Air drag on a thin rod: -k w abs(w) per length, across the rod.

w is the speed across the rod of its points against the wind, k = rho Cd d / 2. The force, its
moment and its power are integrals along the rod, done by Gauss-Legendre quadrature with three
points on each side of where w changes sign: exact, as w is linear along the rod.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise

from reference.arithmetic import Number
from reference.effects.law import Law
from reference.instant import Instant
from reference.loads import Loads
from reference.newton_euler import Motion


@dataclass(frozen=True, kw_only=True)
class RodDrag(Law):
    link: int
    drag_coefficient: float
    diameter: float
    air_density: float = 1.225
    wind: tuple[float, float] = (0.0, 0.0)

    def speed(self, instant: Instant, s: Number) -> Number:
        """Speed of a point of the rod against the wind, across the rod."""
        number, point, (nx, ny) = (
            instant.arithmetic.number,
            instant.point(self.link, s),
            instant.across(self.link),
        )
        return nx * (point.vx - number(self.wind[0])) + ny * (point.vy - number(self.wind[1]))

    def points(self, instant: Instant) -> Iterator[tuple[Number, Number]]:
        """Points of the rod and the weights with which they count in an integral along it."""
        number = instant.arithmetic.number
        length = number(instant.bodies[self.link - 1].length)
        start, end = self.speed(instant, 0), self.speed(instant, length)
        ends = [number(0), length]
        if start * end < 0:
            ends.insert(1, length * start / (start - end))
        offset = (number(3) / 5) ** number("0.5")
        for a, b in pairwise(ends):
            for x, weight in (
                (-offset, number(5) / 18),
                (0, number(4) / 9),
                (offset, number(5) / 18),
            ):
                yield (a + b) / 2 + x * (b - a) / 2, weight * (b - a)

    def force(self, instant: Instant, s: Number) -> Number:
        """Force across the rod per length."""
        number, w = instant.arithmetic.number, self.speed(instant, s)
        product = number(self.air_density) * number(self.drag_coefficient) * number(self.diameter)
        return -product / 2 * w * abs(w)

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

        def loss(s: Number) -> Number:
            return abs(self.force(instant, s) * self.speed(instant, s))

        lost = self.integral(instant, loss)
        return {"drag": lost, "wind": self.integral(instant, power) + lost}
