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
    cases: Counter[str] = Counter()
    for outcome, count in record["outcomes"].items():  # the reason stands after a colon
        cases[outcome.partition(":")[0]] += count
    kinds = Counter(outcome.partition(":")[0] for outcome in record["outcomes"])
    for name, count in cases.most_common():
        text = words.get(name, f"`{name}`" if " " not in name else name)
        of_kinds = f" ({kinds[name]} kinds)" if kinds[name] > 1 else ""
        lines.append(f"| {text}{of_kinds} | {count:,} |")
    if record["failed"]:
        lines += ["", f"Failed: cases {', '.join(map(str, record['failures']))}."]
    return "\n".join(lines) + "\n"


def write(record: Record, page: Path, file: Path) -> None:
    """Write the record's file, and its tables in place of those on the page."""
    file.write_text(json.dumps(record, indent=1) + "\n", encoding="utf-8")
    before, _, rest = page.read_text(encoding="utf-8").partition(BEGIN)
    shown = before + BEGIN + tables(record) + END + rest.partition(END)[2]
    page.write_text(shown, encoding="utf-8")
