"""A rigid body at the tip: its weight and inertia act on the last link."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation


class Payload(Law):
    """See the core's effect of that name."""

    sentence = "A payload is fixed to the tip"

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        self.mass = notation.parameter("m_P", "m_{P}", effect.mass, "kg", "mass of the payload")
        self.inertia: Expr = Integer(0)
        if effect.inertia != 0.0:
            words = "moment of inertia of the payload about its mass centre"
            self.inertia = notation.parameter("I_P", "I_{P}", effect.inertia, "kg m^2", words)

    def payload(self) -> tuple[Expr, Expr]:
        """Its mass and moment of inertia."""
        return self.mass, self.inertia
