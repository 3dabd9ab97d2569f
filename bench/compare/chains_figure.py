"""Time and memory of a right-hand side against the number of links, all axes logarithmic."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from chains_page import CORE, PEERS, points
from matplotlib.axes import Axes

# Dashes and markers differ as well as colours: the figure survives a grey printer.
STYLES: dict[str, dict[str, Any]] = {
    CORE: {"color": "#000000", "linestyle": "-", "marker": "o", "linewidth": 2.2},
    "pendcore_step": {"color": "#777777", "linestyle": ":", "marker": ".", "linewidth": 1.4},
    "pinocchio": {"color": "#d1495b", "linestyle": "--", "marker": "^"},
    "mujoco": {"color": "#0b5fa5", "linestyle": "-.", "marker": "s"},
}
NANOSECONDS, BYTES = "minimum_ns", "bytes"

Curve = list[tuple[int, float]]


def least(record: dict[str, Any], start: str, kind: str) -> Curve:
    """List (n, the least value of the contenders whose names begin with `start`)."""
    best: dict[int, float] = {}
    for one in record["contenders"]:
        if one["name"] != start and (start not in PEERS or not one["name"].startswith(start)):
            continue
        for n, point in points(one).items():
            if point.get(kind):
                best[n] = min(best.get(n, float("inf")), point[kind])
    return sorted(best.items())


def draw_guide(axes: Axes, curve: Curve) -> None:
    """Draw a line of growth in proportion to n, through the curve's last point."""
    (n, value), (first, _) = curve[-1], curve[0]
    axes.plot([first, n], [value * first / n, value], color="0.6", linewidth=0.8, zorder=0)
    middle = (first * n) ** 0.5
    axes.annotate(
        "proportional to n",
        (middle, value * middle / n),
        xytext=(8, -12),
        textcoords="offset points",
        color="0.45",
        fontsize=8,
    )


def draw_kind(axes: Axes, record: dict[str, Any], kind: str, labels: dict[str, str]) -> None:
    for start, label in labels.items():
        curve = least(record, start, kind)
        if curve:
            axes.plot(*zip(*curve, strict=True), label=label, markersize=5, **STYLES[start])
            if start == CORE:
                draw_guide(axes, curve)
    if axes.lines:
        axes.set(xscale="log", yscale="log")
    axes.set_xlabel("number of links n")
    axes.grid(which="major", color="0.85", linewidth=0.6)


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw into the file. For a peer with several entries, draw the best of them at each n."""
    drawn, (time, memory) = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
    labels = {
        CORE: "pendcore",
        **{start: f"{name}, the best of its ways" for start, name in PEERS.items()},
    }
    in_step = {"pendcore_step": "pendcore, in a step of dopri5"}
    draw_kind(time, record, NANOSECONDS, labels | in_step)
    draw_kind(memory, record, BYTES, labels)
    if time.lines:
        time.legend(loc="upper left", frameon=False, fontsize=9)
    time.set_ylabel("time of a right-hand side / ns")
    memory.set_ylabel("memory of its equations / bytes")
    drawn.suptitle("Forward dynamics of a planar chain of n links, C++", fontsize=11)
    drawn.text(
        0.01, -0.03, f"{record['machine']['processor']}, {record['date']}", fontsize=7, color="0.4"
    )
    drawn.savefig(path, dpi=160, bbox_inches="tight")
    plt.close(drawn)
