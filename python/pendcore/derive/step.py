"""Steps of a derivation and the equations in them, ready to be read."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from textwrap import fill
from typing import Any

from pendcore.derive import line_breaks
from pendcore.derive.document import Block, Displayed, Heading, Paragraph, Reader, written
from pendcore.derive.notation import Notation

A_BLOCK = 12
"""The most rows that are displayed together."""
A_PAGE = 24
"""Rows that one equation may have before a page must be able to end in it."""


class Formula(str):
    """LaTeX of one side of an equation that is no scalar expression, such as a sum of vectors."""

    __slots__ = ()

    @property
    def text(self) -> str:
        """The same as text."""
        return spoken(self)


@dataclass(frozen=True, slots=True)
class Equation:
    """One equation: its sides, each a `sympy.Expr` or a `Formula`, which ``notation`` writes.

    ``number`` is the textbook's, such as ``"2.1"``, if it is one of the textbook's; ``remark`` is
    empty if there is none.
    """

    lhs: Any
    rhs: Any
    number: str | None
    remark: str
    notation: Notation = field(compare=False, repr=False)

    def __str__(self) -> str:
        left, right = (x.text if isinstance(x, Formula) else self.notation.text(x)
                       for x in (self.lhs, self.rhs))  # fmt: skip
        return f"{left} = {right}" + (f"    ({self.number})" if self.number else "")

    def side_latex(self, side: Any) -> str:
        """Return one side in LaTeX."""
        return str(side) if isinstance(side, Formula) else self.notation.latex(side)

    def latex(self) -> str:
        """Return both sides in LaTeX, without the number: ``lhs &= rhs``."""
        return f"{self.side_latex(self.lhs)} &= {self.side_latex(self.rhs)}"

    def rows(self, margin: float = 0.0) -> list[str]:
        """Return the equation on as many rows as it takes; see `line_breaks.rows`."""
        return line_breaks.rows(self.side_latex(self.lhs), self.side_latex(self.rhs), margin)

    def _repr_latex_(self) -> str:
        tag = rf" \tag{{{self.number}}}" if self.number else ""
        return rf"$\displaystyle {self.latex().replace('&=', '=')}{tag}$"


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a derivation: what is done, and why; ``equations`` are its results.

    Steps are counted from 1. The text holds inline LaTeX between ``$``.
    """

    number: int
    title: str
    text: str
    equations: tuple[Equation, ...] = ()

    def blocks(self, note: Callable[[Equation], str] = lambda equation: "") -> Iterator[Block]:
        """Yield what a document has of the step; ``note`` is set behind each equation."""
        yield Heading(3, f"{self.number}. {self.title}")
        yield Paragraph(self.text)
        for number, equations in groups(self.equations):
            margin = max(line_breaks.width(e.side_latex(e.lhs)) for e in equations)
            rows: list[str] = []
            for equation in equations:
                own = equation.rows(margin)
                own[-1] += note(equation)
                if number is None and rows and len(rows) + len(own) > A_BLOCK:
                    yield Displayed(line_breaks.aligned(rows))
                    rows = []
                rows += own
                while len(rows) > A_PAGE:
                    yield Displayed(line_breaks.aligned(rows[:A_PAGE]))
                    rows = rows[A_PAGE:]
            yield Displayed(line_breaks.aligned(rows), number)
            if equations[-1].remark:
                yield Paragraph(equations[-1].remark, is_remark=True)

    def __str__(self) -> str:
        head = f"{self.number}. {self.title}"
        lines = [head, "-" * len(head), fill(plain(self.text), 88, break_on_hyphens=False), ""]
        for equation in self.equations:
            lines.append(_wrapped(str(equation)))
            if equation.remark:
                remark = fill(f"[{plain(equation.remark)}]", 80, break_on_hyphens=False)
                lines += [f"        {line}" for line in remark.splitlines()]
        return "\n".join(lines).rstrip()

    def latex(self) -> str:
        """Return the step as a LaTeX section, for ``amsmath``."""
        return written(self.blocks(), Reader.LATEX).rstrip()

    def _repr_markdown_(self) -> str:
        return written(self.blocks(), Reader.PEOPLE).rstrip()


def groups(equations: Iterable[Equation]) -> Iterator[tuple[str | None, list[Equation]]]:
    """Yield the equations that are displayed together: those of one number, or of none.

    A remark ends a group.
    """
    together: list[Equation] = []
    for equation in equations:
        if together and (together[-1].remark or together[-1].number != equation.number):
            yield together[-1].number, together
            together = []
        together.append(equation)
    if together:
        yield together[-1].number, together


def _wrapped(equation: str) -> str:
    """Return an equation on as many lines as it needs, broken before a term."""
    for sign in "+-=":
        equation = equation.replace(f" {sign} ", f" {sign}\N{NO-BREAK SPACE}")
    lines = fill(
        equation.replace("    (", "\N{NO-BREAK SPACE}" * 4 + "("), 100,
        initial_indent=" " * 4, subsequent_indent=" " * 8,
        break_long_words=False, break_on_hyphens=False,
    )  # fmt: skip
    return lines.replace("\N{NO-BREAK SPACE}", " ")


_SPOKEN = (
    (r"\\(?:left|right|math\w+|boldsymbol|displaystyle)\b ?", ""),
    (r"\\begin{vmatrix} ?(.*?) ?\\end{vmatrix}", r"det[\1]"),
    (r" \\\\ ", "; "),
    (r" & ", ", "),
    (r"\\times", "x"),
    (r" ?\\cdot ?", "*"),
    (r" ?\\[,;]", " "),
    (r"\\var", r"\\"),
    (r"_{(\w+ ?[+-] ?\w+)}", r"_(\1)"),
    (r"\\(d+)ot{(\\?\w+)}", r"\2\1"),
    (r"_{(\d\w*)}", r"\1"),
    (r"_{(\w),(\w+)}", r"\1_\2"),
    (r"\\frac{((?:[^{}]|{[^{}]*})*)}{((?:[^{}]|{[^{}]*})*)}", r"\1/\2"),
    (r"\\hat|[\\{}]", ""),
    (r" +", " "),
)
"""What stands for LaTeX's marks in text, in this order."""


def spoken(latex: str) -> str:
    """Return a formula as plain text: ``q1``, ``M qdd = f``, ``r_AB x F21``."""
    for pattern, text in _SPOKEN:
        latex = re.sub(pattern, text, latex)
    return latex


def plain(text: str) -> str:
    """Return a text with its inline LaTeX written as plain text."""
    return "".join(spoken(x) if k % 2 else x for k, x in enumerate(text.split("$")))
