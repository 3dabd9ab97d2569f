"""A rigid body at the tip: its weight and inertia act on the last link."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.laws.law import Law
from pendcore.derive.notation import Notation
from pendcore.derive.writing import MASS


class Payload(Law):
    """See the core's effect of that name."""

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        rank = (MASS, notation.n + 1)
        self.mass = notation.parameter(
            "m_p", "m_{p}", effect.mass, "kg", "mass of the payload", rank
        )
        self.inertia: Expr = Integer(0)
        if effect.inertia != 0.0:
            words = "moment of inertia of the payload about its mass centre"
            self.inertia = notation.parameter("I_p", "I_{p}", effect.inertia, "kg m^2", words, rank)

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        if any(p.symbol.name == "m_p__2" for p in notation.parameters):
            return "The payloads are fixed to the tip, and move as one body."
        return "A payload is fixed to the tip."

    def payload(self) -> tuple[Expr, Expr]:
        """Return the mass and the moment of inertia."""
        return self.mass, self.inertia
