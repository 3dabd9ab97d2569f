"""The page on which the steps are written: it numbers the steps, and names points and forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, TypeAlias

from sympy import Expr, Symbol

from pendcore.derive.derivation import Derivation
from pendcore.derive.laws.law import LinkLoad
from pendcore.derive.notation import MASS
from pendcore.derive.step import Equation, Formula, Step

_UPWARD = "as if $y$ pointed upward. It points downward, and the weight is positive."
ERRATA = {
    "2.2": f"The textbook prints $-m_{{1}} g L_{{1}}/2 \\cos q_{{1}}$, {_UPWARD}",
    "y of 2.5": f"The textbook prints $-m_{{2}} g$, {_UPWARD}",
    "2.5": "The textbook prints $m$ for $m_{2}$.",
    "2.7": f"The textbook prints $-m_{{2}} g$, {_UPWARD}",
    "2.8": "The textbook prints both terms with the opposite sign, which is not what the "
    "determinant in (2.5) gives.",
    "2.9": "The textbook prints the same. It is right for $y$ downward, but does not follow from "
    "the (2.7) printed there.",
    "2.10": "The textbook prints $m_{2} L_{1}^{2}/3$ on the left, for $m_{1} L_{1}^{2}/3$, and "
    "$-m_{1} g L_{1}/2 \\cos q_{1}$.",
    "2.11": "The textbook prints the right side with the opposite sign, which it has from (2.8).",
}
"""What the textbook prints otherwise; docs/reference/errata.md shows each by computation."""


Sides: TypeAlias = tuple[Any, ...]
"""An equation that is to be written: both sides, its number, and its place among the errata."""


class Page:
    """Steps as they are written, with the number of the next and the names of what is in them."""

    def __init__(self, derivation: Derivation) -> None:
        self.derivation = derivation
        self.n = derivation.n
        self.s = derivation.symbols
        self.chain = derivation.chain
        self.equations = derivation.equations
        scene = derivation.scene
        links = [link.particulars().keys() for link in scene.links]
        self.is_uniform = all(given <= {"mass", "length"} for given in links)
        self.is_textbook = self.n == 2 and self.is_uniform and not scene.effects
        self.steps: list[Step] = []

    def step(self, title: str, text: str, *equations: Sides) -> None:
        """Write a step."""
        written = tuple(self._equation(*one) for one in equations)
        self.steps.append(Step(len(self.steps) + 1, title, text, written))

    def _equation(self, lhs: Any, rhs: Any, number: str = "", erratum: str = "") -> Equation:
        """Return an equation; it keeps its number for two links, its remark for the textbook's."""
        remark = ERRATA.get(erratum or number, "") if self.is_textbook else ""
        shown = number if self.n == 2 and number else None
        return Equation(lhs, rhs, shown, remark, self.s)

    def joint(self, joint: int) -> Formula:
        """Return the name of P_0, ..., P_n: A, B and D for two links, as in the textbook."""
        return Formula(("A", "B", "D")[joint] if self.n <= 2 or joint == 0 else f"P_{{{joint}}}")

    def center(self, body: int) -> Formula:
        """Return the name of a mass centre; that of a payload, the last body, is the tip."""
        return Formula(f"C_{{{body}}}") if body <= self.n else self.joint(self.n)

    def coordinate(self, axis: str, point: Formula, dots: int = 0) -> Symbol:
        """Return x_C1, or with dots its velocity and acceleration."""
        return self.s.moving(axis, f"_{point.text}", point)[dots]

    def moment_of_inertia(self, link: int) -> Symbol:
        """Return I_C1; for link 0 I_A, that of link 1 about the pivot."""
        if link == 0:
            return self.s.symbol("I_A", "I_{A}", MASS)
        return self.s.symbol(f"I_C{link}", f"I_{{C_{{{link}}}}}", MASS, link)

    @staticmethod
    def vector(letter: str, index: object) -> Formula:
        """Return a vector: a_C1, alpha_1, G_1, F_12; r_C1B from C1 to B."""
        bold = rf"\boldsymbol{{\{letter}}}" if len(letter) > 1 else rf"\mathbf{{{letter}}}"
        return Formula(f"{bold}_{{{index}}}")

    def load(self, load: LinkLoad) -> Formula:
        """Return the name of a force on a link, D_2; a second force there gets another name."""
        count = 1 + [x for x in self.equations.loads if x.link == load.link].index(load)
        mark = f"^{{({count})}}" if count > 1 else ""
        return Formula(self.vector("D", load.link) + mark)

    def along(self, unit: str, value: Any) -> Formula:
        """Return a value along a unit vector: ``m1*g j``."""
        return self.scaled(value, Formula(rf"\, \mathbf{{{unit}}}"))

    def scaled(self, factor: Any, vector: Formula) -> Formula:
        """Return a vector times a factor: ``m1 a_C1``."""
        latex = self.s.latex(factor)
        if getattr(factor, "is_Add", False):
            latex = rf"\left({latex}\right)"
        return Formula(f"{latex} {vector}")

    def determinant(self, arm: tuple[Expr, Expr], force: tuple[Expr, Expr]) -> Formula:
        """Return the cross product of two vectors in the plane, as the textbook prints it."""
        rows = [[rf"\mathbf{{{unit}}}" for unit in "ijk"]]
        rows += [[*map(self.s.latex, row), "0"] for row in (arm, force)]
        latex = r" \\ ".join(" & ".join(row) for row in rows)
        return Formula(rf"\begin{{vmatrix}} {latex} \end{{vmatrix}}")


def total(terms: Iterable[Formula]) -> Formula:
    """Return a sum; a term that begins with a minus is subtracted."""
    return Formula(" + ".join(terms).replace("+ -", "- "))
