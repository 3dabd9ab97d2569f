"""The steps of a derivation as they stand in a handout, and with blanks for the worksheet."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import groupby

from sympy import Expr

from pendcore.derive import line_breaks
from pendcore.derive.derivation import Derivation
from pendcore.derive.handout.document import Blank, Block, Displayed, Heading, Paragraph
from pendcore.derive.handout.figures import Figures
from pendcore.derive.handout.quantities import quantity
from pendcore.derive.step import Equation, Step

A_BLOCK = 12
"""Rows that are displayed together."""
A_PAGE = 24
"""Rows that one equation may have before a page must be able to end in it."""
BY_HAND = 22.0
"""Width of what fits on a line by hand, in the letter m's of print."""


def derivation_steps(
    derivation: Derivation, figures: Figures, *, blanks: bool = False
) -> Iterator[Block]:
    """Yield the derivation, step by step; the free bodies come before the first of their equations.

    Parameters
    ----------
    derivation : Derivation
        Whose steps they are.
    figures : Figures
        Draws the free bodies.
    blanks : bool
        Whether the right sides are left for the reader to find.
    """
    drawn = False
    for step in derivation.steps:
        yield Heading(3, f"{step.number}. {step.title}")
        yield Paragraph(step.text)
        if not drawn and _is_of_forces(step, derivation):
            drawn = True
            yield figures.free_bodies(forces=not blanks)
        yield from _blanks(step) if blanks else _shown(step, derivation)


def _is_of_forces(step: Step, derivation: Derivation) -> bool:
    """Whether a step has reactions in it."""
    forces = {symbol for pair in derivation.equations.forces for symbol in pair}
    return any(
        forces & side.free_symbols
        for equation in step.equations
        for side in (equation.lhs, equation.rhs)
        if isinstance(side, Expr)
    )


def _shown(step: Step, derivation: Derivation) -> Iterator[Block]:
    for number, equations in groups(step.equations):
        margin = max(line_breaks.width(e.side_latex(e.lhs)) for e in equations)
        lines = [row for e in equations for row in _rows(e, derivation, margin)]
        if len(lines) > A_BLOCK and number is None:  # a page must be able to end in between
            for equation in equations:
                own = _rows(equation, derivation)
                for first in range(0, len(own), A_PAGE):
                    yield Displayed(line_breaks.aligned(own[first : first + A_PAGE]))
        else:
            yield Displayed(line_breaks.aligned(lines), number)
        if remark := equations[-1].remark:
            yield Paragraph(f"*{remark}*")


def groups(equations: Iterable[Equation]) -> Iterator[tuple[str | None, list[Equation]]]:
    """Yield the equations that are displayed together: of one number, or of none.

    A remark ends a group.
    """
    for number, of_one in groupby(equations, key=lambda equation: equation.number):
        together: list[Equation] = []
        for equation in of_one:
            together.append(equation)
            if equation.remark:
                yield number, together
                together = []
        if together:
            yield number, together


def _rows(equation: Equation, derivation: Derivation, margin: float = 0.0) -> list[str]:
    rows = equation.rows(margin)
    if (number := _number(equation, derivation)) is not None:
        rows[-1] += f" = {number}"
    return rows


def _number(equation: Equation, derivation: Derivation) -> str | None:
    """Return the number of a moment of inertia that is given by the parameters alone."""
    name = getattr(equation.lhs, "name", "")
    right, values = equation.rhs, derivation.values
    if not isinstance(right, Expr) or not name.startswith(("I_", "M")):
        return None
    if not right.free_symbols or right.free_symbols - values.keys():
        return None
    return quantity(float(right.xreplace(values)), "kg m^2")


def _blanks(step: Step) -> Iterator[Block]:
    for number, equations in groups(step.equations):
        for k, equation in enumerate(equations):
            needed = line_breaks.width(equation.side_latex(equation.rhs))
            yield Blank(
                equation.side_latex(equation.lhs),
                number if k == len(equations) - 1 else None,
                1 + int(needed / BY_HAND),
            )
