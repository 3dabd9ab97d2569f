"""Two joints with dry friction under a slow motor: angles over time, and how far each is off."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hard_cases.styles import STYLES, dress, label

LEAST = 1e-15  # an error of zero is drawn here


def rests(reference: Any, joint: int) -> list[tuple[float, float]]:
    """List when the joint sticks: from the start or a switch into stick, to the next out of it."""
    times = [0.0, *reference["switches"], reference["t"][-1]]
    modes = [0.0, *reference[f"mode_{joint}"]]
    return [
        (begin, end) for mode, begin, end in zip(modes, times, times[1:], strict=False) if mode == 0
    ]


def draw_angles(axes: Axes, case: Any) -> None:
    known = case["reference"]
    own = next((one for one in case["contenders"] if one["program"] == "pendcore"), None)
    for joint, style in ((1, "-"), (2, "--")):
        name = f"phi_{joint}"
        curve = own["trace"].get(name, known[name]) if own else known[name]
        from_hanging = np.degrees(curve) - (90 if joint == 1 else 0)
        axes.plot(known["t"], from_hanging, color="k", linestyle=style, label=f"joint {joint}")
    axes.set(ylabel="angle, from hanging / deg", ylim=(-42, 42))
    axes.legend(loc="upper left", frameon=False, fontsize=9)


def draw_rests(axes: Axes, case: Any) -> None:
    for joint in (1, 2):
        spans = [(begin, end - begin) for begin, end in rests(case["reference"], joint)]
        axes.broken_barh(spans, (-joint - 0.35, 0.7), color="0.55")
    axes.set_yticks([-1, -2], ["joint 1 sticks", "joint 2 sticks"])
    axes.set_ylim(-2.6, -0.4)
    axes.tick_params(left=False)


def draw_errors(axes: Axes, case: Any) -> None:
    known = case["reference"]
    for one in case["contenders"]:
        if "error" not in one["trace"]:
            continue
        error = np.maximum(one["trace"]["error"], LEAST)
        axes.plot(
            known["t"], error, label=label(one),
            **STYLES[one["program"]] | ({"linewidth": 0.8} if "hardest" in one["how"] else {}),
        )  # fmt: skip
    axes.set(yscale="log", ylim=(LEAST / 2, 1), ylabel="largest error of an angle / rad")
    axes.set_xlabel("t / s")


def drawn(case: Any) -> Figure:
    figure, (angles, sticks, errors) = plt.subplots(
        3, 1, figsize=(8.6, 7), sharex=True, layout="constrained", height_ratios=(1, 0.2, 1.1)
    )
    draw_angles(angles, case)
    draw_rests(sticks, case)
    draw_errors(errors, case)
    for axes in (angles, sticks, errors):
        axes.margins(x=0)
        dress(axes)
    angles.set_title("Two rods with dry friction in both joints under a slow motor", fontsize=11)
    lines = errors.get_lines()
    figure.legend(handles=lines, loc="outside lower center", ncols=2, frameon=False, fontsize=9)
    return figure
