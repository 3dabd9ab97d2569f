"""The page on which the steps are written: it numbers the steps, and names points and forces."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sympy import Expr, Symbol

from pendcore.derive.algebra import Algebra
from pendcore.derive.laws import LinkLoad
from pendcore.derive.step import Equation, Formula, Step
from pendcore.derive.writing import ACCELERATION, ANGLE, MASS, RATE


class Page:
    """Steps as they are written.

    Attributes
    ----------
    derivation : Algebra
        The equations that the steps derive.
    is_textbook : bool
        Whether the equations are the textbook's: two uniform rods and nothing else.
    steps : list of Step
        The steps written so far.
    links : dict
        The number of the step with the equations of each link written so far.
    """

    def __init__(self, derivation: Algebra) -> None:
        self.derivation = derivation
        self.n = derivation.n
        self.s = derivation.symbols
        self.chain = derivation.chain
        self.equations = derivation.equations
        self.motion = derivation.motion
        links = derivation.scene.links
        self.is_uniform = not any(x.particulars().keys() - {"mass", "length"} for x in links)
        self.is_textbook = self.n == 2 and self.is_uniform and not derivation.scene.effects
        self.steps: list[Step] = []
        self.links: dict[int, int] = {}

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
        """Return an equation; it keeps its number for two links, its remark for the textbook's."""
        number = number if self.n == 2 else None
        return Equation(lhs, rhs, number, remark if self.is_textbook else "", self.s)

    def symbol(self, name: str, latex: str, rank: int | None = None, link: int = 0) -> Symbol:
        """Return a symbol that only names a side of an equation."""
        return self.s.symbol(name, latex, rank, link)

    def joint(self, joint: int) -> Formula:
        """Return the name of P_0, ..., P_n: A, B and D for two links, as in the textbook."""
        if joint <= min(self.n, 2) <= self.n <= 2:
            name = ("A", "B", "D")[joint]
            return Formula(name, name)
        return Formula("A", "A") if joint == 0 else Formula(f"P{joint}", f"P_{{{joint}}}")

    @staticmethod
    def center(link: int) -> Formula:
        """Return the name of a mass centre."""
        return Formula(f"C{link}", f"C_{{{link}}}")

    def coordinate(self, axis: str, point: Formula, dots: int = 0) -> Symbol:
        """Return x_C1, or with dots its velocity and acceleration."""
        name = f"{axis}{'d' * dots}_{point.text}"
        letter = {0: axis, 1: rf"\dot{{{axis}}}", 2: rf"\ddot{{{axis}}}"}[dots]
        rank = (ANGLE, RATE, ACCELERATION)[dots]
        return self.symbol(name, f"{letter}_{{{point.latex}}}", rank)

    def moment_of_inertia(self, link: int) -> Symbol:
        """Return I_C1."""
        return self.symbol(f"I_C{link}", f"I_{{C_{{{link}}}}}", MASS, link)

    @staticmethod
    def position(of: Formula, origin: Formula | None = None) -> Formula:
        """Return a vector between points, such as r_C1, or r_C1B from C1 to B."""
        before = origin or Formula("", "")
        return Formula(f"r_{before.text}{of.text}", rf"\mathbf{{r}}_{{{before.latex}{of.latex}}}")

    @staticmethod
    def vector(letter: str, index: Formula | str | int) -> Formula:
        """Return a vector: a_C1, alpha_1, G_1, F_12."""
        text, latex = (index.text, index.latex) if isinstance(index, Formula) else (index, index)
        name = {"alpha": r"\boldsymbol{\alpha}", "omega": r"\boldsymbol{\omega}"}.get(
            letter, rf"\mathbf{{{letter}}}"
        )
        between = "_" if isinstance(index, Formula) else ""
        return Formula(f"{letter}{between}{text}", f"{name}_{{{latex}}}")

    def load(self, load: LinkLoad) -> Formula:
        """Return the name of a force on a link, D_2; a second force there gets another name."""
        vector = self.vector("D", load.link)
        count = 1 + [x for x in self.equations.loads if x.link == load.link].index(load)
        if count == 1:
            return vector
        return Formula(f"{vector.text}__{count}", f"{vector.latex}^{{({count})}}")

    def along(self, unit: str, value: Any) -> Formula:
        """Return a value along a unit vector: ``m1*g j``."""
        text, latex = self.s.text(value), self.s.latex(value)
        if getattr(value, "is_Add", False):
            text, latex = f"({text})", rf"\left({latex}\right)"
        return Formula(f"{text} {unit}", rf"{latex} \, \mathbf{{{unit}}}")

    def scaled(self, factor: Expr, vector: Formula) -> Formula:
        """Return a vector times a factor: ``m1 a_C1``."""
        text, latex = self.s.text(factor), self.s.latex(factor)
        if factor.is_Add:
            text, latex = f"({text})", rf"\left({latex}\right)"
        return Formula(f"{text} {vector.text}", f"{latex} {vector.latex}")

    @staticmethod
    def cross(arm: Formula, force: Formula) -> Formula:
        """Return a moment: arm x force."""
        return Formula(f"{arm.text} x {force.text}", rf"{arm.latex} \times {force.latex}")

    def determinant(self, arm: tuple[Expr, Expr], force: tuple[Expr, Expr]) -> Formula:
        """Return the cross product of two vectors in the plane, as the textbook prints it."""
        rows = [[self.s.text(x) for x in row] for row in (arm, force)]
        shown = [[self.s.latex(x) for x in row] for row in (arm, force)]
        text = "; ".join(f"{x}, {y}, 0" for x, y in rows)
        latex = r" \\ ".join(f"{x} & {y} & 0" for x, y in shown)
        head = r"\mathbf{i} & \mathbf{j} & \mathbf{k}"
        return Formula(
            f"det[i, j, k; {text}]", rf"\begin{{vmatrix}} {head} \\ {latex} \end{{vmatrix}}"
        )


def total(terms: Iterable[Formula]) -> Formula:
    """Return a sum; a term that begins with a minus is subtracted."""
    texts: list[str] = []
    pieces: list[str] = []
    for term in terms:
        sign = "-" if term.text.startswith("-") else "+"
        text, latex = term.text.removeprefix("-"), term.latex.removeprefix("-")
        texts.append(f"{sign} {text}" if texts else term.text)
        pieces.append(f"{sign} {latex}" if pieces else term.latex)
    return Formula(" ".join(texts) or "0", " ".join(pieces) or "0", tuple(pieces))
