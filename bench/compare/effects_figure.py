"""What each effect adds to a right-hand side of two links: bars, pendcore beside MuJoCo.

The right panel shows the instructions that it adds, for pendcore alone. A stroke across a bar's row
is the most that pendcore promises.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")

import matplotlib.pyplot as plt
from effects_page import PEER, STEP, added, effects_of, instructions_added, share
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

COLORS = {STEP: "#000000", PEER: "#6fa8d6"}
LABELS = {STEP: "pendcore, in a step", PEER: "MuJoCo, mj_forward"}
ROWS = {STEP: 0.2, PEER: -0.2}
BAR = 0.36
LEAST = 0.2  # ns; smaller values, and those lost in the noise, are drawn as this
LIMIT = "#d1495b"


def write(axes: Axes, x: float, y: float, text: str, color: str = "0") -> None:
    axes.text(x, y, f" {text}", fontsize=7, va="center", color=color)


def draw_limit(axes: Axes, most: float | None, place: float) -> None:
    if most is not None:
        axes.plot([most, most], [place - BAR / 2, place + BAR / 2], color=LIMIT)


def draw_times(axes: Axes, record: dict[str, Any], found: list[Any]) -> None:
    for place, effect in enumerate(found):
        for side, offset in ROWS.items():
            more, part = added(record, effect, side), share(record, effect, side)
            if more is None or part is None:
                write(axes, LEAST, place + offset, "not yet" if side == STEP else "has none", "0.5")
                continue
            length = max(more, LEAST)
            axes.barh(place + offset, length - LEAST, BAR, left=LEAST, color=COLORS[side])
            ends = max(length, (effect["most_ns"] or 0.0) if side == STEP else 0.0)
            text = f"{more:+.1f} ns ({part:+.0%})" if more > LEAST else "nothing seen"
            write(axes, ends, place + offset, text)
        if added(record, effect, STEP) is not None:
            draw_limit(axes, effect["most_ns"], place + ROWS[STEP])
    axes.set(xscale="log", xlim=(LEAST, 8000))
    axes.set_xlabel("added to a right-hand side / ns\n(in parentheses: of the side's bare scene)")


def draw_instructions(axes: Axes, record: dict[str, Any], found: list[Any]) -> None:
    for place, effect in enumerate(found):
        more = instructions_added(record, effect, "step")
        if more is None:
            write(axes, 0.0, place, "not counted" if effect["ours"] else "not yet", "0.5")
            continue
        axes.barh(place, max(more, 0.0), BAR, color=COLORS[STEP])
        write(axes, max(more, effect["most_instructions"] or 0, 0.0), place, f"{more:+.0f}")
        draw_limit(axes, effect["most_instructions"], place)
    axes.set_xlim(0, 1.2 * max(axes.get_xlim()[1], 200.0))
    axes.set_xlabel("added to a right-hand side\nin a step / instructions")
    axes.tick_params(left=False)


def draw(record: dict[str, Any], path: Path) -> None:
    """Draw into the file. Each bar ends with what is added and its share of the bare scene."""
    found = effects_of(record)[::-1]
    drawn, (times, instructions) = plt.subplots(
        1, 2, figsize=(11, 0.44 * len(found) + 1.7), width_ratios=(2.2, 1), sharey=True,
        layout="constrained",
    )  # fmt: skip
    draw_times(times, record, found)
    draw_instructions(instructions, record, found)
    times.set_yticks(range(len(found)), [effect["label"] for effect in found], fontsize=9)
    times.set_ylim(-0.6, len(found) - 0.4)
    for axes in (times, instructions):
        axes.grid(axis="x", which="major", color="0.85", linewidth=0.6)
        axes.set_axisbelow(True)
    drawn.suptitle("What an effect adds to the right-hand side of two links, C++", fontsize=11)
    known = [
        *(Patch(color=COLORS[side], label=LABELS[side]) for side in ROWS),
        Line2D([], [], color=LIMIT, label="promised: at most"),
    ]
    drawn.legend(handles=known, loc="outside lower right", ncols=3, frameon=False)
    drawn.text(
        0.01, 0.01, f"{record['machine']['processor']}, {record['date']}", fontsize=7, color="0.4"
    )
    drawn.savefig(path, dpi=160, bbox_inches="tight")
    plt.close(drawn)
