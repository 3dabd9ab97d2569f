"""Bounces that accumulate: their height over the time left until the last of them."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from hard_cases.styles import STYLES, dress, label

LEAST = 1e-16  # rad: a figure of logarithms has no zero


def drawn(case: Any) -> Figure:
    """Draw the angles of each program, except SciPy's second way, which gives the same curve."""
    left = np.array(case["reference"]["before"])
    figure, (plain, logarithmic) = plt.subplots(
        2, 1, figsize=(8.6, 7), layout="constrained", height_ratios=(0.8, 1.2)
    )
    for one in case["contenders"]:
        if "q" not in one["trace"] or "same" in one["how"]:
            continue
        q = np.array(one["trace"]["q"])
        style = dict(STYLES[one["program"]])
        if one["program"] == "scipy":  # beneath the others, because it coincides with pendcore
            style |= {"linestyle": "-", "linewidth": 5.0, "color": "0.8", "zorder": 1}
        if "0.1 ms" in one["how"] or one["program"] == "pendcore":
            style["linewidth"] = 0.9
        plain.plot(left[0] - left, q, **style)
        logarithmic.plot(left, np.where(q > LEAST, q, np.nan), label=label(one), **style)
    plain.set(xlabel="t / s", ylabel="angle off the stop / rad", ylim=(-0.03, 0.42))
    logarithmic.set(
        xscale="log", yscale="log", xlim=(left[0], left[-1]), ylim=(LEAST, 1),
        xlabel="time left until infinitely many bounces are over / s",
        ylabel="angle off the stop / rad",
    )  # fmt: skip
    for axes in (plain, logarithmic):
        dress(axes)
    plain.margins(x=0)
    plain.set_title("A rod pressed against a stop, restitution 0.8", fontsize=11)
    figure.legend(
        handles=logarithmic.get_lines(), loc="outside lower center", ncols=2, frameon=False,
        fontsize=9,
    )  # fmt: skip
    return figure
