"""A mark passed just before and after a turn: each program's steps and the passages it found."""

from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

from hard_cases.styles import STYLES, dress, label
from hard_cases.two_roots import AMPLITUDE, MARK, SHOWN, G

CLOSE = 6.0  # ms; the upper panel shows so little that the passages can be told apart


def drawn(case: Any) -> Figure:
    """Draw the swing about the mark, and a row of steps and passages for each program."""
    contenders = [one for one in case["contenders"] if "found" in one["trace"]]
    figure, (swing, rows) = plt.subplots(
        2, 1, figsize=(8.6, 8.4), layout="constrained", height_ratios=(0.6, 1.6)
    )
    ms = np.linspace(-CLOSE, CLOSE, 201)
    # So close to the turn the swing is as good as a parabola.
    fall = 0.75 * G * np.sin(AMPLITUDE) * (1e-3 * ms) ** 2
    swing.plot(ms, 1e6 * (AMPLITUDE - MARK - fall), "k")
    swing.axhline(0.0, color="0.5", linestyle="--", linewidth=1.0)
    swing.annotate("the mark", (-CLOSE, 6), fontsize=9, xytext=(4, 0), textcoords="offset points")
    swing.set(xlabel="time from the tenth turn / ms", ylabel="angle past the mark / µrad")
    swing.set_title("A swing that passes a mark 1.3 ms before and after it turns", fontsize=11)
    for row, one in enumerate(contenders):
        steps, found = one["trace"]["steps"], one["trace"]["found"]
        color = STYLES[one["program"]]["color"]
        rows.axhline(-row, color="0.85", linewidth=0.8)
        rows.plot(steps, np.full(len(steps), -row), "|", color="0.45", markersize=8)
        rows.plot(found, np.full(len(found), -row), "o", color=color, markersize=6)
        count = f"{len(found)} found"
        count += ", steps not told" if one["program"] == "odeint" else ""
        rows.annotate(
            f"{label(one)}: {count}", (-SHOWN, -row), xytext=(4, 8), textcoords="offset points",
            fontsize=8, va="center",
        )  # fmt: skip
    rows.set(
        xlim=(-SHOWN, SHOWN), ylim=(-len(contenders) + 0.4, 0.7), yticks=[],
        xlabel="time from the tenth turn / ms; strokes: ends of steps, dots: passages found",
    )  # fmt: skip
    for axes in (swing, rows):
        dress(axes)
    swing.margins(x=0)
    return figure
