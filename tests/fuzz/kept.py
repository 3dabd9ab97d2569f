"""The record of a full campaign, and the tables that docs/background/fuzz.md has of it."""

from __future__ import annotations

import json
from collections import Counter
from pathlib import Path
from typing import Any

FULL = 100_000
"""Cases that a campaign has to have run for the page to be written."""
BEGIN, END = "<!-- campaign: begin -->\n", "<!-- campaign: end -->"

Record = dict[str, Any]


def reasons(outcomes: dict[str, int]) -> list[tuple[str, int, int]]:
    """Return each outcome, its cases, and the number of its reasons, which stand after a colon."""
    cases: Counter[str] = Counter()
    kinds: Counter[str] = Counter()
    for outcome, count in outcomes.items():
        name = outcome.partition(":")[0]
        cases[name] += count
        kinds[name] += 1
    return [(name, count, kinds[name]) for name, count in cases.most_common()]


def tables(record: Record) -> str:
    """Return what stands between the markers of the page."""
    words = {"refused": "refused, with the reason", "not drawn": "not drawn: no such scene can be"}
    seconds, longest = record["longest"]["seconds"], record["longest"]["case"]
    facts = {
        "seed": f"`{record['seed']}`",
        "cases": f"{record['cases']:,}",
        "failed": f"{record['failed']:,}",
        "crashed or hung": f"{sum(record['outcomes'].get(x, 0) for x in ('crash', 'hang')):,}",
        "longest case": f"{seconds:.1f} s (number {longest})",
        "in all": f"{record['seconds']:,.0f} s, {record['workers']} processes",
        "pendcore": record["pendcore"],
        "date": record["date"],
    }
    lines = ["| | |", "|---|---|", *(f"| {name} | {fact} |" for name, fact in facts.items())]
    lines += ["", "| outcome | cases |", "|---|--:|"]
    for name, count, kinds in reasons(record["outcomes"]):
        text = words.get(name, f"`{name}`" if " " not in name else name)
        lines.append(f"| {text}{f' ({kinds} kinds)' if kinds > 1 else ''} | {count:,} |")
    if record["failed"]:
        lines += ["", f"Failed: cases {', '.join(map(str, record['failures']))}."]
    return "\n".join(lines) + "\n"


def page_of(text: str, record: Record) -> str:
    """Return the page with the record's tables in place of those before."""
    before, rest = text.split(BEGIN)
    return before + BEGIN + tables(record) + END + rest.split(END)[1]


def write(record: Record, page: Path, file: Path) -> bool:
    """Write the page and the record's file, if the campaign was a full one."""
    if record["cases"] < FULL:
        return False
    file.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    page.write_text(page_of(page.read_text(encoding="utf-8"), record), encoding="utf-8")
    return True
