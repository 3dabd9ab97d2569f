"""The figures of the comparisons, drawn from the record alone."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from contenders.contender import COMPILED, COMPILED_V3, PYTHON
from equal_error import SIDES, Contender, Entrants, bar, compare, curve, envelope
from forward_tables import CORE, PEER, STEP, added, effects_of, of_links, share
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch
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


# The lines of chains, each of the best of the contenders whose names begin so.
CHAINS: dict[str, tuple[str, dict[str, Any]]] = {
    CORE: ("pendcore", {"color": "#000000", "linestyle": "-", "marker": "o", "linewidth": 2.2}),
    "pinocchio": (
        "Pinocchio's ABA, the best of its ways",
        {"color": "#d1495b", "linestyle": "--", "marker": "^"},
    ),
    "mujoco": (
        "MuJoCo, the best of its ways",
        {"color": "#0b5fa5", "linestyle": "-.", "marker": "s"},
    ),
    STEP: (
        "pendcore, in a step of dopri5",
        {"color": "#777777", "linestyle": ":", "marker": ".", "linewidth": 1.4},
    ),
}


def least(record: Record, start: str, metric: str) -> list[tuple[int, float]]:
    """List (n, the least value of the contenders of that name, or of a peer's beginning)."""
    best: dict[int, float] = {}
    for name in record.contenders:
        if name == start or (name.startswith(start) and not start.startswith(CORE)):
            for n, value in of_links(record, name, metric).items():
                best[n] = min(best.get(n, float("inf")), value)
    return sorted(best.items())


def draw_chains(record: Record, path: Path) -> None:
    """Draw time and memory against the number of links, all axes logarithmic."""
    drawn, both = plt.subplots(1, 2, figsize=(11, 5), layout="constrained")
    for axes, metric, shown in zip(both, ("minimum_ns", "bytes"), (4, 3), strict=True):
        for start, (label, how) in list(CHAINS.items())[:shown]:
            line = least(record, start, metric)
            if not line:
                continue
            axes.plot(*zip(*line, strict=True), label=label, markersize=5, **how)
            axes.set(xscale="log", yscale="log")
            if start == CORE:  # a guide through the last point, of growth in proportion to n
                (first, _), (n, value) = line[0], line[-1]
                guide: dict[str, Any] = {"color": "0.6", "linewidth": 0.8, "zorder": 0}
                axes.plot([first, n], [value * first / n, value], **guide)
                middle = (first * n) ** 0.5
                words: dict[str, Any] = {"textcoords": "offset points", "fontsize": 8}
                at = (middle, value * middle / n)
                axes.annotate("proportional to n", at, (8, -12), color="0.45", **words)
        axes.set_xlabel("number of links n")
        axes.grid(which="major", color="0.85", linewidth=0.6)
    if both[0].lines:
        both[0].legend(loc="upper left", frameon=False, fontsize=9)
    both[0].set_ylabel("time of a right-hand side / ns")
    both[1].set_ylabel("memory of its equations / bytes")
    drawn.suptitle("Forward dynamics of a planar chain of n links, C++", fontsize=11)
    drawn.text(0.01, -0.03, circumstances(record), fontsize=7, color="0.4")
    save(drawn, path, 160, bbox_inches="tight")


BARS = {
    STEP: ("pendcore, in a step", "#000000", 0.2),
    PEER: ("MuJoCo, mj_forward", "#6fa8d6", -0.2),
}
BAR = 0.36
LEAST = 0.2  # ns; smaller values, and those lost in the noise, are drawn as this


def draw_effects(record: Record, path: Path) -> None:
    """Draw what each effect adds, and for pendcore the instructions, with what is promised.

    A bar ends with what is added and its share of the bare scene; a stroke across its row is the
    most that pendcore promises.
    """
    found = list(effects_of(record).items())[::-1]
    drawn, (times, instructions) = plt.subplots(
        1, 2, figsize=(11, 0.44 * len(found) + 1.7), width_ratios=(2.2, 1), sharey=True,
        layout="constrained",
    )  # fmt: skip

    def write(axes: Axes, x: float, y: float, text: str, color: str = "0") -> None:
        axes.text(x, y, f" {text}", fontsize=7, va="center", color=color)

    def stroke(axes: Axes, most: float | None, place: float) -> None:
        if most is not None:
            axes.plot([most, most], [place - BAR / 2, place + BAR / 2], color=GOAL)

    for place, (name, facts) in enumerate(found):
        for side, (_, color, offset) in BARS.items():
            more, part = added(record, name, side), share(record, name, side)
            if more is None or part is None:
                words = "not yet" if side == STEP else "has none"
                write(times, LEAST, place + offset, words, "0.5")
                continue
            length, most = max(more, LEAST), facts["most_ns"] if side == STEP else None
            times.barh(place + offset, length - LEAST, BAR, left=LEAST, color=color)
            text = f"{more:+.1f} ns ({part:+.0%})" if more > LEAST else "nothing seen"
            write(times, max(length, most or 0.0), place + offset, text)
            stroke(times, most, place + offset)
        counted = added(record, name, STEP, "instructions")
        if counted is None:
            write(instructions, 0.0, place, "not counted" if facts["ours"] else "not yet", "0.5")
            continue
        most = facts["most_instructions"]
        instructions.barh(place, max(counted, 0.0), BAR, color=BARS[STEP][1])
        write(instructions, max(counted, most or 0, 0.0), place, f"{counted:+.0f}")
        stroke(instructions, most, place)
    times.set(xscale="log", xlim=(LEAST, 8000), ylim=(-0.6, len(found) - 0.4))
    times.set_xlabel("added to a right-hand side / ns\n(in parentheses: of the side's bare scene)")
    times.set_yticks(range(len(found)), [facts["label"] for _, facts in found], fontsize=9)
    instructions.set_xlim(0, 1.2 * max(instructions.get_xlim()[1], 200.0))
    instructions.set_xlabel("added to a right-hand side\nin a step / instructions")
    instructions.tick_params(left=False)
    for axes in (times, instructions):
        axes.grid(axis="x", which="major", color="0.85", linewidth=0.6)
        axes.set_axisbelow(True)
    drawn.suptitle("What an effect adds to the right-hand side of two links, C++", fontsize=11)
    known = [Patch(color=color, label=label) for label, color, _ in BARS.values()]
    goal = Line2D([], [], color=GOAL, label="promised: at most")
    drawn.legend(handles=[*known, goal], loc="outside lower right", ncols=3, frameon=False)
    drawn.text(0.01, 0.01, circumstances(record), fontsize=7, color="0.4")
    save(drawn, path, 160, bbox_inches="tight")
