"""What the steps are written on: it numbers them, and knows the names of points and forces."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from sympy import Expr, Symbol

from pendcore.derive.step import Equation, Formula, Step

if TYPE_CHECKING:
    from pendcore.derive.derivation import Derivation


class Page:
    """Steps as they are written.

    Attributes
    ----------
    derivation : Derivation
        What they are about.
    is_textbook : bool
        Whether the equations are the textbook's: two uniform rods and nothing else.
    steps : list of Step
        Those written so far.
    """

    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.n = derivation.n
        self.s = derivation.symbols
        self.chain = derivation.chain
        self.equations = derivation.equations
        self.motion = derivation.motion
        uniform = not any(link.particulars().keys() - {"mass", "length"} for link in self.links)
        self.is_textbook = self.n == 2 and uniform and not derivation.scene.effects
        self.steps: list[Step] = []

    @property
    def links(self) -> Any:
        """The links of the scene."""
        return self.derivation.scene.links

    def step(self, title: str, text: str, *equations: Equation) -> None:
        """Write a step."""
        self.steps.append(Step(len(self.steps) + 1, title, text, equations))

    def equation(
        self,
        lhs: Expr | Formula,
        rhs: Expr | Formula,
        number: str | None = None,
        remark: str = "",
    ) -> Equation:
        """Return an equation; a textbook number is left out where there are not two links."""
        number = number if self.n == 2 else None
        return Equation(lhs, rhs, number, remark if self.is_textbook else "", self.s)

    def symbol(self, name: str, latex: str) -> Symbol:
        """Return a symbol that only names a side of an equation."""
        return self.s.symbol(name, latex)

    def center(self, link: int) -> tuple[str, str]:
        """Return the name of a mass centre, in text and LaTeX."""
        return f"C{link}", f"C_{{{link}}}"

    def joint(self, joint: int) -> tuple[str, str]:
        """Return the name of P_0, ..., P_n: A, B and D for two links, as in the textbook."""
        if joint == 0:
            return "A", "A"
        if self.n <= 2:
            name = "BD"[joint - 1 if self.n == 2 else 0]
            return name, name
        return f"P{joint}", f"P_{{{joint}}}"

    def coordinate(self, axis: str, point: tuple[str, str], dots: int = 0) -> Symbol:
        """Return x_C1, or with dots its velocity and acceleration."""
        text, latex = point
        name = f"{axis}{'d' * dots}_{text}"
        letter = {0: axis, 1: rf"\dot{{{axis}}}", 2: rf"\ddot{{{axis}}}"}[dots]
        return self.symbol(name, f"{letter}_{{{latex}}}")

    def force(self, on: int, of: str) -> Formula:
        """Return a force vector: of another body on a link."""
        return Formula(f"F{of}{on}", rf"\mathbf{{F}}_{{{of}{on}}}")
