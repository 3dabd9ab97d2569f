"""What generated files have in common: what they compute, their statements, what they say."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import chain, count
from textwrap import wrap
from typing import Any, NamedTuple

import sympy
from sympy import Dummy, Expr, Symbol, cos, numbered_symbols, sin

import pendcore
from pendcore.derive.derivation import Derivation
from pendcore.derive.motion import Assignments, needed

COLUMNS = 100
Write = Callable[[Expr], str]


class Computation(NamedTuple):
    """Assignments, each of which needs only those before it, and the results."""

    assignments: Assignments
    results: tuple[Expr, ...]

    @property
    def needs(self) -> set[Symbol]:
        """What must be known from outside."""
        inside = {symbol for symbol, _ in self.assignments}
        return {symbol for one in self._every for symbol in one.free_symbols} - inside

    @property
    def operations(self) -> int:
        """The number of additions, multiplications, divisions, powers and calls of functions."""
        return sum(int(sympy.count_ops(one)) for one in self._every)

    @property
    def _every(self) -> list[Expr]:
        return [*(value for _, value in self.assignments), *self.results]


def computations(derivation: Derivation) -> dict[str, Computation]:
    """Return what a file computes, of t, q, qd, qdd and the parameters.

    ``accelerations`` (n,), rad/s^2; ``reactions`` F_01x, F_01y, F_12x, ... (2n,), N; ``energy``,
    kinetic and potential, J; ``powers`` of the effects in the order of `powers_by_name`, W.
    """
    laws = derivation.equations.definitions.items()
    forces = [part for force in derivation.equations.reactions for part in force]
    return {
        "accelerations": share(derivation.shared_accelerations, derivation.shared),
        "reactions": share(forces, laws),
        "energy": share(derivation.energies_by_definitions, laws),
        "powers": share([*derivation.powers_by_definitions.values()], laws),
    }


def powers_by_name(derivation: Derivation) -> dict[str, Any]:
    """Return the effects that bring in or take energy, by kind and place: ``viscous_joint_1``."""
    named: dict[str, Any] = {}
    for effect in derivation.powers_by_definitions:
        place = getattr(effect, "joint", getattr(effect, "link", None))
        name = effect.kind if place is None else f"{effect.kind}_{place}"
        numbered = (f"{name}_{number}" for number in count(2))
        named[next(one for one in chain([name], numbered) if one not in named)] = effect
    return named


def share(results: Sequence[Expr], assignments: Iterable[tuple[Symbol, Expr]] = ()) -> Computation:
    """Compute once whatever the results, and the assignments that lead to them, have in common.

    Sines and cosines are named ``sin_q1``, or ``cos_q1_q2`` for q1 - q2; everything else that is
    shared is named ``e1``, ``e2``, ... Assignments that nothing uses are left out.
    """
    used = needed(assignments, results)
    expressions = [*(value for _, value in used), *results]
    calls = sorted({call for x in expressions for call in x.atoms(sin, cos)}, key=str)
    named = {call: Symbol(_name(call), real=True) for call in calls}
    temporary, reduced = sympy.cse(
        [x.xreplace(named) for x in expressions], numbered_symbols(cls=Dummy), order="canonical"
    )
    names = [symbol for symbol, _ in used]
    values = {symbol: call for call, symbol in named.items()} | dict(temporary)
    values |= dict(zip(names, reduced, strict=False))
    wanted = reduced[len(names) :]
    order: dict[Symbol, Expr] = {}  # each just before what needs it

    def reach(symbol: Symbol) -> None:
        if symbol in values and symbol not in order:
            for other in sorted(values[symbol].free_symbols, key=str):
                reach(other)
            order[symbol] = values[symbol]

    for symbol in (*names, *(s for x in wanted for s in sorted(x.free_symbols, key=str))):
        reach(symbol)
    numbers = numbered_symbols("e", real=True)
    final = {symbol: next(numbers) for symbol in order if isinstance(symbol, Dummy)}
    return Computation(
        tuple((final.get(symbol, symbol), x.xreplace(final)) for symbol, x in order.items()),
        tuple(x.xreplace(final) for x in wanted),
    )


def _name(call: Expr) -> str:
    words = str(call).replace(" + ", "_plus_").replace(" - ", "_")
    return re.sub(r"\W+", "_", words).strip("_")


def origin(derivation: Derivation, mark: str = "") -> str:
    """Return the lines that say what wrote a file, from which scene, and in which convention."""
    scene = "\n".join(indented(repr(derivation.scene)))
    text = f"""\
Written by pendcore {pendcore.__version__} (pendcore.derive, SymPy {sympy.__version__}) from

{scene}

The textbook's section 2.1, for any chain: Newton's and Euler's equations of every link,
its joint forces eliminated, solved for the angular accelerations.

x points right, y points DOWN, the origin is the pivot. q_i is the absolute angle of
link i, from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Units are SI: kg,
m, s, rad, N, J.

M qdd = f are the equations of motion, M11 and f1 entries of both; D1, l21, h1, a2 come
from elimination, M = L D L^T. cos_q1_q2 is the cosine of q1 - q2; e1, e2, ... are what
several lines share."""
    return "\n".join(f"{mark}{line}".rstrip() for line in text.splitlines())


def indented(text: str) -> list[str]:
    """Return a text in lines, four columns in."""
    lines = wrap(text, COLUMNS - 14, break_long_words=False, break_on_hyphens=False)
    return [f"    {line}" for line in lines]


def wrapped(statement: str, indent: str = "", more: str = "") -> list[str]:
    """Return a statement in lines: all but the last end in `more`, the later ones are indented."""
    lines = wrap(
        statement, COLUMNS - len(more), initial_indent=indent, subsequent_indent=f"{indent}    ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return [f"{line}{more}" for line in lines[:-1]] + lines[-1:]


def assigned(
    derivation: Derivation, computation: Computation, write: Write, statement: str, remark: str
) -> Iterator[str]:
    """Yield the assignments of a computation as statements, with what the laws' symbols mean."""
    meanings = derivation.symbols.meanings
    for symbol, value in computation.assignments:
        if symbol in meanings:
            yield f"{remark}{meanings[symbol]}"
        yield statement.format(write(symbol), write(value))


def constants(derivation: Derivation, statement: str, remark: str) -> str:
    """Return the scene's numbers as lines, with their meanings behind them, or above."""
    rows = []
    for symbol, value, unit, meaning in derivation.symbols.parameters:
        words = meaning if unit == "1" else f"{meaning}, {unit}"
        rows.append((statement.format(symbol, value), f"{remark}{words}"))
    width = max(len(number) for number, _ in rows)
    lines = []
    for number, words in rows:
        beside = f"{number:{width}}  {words}"
        indent = number[: len(number) - len(number.lstrip())]
        above = [indent + words.replace("///<", "///"), number]
        lines += [beside] if len(beside) <= COLUMNS else above
    return "\n".join(lines)
