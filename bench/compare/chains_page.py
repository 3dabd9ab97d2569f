"""The record of chains as a page, made of nothing but what the JSON holds."""

from __future__ import annotations

import math
from typing import Any

from equal_error import Record
from tables import entrants, number, pair, table

CORE = "pendcore"
PEERS = {"pinocchio": "Pinocchio's ABA", "mujoco": "MuJoCo"}
BARS = {10: 5, 100: 8}  # n: pendcore takes at most this part of the fastest peer's time, 1/5 or 1/8
GROWTH_FROM = 100  # links: where a call's fixed cost no longer shows

PAGE = """# Chains of n links

Made by `make compare`; do not edit: run again. The raw figures are in
[chains.json](../records/comparison/chains.json).

![Time and memory of a right-hand side against the number of links](chains.png)

This page compares the time that C++ programs take for the accelerations of a planar chain of n
rods, in **nanoseconds a call**. Each figure is the least over {rounds} rounds in which every
contender at every n had its turn, in an order drawn anew; where a ratio is formed, the ratio of
medians is in parentheses. Every call waits for the accelerations of the previous call, on states
that change from call to call; *in a step* is a right-hand side's share of an attempted step of
dopri5. Up to n = {checked} every contender's accelerations were compared with those of the dense
equations: the largest difference was {disagreement:.0e} of the largest acceleration. Pinocchio and
MuJoCo support spatial motion, trees and many kinds of joints; pendcore supports planar chains.

## Beside the fastest peer

A ratio is pendcore's time divided by the time of the fastest peer in that row, for minima and, in
parentheses, for medians. Below 1 pendcore is quicker.

{fastest}
{bars}

{growth}

## All contenders

Nanoseconds a call, minima.

{everybody}
## Memory

The table has the heap memory that a prepared contender holds, in bytes **a link**. It includes the
angles and rates of the states that the calls go through: 256 angles in all, but at least two
states. MuJoCo's memory includes the arena that it reserves.

{memory}
{held}

## Where pendcore loses

{losses}

## Who took part, and on what

{contenders}

{machine}
"""


def points(contender: Any) -> dict[int, Any]:
    return {point["n"]: point for point in contender["points"]}


def lengths(record: Record) -> list[int]:
    return sorted({point["n"] for one in record["contenders"] for point in one["points"]})


def fastest_peer(record: Record, n: int) -> tuple[str, Any] | None:
    """Find the label and the point of the peer that is quickest at n."""
    found = [
        (points(one)[n]["minimum_ns"], one["label"], points(one)[n])
        for one in record["contenders"]
        if not one["name"].startswith(CORE) and n in points(one)
    ]
    return min(found, key=lambda peer: peer[0])[1:] if found else None


def ratios(record: Record, n: int) -> tuple[str, float, float] | None:
    """Compare with the fastest peer at n: its label, the ratio of minima, the ratio of medians."""
    known = entrants(record)
    mine = points(known[CORE]).get(n) if CORE in known else None
    peer = fastest_peer(record, n)
    if mine is None or peer is None:
        return None
    label, point = peer
    of_minima, of_medians = (mine[kind] / point[kind] for kind in ("minimum_ns", "median_ns"))
    return label, of_minima, of_medians


def beside_the_fastest(record: Record) -> str:
    known = entrants(record)
    own = points(known[CORE]) if CORE in known else {}
    rows = []
    for n in lengths(record):
        mine = own[n]["minimum_ns"] if n in own else None
        peer, found = fastest_peer(record, n), ratios(record, n)
        rows.append(
            [str(n), number(mine), number(mine / n if mine else None)]
            + ([peer[0], number(peer[1]["minimum_ns"])] if peer else ["—", "—"])
            + [pair(*found[1:]) if found else "—"]
        )
    return table(["n", "pendcore", "ns a link", "fastest peer", "its time", "ratio"], rows)


