"""A rod that friction holds, and how far each program lets it creep in a million seconds."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from hard_cases.styles import STYLES, dress, label

LEAST = 1e-11  # rad: the end of the axis
WATCHED = 10.0  # s that MuJoCo is run; beyond, its last rate is continued


def break_axis(above: Axes, below: Axes) -> None:
    """Show that the logarithmic axis ends, because it has no zero."""
    above.spines["bottom"].set_visible(False)
    below.spines["top"].set_visible(False)
    above.tick_params(bottom=False, which="both")
    cut = {"marker": [(-1, -0.6), (1, 0.6)], "markersize": 9, "linestyle": "", "color": "k",
           "clip_on": False}  # fmt: skip
    above.plot([0, 1], [0, 0], transform=above.transAxes, **cut)
    below.plot([0, 1], [1, 1], transform=below.transAxes, **cut)


def drawn(case: Any) -> Figure:
    """Draw a curve for each contender with a trace, and the end for the others."""
    t = np.array(case["reference"]["t"])
    figure, (axes, zero) = plt.subplots(
        2, 1, figsize=(8.6, 5), sharex=True, layout="constrained", height_ratios=(1, 0.12)
    )
    for one in case["contenders"]:
        style = dict(STYLES[one["program"]])
        if "hardest" in one["how"]:
            style["linewidth"] = 0.8
        if "moved" in one["trace"]:
            moved = np.array(one["trace"]["moved"])
            (zero if not moved.any() else axes).plot(t, moved, label=label(one), **style)
        elif not one["own_loop"] and one["error"] is not None:
            style |= {"linestyle": "", "marker": "D", "markersize": 7}
            axes.plot(t[-1:], [one["error"]], label=f"{label(one)} (the end)", clip_on=False,
                      **style)  # fmt: skip
    axes.axvline(WATCHED, color="0.6", linewidth=0.8)
    axes.annotate(" from here on MuJoCo's rate, times the time", (WATCHED, 1e-10), fontsize=9)
    axes.set(yscale="log", ylim=(LEAST, 1e5), ylabel="moved / rad")
    zero.set(xscale="log", xlim=(t[0], t[-1]), ylim=(-1, 1), xlabel="t / s")
    zero.set_yticks([0], ["exactly 0"])
    break_axis(axes, zero)
    axes.set_title("A rod at 30 degrees, held by friction of twice what it takes", fontsize=11)
    dress(axes)
    lines = [*zero.get_lines(), *axes.get_lines()]
    figure.legend(
        handles=[line for line in lines if not str(line.get_label()).startswith("_")],
        loc="outside lower center", ncols=2, frameon=False, fontsize=9,
    )  # fmt: skip
    return figure
