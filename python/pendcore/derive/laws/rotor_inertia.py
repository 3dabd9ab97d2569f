"""A rotor that turns with a joint: T = J phid^2 / 2."""

from __future__ import annotations

from typing import Any

from sympy import Expr

from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation


class RotorInertia(Law):
    """See the core's effect of that name; turning the rotor takes the couple J phidd."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        j = effect.joint
        self.inertia = notation.parameter(
            f"J_{j}", f"J_{{{j}}}", effect.armature, "kg m^2", f"inertia of the rotor at joint {j}"
        )

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        joint = self.effect.joint
        return (
            f"A rotor turns with joint {joint}: accelerating the rotor takes a couple that is its "
            f"moment of inertia ${notation.latex(self.inertia)}$ times the acceleration of the "
            "joint."
        )

    def armature(self) -> tuple[int, Expr]:
        """Return the joint and the moment of inertia."""
        return self.effect.joint, self.inertia
