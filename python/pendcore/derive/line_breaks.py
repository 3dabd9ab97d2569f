"""Long equations on several lines: they are broken before a sign, inside brackets only if needed.

Neither MathML in browsers nor LaTeX breaks a displayed equation, so it is done here, on the
expression itself: a term that is wider than a line is opened, and the sum in it is broken.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

from sympy import Expr, Mul, fraction

from pendcore.derive.notation import Notation

LINE = 35.0
"""Width of a line of a page, in em (widths of the letter m)."""

_NARROW = {" ": 0.0, ",": 0.3, ".": 0.3, "(": 0.4, ")": 0.4, "[": 0.3, "]": 0.3, "|": 0.3, "'": 0.3}
_SIGN = {"+": 1.25, "-": 1.25, "=": 1.4, "<": 1.4, ">": 1.4, "/": 0.5}
_COMMANDS = {
    "left": 0.0, "right": 0.0, ",": 0.17, ";": 0.28, "!": -0.17, ":": 0.22, "quad": 1.0,
    "qquad": 2.0, "sin": 1.4, "cos": 1.45, "tan": 1.5, "sqrt": 0.9, "cdot": 0.7, "times": 1.3,
    "mathbf": 0.0, "text": 0.0, "operatorname": 0.0, "dot": 0.0, "ddot": 0.0, "mathrm": 0.0,
    "bigl": 0.0, "bigr": 0.0, "Bigl": 0.0, "Bigr": 0.0, "boldsymbol": 0.0, "displaystyle": 0.0,
}  # fmt: skip
_TOKEN = re.compile(r"\\([A-Za-z]+|.)|([{}^_])|(.)", re.DOTALL)


_MATRIX = re.compile(r"\\begin{vmatrix}(.*?)\\end{vmatrix}", re.DOTALL)


def _widest_row(matrix: re.Match[str]) -> str:
    rows = [row.replace("&", r"\quad ") for row in matrix[1].split(r"\\")]
    return max(rows, key=width)


def width(latex: str) -> float:
    """Estimate how wide LaTeX is when it is set, in em."""
    tokens = [found.groups() for found in _TOKEN.finditer(_MATRIX.sub(_widest_row, latex))]
    return _width(iter(tokens))


def _width(tokens: Iterator[tuple[Any, ...]], *, one: bool = False) -> float:
    """Add up widths until the group ends, or return the width of one token or group."""
    total = 0.0
    for command, mark, letter in tokens:
        if mark == "}":
            break
        if mark == "{":
            total += _width(tokens)
        elif mark in ("^", "_"):
            total += 0.7 * _width(tokens, one=True)
        elif command in ("frac", "dfrac", "tfrac"):
            total += 0.2 + max(_width(tokens, one=True), _width(tokens, one=True))
        elif command is not None:
            total += _COMMANDS.get(command, 0.6)
        else:
            total += _NARROW.get(letter, _SIGN.get(letter, 0.55))
        if one:
            break
    return total


def rows(
    left: str,
    right: Expr | str | tuple[str, ...],
    notation: Notation,
    margin: float = 0.0,
    room: float = LINE,
) -> list[str]:
    """Return left = right as rows of LaTeX's ``aligned``, as many as it takes.

    Parameters
    ----------
    left : str
        LaTeX of the left side.
    right : sympy.Expr, str or tuple of str
        The right side. Text is LaTeX that goes on one row as it is; a tuple holds the terms of a
        sum, which may go on several rows.
    notation : Notation
        Writes an expression in LaTeX, and orders its terms.
    margin : float
        Width of the widest left side among those that the row is aligned with.
    room : float
        Width of a line, in em.
    """
    margin = max(margin, width(left))
    if isinstance(right, str):
        pieces = [right]
    elif isinstance(right, tuple):
        pieces = list(right)
    else:
        pieces = _pieces(right, notation, room - 4.0)
        whole = notation.latex(right)
        if width(whole) + margin + 1.4 <= room:
            pieces = [whole]
    indent = margin + 1.5
    if indent > room / 3 and indent + sum(map(width, pieces)) > room:
        found, used = [f"{left} &= {{}}", r"&\quad "], indent
    else:
        found, used = [f"{left} &= "], indent
    for k, piece in enumerate(pieces):
        needed = width(piece)
        if k and used + needed > room:
            found.append(r"&\quad ")
            used = indent + 1.0
        found[-1] += piece + " "
        used += needed
    return [row.rstrip() for row in found]


def aligned(lines: list[str]) -> str:
    """Return rows as one displayed equation; a single one needs no alignment."""
    if len(lines) == 1:
        return lines[0].replace("&=", "=", 1)
    body = " \\\\\n".join(lines)
    return f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}"


def _pieces(expression: Expr, notation: Notation, room: float, depth: int = 0) -> list[str]:
    """Return the pieces that must not be broken, in order; each begins with its sign."""
    write = notation.latex
    if expression.is_Add:
        return _pieces_of_sum(expression, notation, room, depth)
    if width(write(expression)) <= room:
        return [write(expression)]
    negative = expression.could_extract_minus_sign()
    sign, expression = ("-", -expression) if negative else ("", expression)
    above, below = fraction(expression)
    before = f"{sign}" if below == 1 else rf"{sign}\frac{{1}}{{{write(below)}}} "
    wide = [f for f in Mul.make_args(above) if f.is_Add]
    if not wide:
        return [f"{sign}{write(expression)}"]
    longest = max(wide, key=lambda factor: width(write(factor)))
    rest = Mul(*(f for f in Mul.make_args(above) if f is not longest))
    if rest != 1:
        text = write(rest)
        before += rf"\left({text}\right)" if rest.is_Add else text
    opened, closed = (r"\bigl[", r"\bigr]") if depth % 2 == 0 else (r"\bigl(", r"\bigr)")
    inner = _pieces_of_sum(longest, notation, room - 1.0, depth + 1)
    inner[0] = f"{before} {opened} {inner[0]}"
    inner[-1] = f"{inner[-1]} {closed}"
    return inner


def _pieces_of_sum(total: Expr, notation: Notation, room: float, depth: int) -> list[str]:
    pieces: list[str] = []
    for term in notation.terms(total):
        own = _pieces(term, notation, room, depth)
        if pieces and not own[0].startswith("-"):
            own[0] = f"+ {own[0]}"
        elif pieces:
            own[0] = f"- {own[0][1:].lstrip()}"
        pieces += own
    return pieces
