"""What a document is made of, and how it is written for its readers: people, pandoc, LaTeX."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import Enum
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Reader(Enum):
    r"""A kind of reader, for whom a document is written.

    ``PEOPLE``, and the programs they view Markdown with: equations are numbered by ``\tag``.
    ``HTML`` and ``PDF`` are pandoc, which converts the Markdown; its MathML knows no ``\tag``.
    ``LATEX`` reads no Markdown.
    """

    PEOPLE = "png"
    HTML = "svg"
    PDF = "pdf"
    LATEX = ""


class Heading(NamedTuple):
    """A heading; level 1 is that of the document."""

    level: int
    text: str


class Paragraph(NamedTuple):
    """Text, with inline LaTeX between dollars."""

    text: str
    is_remark: bool = False


class Displayed(NamedTuple):
    """LaTeX on lines of its own; the number ``"2.1"`` is shown as (2.1)."""

    latex: str
    number: str | None = None


class Blank(NamedTuple):
    """Lines to write on, so many of them, beside and below the left side of an equation if any."""

    latex: str
    number: str | None = None
    lines: int = 1


class Table(NamedTuple):
    """A table with inline LaTeX; ``columns`` has a letter for each column: ``l`` or ``r``."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    columns: str


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure with its caption; `name` is the name of its file."""

    name: str
    caption: str
    figure: Figure = field(compare=False, repr=False)

    def file(self, reader: Reader) -> str:
        """Return the name of the picture that this reader looks at."""
        return f"{self.name}.{reader.value}"


Block: TypeAlias = Heading | Paragraph | Displayed | Blank | Table | Drawing

_LINE_OF_HTML = '<div class="line"></div>\n'
_LINE_OF_LATEX = "\\noindent\\mbox{}\\hrulefill\\par\\vspace{4mm}\n"
A_PAGE = 40
"""Lines of a table that fit on a page."""


@dataclass(frozen=True, slots=True)
class Document:
    """A document: its title and its blocks."""

    title: str
    blocks: tuple[Block, ...]

    def markdown(self, reader: Reader = Reader.PEOPLE) -> str:
        """Return the document as Markdown for a reader; pandoc gets the title separately."""
        title = [Heading(1, self.title)] if reader is Reader.PEOPLE else []
        return written([*title, *self.blocks], reader)

    @property
    def drawings(self) -> tuple[Drawing, ...]:
        """The figures."""
        return tuple(block for block in self.blocks if isinstance(block, Drawing))


def written(blocks: Iterable[Block], reader: Reader) -> str:
    """Return blocks as text for a reader."""
    parts: list[str] = []
    every = [*blocks]
    led_to = False  # with the paragraph before it
    for block, following in zip(every, [*every[1:], None], strict=True):
        lines = _lines_together(block, following)
        if reader is Reader.PDF and lines and not led_to:
            parts.append(_raw(f"\\needroom{{{lines}\\baselineskip}}\n", reader))
        parts.append(_written(block, reader))
        led_to = isinstance(block, Paragraph)
    return "\n\n".join(parts) + "\n"


def _written(block: Block, reader: Reader) -> str:
    tex = reader in (Reader.PDF, Reader.LATEX)
    match block:
        case Heading(level, text):
            if reader is Reader.LATEX:
                return f"\\{'sub' * (level - 2)}section*{{{text}}}"
            return f"{'#' * level} {text}"
        case Paragraph(text, is_remark):
            if reader is Reader.LATEX:
                text = text.replace("%", r"\%").replace("#", r"\#")
                return f"\\emph{{{text}}}" if is_remark else text
            return f"*{text}*" if is_remark else text
        case Displayed(latex, number):
            tag = rf" \tag{{{number}}}" if number else ""
            if reader is Reader.LATEX:
                return f"\\begin{{equation*}}\n{latex}{tag}\n\\end{{equation*}}"
            if reader is Reader.HTML and number:
                return f"::: equation\n$${latex}$$\n\n[({number})]{{.number}}\n:::"
            edge = "\n" if reader is Reader.PEOPLE else ""
            return f"$${edge}{latex}{'' if reader is Reader.HTML else tag}{edge}$$"
        case Blank("", _, lines):
            if reader is Reader.PEOPLE:
                return "\n\n".join(["_" * 60] * lines)
            return _raw((_LINE_OF_LATEX if tex else _LINE_OF_HTML) * lines, reader)
        case Blank(latex, number, lines):
            left, tag = rf"$\displaystyle {latex} =$", f" ({number})" if number else ""
            first = f"{left} {'_' * 40}{tag}"
            if reader is Reader.HTML:
                first = f"::: blank\n{left} []{{.rule}}{tag}\n:::"
            elif tex:
                first = _raw(f"\\noindent {left} \\hrulefill{tag}\\par\\vspace{{4mm}}\n", reader)
            more = [_written(Blank("", lines=lines - 1), reader)] if lines > 1 else []
            return "\n\n".join([first, *more])
        case Table(head, rows, columns):
            rules = ["--:" if column == "r" else ":--" for column in columns]
            return "\n".join(f"| {' | '.join(row)} |" for row in (head, rules, *rows))
        case Drawing(_, caption):
            link = f"![{caption}]({block.file(reader)})"
            return f"{link}\n\n*{caption}*" if reader is Reader.PEOPLE else link


def _raw(text: str, reader: Reader) -> str:
    """Return text that pandoc passes on as it is."""
    return f"```{{={'html' if reader is Reader.HTML else 'latex'}}}\n{text}```"


def _lines_together(block: Block, following: Block | None) -> int:
    """Return how many lines a page must have left: for a table, or a lead-in and what follows."""
    if isinstance(block, Table):
        return min(len(block.rows) + 3, A_PAGE)
    if isinstance(block, Paragraph) and isinstance(following, (Table, Displayed, Blank)):
        return 1 + len(block.text) // 90 + (_lines_together(following, None) or 4)
    return 0
