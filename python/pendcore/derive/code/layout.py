"""The common parts of generated files: the lines on their origin, names, lines of a page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from keyword import iskeyword
from textwrap import wrap

import sympy
from sympy import Symbol

from pendcore import _core
from pendcore.derive.algebra import Algebra
from pendcore.derive.code.printer import Infix
from pendcore.derive.notation import Parameter

COLUMNS = 100


def origin(derivation: Algebra) -> Iterator[str]:
    """Yield the lines that say what wrote a file, from which scene, and in which convention."""
    writer = f"pendcore {_core.__version__} (pendcore.derive, SymPy {sympy.__version__})"
    yield f"Written by {writer} from"
    yield ""
    yield from indented(repr(derivation.scene))
    yield ""
    yield "The textbook's section 2.1, for any chain: Newton's and Euler's equations of every link,"
    yield "its joint forces eliminated, solved for the angular accelerations."
    yield ""
    yield "x points right, y points DOWN, the origin is the pivot. q_i is the absolute angle of"
    yield "link i, from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Units are SI: kg,"
    yield "m, s, rad, N, J."
    yield ""
    yield "M qdd = f are the equations of motion, M11 and f1 entries of both; D1, l21, h1, a2 come"
    yield "from elimination, M = L D L^T. cos_q1_q2 is the cosine of q1 - q2; e1, e2, ... are what"
    yield "several lines share."


def indented(text: str, columns: int = COLUMNS - 10) -> list[str]:
    """Return a text in lines, four columns in."""
    return [
        f"    {line}"
        for line in wrap(text, columns - 4, break_long_words=False, break_on_hyphens=False)
    ]


def wrapped(statement: str, indent: str, more: str = "") -> list[str]:
    """Return a statement in lines: all but the last end in `more`, the later ones are indented."""
    lines = wrap(
        statement,
        COLUMNS - len(more),
        initial_indent=indent,
        subsequent_indent=f"{indent}    ",
        break_long_words=False,
        break_on_hyphens=False,
    )
    return [f"{line}{more}" for line in lines[:-1]] + lines[-1:]


def identifiers(symbols: Iterable[Symbol], taken: Iterable[str]) -> dict[Symbol, str]:
    """Name symbols in a language that keeps the names of `taken` for itself.

    No name has two underscores in a row, which C++ keeps for itself.
    """
    known = {*taken}
    names: dict[Symbol, str] = {}
    for symbol in symbols:
        name = re.sub(r"\W|_+", "_", symbol.name)
        while name in known or iskeyword(name):
            name += "_" if not name.endswith("_") else "1"
        known.add(name)
        names[symbol] = name
    return names


def meanings(derivation: Algebra) -> dict[Symbol, str]:
    """Return the meanings, with units, of the symbols that laws define."""
    return {known.symbol: known.meaning for known in derivation.equations.definitions}


def constants(derivation: Algebra, writer: Infix, name: str, value: str, remark: str) -> list[str]:
    """Return the scene's numbers as lines; the three patterns are a language's.

    The meaning of a number stands behind it, or above it where the line would be too long.
    """
    rows = [
        (
            name.format(writer.doprint(parameter.symbol)) + value.format(parameter.value),
            remark.format(_in_words(parameter)),
        )
        for parameter in derivation.symbols.parameters
    ]
    width = max(len(row[0]) for row in rows)
    lines: list[str] = []
    for number, words in rows:
        beside = f"{number:{width}}{words}"
        if len(beside) <= COLUMNS:
            lines.append(beside)
        else:
            indent = number[: len(number) - len(number.lstrip())]
            lines += [f"{indent}{words.strip().replace('///<', '///')}", number]
    return lines


def chain_in_words(derivation: Algebra) -> str:
    """Return what is simulated, in words."""
    kinds = {1: "a pendulum", 2: "a double pendulum", 3: "a triple pendulum"}
    return kinds.get(derivation.n, f"a chain of {derivation.n} links")


def _in_words(parameter: Parameter) -> str:
    unit = "" if parameter.unit in ("", "1") else f", {parameter.unit}"
    return f"{parameter.meaning}{unit}"
