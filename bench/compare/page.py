"""The record as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

from tables import (
    CORE,
    CORE_PEERS,
    DECADES,
    PYTHON,
    PYTHON_PEERS,
    SHOWN_TOLERANCES,
    Record,
    at_tolerance,
    curve,
    entrants,
    equal_error,
    equal_tolerance,
    fixed_cost,
    number,
    power,
)
from work_precision import ratios_at

PAGE = """# What accuracy costs: {case}

Made by `make compare`; the raw figures are in [{case}.json]({case}.json). Do not edit: run again.

![Work against precision]({case}.png)

**Error** is the largest distance, over the case's fixed times, between computed and reference
joints and tip, divided by the total length; the reference is in multiple precision. **Time** is the
least over {rounds} rounds in which every contender at every tolerance had its turn, in an order
drawn anew; medians beside it. It is the call that produced the error, the states at all times in
hand at its end; what can be built beforehand is not in it. Tolerances are rtol = atol. Between
tolerances, log time is interpolated over log error, on the points that no other beats in both (the
lines of the figure; its markers are the decades of tolerance). A ratio is pendcore's time over the
peer's, of minima and, in parentheses, of medians: below 1 pendcore is quicker. Times are in
microseconds.

## At equal achieved error, in C++

{core}
## At equal achieved error, called from Python

{python}
## At equal tolerance

The energy's error is its largest drift, as a share of what the whole mass gains falling the whole
length. A right-hand side's nanoseconds are the whole call's time, divided by their number.

{tolerances}
{shares}

## Fixed cost of a call

An interval that one step covers.

{fixed}
## Where pendcore loses

{losses}

## Runs that failed

{failures}

## Who took part, and on what

{contenders}

{machine}
"""


def shares(record: Record) -> list[str]:
    """Say what part of each Python peer's time `pc.simulate` takes at rtol = atol = 1e-6."""
    known = entrants(record)
    if PYTHON not in known:
        return ["* nobody: pendcore was not installed."]
    own = at_tolerance(known[PYTHON], 1e-6)
    lines = []
    for name in PYTHON_PEERS:
        peer = at_tolerance(known[name], 1e-6) if name in known else {}
        if own and peer:
            share = own["minimum_us"] / peer["minimum_us"]
            median = own["median_us"] / peer["median_us"]
            compared = f"{share:.4f} = 1/{1 / share:.1f} of its time (medians: 1/{1 / median:.1f})"
            lines.append(f"* {known[name]['label']}: {compared}")
    return lines


def losses(record: Record) -> list[str]:
    """Name each peer that is quicker at some decade of achieved error, or gets further."""
    known, lines, compared = entrants(record), [], False
    for own, peers in ((CORE, CORE_PEERS), (PYTHON, PYTHON_PEERS)):
        for name in peers:
            ours, theirs = (curve(known[side]) if side in known else [] for side in (own, name))
            if not ours or not theirs:
                continue
            compared = True
            ratios = ratios_at(ours, theirs, DECADES)
            slower = [
                power(error) for error, ratio in ratios.items() if ratio is not None and ratio > 1
            ]
            pair = f"{known[own]['label']} against {known[name]['label']}"
            if slower:
                lines.append(f"* {pair}: slower at {', '.join(slower)}.")
            mine, other = (known[side]["one_step"]["minimum_us"] for side in (own, name))
            if mine > other:
                cost = f"{number(mine)} us against {number(other)} us"
                lines.append(f"* {pair}: a call of one step costs more, {cost}.")
            best, peers_best = min(ours)[0], min(theirs)[0]
            if peers_best < best / 2:
                lines.append(
                    f"* {pair}: the peer gets down to {peers_best:.0e}, pendcore to {best:.0e}."
                )
    nowhere = "Nowhere among these contenders, from 1e-2 to 1e-11." if compared else "Not measured."
    return lines or [f"* {nowhere}"]


def failures(record: Record) -> list[str]:
    """Name each contender that failed somewhere, with its first reason."""
    lines = []
    for contender in record["contenders"]:
        failed = [point for point in contender["points"] if "failure" in point]
        if failed:
            where = ", ".join(power(point["tolerance"]) for point in failed)
            lines.append(f"* {contender['label']} at {where}: {failed[0]['failure']}.")
    return lines or ["* None."]


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    return "\n".join(
        [
            equal_error(record, CORE, CORE_PEERS),
            "pc.simulate at rtol = atol = 1e-6 takes, against",
            *shares(record),
            "",
            "Where pendcore loses:",
            *losses(record),
        ]
    )


def contenders(record: Record) -> list[str]:
    """Say of each contender what it was and how long it compiles."""
    lines = []
    for contender in record["contenders"]:
        seconds = contender["compile_seconds"]
        waiting = "" if seconds is None else f"; compiles for {number(seconds, 2)} s once a process"
        lines.append(f"* {contender['label']}: {contender['about']}{waiting}")
    return lines


def page(record: Record) -> str:
    """Make the whole page."""
    tolerances = [
        f"rtol = atol = {power(tolerance)}:\n\n{equal_tolerance(record, tolerance)}"
        for tolerance in SHOWN_TOLERANCES
    ]
    machine = [*record["machine"].items(), ("date", record["date"])]
    return PAGE.format(
        case=record["case"],
        rounds=record["rounds"],
        core=equal_error(record, CORE, CORE_PEERS),
        python=equal_error(record, PYTHON, PYTHON_PEERS),
        tolerances="\n".join(tolerances),
        shares="\n".join(["At rtol = atol = 1e-6 `pc.simulate` takes, against\n", *shares(record)]),
        fixed=fixed_cost(record),
        losses="\n".join(losses(record)),
        failures="\n".join(failures(record)),
        contenders="\n".join(contenders(record)),
        machine="\n".join(f"* {name}: {value}" for name, value in machine),
    )
