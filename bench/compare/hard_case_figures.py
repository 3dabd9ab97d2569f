"""The figures of the hard cases, drawn from the record alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from figures import save
from hard_case_tables import PROGRAMS
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from pendcore.plotting import LIGHT, grid, new_axes
from record import Point, Record

# Colours differ in lightness, and dashes differ, so that the figures survive a grey printer.
STYLES: dict[str, dict[str, Any]] = {
    "pendcore": {"color": LIGHT.ink, "linestyle": "-", "linewidth": 2.0},
    "scipy": {"color": LIGHT.quiet, "linestyle": "-.", "linewidth": 1.4},
    "mujoco": {"color": LIGHT.red, "linestyle": "--", "linewidth": 1.4},
    "odeint": {"color": LIGHT.teal, "linestyle": ":", "linewidth": 2.0},
}
Line = tuple[Point, str, dict[str, Any]]
"""A row, its name in a legend, and its style."""


def lines_of(record: Record, case: str) -> list[Line]:
    """List the rows of all programs; the hardest constraint of MuJoCo has a thin line."""
    found = []
    for program, name in PROGRAMS.items():
        for row in record.points(program, case):
            thin = {"linewidth": 0.8} if "hardest" in row["setting"] else {}
            label = f"{name}: {row['setting'].replace('`', '')}"
            found.append((row, label, {**STYLES[program], **thin}))
    return found


def sheet(*heights: float, tall: float, sharex: bool = False) -> tuple[Figure, list[Axes]]:
    axes = new_axes((8.6, tall), len(heights), height_ratios=heights, sharex=sharex)
    for each in axes:
        grid(each)
    return axes[0].get_figure(), axes


def legend(figure: Figure, lines: list[Any]) -> None:
    named = [line for line in lines if not str(line.get_label()).startswith("_")]
    figure.legend(handles=named, loc="outside lower center", ncols=2)


def held_rod(record: Record, case: str) -> Figure:
    """Draw how far the rod creeps: a curve for each row with a trace, and the end for others.

    The logarithmic axis has no zero: it ends in a cut, below which is "exactly 0".
    """
    t = np.array(record.cases[case]["reference"]["t"])
    figure, (axes, zero) = sheet(1, 0.12, tall=5, sharex=True)
    zero.grid(visible=False)
    for row, label, style in lines_of(record, case):
        if "trace" in row:
            moved = np.array(row["trace"]["moved"])
            (axes if moved.any() else zero).plot(t, moved, label=label, **style)
        elif not row["own_loop"] and "error" in row:
            dot = {"linestyle": "", "marker": "D", "markersize": 7, "clip_on": False}
            axes.plot(t[-1:], [row["error"]], label=f"{label} (the end)", **style | dot)
    watched = 10.0  # s that MuJoCo is run
    axes.axvline(watched, color=LIGHT.quiet, linewidth=0.8)
    axes.annotate(" from here on MuJoCo's rate, times the time", (watched, 1e-10), fontsize=9)
    axes.set(yscale="log", ylim=(1e-11, 1e5), ylabel="moved (rad)")
    axes.set_title("A rod at 30 degrees, held by friction of twice what it takes")
    zero.set(xscale="log", xlim=(t[0], t[-1]), ylim=(-1, 1), xlabel="t (s)")
    zero.set_yticks([0], ["exactly 0"])
    cut: dict[str, Any] = {"marker": [(-1, -0.6), (1, 0.6)], "markersize": 9, "linestyle": ""}
    for each, spine, y in ((axes, "bottom", 0), (zero, "top", 1)):
        each.spines[spine].set_visible(False)
        each.plot([0, 1], [y, y], transform=each.transAxes, color=LIGHT.ink, clip_on=False, **cut)
    axes.tick_params(bottom=False, which="both")
    legend(figure, [*zero.get_lines(), *axes.get_lines()])
    return figure


def two_joints(record: Record, case: str) -> Figure:
    """Draw the angles, when each joint sticks, and how far each program is off."""
    known = record.cases[case]["reference"]
    figure, (angles, sticks, errors) = sheet(1, 0.2, 1.1, tall=7, sharex=True)
    own: Any = next(iter(record.points("pendcore", case)), {}).get("trace", known)
    for joint, dashes in ((1, "-"), (2, "--")):
        from_hanging = np.degrees(own[f"phi_{joint}"]) - (90 if joint == 1 else 0)
        how: dict[str, Any] = {"color": LIGHT.ink, "linestyle": dashes}
        angles.plot(known["t"], from_hanging, label=f"joint {joint}", **how)
        times = [0.0, *known["switches"], known["t"][-1]]
        modes = [0.0, *known[f"mode_{joint}"]]  # from the start or a switch to the next
        rests = [
            (begin, end - begin)
            for mode, begin, end in zip(modes, times, times[1:], strict=False)
            if mode == 0
        ]
        sticks.broken_barh(rests, (-joint - 0.35, 0.7), color=LIGHT.lost)
    angles.set(ylabel="angle, from hanging (deg)", ylim=(-42, 42))
    angles.legend(loc="upper left")
    angles.set_title("Two rods with dry friction in both joints under a slow motor")
    sticks.set_yticks([-1, -2], ["joint 1 sticks", "joint 2 sticks"])
    sticks.set_ylim(-2.6, -0.4)
    sticks.tick_params(left=False)
    least = 1e-15  # an error of zero is drawn here
    for row, label, style in lines_of(record, case):
        if "trace" in row:
            error = np.maximum(row["trace"]["error"], least)
            errors.plot(known["t"], error, label=label, **style)
    errors.set(yscale="log", ylim=(least / 2, 1), ylabel="largest error of an angle (rad)")
    errors.set_xlabel("t (s)")
    for axes in (angles, sticks, errors):
        axes.margins(x=0)
    legend(figure, list(errors.get_lines()))
    return figure


def bounces(record: Record, case: str) -> Figure:
    """Draw heights over the time left, but not SciPy's second way, which gives the same curve."""
    left = np.array(record.cases[case]["reference"]["before"])
    figure, (plain, logarithmic) = sheet(0.8, 1.2, tall=7)
    least = 1e-16  # rad: a figure of logarithms has no zero
    for row, label, style in lines_of(record, case):
        if "trace" not in row or "same" in row["setting"]:
            continue
        q = np.array(row["trace"]["q"])
        if label.startswith("SciPy"):  # beneath the others, because it coincides with pendcore
            style |= {"linestyle": "-", "linewidth": 5.0, "color": LIGHT.line, "zorder": 1}
        if "0.1 ms" in label or label.startswith("pendcore"):
            style["linewidth"] = 0.9
        plain.plot(left[0] - left, q, **style)
        logarithmic.plot(left, np.where(q > least, q, np.nan), label=label, **style)
    plain.set(xlabel="t (s)", ylabel="angle off the stop (rad)", ylim=(-0.03, 0.42))
    plain.margins(x=0)
    plain.set_title("A rod pressed against a stop, restitution 0.8")
    logarithmic.set(xscale="log", yscale="log", xlim=(left[0], left[-1]), ylim=(least, 1))
    logarithmic.set_xlabel("time left until infinitely many bounces are over (s)")
    logarithmic.set_ylabel("angle off the stop (rad)")
    legend(figure, list(logarithmic.get_lines()))
    return figure


