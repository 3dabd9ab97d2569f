"""A record of solves as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

import re

from equal_error import SIDES, Contender, Record, Side, compare, on
from tables import (
    SHOWN_TOLERANCES,
    best_against_best,
    equal_tolerance,
    everybody,
    fixed_cost,
    number,
    power,
    short,
)

PAGE = """# What accuracy costs: {case}

Made by `make compare`; do not edit: run again. The raw figures are in
[{case}.json](../records/comparison/{case}.json).
[All cases](README.md) has what to choose, how this was measured, and why pendcore loses where it
does.

{about}

![Work against precision]({case}.png)

The upper half shows the time of a solve at an achieved error. Each contender has a line, with a
marker for each decade of tolerance (for heyoka and rk4: every third setting) and a cross where
tighter settings failed or were not run. The lower half shows the time of pendcore's best method
divided by that of the best peer, shaded where the peer is quicker. SciPy with right-hand sides in
Python is only in the tables.

{sides}
## Each contender at equal achieved error

{everybody}
## At equal tolerance

The error of the energy is its largest drift, as a share of the energy that the whole mass gains by
falling the whole length. The nanoseconds of a right-hand side are the time of the whole call,
divided by the number of right-hand sides. heyoka and pendcore's rk4 are not in these tables:
heyoka ran with one tolerance for each order, rk4 with fixed steps.

{tolerances}
## Fixed cost of a call

The time of a call whose interval one step covers.

{fixed}
## Where pendcore loses

{losses}

## Runs that failed or were not made

{failures}

## Who took part, and on what

{contenders}
{absent}
{machine}
"""

ABOUT = {
    "textbook": "The double pendulum of the textbook's section 2.1 from its start, 5 s.",
    "textbook_long": "The textbook's double pendulum for 60 s.",
    "high_energy": (
        "The textbook's rods, thrown: a chaotic motion, 10 s. A rounding error of 1e-16 grows to "
        "about 1e-8 on the way, so much smaller errors are beyond double precision, but for luck."
    ),
    "damped_textbook": "The textbook's start with viscous dampers in both joints, 10 s.",
    "three_links": "Three unit rods, 5 s.",
}


def title(side: Side) -> str:
    return f"## Best against best, {side.title}"


def losses(record: Record) -> list[str]:
    """Name, for each side, the errors where the best peer is quicker, and who gets further."""
    lines = []
    for side in SIDES:
        slower = [
            f"{power(at.error)} ({short(at.peer[1])}: x {number(at.ratio)})"
            for at in compare(record, side)
            if at.peer and at.ratio is not None and at.ratio > 1
        ]
        alone = [
            f"{power(at.error)} ({short(at.peer[1])})"
            for at in compare(record, side)
            if at.peer and not at.own
        ]
        if slower:
            lines.append(f"* {side.title}: slower than the best peer at {', '.join(slower)}.")
        if alone:
            lines.append(f"* {side.title}: does not get to {', '.join(alone)}.")
    return lines + dearer_calls(record)


def dearer_calls(record: Record) -> list[str]:
    """Name the peers whose call of one step costs less than pendcore's cheapest."""
    lines = []
    for side in SIDES:
        ours, peers = (
            [(one["one_step"]["minimum_us"], one["label"]) for one in listed if one["one_step"]]
            for listed in (on(record, side.ours, ours=True), on(record, side.peers, ours=False))
        )
        if not ours:
            continue
        least, _ = min(ours)
        cheaper = [f"{short(who)} {number(time)} us" for time, who in peers if time < least]
        if cheaper:
            lines.append(
                f"* {side.title}: a call of one step costs {number(least)} us or more, and less "
                f"with {', '.join(cheaper)}."
            )
    return lines


def failures(record: Record) -> list[str]:
    """Name each contender that failed somewhere, and why, without the time of the failure."""
    lines = []
    for contender in record["contenders"]:
        reasons: dict[str, list[str]] = {}
        for point in contender["points"]:
            if "failure" in point:
                reason = re.sub(r" \(at t = [^)]*\)", "", point["failure"])
                reasons.setdefault(reason, []).append(power(point["setting"]))
        for reason, where in reasons.items():
            span = where[0] if len(where) == 1 else f"{where[0]} to {where[-1]}"
            lines.append(f"* {contender['label']} at {span}: {reason.rstrip('.')}.")
    return lines or ["* None."]


def waiting(contender: Contender) -> str:
    """Say how long it compiles, as the range from the quickest to the slowest setting."""
    if contender["compile_seconds"] is None:
        return ""
    least, most = (number(seconds, 2) for seconds in contender["compile_seconds"])
    span = least if least == most else f"{least} to {most}"
    return f"; compiles for {span} s, which is in no figure here"


def contenders(record: Record) -> list[str]:
    return [f"* {one['label']}: {one['about']}{waiting(one)}" for one in record["contenders"]]


def absent(record: Record) -> str:
    """Say who is missing, and why."""
    lines = [f"* not here: {who}: {reason}" for who, reason in record["absent"].items()]
    return "\n".join(["", *lines, ""]) if lines else ""


def machine(record: Record) -> str:
    facts = [*record["machine"].items(), ("date", record["date"])]
    return "\n".join(f"* {name}: {value}" for name, value in facts)


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    tables = [f"{side.title}:\n{best_against_best(record, side)}" for side in SIDES]
    return "\n".join([*tables, "Where pendcore loses:", *(losses(record) or ["* nowhere"])])


def page(record: Record) -> str:
    """Make the whole page."""
    tolerances = [
        f"rtol = atol = {power(tolerance)}:\n\n{equal_tolerance(record, tolerance)}"
        for tolerance in SHOWN_TOLERANCES
    ]
    sides = [f"{title(side)}\n\n{best_against_best(record, side)}" for side in SIDES]
    every = [
        f"{side.title}:\n\n{everybody(record, side.ours)}"
        for side in SIDES
        if on(record, side.ours, ours=True) or on(record, side.ours, ours=False)
    ]
    known = f"The reference is good to {record['uncertainty']:.0e} of the length"
    return PAGE.format(
        case=record["case"],
        about=f"{ABOUT[record['case']]} {known}; {record['times']} times are compared.",
        sides="\n".join(sides),
        everybody="\n".join(every),
        tolerances="\n".join(tolerances),
        fixed=fixed_cost(record),
        losses="\n".join(losses(record) or ["* Nowhere among these contenders, 1e-2 to 1e-13."]),
        failures="\n".join(failures(record)),
        contenders="\n".join(contenders(record)),
        absent=absent(record),
        machine=machine(record),
    )
