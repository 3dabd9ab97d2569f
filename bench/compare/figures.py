"""The figures of solves, drawn from the record alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from contenders.contender import COMPILED, COMPILED_V3, PYTHON
from equal_error import SIDES, Contender, Entrants, bar, compare, curve, envelope
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter
from record import Record
from solve_tables import solves_of
from tables import short

# Dashes and lightness distinguish the families of solvers, markers the methods, so that the figures
# survive a grey printer.
FAMILIES: dict[str, tuple[str, Any, float]] = {
    "pendcore": ("#000000", "-", 2.2),
    "heyoka": ("#d1495b", (0, (6, 2)), 1.8),
    "odeint": ("#14506b", (0, (4, 1.5)), 1.3),
    "arkode": ("#9a6fb8", "-.", 1.3),
    "cvode": ("#cf8fb4", ":", 1.6),
    "cyrk_nbsolve2": ("#14506b", (0, (4, 1.5)), 1.3),
    "cyrk_pysolve": ("#9a6fb8", "-.", 1.3),
    "scipy": ("#8c8c8c", ":", 1.6),
}
MARKERS = {
    "dopri5": "o",
    "rk45": "o",
    "dop853": "s",
    "rkf78": "s",
    "taylor": "*",
    "heyoka": "*",
    "rk4": "^",
    "dopri5-radau5": "^",
    "dop853-radau5": "<",
    "taylor-radau5": ">",
    "verner6": "p",
    "vern7": "p",
    "radau5": "D",
    "radau": "D",
    "bdf": "v",
    "adams": "P",
    "lsoda": "X",
}
LEFT_OUT = ("scipy", "python")  # close to what numba makes of them; the tables have them
ERRORS = np.logspace(-1, -13.5, 126)
GOAL = "#d1495b"


def save(drawn: Figure, path: Path, dpi: int, **how: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    drawn.savefig(path, dpi=dpi, **how)
    plt.close(drawn)


def circumstances(record: Record) -> str:
    return f"{record.measured['machine']['processor']}, {record.measured['date']}"


def style(name: str) -> dict[str, Any]:
    family = next((one for one in FAMILIES if name.startswith(one)), "scipy")
    marker = next((MARKERS[word] for word in name.split("_") if word in MARKERS), "h")
    how = zip(("color", "linestyle", "linewidth"), FAMILIES[family], strict=True)
    return {**dict(how), "marker": marker}


def marked(contender: Contender, reached: list[Any]) -> list[Any]:
    """Choose the settings that get a marker: whole decades of tolerance, or every third."""
    if contender["setting"] != "tolerance" or contender["name"] == "heyoka":
        return reached[::3]
    return [point for point in reached if f"{point['setting']:.4e}".startswith("1.0000")]


def draw_contender(axes: Axes, contender: Contender, *, by_language: bool = False) -> None:
    """Draw the contender's unbeaten points as a line, and some of its settings as markers.

    `by_language`: C++ and Python of pendcore share the axes; the second is then dashed.
    """
    reached = [point for point in contender["points"] if "failure" not in point]
    if not reached:
        return
    how = style(contender["name"])
    if by_language and contender["ours"] and PYTHON in contender["sides"]:
        how |= {"linestyle": (0, (5, 1)), "color": "#5c5c5c", "linewidth": 1.6}
    dots = {"linestyle": "", "color": how["color"], "markersize": 5 if how["marker"] != "*" else 8}
    unbeaten = envelope(curve(contender))
    axes.plot(*zip(*unbeaten, strict=True), **how | {"marker": ""})
    shown = marked(contender, reached)
    across, up = ([point[key] for point in shown] for key in ("error", "minimum_us"))
    axes.plot(across, up, marker=how["marker"], **dots)
    if "failure" in contender["points"][-1]:
        cross = {"marker": "x", "markersize": 9, "markeredgewidth": 1.6}
        axes.plot(*unbeaten[-1], **dots | cross)
    label = contender["label"] if by_language else short(contender["label"])
    axes.plot([], [], label=label, markersize=dots["markersize"], **how)


def draw_ratios(axes: Axes, who: Entrants, side: str) -> None:
    """Draw the time of pendcore's best method as a share of the best peer's time, and the goals."""
    listed = [one for one in SIDES if one.peers == side]
    for one, dashes in zip(listed, ("-", (0, (2, 1.5))), strict=False):
        known = [(at.error, at.ratio) for at in compare(who, one, ERRORS) if at.ratio is not None]
        if not known:
            continue
        errors, ratios = map(np.array, zip(*known, strict=True))
        label = "pendcore / best peer" if one.ours == side else "with x86-64-v3"
        axes.plot(errors, ratios, color="black", linestyle=dashes, linewidth=1.8, label=label)
        if dashes == "-":
            shade: dict[str, Any] = {"color": "0.75", "interpolate": True}
            axes.fill_between(errors, ratios, 1.0, where=ratios > 1.0, **shade)
    axes.axhline(1.0, color="0.5", linewidth=0.8)
    goals = [bar(listed[0], error) for error in ERRORS]
    axes.plot(ERRORS, goals, color=GOAL, linewidth=1.2, linestyle="--", label="goal")
    axes.set(yscale="log", ylim=(0.1, 4.0))
    axes.yaxis.set_major_locator(FixedLocator([0.1, 0.2, 0.5, 1, 2]))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    note: dict[str, Any] = {"fontsize": 7, "color": "0.35", "va": "top"}
    axes.text(0.012, 0.97, "above 1: the peer is quicker", transform=axes.transAxes, **note)
    axes.legend(loc="lower left", fontsize=7, frameon=False, ncols=3)


def cost(contender: Contender) -> float:
    """Return the time at a middling setting that succeeded; it orders the contenders."""
    times = [point["minimum_us"] for point in contender["points"] if "minimum_us" in point]
    return float(times[len(times) // 2]) if times else 0.0


def error_axis(axes: Axes, tightest: float, loosest: float = 0.1, color: str = "0.88") -> None:
    axes.set(xscale="log", xlim=(loosest, tightest))
    axes.grid(which="major", color=color, linewidth=0.6)
    axes.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
    axes.xaxis.set_minor_formatter(NullFormatter())


def draw_solves(record: Record, path: Path) -> None:
    """Draw the work-precision diagram, and best against best below it.

    The slowest is drawn first, so that legend and lines have the same order.
    """
    case, who = solves_of(record)
    drawn, panels = plt.subplots(
        2, 2, figsize=(12.0, 9.6), sharex=True, sharey="row", height_ratios=(3, 1),
        layout="constrained",
    )  # fmt: skip
    errors = [error for one in who for error, _ in curve(one)]
    tightest = max(6e-16, min(errors, default=6e-16)) / 3
    columns = ((COMPILED, "C++ and compiled code"), (PYTHON, "called from Python"))
    for (side, title), upper, lower in zip(columns, *panels, strict=True):
        present = [one for one in who if side in one["sides"]]
        shown = [one for one in present if not all(word in one["name"] for word in LEFT_OUT)]
        for contender in sorted(shown, key=cost, reverse=True):
            draw_contender(upper, contender)
        upper.set(yscale="log")
        upper.set_title(title, fontsize=10, pad=8)
        below = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.02), "ncols": 3}
        if upper.lines:
            upper.legend(**below, fontsize=7.5, frameon=False, handlelength=3.4)
        draw_ratios(lower, who, side)
        lower.set_xlabel("largest position error / total length (more accurate to the right)")
        for axes in (upper, lower):
            error_axis(axes, tightest, loosest=1.0)
    panels[0][0].set_ylabel("time of a solve / \N{MICRO SIGN}s")
    panels[1][0].set_ylabel("share of the best peer's time")
    facts = record.cases[case]
    title = f"What accuracy costs: {case}, {facts['duration']:g} s, {facts['times']} times"
    drawn.suptitle(title, fontsize=12)
    note = f"{circumstances(record)}; a cross: no tighter setting ran"
    drawn.text(0.01, -0.02, note, fontsize=7, color="0.4")
    save(drawn, path, 150, bbox_inches="tight")


def panels_of(record: Record, height: float, what: str, error: str) -> tuple[Figure, Any]:
    """Make a panel for each case, with times up and errors across."""
    drawn, panels = plt.subplots(
        1, len(record.cases), figsize=(4.4 * len(record.cases), height), sharey=True,
        layout="constrained",
    )  # fmt: skip
    for panel, facts in zip(panels, record.cases.values(), strict=True):
        panel.set(yscale="log", xlabel=error)
        panel.set_title(facts["label"], fontsize=9)
    panels[0].set_ylabel(f"time of a {what} / \N{MICRO SIGN}s")
    return drawn, panels


def legend_below(drawn: Figure, panels: Any, columns: int) -> None:
    by_label: dict[Any, Any] = {}
    for panel in panels:
        handles, labels = panel.get_legend_handles_labels()
        by_label |= dict(zip(labels, handles, strict=True))
    how: dict[str, Any] = {"ncols": columns, "fontsize": 8, "frameon": False}
    drawn.legend(list(by_label.values()), list(by_label), loc="outside lower center", **how)


def draw_stiff(record: Record, path: Path) -> None:
    """Draw a panel for each scene; a cross ends a line if tighter settings failed or never ran."""
    drawn, panels = panels_of(record, 5.4, "solve", "largest position error / length")
    for panel, case in zip(panels, record.cases, strict=True):
        for one in record.taking_part(case):
            left_out = all(word in one["name"] for word in LEFT_OUT)
            if COMPILED_V3 not in one["sides"] and not left_out:
                draw_contender(panel, one, by_language=True)
        error_axis(panel, 1e-9)
    legend_below(drawn, panels, 5)
    save(drawn, path, 150)


def draw_ensembles(record: Record, path: Path) -> None:
    """Draw pendcore's contenders as whole lines, others dashed."""
    drawn, panels = panels_of(record, 5.0, "trajectory", "median position error / length")
    for panel, case in zip(panels, record.cases, strict=True):
        for k, (name, facts) in enumerate(record.contenders.items()):
            points = envelope(curve({"points": record.points(name, case)}))
            if points:
                how: dict[str, Any] = {"linestyle": "-" if facts["ours"] else "--", "marker": "."}
                how |= {"color": f"C{k}", "label": facts["label"]}
                panel.plot(*zip(*points, strict=True), **how)
        error_axis(panel, 1e-14)
    legend_below(drawn, panels[:1], 4)
    save(drawn, path, 150)
