"""The equations with the numbers of the scene, and what they say at the start."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import sympy
from sympy import Expr, Float

from pendcore._cases.case import Case
from pendcore._messages.arguments import Floats
from pendcore.derive import line_breaks
from pendcore.derive.algebra import Algebra
from pendcore.derive.report.document import Block, Displayed, Heading, Paragraph, Table
from pendcore.derive.report.quantities import number, quantity, unit
from pendcore.derive.report.scales import ROUNDING, Scales


def numbers_put_in(derivation: Algebra) -> Iterator[Block]:
    """Yield M and f with the numbers of the scene."""
    yield Heading(3, "The equations of motion with numbers")
    locked = derivation.motion.locking
    law = r"\mathbf{M}(q)\,\ddot{\mathbf{q}} = \mathbf{f}"
    law += r" + \boldsymbol{\lambda}" if locked else ""
    yield Paragraph(
        r"With the numbers of the table, angles in rad, rates in rad/s and $t$ in s, the equations "
        rf"of motion ${law}$ have"
    )
    for block in (_laws(derivation), _entries(derivation)):
        if block:
            yield Displayed(line_breaks.aligned(block))
    if locked:
        write = derivation.symbols.latex
        told = ", ".join(f"${write(name)} = {write(value)}$" for name, value in locked.items())
        yield Paragraph(
            f"and {told}: the couples of locks are unknown, and found together with the "
            "accelerations, from the condition that a locked joint does not turn."
        )


def _laws(derivation: Algebra) -> list[str]:
    """Return rows for the symbols in which M and f are written: torques, loads, the pivot."""
    needed = set[Any]().union(*(x.free_symbols for x in derivation.motion.named.entries.values()))
    wanted = []
    for definition in reversed(derivation.equations.definitions):
        if definition.symbol in needed:
            needed |= definition.value.free_symbols
            wanted.append(definition)
    found: list[str] = []
    for symbol, value, meaning in reversed(wanted):
        found += _numeric(derivation, symbol, value, meaning.rpartition(", ")[2])
    return found


def _entries(derivation: Algebra) -> list[str]:
    found: list[str] = []
    for symbol, value in derivation.motion.named.entries.items():
        name = "kg m^2" if symbol.name.startswith("M") else "N m"
        found += _numeric(derivation, symbol, value, name)
    return found


def _numeric(derivation: Algebra, symbol: Any, value: Expr, name: str) -> list[str]:
    """Return rows of a symbol's value in numbers, with the unit behind it."""
    write = derivation.symbols.latex
    put_in = sympy.sympify(value.xreplace(derivation.values))
    if not put_in.has(sympy.Abs):  # the drag is a quotient, and stays one
        put_in = sympy.expand(put_in)
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
    """Replace each number by a symbol named by six digits: 0.5 is written so, before its term."""
    short: dict[Expr, Expr] = {}
    for x in expression.atoms(Float):
        size = number(abs(float(x)))
        known = sympy.Integer(size) if size.isdigit() else sympy.Symbol(size, positive=True)
        short[x] = -known if x < 0 else known
    return expression.xreplace(short)


class Start:
    """The state at the start, and what the derivation and the compiled core make of it."""

    def __init__(self, derivation: Algebra, case: Case) -> None:
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
        """Return name, unit, value by the derivation and by the core, for each row of the table."""
        derivation, case, scene = self.derivation, self.case, self.derivation.scene
        s, write = derivation.symbols, derivation.symbols.latex
        q, qd, t = np.array([case.q0]), np.array([case.qd0]), np.array([case.t_span[0]])
        accelerations = scene.accelerations(t, q, qd)
        forces = scene._compiled.reactions(t, q, qd)[0]
        kinetic, potential = (float(x[0]) for x in scene._compiled.energy(t, q, qd))
        found = [
            (write(s.qdd[i]), "rad/s^2", self.accelerations[i], float(accelerations[0, i]))
            for i in range(derivation.n)
        ]
        for i, (names, pair) in enumerate(
            zip(derivation.equations.forces, derivation.reactions, strict=True)
        ):
            sign = 1 if i == 0 else -1  # F_12 is the core's, F_21 the derivation's
            for k in (0, 1):
                own, core = sign * self.value(pair[k]), sign * float(forces[i, k])
                found.append((write(names[k]), "N", own, core))
        for joint, couple in self._couples_of_core(q, qd, t, accelerations[0]).items():
            own = self.value(derivation.holding_couples[joint])
            found.append((write(derivation.equations.holding[joint]), "N m", own, couple))
        found.append(("T", "J", self.value(derivation.kinetic_energy), kinetic))
        found.append(("V", "J", self.value(derivation.potential_energy), potential))
        return found

    def _couples_of_core(
        self, q: Floats, qd: Floats, t: Floats, locked: Floats
    ) -> dict[int, float]:
        """Return the couples of locks, N m, which make the free chain's accelerations these."""
        scene, joints = self.derivation.scene, self.derivation.equations.locked
        if not joints:
            return {}
        free = scene.replace(effects=[x for x in scene.effects if x.kind != "lock"])
        left = scene.mass_matrix(q[0]) @ (locked - free.accelerations(t, q, qd)[0])
        couples = np.cumsum(left[::-1])[::-1]
        return {joint: float(couples[joint - 1]) for joint in joints}


