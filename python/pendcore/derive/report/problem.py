"""The first page of a report: what is given and what is to be found."""

from __future__ import annotations

from collections.abc import Iterator

from pendcore._cases.case import Case
from pendcore.derive.algebra import Algebra
from pendcore.derive.laws.rod_drag import AT_REST
from pendcore.derive.report.document import Block, Displayed, Heading, Paragraph, Table
from pendcore.derive.report.effect_text import what_acts
from pendcore.derive.report.figures import Figures
from pendcore.derive.report.quantities import number, quantity, unit

COUNTS = {1: "one link", 2: "two links", 3: "three links", 4: "four links", 5: "five links"}


def problem(
    derivation: Algebra, case: Case, figures: Figures, *, by_hand: bool = False
) -> Iterator[Block]:
    """Yield what is given, and Fig. 1.

    Parameters
    ----------
    derivation : Algebra
        The derivation of the scene.
    case : Case
        The case, with its start.
    figures : Figures
        Draws Fig. 1.
    by_hand : bool
        Whether to leave out what only a computer needs, to avoid 0/0.
    """
    yield Heading(2, "The problem")
    yield Paragraph(_what_moves(derivation))
    for sentences in what_acts(derivation, case.q0):
        yield Paragraph(sentences)
    yield figures.mechanism()
    yield Paragraph("These numbers are given:")
    rows = [
        (f"${derivation.symbols.latex(p.symbol)}$", p.meaning, f"${number(p.value, 10)}$", _unit(p))
        for p in derivation.symbols.parameters
        if not (by_hand and p.value == AT_REST)
    ]
    yield Table(("symbol", "meaning", "value", "unit"), tuple(rows), "llrl")
    yield Paragraph(
        "Find the equations of motion, the joint reactions and the motion that follows from"
    )
    yield Displayed(initial_conditions(derivation, case))
    start, end = case.t_span
    yield Paragraph(f"from $t = {quantity(start, 's')}$ to $t = {quantity(end, 's')}$.")


def initial_conditions(derivation: Algebra, case: Case) -> str:
    """Return LaTeX of the angles and rates at the start."""
    s, lines = derivation.symbols, []
    time = number(case.t_span[0])
    for q, qd, angle, rate in zip(s.q, s.qd, case.q0, case.qd0, strict=True):
        lines.append(
            rf"{s.latex(q)}({time}) &= {quantity(angle, 'rad')} = "
            rf"{number(angle * 57.29577951308232)}^\circ, & "
            rf"{s.latex(qd)}({time}) &= {quantity(rate, 'rad/s')}"
        )
    body = " \\\\\n".join(lines)
    return f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}"


def _what_moves(derivation: Algebra) -> str:
    n, scene = derivation.n, derivation.scene
    uniform = not any(link.particulars().keys() - {"mass", "length"} for link in scene.links)
    name = {1: "pendulum", 2: "double pendulum"}.get(n, "chain")
    links = COUNTS.get(n, f"{n} links")
    rods = " The links are uniform rods." if n > 1 else " The link is a uniform rod."
    rods = rods if uniform else ""
    return (
        f"A planar {name} of {links} (Fig. 1) moves in a vertical plane.{rods} "
        "The $x$ axis points to the right and the $y$ axis down; the angles are measured from the "
        "$x$ axis towards the $y$ axis."
    )


def _unit(parameter: object) -> str:
    shown = unit(getattr(parameter, "unit", ""))
    return f"${shown}$" if shown else ""
