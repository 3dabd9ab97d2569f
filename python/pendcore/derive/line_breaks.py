"""Long equations on several lines: they are broken before a sign, inside brackets only if needed.

Neither MathML in browsers nor LaTeX breaks a displayed equation, so it is done here, on LaTeX whose
signs between terms have blanks on both sides.
"""

from __future__ import annotations

import re
from collections.abc import Iterator

LINE = 35.0
"""Width of a line of a page, in em (widths of the letter m)."""

_WIDTHS = {
    "+": 1.25, "-": 1.25, "=": 1.4, "/": 0.5, " ": 0.0, ",": 0.3, ".": 0.3, "(": 0.4, ")": 0.4,
    "|": 0.3, "[": 0.4, "]": 0.4, "left": 0.0, "right": 0.0, "sin": 1.4, "cos": 1.45, "quad": 1.0,
    "times": 1.3, "cdot": 0.7, "mathbf": 0.0, "text": 0.0, "dot": 0.0, "ddot": 0.0, "mathrm": 0.0,
    "bigl": 0.0, "bigr": 0.0, "boldsymbol": 0.0, "displaystyle": 0.0, ";": 0.28,
}  # fmt: skip
_TOKEN = re.compile(r"\\([A-Za-z]+|.)|([{}^_])|(.)", re.DOTALL)
_MATRIX = re.compile(r"\\begin{vmatrix}(.*?)\\end{vmatrix}", re.DOTALL)


def width(latex: str) -> float:
    """Estimate how wide LaTeX is when it is set, in em."""

    def widest_row(matrix: re.Match[str]) -> str:
        return max((row.replace("&", r"\quad ") for row in matrix[1].split(r"\\")), key=width)

    tokens = [found.groups() for found in _TOKEN.finditer(_MATRIX.sub(widest_row, latex))]
    return _width(iter(tokens))


def _width(tokens: Iterator[tuple[str | None, ...]], *, one: bool = False) -> float:
    """Add up widths until the group ends, or return the width of one token or group."""
    total = 0.0
    for command, mark, letter in tokens:
        if mark == "}":
            break
        if mark == "{":
            total += _width(tokens)
        elif mark in ("^", "_"):
            total += 0.7 * _width(tokens, one=True)
        elif command == "frac":
            total += 0.2 + max(_width(tokens, one=True), _width(tokens, one=True))
        else:
            total += _WIDTHS.get(command or letter or "", 0.6)
        if one:
            break
    return total


def rows(left: str, right: str, margin: float = 0.0) -> list[str]:
    """Return left = right as rows of LaTeX's ``aligned``, as many as it takes.

    ``margin`` is the width of the widest left side among those that the row is aligned with.
    """
    indent = max(margin, width(left)) + 1.5
    if indent + width(right) <= LINE:
        return [f"{left} &= {right}"]
    pieces = _pieces(right, LINE - 4.0)
    found, used = [f"{left} &= "], indent
    if indent > LINE / 3:
        found = [f"{left} &= {{}}", r"&\quad "]
    for k, piece in enumerate(pieces):
        needed = width(piece)
        if k and used + needed > LINE:
            found.append(r"&\quad ")
            used = indent + 1.0
        found[-1] += f"{piece} "
        used += needed
    return [row.rstrip() for row in found]


def aligned(lines: list[str]) -> str:
    """Return rows as one displayed equation; a single one needs no alignment."""
    if len(lines) == 1:
        return lines[0].replace("&=", "=", 1)
    body = " \\\\\n".join(lines)
    return f"\\begin{{aligned}}\n{body}\n\\end{{aligned}}"


def _pieces(latex: str, room: float) -> list[str]:
    """Return the pieces that must not be broken, in order; each begins with its sign."""
    found: list[str] = []
    for term in _terms(latex):
        found += [term] if width(term) <= room else _opened(term, room)
    return found


def _terms(latex: str) -> Iterator[str]:
    """Return the terms of a sum, which ends inside no brace and no bracket."""
    begin = depth = 0
    for mark in re.finditer(r"\\(?:left|right)\b|[{}]| [+-] ", latex):
        depth += (mark[0] in (r"\left", "{")) - (mark[0] in (r"\right", "}"))
        if depth == 0 and mark[0][0] == " ":
            yield latex[begin : mark.start()]
            begin = mark.start() + 1
    yield latex[begin:]


def _opened(term: str, room: float) -> list[str]:
    r"""Return the pieces of a term whose widest bracket is opened, \left( ... \right)."""
    spans, depth, begin = list[tuple[int, int]](), 0, 0
    for mark in re.finditer(r"\\left\(|\\right\)|[{}]", term):
        if mark[0] == r"\left(" and depth == 0:
            begin = mark.end()
        depth += (mark[0] in (r"\left(", "{")) - (mark[0] in (r"\right)", "}"))
        if mark[0] == r"\right)" and depth == 0:
            spans.append((begin, mark.start()))
    if not spans:
        return [term]
    first, last = max(spans, key=lambda span: span[1] - span[0])
    inner = _pieces(term[first:last].strip(), room - 1.0)
    inner[0] = term[:first].removesuffix(r"\left(") + r"\bigl[" + inner[0]
    inner[-1] += r"\bigr]" + term[last:].removeprefix(r"\right)")
    return inner
