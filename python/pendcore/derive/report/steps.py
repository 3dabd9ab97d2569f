"""The steps of a derivation as they stand in a report, and with blanks for the worksheet."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from itertools import groupby

from sympy import Expr, fraction

from pendcore.derive import line_breaks
from pendcore.derive.algebra import Algebra
from pendcore.derive.report.document import Blank, Block, Displayed, Heading, Paragraph
from pendcore.derive.report.figures import Figures
from pendcore.derive.report.quantities import quantity
from pendcore.derive.step import Equation, Step

A_BLOCK = 12
"""The most rows that are displayed together."""
A_PAGE = 24
"""Rows that one equation may have before a page must be able to end in it."""
A_DENOMINATOR = 24.0
"""Width of a denominator, in em, beyond which it has a name of its own."""
BY_HAND = 22.0
"""Width in print, in em, of what fits on a line by hand."""


def derivation_steps(
    derivation: Algebra, written: Iterable[Step], figures: Figures, *, blanks: bool = False
) -> Iterator[Block]:
    """Yield the derivation, step by step; the free bodies come before the first of their equations.

    Parameters
    ----------
    derivation : Algebra
        The derivation whose steps they are.
    written : iterable of Step
        The steps.
    figures : Figures
        Draws the free bodies.
    blanks : bool
        Whether the right sides are left for the reader to find.
    """
    drawn = False
    for step in written:
        yield Heading(3, f"{step.number}. {step.title}")
        yield Paragraph(step.text)
        if not drawn and _is_of_forces(step, derivation):
            drawn = True
            yield figures.free_bodies(forces=not blanks)
        yield from _blanks(step) if blanks else _shown(step, derivation)


def _is_of_forces(step: Step, derivation: Algebra) -> bool:
    """Whether a step has reactions in it."""
    forces = {symbol for pair in derivation.equations.forces for symbol in pair}
    return any(
        forces & side.free_symbols
        for equation in step.equations
        for side in (equation.lhs, equation.rhs)
        if isinstance(side, Expr)
    )


def _shown(step: Step, derivation: Algebra) -> Iterator[Block]:
    for number, equations in groups(_with_short_denominators(step.equations, derivation)):
        margin = max(line_breaks.width(e.side_latex(e.lhs)) for e in equations)
        together: list[str] = []
        for equation in equations:
            own = _rows(equation, derivation, margin)
            if number is None and together and len(together) + len(own) > A_BLOCK:
                yield Displayed(line_breaks.aligned(together))
                together = []
            together += own
        first = max(0, len(together) - 1) // A_PAGE * A_PAGE
        for k in range(0, first, A_PAGE):  # a page must be able to end in a very long block
            yield Displayed(line_breaks.aligned(together[k : k + A_PAGE]))
        yield Displayed(line_breaks.aligned(together[first:]), number)
        if remark := equations[-1].remark:
            yield Paragraph(f"*{remark}*")


def _with_short_denominators(equations: Iterable[Equation], derivation: Algebra) -> list[Equation]:
    """Return the equations with names for long denominators, such as determinants."""
    notation, found, named = derivation.symbols, list[Equation](), dict[Expr, Expr]()
    for equation in equations:
        if isinstance(equation.rhs, Expr):
            above, below = fraction(equation.rhs)
            if below not in named and line_breaks.width(notation.latex(below)) > A_DENOMINATOR:
                mark = f"_{{{len(named) + 1}}}" if named else ""
                named[below] = notation.symbol(f"Delta{len(named) or ''}", rf"\Delta{mark}")
                found.append(replace(equation, lhs=named[below], rhs=below, number=None, remark=""))
            if below in named:
                equation = replace(equation, rhs=above / named[below])
        found.append(equation)
    return found


def groups(equations: Iterable[Equation]) -> Iterator[tuple[str | None, list[Equation]]]:
    """Yield the equations that are displayed together: those of one number, or of none.

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


def _rows(equation: Equation, derivation: Algebra, margin: float = 0.0) -> list[str]:
    rows = equation.rows(margin)
    if (number := _number(equation, derivation)) is not None:
        rows[-1] += f" = {number}"
    return rows


def _number(equation: Equation, derivation: Algebra) -> str | None:
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
