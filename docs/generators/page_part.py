"""The part of a page that a program writes, between two comments that name it; its tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

ROOT = Path(__file__).parents[2]


def with_part(text: str, name: str, part: str) -> str:
    """Return the page with another part of that name; ValueError if it has none."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->"
    before, begun, rest = text.partition(begin)
    _, ended, after = rest.partition(end)
    if not (begun and ended):
        raise ValueError(f"the page has no part {name!r}")
    return before + begin + part + end + after


def rewrite(page: Path, **parts: str) -> None:
    """Write parts of a page anew; "_" in a name stands for a space."""
    text = page.read_text(encoding="utf-8")
    for name, part in parts.items():
        text = with_part(text, name.replace("_", " "), part)
    page.write_text(text, encoding="utf-8")


def table_of(heads: Sequence[str], rows: Iterable[Iterable[str]], left: int = 1) -> str:
    """Return a table; so many of the first columns are aligned to the left, the others right."""
    lines = [f"| {' | '.join(cells)} |\n" for cells in (heads, *rows)]
    marks = ["---"] * left + ["--:"] * (len(heads) - left)
    lines.insert(1, f"|{'|'.join(marks)}|\n")
    return "".join(lines)