def two_roots(record: Record, case: str) -> Figure:
    """Draw the swing about the mark, and a row of steps and passages for each program."""
    known = record.cases[case]["reference"]
    lines = [line for line in lines_of(record, case) if "trace" in line[0]]
    figure, (swing, rows) = sheet(0.6, 1.6, tall=8.4)
    close, shown = 6.0, 25.0  # ms about the turn; in the upper panel the passages can be told apart
    ms = np.linspace(-close, close, 201)
    (amplitude,), (mark,), (gravity,) = (known[key] for key in ("amplitude", "mark", "gravity"))
    # So close to the turn the swing is as good as a parabola.
    fall = 0.75 * gravity * np.sin(amplitude) * (1e-3 * ms) ** 2
    swing.plot(ms, 1e6 * (amplitude - mark - fall), color=LIGHT.ink)
    swing.axhline(0.0, color=LIGHT.quiet, linestyle="--", linewidth=1.0)
    words: dict[str, Any] = {"textcoords": "offset points"}
    swing.annotate("the mark", (-close, 6), (4, 0), fontsize=9, **words)
    swing.set(xlabel="time from the tenth turn (ms)", ylabel="angle past the mark (µrad)")
    swing.margins(x=0)
    swing.set_title("A swing that passes a mark 1.3 ms before and after it turns")
    for row, (one, label, style) in enumerate(lines):
        steps, found = one["trace"]["steps"], one["trace"]["found"]
        rows.axhline(-row, color=LIGHT.line, linewidth=0.8)
        rows.plot(steps, np.full(len(steps), -row), "|", color=LIGHT.quiet, markersize=8)
        rows.plot(found, np.full(len(found), -row), "o", color=style["color"], markersize=6)
        untold = ", steps not told" if label.startswith("Boost") else ""
        text = f"{label}: {len(found)} found{untold}"
        rows.annotate(text, (-shown, -row), (4, 12), fontsize=8, va="center", **words)
    rows.set(xlim=(-shown, shown), ylim=(-len(lines) + 0.4, 0.7), yticks=[])
    rows.grid(visible=False)
    rows.set_xlabel("time from the tenth turn (ms). Strokes: ends of steps; dots: passages found")
    return figure


FIGURES = {
    "held_rod": held_rod,
    "two_joints": two_joints,
    "bounces": bounces,
    "two_roots": two_roots,
}


def draw(record: Record, path: Path) -> None:
    """Draw the figures of the cases that the record has, into the folder of all figures."""
    folder = path.parents[1] / "figures"
    for name in record.cases:
        if name in FIGURES:
            save(FIGURES[name](record, name), folder / f"hard_cases_{name}.png", 160)
