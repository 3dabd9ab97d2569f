"""The work-precision diagram: achieved error across, microseconds up, a line a contender."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from matplotlib.axes import Axes
from matplotlib.ticker import LogLocator, NullFormatter
from tables import curve
from work_precision import envelope

# Colours differ in lightness too, dashes and markers differ: the figure survives a grey printer.
STYLES: dict[str, dict[str, Any]] = {
    "pendcore_cpp": {"color": "#000000", "linestyle": "-", "marker": "o", "linewidth": 2.2},
    "pendcore_python": {"color": "#0b5fa5", "linestyle": "-", "marker": "s", "linewidth": 2.2},
    "odeint": {"color": "#d1495b", "linestyle": "--", "marker": "^", "linewidth": 1.4},
    "cyrk_nbsolve2": {"color": "#6f4a8e", "linestyle": "-.", "marker": "D", "linewidth": 1.4},
    "cyrk_pysolve": {"color": "#a68bc2", "linestyle": "-.", "marker": "v", "linewidth": 1.4},
    "scipy_numba": {"color": "#5a5a5a", "linestyle": ":", "marker": "P", "linewidth": 1.4},
    "scipy_python": {"color": "#9a9a9a", "linestyle": ":", "marker": "X", "linewidth": 1.4},
}
OTHERS = {"linestyle": (0, (5, 1, 1, 1, 1, 1)), "marker": "*", "linewidth": 1.4}


def is_decade(tolerance: float) -> bool:
    return f"{tolerance:.6e}".startswith("1.000000")


def draw_contender(axes: Axes, contender: Any) -> None:
    """Draw the contender's unbeaten points as a line, its decades of tolerance as markers."""
    reached = [point for point in contender["points"] if "failure" not in point]
    if not reached:
        return
    style = STYLES.get(contender["name"], OTHERS)
    line = axes.plot(*zip(*envelope(curve(contender)), strict=True), **style | {"marker": ""})[0]
    decades = [point for point in reached if is_decade(point["tolerance"])]
    axes.plot(
        [point["error"] for point in decades],
        [point["minimum_us"] for point in decades],
        color=line.get_color(),
        marker=style["marker"],
        markersize=5,
        linestyle="",
    )
    axes.plot([], [], label=contender["label"], **style)


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw into the file; dearest first, so that the legend reads as the lines lie."""
    drawn, axes = plt.subplots(figsize=(8.6, 5.2), layout="constrained")
    by_cost = sorted(record["contenders"], key=lambda c: -c["points"][0].get("minimum_us", 0.0))
    for contender in by_cost:
        draw_contender(axes, contender)
    axes.set(xscale="log", yscale="log", ylabel="time of a solve / \N{MICRO SIGN}s")
    axes.set_xlabel("largest position error / total length (more accurate to the right)")
    axes.invert_xaxis()
    axes.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
    axes.xaxis.set_minor_formatter(NullFormatter())
    axes.grid(which="major", color="0.85", linewidth=0.6)
    axes.set_title(
        f"Dormand-Prince 5(4) on the case {record['case']!r}, a marker a decade of tolerance",
        fontsize=11,
    )
    drawn.legend(loc="outside right center", frameon=False)
    drawn.text(
        0.01, -0.03, f"{record['machine']['processor']}, {record['date']}", fontsize=7, color="0.4"
    )
    drawn.savefig(path, dpi=160, bbox_inches="tight")
    plt.close(drawn)
