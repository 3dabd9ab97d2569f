"""Tables of right-hand sides: of chains of n links, and of two links with effects."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from record import Point, Record
from tables import NONE, Rows, listed, number, pair, power, table

CORE, STEP, PEER = "pendcore", "pendcore_step", "mujoco_forward"
RUNS = {CORE: "pendcore_run", PEER: "mujoco_run"}
BARS = {10: 5, 100: 8}  # n: pendcore takes at most this part of the fastest peer's time, 1/5 or 1/8
GROWTH_FROM = 100  # links: where a call's fixed cost no longer shows
BARE = "none"


def point(record: Record, contender: str, case: Any) -> Point:
    """Return the only row of a contender on a case, or nothing."""
    return next(iter(record.points(contender, str(case))), {})


def lengths(record: Record) -> list[int]:
    return [facts["n"] for facts in record.cases.values()]


def of_links(record: Record, contender: str, metric: str) -> dict[int, float]:
    """Return a metric of a contender by number of links, where it was measured."""
    found = {n: point(record, contender, n).get(metric) for n in lengths(record)}
    return {n: value for n, value in found.items() if value}


def fastest_peer(record: Record, n: int) -> tuple[str, Point] | None:
    """Find the label and the row of the peer that is quickest at n."""
    found = [
        (at["minimum_ns"], facts["label"], at)
        for name, facts in record.contenders.items()
        if not name.startswith(CORE) and (at := point(record, name, n))
    ]
    return min(found, key=lambda peer: peer[0])[1:] if found else None


def ratios(record: Record, n: int) -> tuple[str, float, float] | None:
    """Compare with the fastest peer at n: its label, the ratio of minima, the ratio of medians."""
    mine, peer = point(record, CORE, n), fastest_peer(record, n)
    if not mine or peer is None:
        return None
    of_minima, of_medians = (mine[kind] / peer[1][kind] for kind in ("minimum_ns", "median_ns"))
    return peer[0], of_minima, of_medians


def beside_the_fastest(record: Record) -> str:
    own = of_links(record, CORE, "minimum_ns")
    rows = []
    for n in lengths(record):
        peer, found = fastest_peer(record, n), ratios(record, n)
        rows.append(
            [str(n), number(own.get(n)), number(own[n] / n if n in own else None)]
            + ([peer[0], number(peer[1]["minimum_ns"])] if peer else [NONE, NONE])
            + [pair(*found[1:]) if found else NONE]
        )
    return table(["n", "pendcore", "ns a link", "fastest peer", "its time", "ratio"], rows)


def bars(record: Record) -> str:
    """Say at which n pendcore keeps its promise."""
    lines = []
    for n, parts in BARS.items():
        found = ratios(record, n)
        if found:
            label, of_minima, of_medians = found
            verdict = "kept" if of_minima <= 1 / parts else "**missed**"
            lines.append(
                f"n = {n}: 1/{1 / of_minima:.1f} of the time of {label} (medians: "
                f"1/{1 / of_medians:.1f}); promised is at most 1/{parts}: {verdict}."
            )
    return listed(lines, otherwise="Not measured: one of the two sides was not installed.")


def exponent(times: Mapping[int, float]) -> float | None:
    """Fit p in time ~ n^p by least squares in the logarithms, from GROWTH_FROM links on."""
    found = [(math.log(n), math.log(time)) for n, time in times.items() if n >= GROWTH_FROM]
    if len(found) < 2:
        return None
    x0, y0 = (sum(column) / len(found) for column in zip(*found, strict=True))
    return sum((x - x0) * (y - y0) for x, y in found) / sum((x - x0) ** 2 for x, _ in found)


def growth(record: Record) -> str:
    """Say with what power of n the time grows."""
    found = exponent(of_links(record, CORE, "minimum_ns"))
    return NONE if found is None else f"{found:.2f}"


def longest(record: Record) -> str:
    return str(max(of_links(record, CORE, "minimum_ns"), default=NONE))


def everybody(record: Record, metric: str) -> str:
    """Tabulate times, bytes a link, or errors of all contenders."""
    columns = {name: of_links(record, name, metric) for name in record.contenders}
    rows: Rows = []
    for n in lengths(record):
        values = (column.get(n) for column in columns.values())
        write, per = power if metric == "error" else number, n if metric == "bytes" else 1
        rows.append([str(n), *(write(x / per) if x else NONE for x in values)])
    return table(["n", *(facts["label"] for facts in record.contenders.values())], rows)


def held(record: Record) -> str:
    """Say how pendcore's memory grows."""
    bytes_of = of_links(record, CORE, "bytes")
    found = [(n, bytes_of[n] / n) for n in bytes_of if n >= GROWTH_FROM]
    if len(found) < 2:
        return ""
    (first, little), (last, much) = found[0], found[-1]
    return (
        f"pendcore holds {little:.0f} bytes a link at n = {first} and {much:.0f} at n = {last}: "
        f"{much / little:.2f} times as much for {last / first:.0f} times the links."
    )


def chain_losses(record: Record) -> str:
    """Name each n at which a peer is quicker."""
    compared = {n: found for n in lengths(record) if (found := ratios(record, n))}
    slower = [
        f"n = {n}: {label} takes {1 / of_minima:.2f} of its time."
        for n, (label, of_minima, _) in compared.items()
        if of_minima > 1
    ]
    return listed(slower, otherwise="At none of these n." if compared else "Not measured.")


