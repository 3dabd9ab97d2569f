"""The report and the worksheet of a case: the same problem, with answers or with blanks.

Both are templates, in which ``@{name}`` alone in a paragraph stands for blocks, else for text.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import replace
from itertools import count
from math import degrees
from pathlib import Path
from typing import Any

from sympy import Expr

import pendcore
from pendcore import Case, Solution
from pendcore.derive import document as doc
from pendcore.derive import line_breaks
from pendcore.derive.derivation import Derivation
from pendcore.derive.document import Block, Document, Heading, Paragraph
from pendcore.derive.laws.rod_drag import AT_REST
from pendcore.derive.narration.kinematics import statements
from pendcore.derive.narration.page import Page
from pendcore.derive.report import motion, numbers
from pendcore.derive.report.bodies import free_bodies, mechanism
from pendcore.derive.report.quantities import number, quantity, unit
from pendcore.derive.step import Equation, Step, groups

BY_HAND = 22.0
"""Width in print, in em, of what fits on a line by hand."""
ROOM = r"\qquad" * 7
"""Room in which an acceleration is written by hand."""


def filled(name: str, parts: Mapping[str, Any]) -> list[Block]:
    """Return the blocks of a template, of texts and lists of blocks; empty ones are left out."""
    found: list[Block] = []
    template = Path(__file__).with_name("templates") / f"{name}.md"
    for paragraph in template.read_text("utf-8").strip().split("\n\n"):
        text, key = " ".join(paragraph.splitlines()), paragraph[2:-1]
        if not isinstance(blocks := parts.get(key, ""), str):
            found += blocks
            continue
        text = re.sub(r"@{(\w+)}", lambda place: str(parts[place[1]]), text)
        hashes, _, title = text.partition(" ")
        if hashes in ("##", "###"):
            found.append(Heading(len(hashes), title))
        elif text:
            found.append(Paragraph(text.strip("*"), is_remark=text[0] == "*" != text[1]))
    return found


def report(derivation: Derivation, case: Case, solution: Solution, refusal: str = "") -> Document:
    """Return the derivation of a case with its solution, as `motion.solved` has it."""
    parts = {
        "problem": _problem(derivation, case),
        "steps": _steps(derivation, case),
        **numbers.put_in(derivation),
        **numbers.at_the_start(derivation, case),
        **motion.numerical_solution(derivation, solution, refusal),
        **motion.energy_check(derivation, solution),
        "version": pendcore.__version__,
    }
    return _document(case.name or derivation.in_words, "report", parts)


def worksheet(derivation: Derivation, case: Case, solution: Solution) -> Document:
    """Return the same problem with blanks: right sides, free bodies and curves are to be found."""
    balance = "how well does your solution keep it?"
    if motion.does_work(case):
        balance = (
            "how much did the effects take or give until the end, and how well does your solution "
            "keep the balance?"
        )
    parts = {
        "problem": _problem(derivation, case, by_hand=True),
        "steps": _steps(derivation, case, blanks=True),
        "axes": [motion.empty_axes(solution)],
        "balance": balance,
    }
    for name, lines in (("five_lines", 5), ("six_lines", 6), ("seven_lines", 7)):
        parts[name] = [doc.Blank("", lines=lines)]
    return _document(f"{case.name or derivation.in_words}: worksheet", "worksheet", parts)


def _document(title: str, name: str, parts: Mapping[str, Any]) -> Document:
    """Return a filled template with its figures numbered."""
    numbers, blocks = count(1), list[Block]()
    for block in filled(name, parts):
        if isinstance(block, doc.Drawing):
            block = replace(block, caption=f"Fig. {next(numbers)}. {block.caption}")
        blocks.append(block)
    return Document(title[:1].upper() + title[1:], tuple(blocks))


def _problem(derivation: Derivation, case: Case, *, by_hand: bool = False) -> list[Block]:
    """Return what is given, and Fig. 1; by hand without what only avoids 0/0."""
    page, s, write = Page(derivation), derivation.symbols, derivation.symbols.latex
    gravity = "gravity and " if derivation.scene.gravity else ""
    nothing = f"Nothing acts on the chain but {gravity}the joint that holds it."
    rows = tuple(
        (f"${write(symbol)}$", meaning, f"${number(value, 10)}$", f"${unit(name) or '-'}$")
        for symbol, value, name, meaning in s.parameters
        if not (by_hand and value == AT_REST)
    )
    begin, end = (quantity(t, "s") for t in case.t_span)
    initial = " \\\\\n".join(
        rf"{write(q)}({number(case.t_span[0])}) &= {quantity(angle, 'rad')} = "
        rf"{number(degrees(angle))}^\circ, & {write(qd)}({number(case.t_span[0])}) &= "
        rf"{quantity(rate, 'rad/s')}"
        for q, qd, angle, rate in zip(s.q, s.qd, case.q0, case.qd0, strict=True)
    )
    return filled("problem", {
        "chain": derivation.in_words,
        "rods": " The links are uniform rods." if page.is_uniform else "",
        "acts": [Paragraph(x) for x in (statements(page) if page.equations.laws else [nothing])],
        "mechanism": [mechanism(page, case.q0)],
        "parameters": [doc.Table(("symbol", "meaning", "value", "unit"), rows, "llrl")],
        "initial": [doc.Displayed(f"\\begin{{aligned}}\n{initial}\n\\end{{aligned}}")],
        "begin": begin, "end": end,
    })  # fmt: skip


def _steps(derivation: Derivation, case: Case, *, blanks: bool = False) -> list[Block]:
    """Return the derivation; the free bodies come before the first of their equations."""
    names, found = _names(derivation), list[Block]()
    for step in derivation.steps:
        if step.title == "Effects":
            step = replace(step, text="What acts besides gravity is stated above.")
        heading, text, *displayed = step.blocks(lambda e: _value(e, derivation))
        found += [heading, text]
        if step.title == "Newton-Euler equations of link 1":
            found.append(free_bodies(Page(derivation), case.q0, forces=not blanks))
        found += _blanks(step, names) if blanks else displayed
    return found


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
