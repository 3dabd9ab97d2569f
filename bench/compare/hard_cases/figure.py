"""Two joints with dry friction under a slow motor: angles over time, and how far each is off."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from hard_cases.cases import PROGRAMS

# Colours differ in lightness too, dashes differ: the figure survives a grey printer.
STYLES: dict[str, dict[str, Any]] = {
    "pendcore": {"color": "#000000", "linestyle": "-", "linewidth": 2.0},
    "scipy": {"color": "#8a8a8a", "linestyle": "-.", "linewidth": 1.4},
    "mujoco": {"color": "#d1495b", "linestyle": "--", "linewidth": 1.4},
    "odeint": {"color": "#6fa8d6", "linestyle": ":", "linewidth": 2.0},
}
LEAST = 1e-15  # an error of nothing is drawn here


def rests(reference: Any, joint: int) -> list[tuple[float, float]]:
    """When the joint sticks: from the start, and from each switch into it to the next out of it."""
    times = [0.0, *reference["switches"], reference["t"][-1]]
    modes = [0.0, *reference[f"mode_{joint}"]]
    return [
        (begin, end) for mode, begin, end in zip(modes, times, times[1:], strict=False) if mode == 0
    ]


def draw_angles(axes: Axes, case: Any) -> None:
    known = case["reference"]
    own = next((one for one in case["contenders"] if one["program"] == "pendcore"), None)
    for joint, style, shade in ((1, "-", "0.87"), (2, "--", "0.80")):
        curve = own["trace"].get(f"phi_{joint}") if own else None
        degrees = np.degrees(curve or known[f"phi_{joint}"])
        axes.plot(
            known["t"], degrees - (90 if joint == 1 else 0), color="k", linestyle=style,
            label=f"joint {joint}",
        )  # fmt: skip
        y = {1: 0.93, 2: 0.0}[joint]
        for begin, end in rests(known, joint):
            axes.axvspan(begin, end, y, y + 0.07, color=shade, linewidth=0)
    axes.set_ylabel("angle of the joint\n(from hanging) / deg")


def draw_errors(axes: Axes, case: Any) -> None:
    known = case["reference"]
    for one in case["contenders"]:
        if "error" not in one["trace"]:
            continue
        error = np.maximum(one["trace"]["error"], LEAST)
        axes.plot(
            known["t"], error, label=f"{PROGRAMS[one['program']]}: {one['how'].replace('`', '')}",
            **STYLES[one["program"]] | ({"linewidth": 0.8} if "hardest" in one["how"] else {}),
        )  # fmt: skip
    axes.set(yscale="log", ylim=(LEAST / 2, 1), ylabel="largest error of an angle / rad")
    axes.set_xlabel("t / s")


def draw(record: dict[str, Any], path: Path) -> None:
    (case,) = (case for case in record["cases"] if case["name"] == "two_joints")
    drawn, (angles, errors) = plt.subplots(
        2, 1, figsize=(8.6, 6.4), sharex=True, layout="constrained", height_ratios=(1, 1.1)
    )
    draw_angles(angles, case)
    draw_errors(errors, case)
    for axes in (angles, errors):
        axes.margins(x=0)
        axes.grid(color="0.9", linewidth=0.6)
        axes.set_axisbelow(True)
    angles.set_title(
        "Two rods with dry friction under a slow motor (grey: joint 1, above, or 2 sticks)",
        fontsize=11,
    )
    lines = [*angles.get_lines(), *errors.get_lines()]
    drawn.legend(handles=lines, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    drawn.savefig(path, dpi=160)
    plt.close(drawn)
