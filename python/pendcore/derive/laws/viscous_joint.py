"""Viscous damping: tau = -(b w + b2 w abs(w) + b3 w^3), w the rate of the joint."""

from __future__ import annotations

from typing import Any

from sympy import Abs, Expr, Integer

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation


class ViscousJoint(Law):
    """See the core's effect of that name; its power is tau w."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        j, self.coefficients = effect.joint, dict[int, Expr]()
        for power, name, word in (
            (1, "damping", "linear"),
            (2, "damping2", "quadratic"),
            (3, "damping3", "cubic"),
        ):
            value = getattr(effect, name)
            if power == 1 or value != 0.0:
                number = "" if power == 1 else str(power)
                self.coefficients[power] = notation.parameter(
                    f"b{number}_{j}",
                    f"b_{{{j}}}" if power == 1 else f"b_{{{power},{j}}}",
                    value,
                    f"N m s{'' if power == 1 else f'^{power}'}/rad"
                    + ("" if power == 1 else f"^{power}"),
                    f"{word} damping of joint {j}",
                )

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        return f"Viscous damping at joint {self.effect.joint} opposes its rate."

    def couple(self, chain: Chain) -> Expr:
        """Return the torque, N m, which is odd in w."""
        w = chain.joint_rate(self.effect.joint)
        terms = {1: w, 2: w * Abs(w), 3: w**3}
        return -sum((b * terms[power] for power, b in self.coefficients.items()), Integer(0))

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the power, W; negative where the damping takes energy from the motion."""
        return self.couple(chain) * chain.joint_rate(self.effect.joint)
