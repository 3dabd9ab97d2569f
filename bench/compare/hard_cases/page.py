"""The record of hard cases as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from typing import Any

from hard_cases.cases import PROGRAMS
from hard_cases.listed import LISTED

Record = dict[str, Any]

PAGE = """# Hard cases

Made by `make hard-cases`; the raw figures are in [hard_cases.json](../records/hard_cases.json).
Do not edit: run again.

This page runs the same cases in pendcore and in three programs that you might use instead, each at
its best: as an able user would write the case, in several ways where there is a choice. Each case
states its right answer, from a closed form or from a solution that shares no code with any of the
programs. The question here is only whether the answer is right; [another
page](../comparison/textbook.md) compares times.

## At a glance

The table has the best result of each program; a **bold** result is right. *Own loop* means that
the user's own program handles modes, switches or events, and the library only integrates between
them. *Own loop: not run* means that such a program might be right but was not run; the case says
why.

{glance}
{summary}

## Case by case

{sections}
## Where pendcore loses

The list has the cases that pendcore does not get right, and those where another program's right
answer is ten times closer, or exists where pendcore gives only a message.

{losses}

## Who took part, and on what

{machine}

## What every release passes

This is the list of cases that break simulators, with the tests of each case. All of them run in
`make test`.

{listed}
"""


def table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def cell(text: str) -> str:
    return " ".join(text.split()).replace("|", "\\|")


def taking_part(case: Any, program: str) -> list[Any]:
    return [one for one in case["contenders"] if one["program"] == program]


def best(case: Any, program: str) -> Any | None:
    """Return the contender that is right, else the least wrong one, else the first."""
    found = taking_part(case, program)

    def rank(one: Any) -> tuple[bool, float]:
        return (not one["right"], float("inf") if one["error"] is None else one["error"])

    return min(found, key=rank, default=None)


def measured(case: Any, one: Any) -> str:
    """Write the error with its unit, or what happened."""
    if one["error"] is None or not case["unit"]:
        return "said plainly" if one["right"] else cell(one["said"].split(":")[0].split(";")[0])
    if one["error"] == 0:
        return "exact"
    return f"{one['error']:.0e} {case['unit']}".replace("e-0", "e-").replace("e+0", "e+")


def loops_not_run(case: Any) -> list[str]:
    """Name the programs that are wrong here, but might be right in a loop that was not run."""
    return [
        program
        for program in case.get("loop_not_run", ())
        if (one := best(case, program)) is None or not one["right"]
    ]


def glance(record: Record) -> str:
    rows = []
    for case in record["cases"]:
        row = [f"[{case['title']}](#{anchor(case['title'])})"]
        for program in PROGRAMS:
            one = best(case, program)
            text = "not there" if one is None else measured(case, one)
            if one is not None and one["right"]:
                text = f"**{text}**" + (" (own loop)" if one["own_loop"] else "")
            if program in loops_not_run(case):
                text += " (own loop: not run)"
            row.append(text)
        rows.append(row)
    return table(["case", *PROGRAMS.values()], rows)


def anchor(title: str) -> str:
    return "".join(c for c in title.lower().replace(" ", "-") if c.isalnum() or c == "-")


def unasked(case: Any) -> str:
    """Name the programs for which no loop of the user's own was run."""
    programs = " and ".join(PROGRAMS[program] for program in loops_not_run(case))
    return f" (no loop of one's own was run around {programs})" if programs else ""


def summary(record: Record) -> str:
    """Count the cases that each program gets right, and those that pendcore alone gets right."""
    counts = []
    for program, label in PROGRAMS.items():
        found = [best(case, program) for case in record["cases"]]
        right = [one for one in found if one is not None and one["right"]]
        own = sum(one["own_loop"] for one in right)
        counts.append(f"{label} {len(right)}" + (f" ({own} by a loop of one's own)" if own else ""))
    alone = [
        case["title"].lower() + unasked(case)
        for case in record["cases"]
        if (own := best(case, "pendcore")) is not None
        and own["right"]
        and not any(
            (one := best(case, program)) is not None and one["right"]
            for program in PROGRAMS
            if program != "pendcore"
        )
    ]
    lines = [f"Right, of {len(record['cases'])} cases: {', '.join(counts)}."]
    if alone:
        lines.append(f"Right in pendcore alone: {'; '.join(alone)}.")
    return "\n".join(lines)


def section(case: Any) -> str:
    rows = [
        [
            PROGRAMS[one["program"]],
            cell(one["how"]),
            cell(one["said"]),
            "—" if one["error"] is None else measured(case, one),
            "yes" if one["right"] else "no",
        ]
        for one in case["contenders"]
    ]
    header = ["program", "as its user wrote it", "what happens", "error", "right"]
    bound = f" Right: within {case['allowed']:.0e} {case['unit']}." if case["allowed"] else ""
    figure = case.get("figure", "")
    drawn = f"../figures/hard_cases_{case['name']}.png"
    shown = f"\n![{figure}]({drawn})\n\n*{figure}.*\n" if figure else ""
    return (
        f"### {case['title']}\n\n{case['scene']}\n\n**The answer:** {case['answer']}{bound}\n\n"
        + table(header, rows)
        + shown
    )


def losses(record: Record) -> list[str]:
    """Name each case that pendcore does not get right, and each in which a peer gives more.

    More means an answer where pendcore only has a message, or one that is ten times closer.
    """
    lines = []
    for case in record["cases"]:
        own = best(case, "pendcore")
        if own is None:
            lines.append(f"* {case['title']}: not there.")
            continue
        if not own["right"]:
            lines.append(f"* {case['title']}: {cell(own['said'])}.")
        for program, label in PROGRAMS.items():
            one = best(case, program)
            if program == "pendcore" or one is None or not one["right"]:
                continue
            if one["error"] is None:
                continue
            if own["error"] is None:
                here = f"no answer here ({cell(own['said'])})" if own["right"] else ""
            else:
                here = f"{measured(case, own)} here" if one["error"] < own["error"] / 10 else ""
            if here:
                lines.append(
                    f"* {case['title']}: {here}, {measured(case, one)} in {label} "
                    f"({cell(one['how'])})."
                )
    return lines or ["* Nowhere."]


def page(record: Record) -> str:
    """Make the whole page."""
    machine = [*record["machine"].items(), *record["versions"].items(), ("date", record["date"])]
    return PAGE.format(
        glance=glance(record),
        summary=summary(record),
        sections="\n".join(section(case) for case in record["cases"]),
        losses="\n".join(losses(record)),
        machine="\n".join(f"* {name}: {value}" for name, value in machine),
        listed=table(
            ["case", "test"],
            [
                [case, ", ".join(f"`{test.removeprefix('tests/')}`" for test in tests)]
                for case, tests in LISTED.items()
            ],
        ).rstrip(),
    )