def bars(record: Record) -> list[str]:
    """Say at which n pendcore keeps its promise."""
    lines = []
    for n, parts in BARS.items():
        found = ratios(record, n)
        if found:
            label, of_minima, of_medians = found
            verdict = "kept" if of_minima <= 1 / parts else "**missed**"
            lines.append(
                f"* n = {n}: 1/{1 / of_minima:.1f} of the time of {label} (medians: "
                f"1/{1 / of_medians:.1f}); promised is at most 1/{parts}: {verdict}."
            )
    return lines or ["* Not measured: one of the two sides was not installed."]


def exponent(record: Record, name: str) -> float | None:
    """Fit p in time ~ n^p by least squares in the logarithms, from GROWTH_FROM links on."""
    known = entrants(record)
    found = [
        (math.log(n), math.log(point["minimum_ns"]))
        for n, point in (points(known[name]) if name in known else {}).items()
        if n >= GROWTH_FROM
    ]
    if len(found) < 2:
        return None
    x0 = sum(x for x, _ in found) / len(found)
    y0 = sum(y for _, y in found) / len(found)
    return sum((x - x0) * (y - y0) for x, y in found) / sum((x - x0) ** 2 for x, _ in found)


def growth(record: Record) -> str:
    """Say with what power of n the time grows."""
    found = exponent(record, CORE)
    if found is None:
        return ""
    last = max(points(entrants(record)[CORE]))
    return (
        f"From n = {GROWTH_FROM} to {last} pendcore's time grows with n to the power {found:.2f}."
    )


def everybody(record: Record) -> str:
    rows = [
        [str(n)]
        + [number(points(one).get(n, {}).get("minimum_ns")) for one in record["contenders"]]
        for n in lengths(record)
    ]
    return table(["n"] + [one["label"] for one in record["contenders"]], rows)


def memory(record: Record) -> str:
    rows = [
        [str(n)]
        + [
            number(used / n) if (used := points(one).get(n, {}).get("bytes")) else "—"
            for one in record["contenders"]
        ]
        for n in lengths(record)
    ]
    return table(["n"] + [one["label"] for one in record["contenders"]], rows)


def held(record: Record) -> str:
    """Say how pendcore's memory grows."""
    known = entrants(record)
    found = [
        (n, point["bytes"] / n)
        for n, point in (points(known[CORE]) if CORE in known else {}).items()
        if point["bytes"] and n >= GROWTH_FROM
    ]
    if len(found) < 2:
        return ""
    (first, little), (last, much) = found[0], found[-1]
    return (
        f"pendcore holds {little:.0f} bytes a link at n = {first} and {much:.0f} at n = {last}: "
        f"{much / little:.2f} times as much for {last / first:.0f} times the links."
    )


def losses(record: Record) -> list[str]:
    """Name each n at which a peer is quicker."""
    compared = {n: found for n in lengths(record) if (found := ratios(record, n))}
    slower = [
        f"* n = {n}: {label} takes {1 / of_minima:.2f} of its time."
        for n, (label, of_minima, _) in compared.items()
        if of_minima > 1
    ]
    return slower or ["* At none of these n." if compared else "* Not measured."]


def contenders(record: Record) -> list[str]:
    lines = []
    for one in record["contenders"]:
        stops = f"; {one['stops']}" if one["stops"] else ""
        lines.append(f"* {one['label']}: {one['about']}{stops}")
    return lines


def summary(record: Record) -> str:
    """Make the few lines for the terminal."""
    return "\n".join([beside_the_fastest(record), *bars(record), growth(record)])


def page(record: Record) -> str:
    """Make the whole page."""
    checked = [
        (point["n"], point["disagreement"])
        for one in record["contenders"]
        for point in one["points"]
        if point["disagreement"] is not None
    ]
    machine = [*record["machine"].items(), ("date", record["date"])]
    return PAGE.format(
        rounds=record["rounds"],
        checked=max((n for n, _ in checked), default=0),
        disagreement=max((error for _, error in checked), default=0.0),
        fastest=beside_the_fastest(record),
        bars="\n".join(bars(record)),
        growth=growth(record),
        everybody=everybody(record),
        memory=memory(record),
        held=held(record),
        losses="\n".join(losses(record)),
        contenders="\n".join(contenders(record)),
        machine="\n".join(f"* {name}: {value}" for name, value in machine),
    )
