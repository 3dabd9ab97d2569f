"""Tables of the hard cases: who gets which right, and what happens case by case."""

from __future__ import annotations

from math import inf
from pathlib import Path
from typing import Any

from record import Point, Record
from tables import listed, table

PROGRAMS = {"pendcore": "pendcore", "scipy": "SciPy", "mujoco": "MuJoCo", "odeint": "Boost.odeint"}
Case = dict[str, Any]


def cases_of(record: Record) -> list[Case]:
    """List the facts of each case, with its name and the rows of each program."""
    return [
        {
            **facts,
            "name": name,
            "by": {program: record.points(program, name) for program in PROGRAMS},
        }
        for name, facts in record.cases.items()
    ]


def cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def best(case: Case, program: str) -> Point | None:
    """Return the row that is right, else the least wrong one, else the first."""
    rows: list[Point] = case["by"][program]
    return min(rows, key=lambda row: (not row["right"], row.get("error", inf)), default=None)


def is_right(case: Case, program: str) -> bool:
    row = best(case, program)
    return row is not None and bool(row["right"])


def measured(case: Case, row: Point) -> str:
    """Write the error with its unit, or what happened."""
    if "error" not in row or not case["unit"]:
        return "said plainly" if row["right"] else cell(row["said"].split(":")[0].split(";")[0])
    if row["error"] == 0:
        return "exact"
    return f"{row['error']:.0e} {case['unit']}".replace("e-0", "e-").replace("e+0", "e+")


def loops_not_run(case: Case) -> list[str]:
    """Name the programs that are wrong here, but might be right in a loop that was not run."""
    return [program for program in case["loop_not_run"] if not is_right(case, program)]


def anchor(title: str) -> str:
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c == "-")


def glance(record: Record) -> str:
    rows = []
    for case in cases_of(record):
        cells = [f"[{case['title']}](#{anchor(case['title'])})"]
        for program in PROGRAMS:
            row = best(case, program)
            text = "not there" if row is None else measured(case, row)
            if row is not None and row["right"]:
                text = f"**{text}**" + (" (own loop)" if row["own_loop"] else "")
            cells.append(text + (" (own loop: not run)" * (program in loops_not_run(case))))
        rows.append(cells)
    return table(["case", *PROGRAMS.values()], rows, align="---")


def summary(record: Record) -> str:
    """Count the cases that each program gets right, and those that pendcore alone gets right."""
    cases, counts, alone = cases_of(record), [], []
    for program, label in PROGRAMS.items():
        right = [row for case in cases if (row := best(case, program)) and row["right"]]
        own = sum(row["own_loop"] for row in right)
        counts.append(f"{label} {len(right)}" + (f" ({own} by a loop of one's own)" if own else ""))
    for case in cases:
        if [program for program in PROGRAMS if is_right(case, program)] == ["pendcore"]:
            unasked = " and ".join(PROGRAMS[program] for program in loops_not_run(case))
            note = f" (no loop of one's own was run around {unasked})" if unasked else ""
            alone.append(case["title"].lower() + note)
    lines = [f"Right, of {len(cases)} cases: {', '.join(counts)}."]
    return "\n".join(lines + [f"Right in pendcore alone: {'; '.join(alone)}."] * bool(alone))


def sections(record: Record) -> str:
    header = ["program", "as its user wrote it", "what happens", "error", "right"]
    parts = []
    for case in cases_of(record):
        rows = [
            [
                PROGRAMS[program],
                cell(row["setting"]),
                cell(row["said"]),
                measured(case, row) if "error" in row else "—",
                "yes" if row["right"] else "no",
            ]
            for program in PROGRAMS
            for row in case["by"][program]
        ]
        bound = f" Right: within {case['allowed']:.0e} {case['unit']}." if case["allowed"] else ""
        figure, drawn = case["figure"], f"../figures/hard_cases_{case['name']}.png"
        parts += [f"### {case['title']}\n\n{case['scene']}\n"]
        parts += [f"**The answer:** {case['answer']}{bound}\n", table(header, rows, align="---")]
        parts += [f"![{figure}]({drawn})\n\n*{figure}.*\n"] if figure else []
    return "\n".join(parts)


def losses(record: Record) -> str:
    """Name each case that pendcore does not get right, and each in which a peer gives more.

    More means an answer where pendcore only has a message, or one that is ten times closer.
    """
    lines = []
    for case in cases_of(record):
        own = best(case, "pendcore")
        if own is None:
            lines.append(f"{case['title']}: not there.")
            continue
        if not own["right"]:
            lines.append(f"{case['title']}: {cell(own['said'])}.")
        for program, label in list(PROGRAMS.items())[1:]:
            row = best(case, program)
            if row is None or not row["right"] or "error" not in row:
                continue
            if "error" not in own:
                here = f"no answer here ({cell(own['said'])})" if own["right"] else ""
            else:
                here = f"{measured(case, own)} here" if row["error"] < own["error"] / 10 else ""
            if here:
                there = f"{measured(case, row)} in {label} ({cell(row['setting'])})"
                lines.append(f"{case['title']}: {here}, {there}.")
    return listed(lines, otherwise="Nowhere.")


def missing(template: Path, tests: Path) -> list[str]:
    """List the tests that the page names and that are not there."""
    table_of_tests = template.read_text(encoding="utf-8").partition("| case | test |")[2]
    named = [each.split("::") for each in table_of_tests.split("`")[1::2]]
    sources = {file: tests / file for file, _ in named}
    known = {file: path.read_text("utf-8") for file, path in sources.items() if path.exists()}
    return [f"{file}::{test}" for file, test in named if f"def {test}(" not in known.get(file, "")]
