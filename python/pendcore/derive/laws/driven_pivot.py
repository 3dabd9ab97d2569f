"""A pivot that is moved: x_0 and y_0 are sinusoids of time; the power is F_01 . v_0."""

from __future__ import annotations

from typing import Any

from sympy import Expr, Integer

from pendcore.derive.chain import Chain, Vector, dot
from pendcore.derive.laws.law import Law, NotSmooth
from pendcore.derive.laws.sinusoid import Named, sinusoid
from pendcore.derive.notation import Notation


class DrivenPivot(Law):
    """See the core's effect of that name.

    A spline is smooth only in pieces: its third derivative jumps at every point.
    """

    def __init__(self, effect: Any, notation: Notation) -> None:
        super().__init__(effect, notation)
        if effect.spline is not None:
            raise NotSmooth(
                "spline: its path is given by points, with a different polynomial between each "
                "two, and not by a law",
                "give sinusoids, x= and y=",
            )
        self.path = self._axis("x"), self._axis("y")

    def sentence(self, notation: Notation) -> str:
        """Return the words and formulas of the law."""
        return "The pivot is moved along a given path."

    def _axis(self, axis: str) -> Expr:
        wave = getattr(self.effect, axis)
        if wave is None:
            return Integer(0)
        amplitude, latex = f"{axis.upper()}0", rf"\hat{{{axis}}}_{{A}}"
        named = Named(axis, axis, amplitude, latex, "m", f"the pivot's motion along {axis}")
        return sinusoid(wave, self.notation, named)

    def pivot(self) -> Vector:
        """Return the position of the pivot, m."""
        return self.path

    def power(self, chain: Chain, ground_force: Vector) -> Expr:
        """Return the power of what moves the pivot, W."""
        symbols = {law: symbol for symbol, law in chain.path.items()}
        x, y = (law.diff(self.notation.t) for law in self.path)
        return dot(ground_force, (symbols.get(x, x), symbols.get(y, y)))
