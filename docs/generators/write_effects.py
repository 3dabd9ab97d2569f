"""Writes docs/effects from the descriptions of the effects: run it after adding one.

    python docs/generators/write_effects.py

A test compares the pages with what it would write.
"""

from __future__ import annotations

from pathlib import Path

from effect_pages import pages

FOLDER = Path(__file__).parents[1] / "effects"


def written() -> dict[Path, str]:
    """Return every file and its text."""
    return {FOLDER / name: text for name, text in pages().items()}


if __name__ == "__main__":
    for path, text in written().items():
        path.write_text(text)
        print(path.name)
