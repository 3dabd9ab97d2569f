"""Tables of solves: what accuracy costs on a case, on stiff scenes, and for many runs at once."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

from equal_error import (
    DECADES,
    OUTER_SIDES,
    SIDES,
    Comparison,
    Contender,
    Entrants,
    Side,
    compare,
    curve,
    on,
    time_at,
)
from record import Point, Record
from tables import NONE, fact, listed, number, pair, power, short, table

SHOWN_TOLERANCES = (1e-6, 1e-9)
KINDS = ("minimum_us", "median_us")
STIFF_ERRORS = (1e-3, 1e-4, 1e-5, 1e-6, 1e-7)
ENSEMBLE_ERRORS = (1e-3, 1e-6, 1e-9, 1e-12)
ENSEMBLE_BARS = {"bare": "1/3", "damped": "1/2", "motor": "1/2", "three_links": "1/2"}


def both(at: Comparison, name: Callable[[str], str] = short) -> list[str]:
    """Write the best of pendcore and its time, then the best peer and its time."""
    sides = (at.own or (None, NONE), at.peer or (None, NONE))
    return [cell for time, label in sides for cell in (name(label), number(time))]


def best_against_best(who: Entrants, side: Side, errors: Iterable[float] = DECADES) -> str:
    """Tabulate, for each achieved error, the best of both sides and the goal.

    Ratios are of minima, and of medians in parentheses.
    """
    compared = compare(who, side, errors)
    if not compared:
        return "Not measured: one of the two sides was not there.\n"
    rows = []
    for at in compared:
        if at.ratio is None:
            found = "pendcore alone" if at.own else "peer alone" if at.peer else "nobody"
        else:
            found = pair(at.ratio, at.of_medians)
        goal = f"{at.bar} {'reached' if at.reached else 'missed'}" if at.own or at.peer else NONE
        rows.append([power(at.error), *both(at), found, goal])
    return table(
        ["achieved error", "best of pendcore", "us", "best peer", "us", "ratio", "goal"], rows
    )


def sides(record: Record) -> str:
    who = record.taking_part()
    parts = (f"## Best against best, {one.title}\n\n{best_against_best(who, one)}" for one in SIDES)
    return "\n".join(parts)


def at_errors(
    one: Contender, errors: Iterable[float], kinds: Iterable[str] = KINDS[:1]
) -> list[str]:
    """Return a contender's costs at each error."""
    curves = [curve(one, kind) for kind in kinds]
    return [" / ".join(number(time_at(each, error)) for each in curves) for error in errors]


def everybody(record: Record) -> str:
    """Tabulate every contender's time at each decade of achieved error, side by side."""
    header, parts = ["us at an error of", *map(power, DECADES), "smallest error"], []
    for side in SIDES:
        rows = []
        for one in (one for one in record.taking_part() if side.ours in one["sides"]):
            least = min((error for error, _ in curve(one)), default=None)
            last = power(least) if least else NONE
            rows.append([short(one["label"]), *at_errors(one, DECADES), last])
        if rows:
            parts.append(f"{side.title}:\n\n{table(header, rows)}")
    return "\n".join(parts)


def at_tolerance(contender: Contender, tolerance: float) -> Point:
    """Return the contender's point at rtol = atol = tolerance; empty if there is none."""
    for point in contender["points"]:
        if abs(point["setting"] / tolerance - 1) < 1e-9 and "failure" not in point:
            return dict(point)
    return {}


def per_evaluation(point: Point) -> float | None:
    """Divide the time of the whole call by its right-hand sides, in nanoseconds."""
    evaluations = point.get("evaluations")
    return 1e3 * point["minimum_us"] / evaluations if evaluations else None


def tolerances(record: Record) -> str:
    """Tabulate every contender that was tried with the shown tolerances."""
    who = record.taking_part()
    header = ["contender", "error", "at the end", "of energy", "right-hand sides"]
    header += ["us", "median us", "ns a right-hand side"]
    parts = []
    for tolerance in SHOWN_TOLERANCES:
        rows = []
        for one in who:
            point = at_tolerance(one, tolerance)
            if one["setting"] == "tolerance" and point:
                errors = [point.get(kind) for kind in ("error", "end_error", "energy_error")]
                rows.append(
                    [one["label"]]
                    + [NONE if error is None else f"{error:.1e}" for error in errors]
                    + [str(point.get("evaluations") or NONE)]
                    + [number(point[kind]) for kind in KINDS]
                    + [number(per_evaluation(point))]
                )
        parts.append(f"rtol = atol = {power(tolerance)}:\n\n{table(header, rows)}")
    return "\n".join(parts)


def fixed_cost(record: Record) -> str:
    """Tabulate calls whose interval one step covers."""
    calls = ((one["label"], one["one_step"]) for one in record.taking_part())
    rows = [
        [label, str(call.get("evaluations") or NONE), *(number(call[kind]) for kind in KINDS)]
        for label, call in calls
        if call
    ]
    return table(["contender", "right-hand sides", "us", "median us"], rows)


