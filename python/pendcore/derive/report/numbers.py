"""The equations with the numbers of the scene, and what they say at the start."""

from __future__ import annotations

from typing import Any

import numpy as np
import sympy
from sympy import Expr, Float, Symbol

from pendcore import Case, simulate
from pendcore.derive.derivation import Derivation
from pendcore.derive.document import Displayed, Table
from pendcore.derive.line_breaks import aligned, rows
from pendcore.derive.motion import needed
from pendcore.derive.report.quantities import DIGITS, ROUNDING, Scales, number, quantity, unit

OF_LOCKS = (
    "the couples of locks are unknown, and found together with the accelerations, from the "
    "condition that a locked joint does not turn."
)
LOCKS_IN_THE_CORE = (
    " The core has no couples of locks: in its column they are its mass matrix times the change "
    "that the locks make to its accelerations."
)


def put_in(derivation: Derivation) -> dict[str, Any]:
    """Return M and f with the numbers of the scene, and the laws in which they are written."""
    write, locking = derivation.symbols.latex, derivation.locking
    entries = derivation.named.entries
    laws = needed(derivation.equations.definitions.items(), entries.values())
    units = {x: words.rpartition(", ")[2] for x, words in derivation.symbols.meanings.items()}
    blocks = [
        [
            row
            for symbol, value in block
            for row in _numeric(derivation, symbol, value, units.get(symbol) or _unit(symbol))
        ]
        for block in (laws, entries.items())
    ]
    told = ", ".join(f"${write(name)} = {write(value)}$" for name, value in locking.items())
    return {
        "locking": r" + \boldsymbol{\lambda}" if locking else "",
        "numbers": [Displayed(aligned(rows)) for rows in blocks if rows],
        "couples": f"and {told}: {OF_LOCKS}" if locking else "",
    }


def _unit(entry: Symbol) -> str:
    """Return the unit of an entry of M or f."""
    return "kg m^2" if entry.name.startswith("M") else "N m"


def _numeric(derivation: Derivation, symbol: Symbol, value: Expr, name: str) -> list[str]:
    """Return rows of a symbol's value in numbers, with the unit behind it."""
    write = derivation.symbols.latex
    put_in = sympy.sympify(value.xreplace(derivation.values))
    if not put_in.has(sympy.Abs):  # the drag is a quotient, and stays one
        put_in = sympy.expand(put_in)
    if put_in.is_number:
        return [f"{write(symbol)} &= {quantity(float(put_in), name)}"]
    put_in = put_in.xreplace({x: _short(x) for x in put_in.atoms(Float)})
    right = write(put_in)
    if put_in.is_Add:
        right = rf"\left({right}\right)"
    return rows(write(symbol), rf"{right}\;{unit(name)}")


def _short(value: Float) -> Expr:
    """Return a number with the digits that are printed."""
    text = f"{float(value):.{DIGITS}g}"
    return sympy.Integer(text) if text.lstrip("-").isdigit() else Float(text, DIGITS)


class Start:
    """The state at the start, and what the derivation and the compiled core make of it."""

    def __init__(self, derivation: Derivation, case: Case) -> None:
        self.derivation = derivation
        self.case = case
        s = derivation.symbols
        self.known: dict[Any, Any] = {**derivation.values, s.t: case.t_span[0]}
        self.known |= dict(zip((*s.q, *s.qd), (*case.q0, *case.qd0), strict=True))
        solved = [self.value(a) for a in derivation.accelerations]
        self.known |= dict(zip(s.qdd, solved, strict=True))

    def value(self, expression: Expr) -> float:
        """Return the number of an expression at the start, computed with twenty digits."""
        return float(sympy.sympify(expression.xreplace(self.known)).evalf(20))

    def rows(self) -> list[tuple[str, str, float, float]]:
        """Return name, unit, value by the derivation and by the core, for each row of the table."""
        derivation, case, scene = self.derivation, self.case, self.derivation.scene
        equations, write, time = derivation.equations, derivation.symbols.latex, case.t_span[0]
        run = simulate(scene, (time, time), case.q0, case.qd0, on_failure="ignore")
        qdd, energy = derivation.symbols.qdd, run.energy()
        rows: list[tuple[Any, str, Expr, float]] = [
            (a, "rad/s^2", a, core) for a, core in zip(qdd, run.accelerations()[0], strict=True)
        ]
        forces = zip(equations.forces, derivation.reactions, run.reactions()[0], strict=True)
        for i, of_joint in enumerate(forces):
            sign = 1 if i == 0 else -1  # F_12 is the core's, F_21 the derivation's
            parts = zip(*of_joint, strict=True)
            rows += [(name, "N", sign * x, sign * core) for name, x, core in parts]
        if equations.locked:  # the couples that make the free chain's accelerations these
            free = scene.replace(effects=[x for x in scene.effects if x.kind != "lock"])
            change = run.accelerations() - free.accelerations(run.t, run.q, run.qd)
            couples = np.cumsum((scene.mass_matrix(run.q[0]) @ change[0])[::-1])[::-1]
            for joint, couple in derivation.holding_couples.items():
                rows.append((equations.holding[joint], "N m", couple, couples[joint - 1]))
        rows.append(("T", "J", derivation.kinetic_energy, energy.kinetic[0]))
        rows.append(("V", "J", derivation.potential_energy, energy.potential[0]))
        return [(write(name), unit, self.value(x), float(core)) for name, unit, x, core in rows]


def at_the_start(derivation: Derivation, case: Case) -> dict[str, Any]:
    """Return the accelerations, reactions and energies at the start, beside the core's."""
    start, write, s = Start(derivation, case), derivation.symbols.latex, derivation.symbols
    table = start.rows()
    state = [(x, angle, "rad") for x, angle in zip(s.q, case.q0, strict=True)]
    state += [(x, rate, "rad/s") for x, rate in zip(s.qd, case.qd0, strict=True)]
    entries = {x: start.value(value) for x, value in derivation.known.items()}
    measures = [("N m", value) for x, value in entries.items() if _unit(x) == "N m"]
    scales = Scales(derivation, [*measures, *((u, x) for _, u, *both in table for x in both)])
    shown = _without_rounding(entries, scales).items()
    cells = tuple(
        (f"${name}$", *(f"${number(scales.shown(x, u))}$" for x in both), f"${unit(u)}$")
        for name, u, *both in table
    )
    off = max(abs(a - b) / (scales.of[u] or 1.0) for _, u, a, b in table)
    return {
        "begin": quantity(case.t_span[0], "s"),
        "state": ", ".join(f"${write(x)} = {quantity(value, of)}$" for x, value, of in state),
        "entries": [Displayed(aligned(
            [f"{write(x)} &= {quantity(value, _unit(x))}" for x, value in shown]))],
        "compared": [Table(("", "by this derivation", "by the core", "unit"), cells, "lrrl")],
        "off": number(off, 2), "rounding": number(ROUNDING),
        "of_locks": LOCKS_IN_THE_CORE if derivation.equations.locked else "",
    }  # fmt: skip


def _without_rounding(entries: dict[Symbol, float], scales: Scales) -> dict[Symbol, float]:
    """M and f as they are printed; M_ij is measured by the root of M_ii M_jj."""
    by_name = {symbol.name: value for symbol, value in entries.items()}
    shown = {}
    for symbol, value in entries.items():
        kind, *ij = symbol.name
        size = np.sqrt(np.prod([by_name[f"M{i}{i}"] for i in ij])) if kind == "M" else 0.0
        shown[symbol] = value if abs(value) >= ROUNDING * size else 0.0
        shown[symbol] = scales.shown(shown[symbol], _unit(symbol))
    return shown
