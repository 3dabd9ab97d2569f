"""A rod that friction holds: how far each program lets it creep in a million seconds."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from hard_cases.styles import STYLES, dress, label

NOTHING = 1e-17  # rad: where exactly nothing is drawn
WATCHED = 10.0  # s of MuJoCo's; from there its rate goes on


def drawn(case: Any) -> Figure:
    """Draw what has a trace as a curve; of the others there is the end."""
    t = np.array(case["reference"]["t"])
    figure, axes = plt.subplots(figsize=(8.6, 5), layout="constrained")
    for one in case["contenders"]:
        style = dict(STYLES[one["program"]])
        if "hardest" in one["how"]:
            style["linewidth"] = 0.8
        if "moved" in one["trace"]:
            moved = np.maximum(one["trace"]["moved"], NOTHING)
            axes.plot(t, moved, label=label(one), **style)
        elif not one["own_loop"] and one["error"] is not None:
            style |= {"linestyle": "", "marker": "D", "markersize": 7}
            axes.plot(t[-1:], [one["error"]], label=f"{label(one)} (the end)", clip_on=False,
                      **style)  # fmt: skip
    axes.axvline(WATCHED, color="0.6", linewidth=0.8)
    axes.annotate(" from here on MuJoCo's rate, times the time", (WATCHED, 1e-14), fontsize=9)
    axes.annotate("exactly nothing", (t[0] * 1.3, NOTHING * 2), fontsize=9)
    axes.set(
        xscale="log", yscale="log", xlim=(t[0], t[-1]), ylim=(NOTHING / 2, 1e5), xlabel="t / s",
        ylabel="moved / rad",
    )  # fmt: skip
    axes.set_title("A rod at 30 degrees, held by friction of twice what it takes", fontsize=11)
    dress(axes)
    figure.legend(
        handles=[line for line in axes.get_lines() if not line.get_label().startswith("_")],
        loc="outside lower center", ncols=2, frameon=False, fontsize=9,
    )  # fmt: skip
    return figure
