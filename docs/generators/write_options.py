"""Writes what is made from the descriptors of a run's options: run it after adding one.

    python docs/generators/write_options.py

It writes the keywords in python/pendcore/options.py, and the table of `[run]` in
docs/how_to/case_files.md. A test compares them with what it would write.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from math import inf
from pathlib import Path

from page_part import ROOT, table_of, with_part
from pendcore.options import OPTIONS, RunOption

SPAN = [
    ("`t_start`", "s", "`0.0`", "start"),
    ("`t_end`", "s", "needed", "end; before `t_start` the run goes backward"),
]
KEYWORDS = re.compile(r"(?<=from the descriptors.\n    \"\"\"\n\n)(?:    \w+: .*\n)+")
"""The fields of the class of keywords."""


def keywords() -> str:
    """Return the type of every option."""
    return "".join(f"    {one.name}: {one.annotation}\n" for one in OPTIONS.values())


def table() -> str:
    """Return the rows of the table, a key in each."""
    rows = (_row(one) for one in OPTIONS.values() if one.name != "events")  # tables of their own
    return table_of(["key", "unit", "default", "meaning"], [*SPAN, *rows], left=4)


def _row(one: RunOption) -> Iterator[str]:
    meaning = one.sentence.partition("\n")[0].replace("``", "`")
    yield f"`{one.name}`"
    yield one.unit
    yield one.if_none.replace("``", "`") if one.default is None else f"`{_toml(one.default)}`"
    yield f"{one.range}. {meaning}" if one.range else meaning


def _toml(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str):
        return f'"{value}"'
    if isinstance(value, int):
        return f"{value:_}"
    return "inf" if value == inf else f"{value:g}".replace("e-0", "e-")


def written() -> dict[Path, str]:
    """Return every file and its text."""
    page, module = ROOT / "docs/how_to/case_files.md", ROOT / "python/pendcore/options.py"
    text, replaced = KEYWORDS.subn(keywords(), module.read_text())
    if replaced != 1:
        raise ValueError(f"{module}: has {replaced} classes of keywords: must have one")
    return {module: text, page: with_part(page.read_text(), "options", table())}


if __name__ == "__main__":
    for path, text in written().items():
        path.write_text(text)
        print(path.relative_to(ROOT))
