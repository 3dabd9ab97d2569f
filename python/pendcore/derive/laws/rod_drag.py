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

AT_REST = 1e-100
"""The speed that keeps D from 0, m/s."""


class RodDrag(Law):
    """See the core's effect of that name; its power is F n . v + T qd."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        i, parameter = effect.link, notation.parameter
        rod = f"of rod {i}"
        self.coefficient = parameter(
            f"Cd_{i}", f"C_{{d,{i}}}", effect.drag_coefficient, "1", f"drag coefficient {rod}"
        )
        self.diameter = parameter(f"d_{i}", f"d_{{{i}}}", effect.diameter, "m", f"diameter {rod}")
        self.density = parameter(
            f"rho_{i}", rf"\rho_{{{i}}}", effect.air_density, "kg/m^3",
            f"density of the air around rod {i}",
        )  # fmt: skip
        self.wind = tuple(
            parameter(f"v{a}_{i}", f"v_{{{a},{i}}}", v, "m/s", f"wind along {a} at rod {i}")
            if v != 0.0
            else Integer(0)
            for a, v in zip("xy", effect.wind, strict=True)
        )
        self.at_rest = parameter(
            f"eps_{i}", rf"\varepsilon_{{{i}}}", AT_REST, "m/s", "avoids 0/0 for a rod at rest"
        )
        self._names: dict[str, Symbol] = {}

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        i = self.effect.link
        return (
            f"The air resists the motion of link {i} across the rod: the force on a length of the "
            "rod is quadratic in the speed of that length. The integrals of this force along the "
            "rod are the drag and its moment about the joint where the link begins."
        )

    def _symbol(self, letter: str, latex: str) -> Symbol:
        """Return a symbol of this effect; another effect on the same rod gets another symbol."""
        if letter not in self._names:
            name, i, known = f"{letter}_{self.effect.link}", self.effect.link, 1
            taken = {symbol.name for symbol in self.notation.latex_names}
            while (own := name if known == 1 else f"{name}__{known}") in taken:
                known += 1
            shown = latex.format(i=i)
            shown = shown if known == 1 else f"{{{shown}^{{({known})}}}}"
            self._names[letter] = self.notation.symbol(own, shown)
        return self._names[letter]

    def definitions(self, chain: Chain) -> tuple[Definition, ...]:
        """Return the speeds of the ends, and the integrals F and T."""
        i, s = self.effect.link, self.notation
        length = s.lengths[i - 1]
        w0 = self._symbol("w0", r"w_{{0,{i}}}")
        w1 = self._symbol("w1", r"w_{{1,{i}}}")
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

    @property
    def force(self) -> Symbol:
        """F, the force across the rod."""
        return self._symbol("Fd", r"F_{{d,{i}}}")

    @property
    def moment(self) -> Symbol:
        """T, the moment about the joint where the rod begins."""
        return self._symbol("Td", r"T_{{d,{i}}}")

    def load(self, chain: Chain) -> LinkLoad:
        """Return F across the rod, and T."""
        i = self.effect.link
        across = chain.across(i)
        return LinkLoad(i, (self.force * across[0], self.force * across[1]), self.moment)

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the powers of F, at the joint where the rod begins, and of T."""
        i = self.effect.link
        speed = dot(chain.across(i), chain.joint_velocities[i - 1])
        return self.force * speed + self.moment * self.notation.qd[i - 1]
