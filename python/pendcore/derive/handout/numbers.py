"""The equations with the numbers of the scene, and what they say at the start."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import sympy
from sympy import Expr, Float

from pendcore.case import Case
from pendcore.derive import line_breaks
from pendcore.derive.derivation import Derivation
from pendcore.derive.handout.document import Block, Displayed, Heading, Paragraph, Table
from pendcore.derive.handout.quantities import number, quantity, unit


def numbers_put_in(derivation: Derivation) -> Iterator[Block]:
    """Yield M and f with the numbers of the scene."""
    yield Heading(3, "The equations of motion with numbers")
    yield Paragraph(
        r"With the numbers of the table, angles in rad, rates in rad/s and $t$ in s, the equations "
        r"of motion $\mathbf{M}(q)\,\ddot{\mathbf{q}} = \mathbf{f}$ have"
    )
    for block in (_laws(derivation), _entries(derivation)):
        if block:
            yield Displayed(line_breaks.aligned(block))


def _laws(derivation: Derivation) -> list[str]:
    found: list[str] = []
    for definition in derivation.equations.torques:
        found += _numeric(derivation, definition.symbol, definition.value, "N m")
    return found


def _entries(derivation: Derivation) -> list[str]:
    found: list[str] = []
    for symbol, value in derivation.motion.named.entries.items():
        name = "kg m^2" if symbol.name.startswith("M") else "N m"
        found += _numeric(derivation, symbol, value, name)
    return found


def _numeric(derivation: Derivation, symbol: Any, value: Expr, name: str) -> list[str]:
    """Return rows of a symbol's value in numbers, with its unit behind."""
    write = derivation.symbols.latex
    put_in = sympy.expand(value.xreplace(derivation.values))
    if put_in.is_number:
        return [f"{write(symbol)} &= {quantity(float(put_in), name)}"]
    rounded = _rounded(put_in)
    rows = line_breaks.rows(write(symbol), rounded, derivation.symbols)
    if rounded.is_Add:
        before, after = rows[0].split("&= ", 1)
        if len(rows) == 1:
            return [rf"{before}&= \left({after}\right)\,{unit(name)}"]
        rows[0] = rf"{before}&= \bigl({after}"
        rows[-1] += rf"\bigr)\,{unit(name)}"
        return rows
    rows[-1] += rf"\;{unit(name)}"
    return rows


def _rounded(expression: Expr) -> Expr:
    """Put six digits for every number, as names: 0.5 is written so, and stands before its term."""
    short: dict[Expr, Expr] = {}
    for x in expression.atoms(Float):
        size = number(abs(float(x)))
        known = sympy.Integer(size) if size.isdigit() else sympy.Symbol(size, positive=True)
        short[x] = -known if x < 0 else known
    return expression.xreplace(short)


class Start:
    """The state at the start, and what the derivation and the compiled core make of it."""

    def __init__(self, derivation: Derivation, case: Case) -> None:
        self.derivation = derivation
        self.case = case
        s = derivation.symbols
        self.known: dict[Any, Any] = {**derivation.values, s.t: case.t_span[0]}
        self.known |= dict(zip(s.q, case.q0, strict=True)) | dict(zip(s.qd, case.qd0, strict=True))
        solved = [self.value(a) for a in derivation.accelerations]
        self.known |= dict(zip(s.qdd, solved, strict=True))
        self.accelerations = solved

    def value(self, expression: Expr) -> float:
        """Return the number of an expression at the start, computed with twenty digits."""
        return float(expression.xreplace(self.known).evalf(20))

    def rows(self) -> list[tuple[str, str, float, float]]:
        """Return name, unit, value by the derivation and by the core, for all that is told."""
        derivation, case, scene = self.derivation, self.case, self.derivation.scene
        s, write = derivation.symbols, derivation.symbols.latex
        q, qd, t = np.array([case.q0]), np.array([case.qd0]), np.array([case.t_span[0]])
        accelerations = scene.accelerations(t[0], q[0], qd[0])
        forces = scene._compiled.reactions(t, q, qd)[0]
        kinetic, potential = (float(x[0]) for x in scene._compiled.energy(t, q, qd))
        found = [
            (write(s.qdd[i]), "rad/s^2", self.accelerations[i], float(accelerations[i]))
            for i in range(derivation.n)
        ]
        for i, (names, pair) in enumerate(
            zip(derivation.equations.forces, derivation.reactions, strict=True)
        ):
            sign = 1 if i == 0 else -1  # F_12 is the core's, F_21 the derivation's
            for k in (0, 1):
                own, core = sign * self.value(pair[k]), sign * float(forces[i, k])
                found.append((write(names[k]), "N", own, core))
        found.append(("T", "J", self.value(derivation.kinetic_energy), kinetic))
        found.append(("V", "J", self.value(derivation.potential_energy), potential))
        return found


def at_the_start(derivation: Derivation, case: Case) -> Iterator[Block]:
    """Yield the accelerations, reactions and energies at the start, beside the core's."""
    start = Start(derivation, case)
    s, write = derivation.symbols, derivation.symbols.latex
    yield Heading(3, "At the start")
    state = [(q, angle, "rad") for q, angle in zip(s.q, case.q0, strict=True)]
    state += [(qd, rate, "rad/s") for qd, rate in zip(s.qd, case.qd0, strict=True)]
    told = ", ".join(f"${write(x)} = {quantity(value, of)}$" for x, value, of in state)
    yield Paragraph(f"At $t = {quantity(case.t_span[0], 's')}$, with {told}, they are")
    entries = {
        symbol: start.value(value.xreplace(derivation.motion.definitions))
        for symbol, value in derivation.motion.named.entries.items()
    }
    largest = max(map(abs, entries.values()))
    lines = []
    for symbol, value in entries.items():
        name = "kg m^2" if symbol.name.startswith("M") else "N m"
        lines.append(f"{write(symbol)} &= {quantity(_shown(value, largest), name)}")
    yield Displayed(line_breaks.aligned(lines))
    yield Paragraph(
        "From them follow the accelerations, and from these the reactions. The compiled core of "
        "pendcore, which does not have its equations from here, computes the same:"
    )
    rows = start.rows()
    scale = max(max(abs(a), abs(b)) for *_, a, b in rows) or 1.0
    cells = [
        (f"${n}$", *(f"${number(_shown(value, scale))}$" for value in both), f"${unit(u)}$")
        for n, u, *both in rows
    ]
    yield Table(("", "by this derivation", "by the core", "unit"), tuple(cells), "lrrl")
    off = max(abs(a - b) for *_, a, b in rows) / scale
    yield Paragraph(f"The two differ by at most ${number(off, 2)}$ of the largest value.")


def _shown(value: float, largest: float) -> float:
    """Return a number as it is printed: what the rounding of an angle leaves of 0 is 0."""
    return value if abs(value) > 1e-15 * largest else 0.0
