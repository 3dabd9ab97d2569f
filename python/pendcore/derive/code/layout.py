"""The common parts of generated files: the lines on their origin, statements, lines of a page."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from textwrap import wrap

import sympy
from sympy import Expr

import pendcore
from pendcore.derive.algebra import Algebra
from pendcore.derive.code.computation import Computation

COLUMNS = 100
Write = Callable[[Expr], str]
"""One of SymPy's printers of code."""


def origin(derivation: Algebra, mark: str = "") -> str:
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


def indented(text: str, columns: int = COLUMNS - 10) -> list[str]:
    """Return a text in lines, four columns in."""
    lines = wrap(text, columns - 4, break_long_words=False, break_on_hyphens=False)
    return [f"    {line}" for line in lines]


def wrapped(statement: str, indent: str = "", more: str = "") -> list[str]:
    """Return a statement in lines: all but the last end in `more`, the later ones are indented."""
    lines = wrap(
        statement, COLUMNS - len(more), initial_indent=indent, subsequent_indent=f"{indent}    ",
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return [f"{line}{more}" for line in lines[:-1]] + lines[-1:]


def assigned(
    derivation: Algebra, computation: Computation, write: Write, statement: str, remark: str
) -> Iterator[str]:
    """Yield the assignments of a computation as statements, with what the laws' symbols mean."""
    meanings = {known.symbol: known.meaning for known in derivation.equations.definitions}
    for symbol, value in computation.assignments:
        if symbol in meanings:
            yield f"{remark}{meanings[symbol]}"
        yield statement.format(write(symbol), write(value))


def constants(derivation: Algebra, statement: str, remark: str) -> str:
    """Return the scene's numbers as lines, with their meanings behind them, or above."""
    rows = []
    for symbol, value, unit, meaning in derivation.symbols.parameters:
        words = meaning if unit == "1" else f"{meaning}, {unit}"
        rows.append((statement.format(symbol, value), f"{remark}{words}"))
    width = max(len(number) for number, _ in rows)
    lines = []
    for number, words in rows:
        beside = f"{number:{width}}  {words}"
        above = [
            number[: len(number) - len(number.lstrip())] + words.replace("///<", "///"),
            number,
        ]
        lines += [beside] if len(beside) <= COLUMNS else above
    return "\n".join(lines)


def chain_in_words(derivation: Algebra) -> str:
    """Return what is simulated, in words."""
    kinds = {1: "a pendulum", 2: "a double pendulum", 3: "a triple pendulum"}
    return kinds.get(derivation.n, f"a chain of {derivation.n} links")
