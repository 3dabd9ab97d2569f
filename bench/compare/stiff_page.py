"""The record of stiff scenes as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from equal_error import SIDES, Contender, Record, curve, on
from page import absent, contenders, failures, machine
from tables import best_against_best, number, power, table
from work_precision import time_at

ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
SHOWN_SIDES = tuple(side for side in SIDES if "held back" not in side.title)
KINDS = ("steps", "minimum_us")

PAGE = """# Stiff scenes

Made by `make compare`; do not edit: run again. The raw figures are in
[stiff.json](../records/comparison/stiff.json).
[All cases](README.md) has how this was measured.

![Error against time on three stiff scenes](stiff.png)

Two rods of 1 kg and 1 m are released from rest and swing for 5 s; joint 2 has a damper, a spring
or a controller that is far faster than the pendulum. Every peer has the closed form of the rates
compiled, and, where it uses one, the Jacobian in closed form; pendcore computes its own Jacobian
by dual numbers. CVODE and pendcore's core are called from C++, the others from Python. The
reference is computed by SciPy, at tolerances far tighter than any here. Steps include rejected
ones where the solver reports them.

{scenes}
## Runs that failed or were not made

{failures}

## Who took part, and on what

{contenders}
{absent}
{machine}
"""


def counted(contender: Contender, kind: str) -> list[tuple[float, float]]:
    """List (error, steps or microseconds) of every setting that succeeded."""
    if kind != "steps":
        return curve(contender, kind)
    points = (point for point in contender["points"] if "failure" not in point)
    return [(p["error"], p["steps"]) for p in points if p["steps"] is not None]


def each_at_equal_error(record: Record) -> str:
    """Tabulate steps and times of every contender at equal errors."""
    header = ["steps / us at an error of", *map(power, ERRORS)]
    rows = []
    for one in record["contenders"]:
        if "compiled_v3" in one["sides"]:
            continue
        cells = [
            " / ".join(number(time_at(counted(one, kind), error)) for kind in KINDS)
            for error in ERRORS
        ]
        rows.append([one["label"], *cells])
    return table(header, rows)


def said(record: Record) -> str:
    """Quote the message of dopri5 from the tightest run that was made, finished or not."""
    words = [
        point.get("failure") or point.get("said")
        for one in record["contenders"]
        for point in one["points"]
        if one["name"] == "pendcore_dopri5"
    ]
    spoken = [each for each in words if each and not each.startswith("not run")]
    return f"> dopri5: {spoken[-1]}\n" if spoken else ""


def section(record: Record) -> str:
    parts = [f"## {record['label']}\n"]
    parts += [f"Reference good to {record['uncertainty']:.0e} of the length.\n"]
    for side in SHOWN_SIDES:
        if on(record, side.ours, ours=True) and on(record, side.peers, ours=False):
            parts += [f"Best against best, {side.title}:\n"]
            parts += [best_against_best(record, side, ERRORS)]
    return "\n".join([*parts, each_at_equal_error(record), said(record)])


def page(record: Record) -> str:
    scenes = record["scenes"]
    failed = [f"{line} ({each['case']})" for each in scenes for line in failures(each)]
    return PAGE.format(
        scenes="\n".join(section(each) for each in scenes),
        failures="\n".join(failed),
        contenders="\n".join(contenders(scenes[0])),
        absent=absent(scenes[0]),
        machine=machine(record),
    )


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    return "\n".join(
        f"{each['label']}, {side.title}:\n{best_against_best(each, side, ERRORS)}"
        for each in record["scenes"]
        for side in SHOWN_SIDES
    )
