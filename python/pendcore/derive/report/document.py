"""What a report is made of, and how it is written: as Markdown for people or for pandoc."""

from __future__ import annotations

from dataclasses import dataclass, field
from enum import Enum
from pathlib import Path
from typing import TYPE_CHECKING, TypeAlias

from pendcore.derive.report.drawing import lettering

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Reader(Enum):
    r"""Who reads the Markdown.

    ``PEOPLE``, and the programs they view it with: equations are numbered by ``\tag``.
    ``HTML`` and ``LATEX`` are pandoc, which converts the Markdown; its MathML knows no ``\tag``.
    """

    PEOPLE = "md"
    HTML = "html"
    LATEX = "tex"


@dataclass(frozen=True, slots=True)
class Heading:
    """A heading; level 1 is that of the document."""

    level: int
    text: str

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        return f"{'#' * self.level} {self.text}"


@dataclass(frozen=True, slots=True)
class Paragraph:
    """Text, with inline LaTeX between dollars."""

    text: str

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        return self.text


@dataclass(frozen=True, slots=True)
class Displayed:
    """An equation on lines of its own.

    Attributes
    ----------
    latex : str
        For LaTeX's display mode.
    number : str or None
        In the margin: ``"2.1"`` is shown as (2.1).
    """

    latex: str
    number: str | None = None

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        if reader is Reader.HTML and self.number:
            return f"::: equation\n$${self.latex}$$\n\n[({self.number})]{{.number}}\n:::"
        tag = rf" \tag{{{self.number}}}" if self.number else ""
        if reader is Reader.PEOPLE:
            return f"$$\n{self.latex}{tag}\n$$"
        return f"$${self.latex}{tag}$$"


@dataclass(frozen=True, slots=True)
class Blank:
    """The left side of an equation, and lines for its right side.

    Attributes
    ----------
    latex : str
        The left side.
    number : str or None
        As in `Displayed`.
    lines : int
        The number of lines that the right side takes by hand.
    """

    latex: str
    number: str | None = None
    lines: int = 1

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        left = rf"$\displaystyle {self.latex} =$"
        number = f" ({self.number})" if self.number else ""
        if reader is Reader.LATEX:
            rule = rf"\noindent {left} \hrulefill{number}\par\vspace{{4mm}}"
            first = f"```{{=latex}}\n{rule}\n```"
        elif reader is Reader.HTML:
            first = f"::: blank\n{left} []{{.rule}}{number}\n:::"
        else:
            first = f"{left} {'_' * 40}{number}"
        more = [Space(self.lines - 1).written(reader)] if self.lines > 1 else []
        return "\n\n".join([first, *more])


@dataclass(frozen=True, slots=True)
class Table:
    """A table; its cells may hold inline LaTeX."""

    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    columns: str
    """How each column is aligned, a letter each: ``l`` or ``r``."""

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        rules = ["--:" if column == "r" else ":--" for column in self.columns]
        return "\n".join(f"| {' | '.join(row)} |" for row in (self.head, rules, *self.rows))


@dataclass(frozen=True, slots=True)
class Drawing:
    """A figure with its caption; `name` is the name of its file."""

    name: str
    caption: str
    figure: Figure = field(compare=False, repr=False)

    def written(self, reader: Reader) -> str:
        """Return it as Markdown: the picture of that name beside the document."""
        suffix = {Reader.PEOPLE: "png", Reader.HTML: "svg", Reader.LATEX: "pdf"}[reader]
        link = f"![{self.caption}]({self.name}.{suffix})"
        return f"{link}\n\n*{self.caption}*" if reader is Reader.PEOPLE else link

    def path(self, folder: Path, reader: Reader) -> Path:
        """Return where the picture belongs that this reader looks at."""
        return folder / self.written(reader).splitlines()[0].rpartition("(")[2].rstrip(")")

    def save(self, path: Path) -> None:
        """Write the picture into a file, of the kind that its suffix says."""
        dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix)
        with lettering():
            self.figure.draw_without_rendering()
            self.figure.set_layout_engine("none")  # every picture of it has the first one's layout
            self.figure.savefig(path, dpi=150, metadata=dates)


@dataclass(frozen=True, slots=True)
class Space:
    """So many empty lines to write on."""

    lines: int

    def written(self, reader: Reader) -> str:
        """Return it as Markdown."""
        if reader is Reader.HTML:
            rule = '<div class="line"></div>\n' * self.lines
            return f"```{{=html}}\n{rule}```"
        if reader is Reader.LATEX:
            rule = "\\noindent\\mbox{}\\hrulefill\\par\\vspace{4mm}\n" * self.lines
            return f"```{{=latex}}\n{rule}```"
        return "\n\n".join(["_" * 60] * self.lines)


Block: TypeAlias = Heading | Paragraph | Displayed | Blank | Table | Drawing | Space


A_PAGE = 40
"""Lines of a table that fit on a page."""


@dataclass(frozen=True, slots=True)
class Document:
    """A document: its title and its blocks."""

    title: str
    blocks: tuple[Block, ...]

    def markdown(self, reader: Reader = Reader.PEOPLE) -> str:
        """Return the document as Markdown for a reader; pandoc gets the title separately."""
        parts: list[str] = []
        before, after = (None, *self.blocks[:-1]), (*self.blocks[1:], None)
        for previous, block, following in zip(before, self.blocks, after, strict=True):
            if reader is Reader.LATEX and (lines := _lines_together(previous, block, following)):
                parts.append(f"```{{=latex}}\n\\needroom{{{lines}\\baselineskip}}\n```")
            parts.append(block.written(reader))
        title = [f"# {self.title}"] if reader is Reader.PEOPLE else []
        return "\n\n".join([*title, *parts]) + "\n"

    @property
    def drawings(self) -> tuple[Drawing, ...]:
        """The figures."""
        return tuple(block for block in self.blocks if isinstance(block, Drawing))


def _lines_together(previous: Block | None, block: Block, following: Block | None) -> int:
    """Return how many lines a page must have left: for a table, or a lead-in and what follows."""
    if isinstance(block, Table) and not isinstance(previous, Paragraph):
        return min(len(block.rows) + 3, A_PAGE)
    if isinstance(block, Paragraph) and not isinstance(following, (Heading, Paragraph)):
        lead = 1 + len(block.text) // 90
        if isinstance(following, Table):
            return lead + min(len(following.rows) + 3, A_PAGE)
        if isinstance(following, (Displayed, Blank, Space)):
            return lead + 4
    return 0
