"""A record of solves as markdown tables."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from equal_error import DECADES, Contender, Record, Side, compare, curve
from work_precision import reached_at, time_at

SHOWN_TOLERANCES = (1e-6, 1e-9)
KINDS = ("minimum_us", "median_us")


def entrants(record: Record) -> dict[str, Any]:
    return {contender["name"]: contender for contender in record["contenders"]}


def number(value: float | None, digits: int = 3) -> str:
    """Write with that many digits and no power of ten; None becomes an em dash."""
    if value is None:
        return "—"
    if value >= 10 ** (digits - 1):
        return f"{value:.0f}"
    return f"{value:#.{digits}g}".rstrip(".")


def power(value: float) -> str:
    return f"{value:.0e}".replace("e-0", "e-")


def table(header: list[str], rows: list[list[str]]) -> str:
    lines = [header, ["---"] + ["--:"] * (len(header) - 1), *rows]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in lines) + "\n"


def pair(of_minima: float | None, of_medians: float | None) -> str:
    return f"**{number(of_minima)}** ({number(of_medians)})"


def short(label: str) -> str:
    """Leave out the part that every label on a side has in common."""
    for end in (" (x86-64-v3)", ", C++", ", Python"):
        label = label.removesuffix(end)
    return label


def best_against_best(record: Record, side: Side, errors: Iterable[float] = DECADES) -> str:
    """Tabulate, for each decade of achieved error, the best of both sides and the goal.

    Ratios are of minima, and of medians in parentheses.
    """
    compared = compare(record, side, errors)
    if not compared:
        return "Not measured: one of the two sides was not there.\n"
    header = ["achieved error", "best of pendcore", "us", "best peer", "us", "ratio", "goal"]
    rows = []
    for at in compared:
        own, peer = at.own or (None, "—"), at.peer or (None, "—")
        if at.ratio is None:
            found = "pendcore alone" if at.own else "peer alone" if at.peer else "nobody"
        else:
            found = pair(at.ratio, at.of_medians)
        goal = f"{at.bar} {'reached' if at.reached else 'missed'}" if at.own or at.peer else "—"
        names = [short(who) for _, who in (own, peer)]
        rows.append(
            [power(at.error), names[0], number(own[0]), names[1], number(peer[0]), found, goal]
        )
    return table(header, rows)


def everybody(record: Record, side: str) -> str:
    """Tabulate every contender's time at each decade of achieved error."""
    present = [one for one in record["contenders"] if side in one["sides"]]
    if not present:
        return "Not measured.\n"
    header = ["us at an error of", *map(power, DECADES), "smallest error"]
    rows = [
        [short(one["label"])]
        + [number(time_at(curve(one), error)) for error in DECADES]
        + [power(reached) if (reached := reached_at(curve(one))) else "—"]
        for one in present
    ]
    return table(header, rows)


def at_tolerance(contender: Contender, tolerance: float) -> dict[str, Any]:
    """Return the contender's point at rtol = atol = tolerance; empty if there is none."""
    for point in contender["points"]:
        if abs(point["setting"] / tolerance - 1) < 1e-9 and "failure" not in point:
            return dict(point)
    return {}


def per_evaluation(point: dict[str, Any]) -> float | None:
    """Divide the time of the whole call by its right-hand sides, in nanoseconds."""
    evaluations = point.get("evaluations")
    return 1e3 * point["minimum_us"] / evaluations if evaluations else None


def equal_tolerance(record: Record, tolerance: float) -> str:
    """Tabulate every contender that was tried with this tolerance."""
    header = ["contender", "error", "at the end", "of energy", "right-hand sides"]
    header += ["us", "median us", "ns a right-hand side"]
    rows = []
    for contender in record["contenders"]:
        point = at_tolerance(contender, tolerance)
        if contender["setting"] != "tolerance" or not point:
            continue
        errors = [point[kind] for kind in ("error", "end_error", "energy_error")]
        rows.append(
            [contender["label"]]
            + ["—" if error is None else f"{error:.1e}" for error in errors]
            + [str(point["evaluations"] or "—")]
            + [number(point[kind]) for kind in KINDS]
            + [number(per_evaluation(point))]
        )
    return table(header, rows)


def fixed_cost(record: Record) -> str:
    """Tabulate calls whose interval one step covers."""
    rows = []
    for contender in record["contenders"]:
        call = contender["one_step"]
        if call is None:
            continue
        times = [number(call[kind]) for kind in KINDS]
        rows.append([contender["label"], str(call["evaluations"] or "—"), *times])
    return table(["contender", "right-hand sides", "us", "median us"], rows)
