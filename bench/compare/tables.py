"""Numbers and tables of a page, and what the pages of all comparisons say alike."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from record import Record

NONE = "—"
WORDS = tomllib.loads((Path(__file__).parent / "templates/words.toml").read_text("utf-8"))
"""What the pages say of each case, and why each peer wins where it does."""
Rows = list[list[str]]


def number(value: float | None, digits: int = 3) -> str:
    """Write with that many digits and no power of ten, halves rounded up."""
    if value is None:
        return NONE
    value *= 1 + 1e-12  # 3.235 lies just below the decimal
    if value >= 10 ** (digits - 1):
        return f"{value:.0f}"
    return f"{value:#.{digits}g}".rstrip(".")


def power(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def table(header: list[str], rows: Rows, align: str = "--:") -> str:
    lines = [header, ["---"] + [align] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def listed(lines: Iterable[str], otherwise: str = "None.") -> str:
    return "\n".join(f"* {line}" for line in [*lines] or [otherwise])


def pair(of_minima: float | None, of_medians: float | None) -> str:
    return f"**{number(of_minima)}** ({number(of_medians)})"


def short(label: str) -> str:
    """Leave out the part that every label on a side has in common."""
    for end in (" (x86-64-v3)", ", C++", ", Python"):
        label = label.removesuffix(end)
    return label


def made(record: Record) -> str:
    stem = record.measured["comparison"]
    return (
        "Made by `make compare`; do not edit: run again. The raw figures are in "
        f"[{stem}.json](../records/comparison/{stem}.json)."
    )


def measured(record: Record, what: str) -> str:
    return str(record.measured[what])


def fact(record: Record, what: str) -> Any:
    """Return a fact of the first case."""
    return next(iter(record.cases.values()))[what]


def words(record: Record, what: str) -> str:
    return str(WORDS[what][record.measured["comparison"]])


def who(record: Record) -> str:
    """Say who took part, who did not, and on what machine."""
    return f"{contenders(record)}\n{absent(record)}\n{machine(record)}"


def machine(record: Record) -> str:
    facts = {**record.measured["machine"], "date": record.measured["date"]}
    return listed(f"{name}: {value}" for name, value in facts.items())


def contenders(record: Record) -> str:
    """Say who took part, how long that one compiles, and where it stops."""
    case = next(iter(record.cases), "")
    compiling = {one["name"]: one["one_step"] or {} for one in record.taking_part(case)}
    return listed(
        (
            f"{facts['label']}: {facts['about']}{waiting(compiling.get(name, {}))}"
            + (f"; {facts['stops']}" if facts.get("stops") else "")
            for name, facts in record.contenders.items()
        ),
        otherwise="Nobody.",
    )


def waiting(call: dict[str, Any]) -> str:
    """Say how long a contender compiles, as the range from the quickest to the slowest setting."""
    if "compiling_least_s" not in call:
        return ""
    ends = (number(call[f"compiling_{end}_s"], 2) for end in ("least", "most"))
    return f"; compiles for {' to '.join(dict.fromkeys(ends))} s, which is in no figure here"


def absent(record: Record) -> str:
    """Say who is missing, and why."""
    missing = record.measured.get("absent", {})
    lines = (f"not here: {who}: {reason}" for who, reason in missing.items())
    return f"\n{listed(lines)}\n" if missing else ""
