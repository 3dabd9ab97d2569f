"""A torsional spring: tau = -k (phi - phi_0), V = k (phi - phi_0)^2 / 2."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.chain import Chain
from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation


class TorsionalSpring(Law):
    """See the core's effect of that name; what it stores is potential energy."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        j = effect.joint
        self.stiffness = notation.parameter(
            f"k_{j}", f"k_{{{j}}}", effect.stiffness, "N m/rad", f"stiffness at joint {j}"
        )
        self.rest_angle: Expr = Integer(0)
        if effect.rest_angle != 0.0:
            words = f"angle of joint {j} at which its spring is at rest"
            self.rest_angle = notation.parameter(
                f"phi0_{j}", rf"\varphi_{{0,{j}}}", effect.rest_angle, "rad", words
            )

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        return f"A torsional spring turns joint {self.effect.joint} towards its rest angle."

    def couple(self, chain: Chain) -> Expr:
        """Return the torque, N m: towards the rest angle if the stiffness is positive."""
        return -self.stiffness * (chain.joint_angle(self.effect.joint) - self.rest_angle)

    def potential_energy(self, chain: Chain) -> Expr:
        """Return the energy of the spring, J."""
        wound = chain.joint_angle(self.effect.joint) - self.rest_angle
        return self.stiffness * wound**2 / 2