def losses(record: Record) -> str:
    """Name, for each side, the errors where the best peer is quicker, and who gets further.

    Then come the peers whose call of one step costs less than pendcore's cheapest.
    """
    who = record.taking_part()
    lines, calls = [], []
    for side in SIDES:
        lost = [(at, short(at.peer[1])) for at in compare(who, side) if at.peer and at.lost]
        slower = [f"{power(at.error)} ({who}: x {number(at.ratio)})" for at, who in lost if at.own]
        alone = [f"{power(at.error)} ({who})" for at, who in lost if not at.own]
        if slower:
            lines.append(f"{side.title}: slower than the best peer at {', '.join(slower)}.")
        if alone:
            lines.append(f"{side.title}: does not get to {', '.join(alone)}.")
        ours, peers = (
            [(one["one_step"]["minimum_us"], one["label"]) for one in each if one["one_step"]]
            for each in (on(who, side.ours, ours=True), on(who, side.peers, ours=False))
        )
        least = min(ours, default=(0.0, ""))[0]
        cheaper = [f"{short(label)} {number(time)} us" for time, label in peers if time < least]
        if cheaper:
            calls.append(
                f"{side.title}: a call of one step costs {number(least)} us or more, and less "
                f"with {', '.join(cheaper)}."
            )
    return listed(lines + calls, otherwise="Nowhere among these contenders, 1e-2 to 1e-13.")


def uncertainty(record: Record) -> str:
    return power(fact(record, "uncertainty"))


def failed(record: Record) -> str:
    """Name each contender that failed somewhere, and why, without the times and counts of it."""
    lines = []
    for case in record.cases:
        where = f" ({case})" if len(record.cases) > 1 else ""
        for one in record.taking_part(case):
            reasons: dict[str, list[str]] = {}
            for point in one["points"]:
                if "failure" in point:
                    reason = re.sub(r" \(at t = [^)]*\)", "", point["failure"])
                    reason = re.sub(r"(t =|mode set) [\d.e+-]+", r"\1 ...", reason)
                    reasons.setdefault(reason.rstrip("."), []).append(power(point["setting"]))
            for reason, at in reasons.items():
                span = at[0] if len(at) == 1 else f"{at[0]} to {at[-1]}"
                lines.append(f"{one['label']} at {span}: {reason}.{where}")
    return listed(lines)


def stiff_scene(record: Record, case: str) -> str:
    """Tabulate best against best, steps and times of everybody, and quote dopri5's last words."""
    who, facts = record.taking_part(case), record.cases[case]
    parts = [f"## {facts['label']}\n"]
    parts += [f"Reference good to {facts['uncertainty']:.0e} of the length.\n"]
    for side in OUTER_SIDES:
        if compare(who, side, STIFF_ERRORS):
            parts += [f"Best against best, {side.title}:\n"]
            parts += [best_against_best(who, side, STIFF_ERRORS)]
    rows = [
        [one["label"], *at_errors(one, STIFF_ERRORS, ("steps", "minimum_us"))]
        for one in who
        if "compiled_v3" not in one["sides"]
    ]
    parts += [table(["steps / us at an error of", *map(power, STIFF_ERRORS)], rows)]
    points = record.points("pendcore_dopri5", case)
    words = [point.get("failure") or point.get("said") or "" for point in points]
    spoken = [each for each in words if each and not each.startswith("not run")]
    return "\n".join([*parts, f"> dopri5: {spoken[-1]}\n" if spoken else ""])


def stiff_scenes(record: Record) -> str:
    return "\n".join(stiff_scene(record, case) for case in record.cases)


def ensemble_scenes(record: Record) -> str:
    """Compare the best of pendcore with the best of heyoka at each error, then everybody."""
    header = ["median error", "pendcore", "us", "heyoka", "us", "ratio", "bar"]
    parts = []
    for case, facts in record.cases.items():
        who = record.taking_part(case)
        rivals = [one for one in who if one["ours"] or "heyoka" in one["label"]]
        best = []
        for at in compare(rivals, OUTER_SIDES[1], ENSEMBLE_ERRORS):
            best.append(
                [power(at.error), *both(at, str), f"**{number(at.ratio)}**", ENSEMBLE_BARS[case]]
            )
        rows = [
            [each["label"], *at_errors({"points": record.points(name, case)}, ENSEMBLE_ERRORS)]
            for name, each in record.contenders.items()
        ]
        parts += [f"## {facts['label'][0].upper()}{facts['label'][1:]}\n", table(header, best)]
        parts += ["Everybody, us a trajectory at an error of:\n"]
        parts += [table(["", *map(power, ENSEMBLE_ERRORS)], rows)]
    return "\n".join(parts)


def gain_of(record: Record, what: str) -> str:
    """Return the gain of two threads or processes over one."""
    rows = record.points(what, next(iter(record.cases)))
    return f"{rows[0]['gain']:.2f}" if rows else NONE


def gain_over_loops(record: Record) -> str:
    gains = [row["gain"] for what in ("ensemble", "loops") for row in record.points(what, "bare")]
    return f"{gains[0] / gains[1]:.2f}" if len(gains) == 2 else NONE
