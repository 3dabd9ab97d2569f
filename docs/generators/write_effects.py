"""Writes what is made from the descriptions of the effects: run it after adding one.

    python docs/generators/write_effects.py

It writes the pages in docs/effects, and the table of kinds in docs/how_to/case_files.md. A test
compares them with what it would write.
"""

from __future__ import annotations

from pathlib import Path

from effect_pages import kinds_table, pages
from page_part import with_part

ROOT = Path(__file__).parents[2]


def with_kinds(text: str) -> str:
    """Return the reference of case files with the table of kinds as it should be."""
    return with_part(text, "kinds", kinds_table())


def written() -> dict[Path, str]:
    """Return every file and its text."""
    files = {ROOT / "docs/effects" / name: text for name, text in pages().items()}
    case_files = ROOT / "docs/how_to/case_files.md"
    files[case_files] = with_kinds(case_files.read_text())
    return files


if __name__ == "__main__":
    for path, text in written().items():
        path.parent.mkdir(exist_ok=True)
        path.write_text(text)
        print(path.relative_to(ROOT))
