"""Steps of a derivation and the equations in them, ready to be read."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from textwrap import fill
from typing import Any, NamedTuple

from sympy import sympify

from pendcore.derive import line_breaks
from pendcore.derive.notation import Notation


class Formula(NamedTuple):
    """One side of an equation that is no scalar expression, such as a sum of vectors.

    Attributes
    ----------
    text, latex : str
        As text and as LaTeX.
    terms : tuple of str
        The terms of a sum in LaTeX, with their signs, between which a line may end.
    """

    text: str
    latex: str
    terms: tuple[str, ...] = ()

    def __str__(self) -> str:
        return self.text


@dataclass(frozen=True, slots=True)
class Equation:
    """One equation.

    Attributes
    ----------
    lhs, rhs : sympy.Expr or Formula
        Its sides.
    number : str or None
        The textbook's number, such as ``"2.1"``, if it is one of the textbook's.
    remark : str
        A remark on the equation; empty if there is none.
    """

    lhs: Any
    rhs: Any
    number: str | None = None
    remark: str = ""
    notation: Notation | None = field(default=None, compare=False, repr=False)

    def __str__(self) -> str:
        number = f"    ({self.number})" if self.number else ""
        return f"{self._text(self.lhs)} = {self._text(self.rhs)}{number}"

    def latex(self) -> str:
        """Return both sides in LaTeX, without the number: ``lhs &= rhs``."""
        return f"{self.side_latex(self.lhs)} &= {self.side_latex(self.rhs)}"

    def _text(self, side: Any) -> str:
        if isinstance(side, Formula) or self.notation is None:
            return str(side)
        return self.notation.text(side)

    def rows(self, margin: float = 0.0) -> list[str]:
        """Return the equation in LaTeX on as many rows of an ``align`` as it takes.

        Parameters
        ----------
        margin : float
            Width of the widest left side that it is aligned with; see `line_breaks.rows`.
        """
        left, right = self.side_latex(self.lhs), self.rhs
        if self.notation is None:
            raise ValueError(f"{self}: has no notation, which LaTeX needs")
        whole = (right.terms or right.latex) if isinstance(right, Formula) else sympify(right)
        return line_breaks.rows(left, whole, self.notation, margin)

    def side_latex(self, side: Any) -> str:
        """Return one side in LaTeX."""
        if isinstance(side, Formula):
            return side.latex
        if self.notation is None:
            raise ValueError(f"{self}: has no notation, which LaTeX needs")
        return self.notation.latex(side)

    def _repr_latex_(self) -> str:
        tag = rf" \tag{{{self.number}}}" if self.number else ""
        return rf"$\displaystyle {self.latex().replace('&=', '=')}{tag}$"


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a derivation.

    Attributes
    ----------
    number : int
        From 1.
    title, text : str
        What is done, and why. The text holds inline LaTeX between ``$``.
    equations : tuple of Equation
        The results of the step.
    """

    number: int
    title: str
    text: str
    equations: tuple[Equation, ...] = ()

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
        title = f"\\subsection*{{{self.number}. {self.title}}}"
        parts = [title, escaped(self.text), *map(_with_remark, self._groups())]
        return "\n".join(parts)

    def _repr_markdown_(self) -> str:
        parts = [f"### {self.number}. {self.title}", "", self.text, ""]
        for group in self._groups():
            parts += ["$$", _aligned(group), "$$", ""]
            if group[-1].remark:
                parts += [f"*{group[-1].remark}*", ""]
        return "\n".join(parts)

    def _groups(self) -> list[list[Equation]]:
        """The equations in groups that are shown together; a remark ends a group."""
        groups: list[list[Equation]] = []
        for equation in self.equations:
            if not groups or groups[-1][-1].remark:
                groups.append([])
            groups[-1].append(equation)
        return groups


def _wrapped(equation: str) -> str:
    """Return an equation on as many lines as it needs, broken before a term."""
    for sign in "+-=":
        equation = equation.replace(f" {sign} ", f" {sign}\N{NO-BREAK SPACE}")
    lines = fill(
        equation.replace("    (", "\N{NO-BREAK SPACE}" * 4 + "("),
        100,
        initial_indent=" " * 4,
        subsequent_indent=" " * 8,
        break_long_words=False,
        break_on_hyphens=False,
    )
    return lines.replace("\N{NO-BREAK SPACE}", " ")


def plain(text: str) -> str:
    """Return a text with its inline LaTeX written as plain text."""
    return "".join(_spoken(x) if k % 2 else x for k, x in enumerate(text.split("$")))


def _spoken(latex: str) -> str:
    """Return a short formula without LaTeX's marks: ``q1``, ``M qdd = f``."""
    spoken = latex.replace(r"\,", " ")
    for dots, letters in ((r"\ddot", "dd"), (r"\dot", "d")):
        spoken = re.sub(rf"{re.escape(dots)}{{(\w+)}}", rf"\g<1>{letters}", spoken)
    spoken = re.sub(r"\\math\w+{(\w+)}", r"\1", spoken)
    spoken = re.sub(r"_{(\d+)}", r"\1", spoken)
    return re.sub(r"[\\{}]", "", spoken)


def escaped(text: str) -> str:
    """Return a text as LaTeX takes it, with percent signs and hashes escaped."""
    return text.replace("%", r"\%").replace("#", r"\#")


def _aligned(group: list[Equation]) -> str:
    margin = max(line_breaks.width(equation.side_latex(equation.lhs)) for equation in group)
    lines = []
    for equation in group:
        *rows, last = equation.rows(margin)
        tag = rf" \tag{{{equation.number}}}" if equation.number else r" \notag"
        lines += [*(row + r" \notag" for row in rows), last + tag]
    body = " \\\\\n".join(lines)
    return f"\\begin{{align}}\n{body}\n\\end{{align}}"


def _with_remark(group: list[Equation]) -> str:
    remark = escaped(group[-1].remark)
    return _aligned(group) + (f"\n\\emph{{{remark}}}\n" if remark else "")
