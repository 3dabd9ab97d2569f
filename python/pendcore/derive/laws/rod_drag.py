"""Air drag along a rod: f(s) = -k abs(w) w across it, k = rho C_d d / 2.

w(s) = w_0 + (w_1 - w_0) s/L is the speed across the rod relative to the wind; w_0 and w_1 are the
speeds of its ends. The resultant F (across the rod) and the moment T about the joint where the rod
begins are integrals of f. With D = abs(w_0) + abs(w_1) they are, for all signs of w_0 and w_1:

    F = -k L   (w_0 + w_1)/D (w_0^2 + abs(w_0 w_1) + w_1^2) / 3
    T = -k L^2 ((w_0 abs(w_0)^3 + w_1 w_1^2 (4 abs(w_0) + 3 abs(w_1)))/D^2
                + 2 (w_0 w_1 + abs(w_0 w_1)) (w_0 + w_1)/D) / 12

F and T are as smooth as f: differentiable once, also where a speed changes its sign. As in the
core, 1e-100 m/s is added to D, so that a rod at rest has no drag instead of 0/0.
"""

from __future__ import annotations

from typing import Any

from sympy import Abs, Expr, Integer, Symbol

from pendcore.derive.chain import Chain, Vector, dot, minus
from pendcore.derive.laws.law import Definition, Law, LinkLoad
from pendcore.derive.notation import Notation
from pendcore.derive.writing import RATE

AT_REST = 1e-100
"""The speed that keeps D from 0, m/s."""


class RodDrag(Law):
    """See the core's effect of that name; its power is F n . v + T qd."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        self.link = i = int(effect.link)

        def parameter(name: str, latex: str, value: float, unit: str, meaning: str) -> Symbol:
            return notation.parameter(f"{name}_{i}", f"{latex}{i}}}", value, unit, meaning)

        drag, diameter, density = effect.drag_coefficient, effect.diameter, effect.air_density
        words = f"drag coefficient of rod {i}"
        self.coefficient = parameter("Cd", "C_{d,", drag, "1", words)
        self.diameter = parameter("d", "d_{", diameter, "m", f"diameter of rod {i}")
        words = f"density of the air around rod {i}"
        self.density = parameter("rho", r"\rho_{", density, "kg/m^3", words)
        self.wind = tuple(
            parameter(f"v{axis}", f"v_{{{axis},", v, "m/s", f"wind along {axis} at rod {i}")
            if v != 0.0
            else Integer(0)
            for axis, v in zip("xy", effect.wind, strict=True)
        )
        words = "avoids 0/0 for a rod at rest"
        self.at_rest = parameter("eps", r"\varepsilon_{", AT_REST, "m/s", words)
        self.w0, self.w1, self.force, self.moment = (
            notation.symbol(*notation.fresh(f"{name}_{i}", f"{latex},{i}}}"))
            for name, latex in (("w0", "w_{0"), ("w1", "w_{1"), ("Fd", "F_{d"), ("Td", "T_{d"))
        )

    def statement(self) -> str:
        """Return the law of a length of the rod, and what stands for the integrals of it."""
        i, write = self.link, self.notation.latex
        w = self.notation.symbol("w", "w", RATE)
        law = write(-self.density * self.coefficient * self.diameter * Abs(w) * w / 2)
        air = f"the wind $({', '.join(map(write, self.wind))})$" if any(self.wind) else "the air"
        return (
            f"The air resists the motion of link {i}: the force on each length $\\mathrm{{d}}s$ of "
            f"the rod is ${law}\\,\\mathrm{{d}}s$ along the unit vector $\\mathbf{{n}}_{{{i}}} = "
            f"(-\\sin q_{{{i}}}, \\cos q_{{{i}}})$ across the rod, where $w$ is the speed of that "
            f"length along $\\mathbf{{n}}_{{{i}}}$ relative to {air}. It is ${write(self.w0)}$ where "
            f"the link begins, ${write(self.w1)}$ where the link ends, and linear between them. The "
            f"sum of these forces is ${write(self.force)}\\,\\mathbf{{n}}_{{{i}}}$, and "
            f"${write(self.moment)}$ is the sum of their moments about the begin of the link."
        )

    def definitions(self, chain: Chain) -> tuple[Definition, ...]:
        """Return the speeds of the ends, and the integrals F and T."""
        i, s, w0, w1 = self.link, self.notation, self.w0, self.w1
        length = s.lengths[i - 1]
        near = dot(chain.across(i), minus(chain.joint_velocities[i - 1], self.wind))
        k = self.density * self.coefficient * self.diameter / 2
        size = Abs(w0) + Abs(w1) + self.at_rest
        direction = (w0 + w1) / size
        force = -k * length / 3 * direction * (w0**2 + Abs(w0) * Abs(w1) + w1**2)
        ends = w0 * Abs(w0) ** 3 + w1**3 * (4 * Abs(w0) + 3 * Abs(w1))
        between = 2 * (w0 * w1 + Abs(w0) * Abs(w1)) * direction
        moment = -k * length**2 / 12 * (ends / size**2 + between)
        begins, rod = f"where rod {i} begins", f"rod {i}"
        return (
            Definition(w0, near, f"speed across the rod {begins}, relative to the wind, m/s"),
            Definition(w1, w0 + length * s.qd[i - 1], f"the same where {rod} ends, m/s"),
            Definition(self.force, force, f"drag on {rod}, across it, N"),
            Definition(self.moment, moment, f"its moment about the joint {begins}, N m"),
        )

    def load(self, chain: Chain) -> LinkLoad:
        """Return F across the rod, and T."""
        x, y = chain.across(self.link)
        return LinkLoad(self.link, (self.force * x, self.force * y), self.moment)

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the powers of F, at the joint where the rod begins, and of T."""
        speed = dot(chain.across(self.link), chain.joint_velocities[self.link - 1])
        return self.force * speed + self.moment * self.notation.qd[self.link - 1]