def at_the_start(derivation: Algebra, case: Case) -> Iterator[Block]:
    """Yield the accelerations, reactions and energies at the start, beside the core's."""
    start = Start(derivation, case)
    rows = start.rows()
    yield Heading(3, "At the start")
    yield Paragraph(_state(derivation, case))
    entries = {
        symbol: start.value(value.xreplace(derivation.motion.definitions))
        for symbol, value in derivation.motion.named.entries.items()
    }
    units = {x: "kg m^2" if x.name.startswith("M") else "N m" for x in entries}
    found = [("N m", value) for x, value in entries.items() if units[x] == "N m"]
    scales = Scales(derivation, [*found, *((u, x) for _, u, *both in rows for x in both)])
    write = derivation.symbols.latex
    yield Displayed(
        line_breaks.aligned(
            [
                f"{write(x)} &= {quantity(value, units[x])}"
                for x, value in _without_rounding(entries, scales).items()
            ]
        )
    )
    couples = " and the couples of the locks" if derivation.equations.locked else ""
    yield Paragraph(
        f"They give the accelerations{couples}, and these give the reactions. The compiled core of "
        "pendcore, which has its equations from elsewhere, computes the same:"
    )
    cells = [
        (f"${n}$", *(f"${number(scales.shown(x, u))}$" for x in both), f"${unit(u)}$")
        for n, u, *both in rows
    ]
    yield Table(("", "by this derivation", "by the core", "unit"), tuple(cells), "lrrl")
    off = max(abs(a - b) / (scales.of[u] or 1.0) for _, u, a, b in rows)
    yield Paragraph(
        "A force is measured by the weights, an acceleration by $g$ over the shortest length, a "
        "couple or an energy by the weights times the lengths, or by the largest of its unit "
        f"where that is larger. The two differ by at most ${number(off, 2)}$ of this measure. What "
        f"is below ${number(ROUNDING)}$ of it is what rounding leaves of 0, and is printed as 0."
        + (
            " The core has no couples of locks: in its column they are its mass matrix times the "
            "change that the locks make to its accelerations."
            if derivation.equations.locked
            else ""
        )
    )


def _without_rounding(entries: dict[Any, float], scales: Scales) -> dict[Any, float]:
    """M and f as they are printed; M_ij is measured by the root of M_ii M_jj."""
    by_name = {symbol.name: value for symbol, value in entries.items()}
    shown = {}
    for symbol, value in entries.items():
        kind, *ij = symbol.name
        if kind == "M":
            size = float(np.sqrt(np.prod([by_name[f"M{i}{i}"] for i in ij])))
            shown[symbol] = value if abs(value) >= ROUNDING * size else 0.0
        else:
            shown[symbol] = scales.shown(value, "N m")
    return shown


def _state(derivation: Algebra, case: Case) -> str:
    """Say what the state at the start is."""
    s, write = derivation.symbols, derivation.symbols.latex
    state = [(q, angle, "rad") for q, angle in zip(s.q, case.q0, strict=True)]
    state += [(qd, rate, "rad/s") for qd, rate in zip(s.qd, case.qd0, strict=True)]
    told = ", ".join(f"${write(x)} = {quantity(value, of)}$" for x, value, of in state)
    return (
        f"At $t = {quantity(case.t_span[0], 's')}$, with {told}, the entries of $\\mathbf{{M}}$ "
        "and $\\mathbf{f}$ are"
    )
