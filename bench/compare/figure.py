"""The work-precision diagram: achieved error across, time up; and best against best below it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from contenders.contender import COMPILED, PYTHON
from equal_error import SIDES, Comparison, Contender, Record, bar, compare, curve
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter
from tables import short
from work_precision import envelope

# Dashes and lightness distinguish the families of solvers, markers the methods, so that the figure
# survives a grey printer.
FAMILIES: dict[str, dict[str, Any]] = {
    "pendcore": {"color": "#000000", "linestyle": "-", "linewidth": 2.2},
    "heyoka": {"color": "#d1495b", "linestyle": (0, (6, 2)), "linewidth": 1.8},
    "odeint": {"color": "#14506b", "linestyle": (0, (4, 1.5)), "linewidth": 1.3},
    "arkode": {"color": "#9a6fb8", "linestyle": "-.", "linewidth": 1.3},
    "cvode": {"color": "#cf8fb4", "linestyle": ":", "linewidth": 1.6},
    "cyrk_nbsolve2": {"color": "#14506b", "linestyle": (0, (4, 1.5)), "linewidth": 1.3},
    "cyrk_pysolve": {"color": "#9a6fb8", "linestyle": "-.", "linewidth": 1.3},
    "scipy": {"color": "#8c8c8c", "linestyle": ":", "linewidth": 1.6},
}
MARKERS = {
    "dopri5": "o",
    "rk45": "o",
    "dop853": "s",
    "rkf78": "s",
    "taylor": "*",
    "heyoka": "*",
    "rk4": "^",
    "dopri5-radau5": "^",
    "dop853-radau5": "<",
    "taylor-radau5": ">",
    "verner6": "p",
    "vern7": "p",
    "radau5": "D",
    "radau": "D",
    "bdf": "v",
    "adams": "P",
    "lsoda": "X",
}
LEFT_OUT = ("scipy", "python")  # close to what numba makes of them; the tables have them
ERRORS = np.logspace(-1, -13.5, 126)


def style(name: str) -> dict[str, Any]:
    family = next((one for one in FAMILIES if name.startswith(one)), "scipy")
    words = name.split("_")
    marker = next((MARKERS[word] for word in words if word in MARKERS), "h")
    return {**FAMILIES[family], "marker": marker}


def marked(contender: Contender, reached: list[Any]) -> list[Any]:
    """Choose the settings that get a marker: whole decades of tolerance, or every third."""
    if contender["setting"] != "tolerance" or contender["name"] == "heyoka":
        return reached[::3]
    return [point for point in reached if f"{point['setting']:.6e}".startswith("1.000000")]


def draw_contender(axes: Axes, contender: Contender, *, by_language: bool = False) -> None:
    """Draw the contender's unbeaten points as a line, and some of its settings as markers.

    `by_language`: C++ and Python of pendcore share the axes; the second is then dashed.
    """
    reached = [point for point in contender["points"] if "failure" not in point]
    if not reached:
        return
    how = style(contender["name"])
    if by_language and contender["ours"] and PYTHON in contender["sides"]:
        how |= {"linestyle": (0, (5, 1)), "color": "#5c5c5c", "linewidth": 1.6}
    dots = {"linestyle": "", "color": how["color"], "markersize": 5 if how["marker"] != "*" else 8}
    axes.plot(*zip(*envelope(curve(contender)), strict=True), **how | {"marker": ""})
    shown = marked(contender, reached)
    across, up = ([point[key] for point in shown] for key in ("error", "minimum_us"))
    axes.plot(across, up, marker=how["marker"], **dots)
    if "failure" in contender["points"][-1]:
        last = envelope(curve(contender))[-1]
        axes.plot(*last, marker="x", **dots | {"markersize": 9, "markeredgewidth": 1.6})
    axes.plot(
        [],
        [],
        label=contender["label"] if by_language else short(contender["label"]),
        markersize=dots["markersize"],
        **how,
    )


def draw_ratios(axes: Axes, found: list[Comparison], label: str, dashes: Any) -> None:
    known = [(at.error, at.ratio) for at in found if at.ratio is not None]
    if not known:
        return
    errors, ratios = map(np.array, zip(*known, strict=True))
    axes.plot(errors, ratios, color="black", linestyle=dashes, linewidth=1.8, label=label)
    if dashes == "-":
        axes.fill_between(errors, ratios, 1.0, where=ratios > 1.0, color="0.75", interpolate=True)


def draw_lower(axes: Axes, record: Record, side: str) -> None:
    """Draw the time of pendcore's best method as a share of the best peer's time, and the goals."""
    listed = [one for one in SIDES if one.peers == side]
    for one, dashes in zip(listed, ("-", (0, (2, 1.5))), strict=False):
        label = "pendcore / best peer" if one.ours == side else "with x86-64-v3"
        draw_ratios(axes, compare(record, one, ERRORS), label, dashes)
    axes.axhline(1.0, color="0.5", linewidth=0.8)
    goals = [bar(listed[0], error) for error in ERRORS]
    axes.plot(ERRORS, goals, color="#d1495b", linewidth=1.2, linestyle="--", label="goal")
    axes.set(yscale="log", ylim=(0.1, 4.0))
    axes.yaxis.set_major_locator(FixedLocator([0.1, 0.2, 0.5, 1, 2]))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    note: dict[str, Any] = {
        "fontsize": 7,
        "color": "0.35",
        "transform": axes.transAxes,
        "va": "top",
    }
    axes.text(0.012, 0.97, "above 1: the peer is quicker", **note)
    axes.legend(loc="lower left", fontsize=7, frameon=False, ncols=3)


def most_accurate(record: Record) -> float:
    """Find the smallest error that any contender achieved, but not below 6e-16."""
    errors = [p["error"] for one in record["contenders"] for p in one["points"] if "error" in p]
    return max(6e-16, min(errors, default=6e-16))


def cost(contender: Contender) -> float:
    """Return the time at a middling setting that succeeded; it orders the contenders."""
    times = [point["minimum_us"] for point in contender["points"] if "minimum_us" in point]
    return float(times[len(times) // 2]) if times else 0.0


def draw(record: Record, path: Path) -> None:
    """Draw into the file, the slowest first, so that legend and lines have the same order."""
    drawn, panels = plt.subplots(
        2,
        2,
        figsize=(12.0, 9.6),
        sharex=True,
        sharey="row",
        height_ratios=(3, 1),
        layout="constrained",
    )
    columns = ((COMPILED, "C++ and compiled code"), (PYTHON, "called from Python"))
    for (side, title), upper, lower in zip(columns, *panels, strict=True):
        present = [one for one in record["contenders"] if side in one["sides"]]
        shown = [one for one in present if not all(word in one["name"] for word in LEFT_OUT)]
        for contender in sorted(shown, key=cost, reverse=True):
            draw_contender(upper, contender)
        upper.set(xscale="log", yscale="log", xlim=(1.0, most_accurate(record) / 3))
        upper.set_title(title, fontsize=10, pad=8)
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.02), "ncols": 3}
        if upper.lines:
            upper.legend(**below, fontsize=7.5, frameon=False, handlelength=3.4)
        draw_lower(lower, record, side)
        lower.set_xlabel("largest position error / total length (more accurate to the right)")
        for axes in (upper, lower):
            axes.grid(which="major", color="0.88", linewidth=0.6)
            axes.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
            axes.xaxis.set_minor_formatter(NullFormatter())
    panels[0][0].set_ylabel("time of a solve / \N{MICRO SIGN}s")
    panels[1][0].set_ylabel("share of the best peer's time")
    drawn.suptitle(
        f"What accuracy costs: {record['case']}, {record['duration']:g} s, {record['times']} times",
        fontsize=12,
    )
    facts = f"{record['machine']['processor']}, {record['date']}; a cross: no tighter setting ran"
    drawn.text(0.01, -0.02, facts, fontsize=7, color="0.4")
    drawn.savefig(path, dpi=150, bbox_inches="tight")
    plt.close(drawn)
