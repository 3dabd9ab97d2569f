"""What generated files have in common: who wrote them from what, and lines that are not too long."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import sympy
from sympy import Symbol

from pendcore import _core

if TYPE_CHECKING:
    from pendcore.derive.derivation import Derivation
    from pendcore.derive.notation import Parameter

COLUMNS = 100


def origin(derivation: Derivation) -> Iterator[str]:
    """Yield the lines that say what wrote a file, from which scene, and in which convention."""
    yield f"Written by pendcore {_core.__version__} (pendcore.derive, SymPy {sympy.__version__}) from"
    yield ""
    yield from indented(repr(derivation.scene))
    yield ""
    yield "The textbook's section 2.1, for any chain: Newton's and Euler's equations of every link,"
    yield "its joint forces eliminated, solved for the angular accelerations."
    yield ""
    yield "x points right, y points DOWN, the origin is the pivot. q_i is the absolute angle of link i"
    yield "from +x towards +y: 0 is horizontal, pi/2 hangs straight down. Units: kg, m, s, rad, N, J."


def indented(text: str, columns: int = COLUMNS - 10) -> list[str]:
    """Return a text in lines, four columns in."""
    return [
        f"    {line}"
        for line in wrap(text, columns - 4, break_long_words=False, break_on_hyphens=False)
    ]


def wrapped(statement: str, indent: str, more: str = "") -> list[str]:
    """Return a statement in lines; those that go on end in `more`, and begin further in."""
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
        while name in known:
            name += "_" if not name.endswith("_") else "1"
        known.add(name)
        names[symbol] = name
    return names


def in_columns(rows: Iterable[tuple[str, ...]]) -> list[str]:
    """Return rows as lines whose parts stand below each other."""
    rows = [*rows]
    widths = [max(len(row[k]) for row in rows) for k in range(len(rows[0]))] if rows else []
    return [
        "".join(part.ljust(w) for part, w in zip(row, widths, strict=True)).rstrip()
        for row in rows
    ]


def of_unit(parameter: Parameter) -> str:
    """Return what a parameter is, with its unit."""
    unit = "" if parameter.unit in ("", "1") else f", {parameter.unit}"
    return f"{parameter.meaning}{unit}"


def named_powers(derivation: Derivation) -> dict[str, Any]:
    """Return the powers of effects, by kind and place: ``viscous_joint_1``."""
    found: dict[str, Any] = {}
    for effect, power in derivation.powers.items():
        place = getattr(effect, "joint", getattr(effect, "link", None))
        name = effect.kind if place is None else f"{effect.kind}_{place}"
        number = 2
        while name in found:
            name, number = f"{name.removesuffix(f'_again{number - 1}')}_again{number}", number + 1
        found[name] = power
    return found
