"""The report and the worksheet of a case: the same document, with answers or with blanks."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from math import degrees
from typing import TYPE_CHECKING, Any

from sympy import Expr

import pendcore
from pendcore.derive import line_breaks, narration
from pendcore.derive import document as doc
from pendcore.derive.document import Block, Document, Heading, Paragraph
from pendcore.derive.laws.rod_drag import AT_REST
from pendcore.derive.narration.kinematics import statements
from pendcore.derive.narration.page import Page
from pendcore.derive.report import motion, numbers
from pendcore.derive.report.figures import Figures
from pendcore.derive.report.quantities import number, quantity, unit
from pendcore.derive.step import Equation, Step, groups

if TYPE_CHECKING:
    from pendcore import Case, Solution
    from pendcore.derive.derivation import Derivation

BY_HAND = 22.0
"""Width in print, in em, of what fits on a line by hand."""
ROOM = r"\qquad" * 7
"""Room in which an acceleration is written by hand."""
QUESTIONS = (
    (
        Heading(3, "The equations of motion with numbers"),
        "Put the numbers of the table into the equations of motion. Give the units.",
        doc.Space(5),
    ),
    (
        Heading(3, "At the start"),
        "Compute the angular accelerations and the joint reactions at the start. Which way does "
        "each link begin to turn? Which way does each joint push?",
        doc.Space(7),
    ),
    (
        Heading(2, "Numerical solution"),
        "Integrate the first-order system, and draw the angles.",
        None,
    ),
    (
        Heading(2, "Check by the energy"),
        "Write down kinetic and potential energy. What is their sum at the start, and {balance}",
        doc.Space(6),
    ),
)
"""What a worksheet asks after the derivation, and where the answer goes: None is the axes."""
NAMES = {1: "pendulum", 2: "double pendulum"}


def report(
    derivation: Derivation, case: Case, solution: Solution, refusal: str = ""
) -> Document:
    """Return the derivation of a case with its solution, as `motion.solved_or_refused` has it."""
    figures = Figures(derivation, case.q0)
    blocks = [
        *_problem(derivation, case, figures),
        *_steps(derivation, figures),
        *numbers.numbers_put_in(derivation),
        *numbers.at_the_start(derivation, case),
        *motion.numerical_solution(derivation, solution, figures, refusal),
        *motion.energy_check(derivation, solution, figures),
        Paragraph(f"Derived with SymPy and solved by pendcore {pendcore.__version__}.", True),
    ]
    return Document(_title(derivation, case), tuple(blocks))


def worksheet(derivation: Derivation, case: Case, solution: Solution) -> Document:
    """Return the same problem with blanks: right sides, free bodies and curves are to be found."""
    figures = Figures(derivation, case.q0)
    balance = "how well does your solution keep it?"
    if motion.does_work(case):
        balance = (
            "how much did the effects take or give until the end, and how well does your solution "
            "keep the balance?"
        )
    blocks: list[Block] = [
        *_problem(derivation, case, figures, by_hand=True),
        *_steps(derivation, figures, blanks=True),
    ]
    axes = figures.empty_axes(solution)
    for heading, question, space in QUESTIONS:
        blocks += [heading, Paragraph(question.format(balance=balance)), space or axes]
    return Document(f"{_title(derivation, case)}: worksheet", tuple(blocks))


def _title(derivation: Derivation, case: Case) -> str:
    name = case.name or NAMES.get(derivation.n, f"chain of {derivation.n} links")
    return name[:1].upper() + name[1:]


def _problem(
    derivation: Derivation, case: Case, figures: Figures, *, by_hand: bool = False
) -> Iterator[Block]:
    """Yield what is given, and Fig. 1; by hand without what only avoids 0/0."""
    page, write = Page(derivation), derivation.symbols.latex
    yield Heading(2, "The problem")
    yield Paragraph(
        f"A planar {NAMES.get(derivation.n, f'chain of {derivation.n} links')} (Fig. 1) moves in a "
        "vertical plane. The $x$ axis points to the right and the $y$ axis down; the angles are "
        "measured from the $x$ axis towards the $y$ axis, and turning from $x$ to $y$ is positive."
        f"{' The links are uniform rods.' if page.is_uniform else ''}"
    )
    gravity = "gravity and " if derivation.scene.gravity else ""
    nothing = f"Nothing acts on the chain but {gravity}the joint that holds it."
    for statement in statements(page) if derivation.equations.laws else [nothing]:
        yield Paragraph(statement)
    yield figures.mechanism()
    yield Paragraph("These numbers are given:")
    rows = [
        tuple(f"${x}$" if k != 1 else x for k, x in enumerate(
            (write(p.symbol), p.meaning, number(p.value, 10), unit(p.unit) or "-")))
        for p in derivation.symbols.parameters
        if not (by_hand and p.value == AT_REST)
    ]  # fmt: skip
    yield doc.Table(("symbol", "meaning", "value", "unit"), tuple(rows), "llrl")
    yield Paragraph(
        "Find the equations of motion, the joint reactions and the motion that follows from"
    )
    (start, end), s = case.t_span, derivation.symbols
    lines = [
        rf"{write(q)}({number(start)}) &= {quantity(angle, 'rad')} = {number(degrees(angle))}"
        rf"^\circ, & {write(qd)}({number(start)}) &= {quantity(rate, 'rad/s')}"
        for q, qd, angle, rate in zip(s.q, s.qd, case.q0, case.qd0, strict=True)
    ]
    body = " \\\\\n".join(lines)
    yield doc.Displayed(f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}")
    yield Paragraph(f"from $t = {quantity(start, 's')}$ to $t = {quantity(end, 's')}$.")


def _steps(
    derivation: Derivation, figures: Figures, *, blanks: bool = False
) -> Iterator[Block]:
    """Yield the derivation; the free bodies come before the first of their equations."""
    yield Heading(2, "Derivation of the equations of motion")
    names = _names(derivation)
    drawn = False
    for step in narration.steps(derivation):
        if step.title == "Effects":
            step = replace(step, text="What acts besides gravity is stated above.")
        heading, text, *displayed = step.blocks(lambda e: _value(e, derivation))
        yield from (heading, text)
        if not drawn and step.title.startswith("Newton-Euler"):
            drawn = True
            yield figures.free_bodies(forces=not blanks)
        yield from _blanks(step, names) if blanks else displayed


def _value(equation: Equation, derivation: Derivation) -> str:
    """Return the number of a moment of inertia that is given by the parameters alone."""
    right, values = equation.rhs, derivation.values
    if not isinstance(right, Expr) or not str(equation.lhs).startswith(("I_", "M")):
        return ""
    if not right.free_symbols or right.free_symbols - values.keys():
        return ""
    return f" = {quantity(float(right.xreplace(values)), 'kg m^2')}"


def _blanks(step: Step, names: dict[Any, Any]) -> Iterator[Block]:
    """Yield the left sides of a step, with what gives nothing away, and lines to write on."""
    known: list[Any] = []
    for tag, equations in groups(step.equations):
        for equation in equations:
            left = names.get(equation.lhs, equation.lhs)
            latex = equation.side_latex(left)
            if left in known and not (equation.number and isinstance(left, Expr)):
                continue  # it is the same with its value: one blank will do
            if left in known:  # now the acceleration is to be put in
                *factors, last = map(equation.side_latex, left.as_ordered_factors())
                latex = rf"{' '.join(factors)} \, \underbrace{{{ROOM}}}_{{{last}}}"
            known.append(left)
            lines = 1 + int(line_breaks.width(equation.side_latex(equation.rhs)) / BY_HAND)
            yield doc.Blank(latex, tag if equation is equations[-1] else None, lines)


def _names(derivation: Derivation) -> dict[Any, Any]:
    """Return what stands on a worksheet for each left side that would give something away.

    In the solution, left sides are ``m2 L2^2/12 qdd2``, say, and m2 times the acceleration of C_2
    written out; here they are ``I_C2 qdd2`` and ``m2 xdd_C2``.
    """
    page, found = Page(derivation), dict[Any, Any]()
    for i, link in enumerate(derivation.equations.links, start=1):
        turning = page.moment_of_inertia(0 if link.about_pivot else i) * page.s.qdd[i - 1]
        found[link.moment.inertia] = turning
        found[page.along("k", link.moment.inertia)] = page.along("k", turning)
        for axis, line in zip("xy", link.newton, strict=True):
            acceleration = page.coordinate(axis, page.center(i), 2)
            found[line.inertia] = page.s.masses[i - 1] * acceleration
    return found