def disagreement(record: Record) -> str:
    every = (record.points(name, case) for name in record.contenders for case in record.cases)
    rows = [row for rows in every for row in rows]
    return f"{max((row.get('disagreement', 0.0) for row in rows), default=0.0):.0e}"


def checked(record: Record) -> str:
    known = (n for name in record.contenders for n in of_links(record, name, "disagreement"))
    return str(max(known, default=0))


# ---- effects


def added(record: Record, effect: str, side: str, metric: str = "minimum_ns") -> float | None:
    """Return what the effect adds on that side, in nanoseconds or instructions."""
    mine, bare = (point(record, side, case).get(metric) for case in (effect, BARE))
    return None if mine is None or bare is None else mine - bare


def share(record: Record, effect: str, side: str) -> float | None:
    """Return what the effect adds as a share of the same side's bare scene."""
    more = added(record, effect, side)
    return None if more is None else more / point(record, side, BARE)["minimum_ns"]


def effects_of(record: Record) -> dict[str, Any]:
    return {name: facts for name, facts in record.cases.items() if name != BARE}


def signed(value: float | None, decimals: int = 1) -> str:
    return NONE if value is None else f"{value:+.{decimals}f}"


def beside_mujoco(record: Record) -> str:
    header = ["effect", "pendcore, a call", "in a step", "in a run"]
    header += ["MuJoCo's", "mj_forward", "in a run"]
    rows = []
    for name, facts in effects_of(record).items():
        cells = []
        for side in (CORE, STEP, RUNS[CORE], PEER, RUNS[PEER]):
            part = share(record, name, side)
            more = signed(added(record, name, side))
            cells.append(NONE if part is None else f"{more} ({part:+.0%})")
        rows.append([facts["label"], *cells[:3], facts["theirs"] or "has none", *cells[3:]])
    return table(header, rows)


def exceeded(record: Record, effect: str) -> list[str]:
    """List what the effect adds beyond the promise."""
    facts, over = record.cases[effect], []
    for metric, unit, decimals, most in (
        ("instructions", "instructions", 0, facts["most_instructions"]),
        ("minimum_ns", "ns", 1, facts["most_ns"]),
    ):
        for side, where in ((CORE, "in a call"), (STEP, "in a step")):
            more = added(record, effect, side, metric)
            if most is not None and more is not None and more > most:
                over.append(f"{more:.{decimals}f} {unit} {where}")
    return over


def promised(record: Record) -> str:
    header = ["effect", "at most", "ns, a call", "in a step", "at most", "instructions, a call"]
    rows = []
    for name, facts in effects_of(record).items():
        if facts["most_ns"] is None:
            continue
        times, counts = (
            [signed(added(record, name, side, metric), decimals) for side in (CORE, STEP)]
            for metric, decimals in (("minimum_ns", 1), ("instructions", 0))
        )
        verdict = "; ".join(exceeded(record, name)) or "kept"
        if added(record, name, CORE) is None:
            verdict = "not measured"
        limits = f"{facts['most_ns']} ns", str(facts["most_instructions"])
        rows.append([facts["label"], limits[0], *times, limits[1], *counts, verdict])
    return table([*header, "in a step", "verdict"], rows)


BARE_COUNTS = (STEP, "pendcore_kernel", "one_effect_more")


def bare_count(record: Record, contender: str) -> str:
    found = point(record, contender, BARE).get("instructions")
    return NONE if found is None else f"{found:.1f}"


def absent_effects(record: Record) -> str:
    """Say whether the bare scene executes what it would without any effects."""
    counts = {point(record, who, BARE).get("instructions") for who in BARE_COUNTS}
    return "not counted" if None in counts else "kept" if len(counts) == 1 else "**missed**"


def effect_losses(record: Record) -> str:
    """Name each effect that costs pendcore more than it costs MuJoCo, or more than promised."""
    lines, shares, compared = [], [], False
    for name, facts in effects_of(record).items():
        for where, ours, theirs in (("call", CORE, PEER), ("run", RUNS[CORE], RUNS[PEER])):
            mine, other = added(record, name, ours), added(record, name, theirs)
            compared |= mine is not None and other is not None
            if mine is not None and other is not None and mine > max(other, 0.5):
                more = f"{mine:.1f} ns here, {other:.1f} ns there"
                lines.append(f"{facts['label']} in a {where}: {more}.")
        over = exceeded(record, name)
        if over:
            lines.append(f"{facts['label']} adds more than promised: {', '.join(over)}.")
        mine, other = share(record, name, STEP), share(record, name, PEER)
        if mine is not None and other is not None and mine > max(other, 0.02):
            shares.append(facts["label"])
    if shares:
        lines.append(
            "In a step, as a share of pendcore's own bare scene, which takes less time than "
            f"MuJoCo's: {'; '.join(shares)}."
        )
    return listed(lines, otherwise="Nowhere." if compared else "Not measured.")


def bare_times(record: Record) -> str:
    """Say how long each side's scene without effects takes."""
    found = [
        f"{at['minimum_ns']:.1f} ns ({facts['label']})"
        for name, facts in record.contenders.items()
        if (at := point(record, name, BARE))
    ]
    return ", ".join(found) or "no time: nobody took part"
