"""The record's figures as markdown tables."""

from __future__ import annotations

from typing import Any

from work_precision import Point, ratios_at, time_at

DECADES = [10.0**-k for k in range(2, 12)]
CORE, PYTHON = "pendcore_cpp", "pendcore_python"
CORE_PEERS = ("odeint",)
PYTHON_PEERS = ("cyrk_pysolve", "cyrk_nbsolve2", "scipy_numba", "scipy_python")
SHOWN_TOLERANCES = (1e-6, 1e-9)

KINDS = ("minimum_us", "median_us")

Record = dict[str, Any]


def entrants(record: Record) -> dict[str, Any]:
    return {contender["name"]: contender for contender in record["contenders"]}


def curve(contender: Any, kind: str = "minimum_us") -> list[Point]:
    """List (error, microseconds) of every tolerance that succeeded."""
    return [(p["error"], p[kind]) for p in contender["points"] if "failure" not in p]


def number(value: float | None, digits: int = 3) -> str:
    """Write with so many digits and no power of ten; an em dash where there is nothing."""
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


def worst(ratios: dict[float, float | None]) -> tuple[float, float] | None:
    """Find (ratio, error) where pendcore does worst."""
    known = [(ratio, error) for error, ratio in ratios.items() if ratio is not None]
    return max(known, default=None)


def equal_error(record: Record, own: str, peers: tuple[str, ...]) -> str:
    """Tabulate times and their ratios at each decade of achieved error; the worst ratio last.

    Ratios are of minima, and of medians in parentheses.
    """
    known = entrants(record)
    present = [known[peer] for peer in peers if peer in known]
    if own not in known or not present:
        return "Not measured: one of the two sides was not installed.\n"
    ours = {kind: curve(known[own], kind) for kind in KINDS}
    header = ["achieved error", known[own]["label"]]
    rows = [[power(error), number(time_at(ours["minimum_us"], error))] for error in DECADES]
    last = ["worst ratio", ""]
    for peer in present:
        header += [peer["label"], "ratio"]
        ratios = [ratios_at(ours[kind], curve(peer, kind), DECADES) for kind in KINDS]
        for row, error in zip(rows, DECADES, strict=True):
            row.append(number(time_at(curve(peer), error)))
            row.append(pair(*(by_kind[error] for by_kind in ratios)))
        poorest = [worst(by_kind) for by_kind in ratios]
        last += ["", pair(*(found[0] if found else None for found in poorest))]
    return table(header, [*rows, last])


def at_tolerance(contender: Any, tolerance: float) -> dict[str, Any]:
    """Pick the contender's point at rtol = atol = tolerance; empty where there is none."""
    for point in contender["points"]:
        if abs(point["tolerance"] / tolerance - 1) < 1e-9 and "failure" not in point:
            return dict(point)
    return {}


def per_evaluation(point: dict[str, Any]) -> float | None:
    """Share the whole call out: nanoseconds a right-hand side."""
    evaluations = point.get("evaluations")
    return 1e3 * point["minimum_us"] / evaluations if evaluations else None


def equal_tolerance(record: Record, tolerance: float) -> str:
    """Tabulate every contender at the same tolerance."""
    header = ["contender", "error", "at the end", "of energy", "right-hand sides"]
    header += ["us", "median us", "ns a right-hand side"]
    rows = []
    for contender in record["contenders"]:
        point = at_tolerance(contender, tolerance)
        errors = [point.get(kind) for kind in ("error", "end_error", "energy_error")]
        rows.append(
            [contender["label"]]
            + ["failed" if error is None else f"{error:.1e}" for error in errors]
            + [str(point.get("evaluations") or "—")]
            + [number(point.get(kind)) for kind in KINDS]
            + [number(per_evaluation(point))]
        )
    return table(header, rows)


def fixed_cost(record: Record) -> str:
    """Tabulate calls whose interval one step covers."""
    rows = []
    for contender in record["contenders"]:
        call = contender["one_step"]
        times = [number(call[kind]) for kind in KINDS]
        rows.append([contender["label"], str(call["evaluations"] or "—"), *times])
    return table(["contender", "right-hand sides", "us", "median us"], rows)
