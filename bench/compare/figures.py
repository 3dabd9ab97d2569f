"""The figures of solves, drawn from the record alone."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl

mpl.use("Agg")

import matplotlib.pyplot as plt
import numpy as np
from contenders.contender import COMPILED, COMPILED_V3, PYTHON
from equal_error import SIDES, Contender, Entrants, bar, compare, curve, envelope
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke
from matplotlib.ticker import FixedLocator, LogLocator, NullFormatter
from pendcore.plotting import LIGHT, grid, new_axes, sheet
from record import Record
from tables import words

plt.style.use(sheet())


class Program(NamedTuple):
    """How a program is drawn: what it is called, its colour, and its dashes."""

    label: str
    color: str
    dashes: Any = "-"


# The first word of a contender's name tells its program.
PROGRAMS = {
    "pendcore": Program("pendcore", LIGHT.ink),
    "heyoka": Program("heyoka", LIGHT.red, (0, (6, 2))),
    "odeint": Program("Boost.odeint", LIGHT.blue, (0, (4, 1.5))),
    "arkode": Program("ARKODE", LIGHT.purple, "-."),
    "cvode": Program("CVODE", LIGHT.teal, ":"),
    "cyrk": Program("CyRK", LIGHT.ochre, (0, (4, 1.5))),
    "scipy": Program("SciPy with numba", LIGHT.quiet, "-."),
}
ERRORS = np.logspace(-1, -13.5, 126)
GOAL = LIGHT.red


def save(drawn: Figure, path: Path, dpi: int, **how: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    drawn.savefig(path, dpi=dpi, **how)
    plt.close(drawn)


def circumstances(record: Record) -> str:
    return f"{record.measured['machine']['processor']}, {record.measured['date']}"


def draw_programs(axes: Axes, contenders: Iterable[Contender]) -> None:
    """Draw what each program does best at every error, by whichever of its methods."""
    ends: list[tuple[float, float, Program]] = []
    for name, program in PROGRAMS.items():
        own = [one for one in contenders if one["name"].startswith(name)]
        best = envelope(point for one in own for point in curve(one))
        if best:
            width = 2.6 if name == "pendcore" else 1.6
            how: dict[str, Any] = {"color": program.color, "linestyle": program.dashes}
            axes.plot(*zip(*best, strict=True), linewidth=width, **how)
            ends.append((*best[-1], program))
    label_ends(axes, ends)


def label_ends(axes: Axes, ends: Sequence[tuple[float, float, Program]]) -> None:
    """Write the names of programs at the ends of their lines, none on another."""
    heights = [np.log10(time) for _, time, _ in ends]
    room = 0.05 * (max(heights, default=0.0) - min(heights, default=0.0) + 1.0)
    taken: list[float] = []
    for error, time, program in sorted(ends, key=lambda end: end[1]):
        height = max([np.log10(time), *(one + room for one in taken[-1:])])
        taken.append(height)
        how: dict[str, Any] = {"textcoords": "offset points", "va": "bottom", "fontsize": 9}
        how["path_effects"] = [withStroke(linewidth=3, foreground=LIGHT.ground)]
        axes.annotate(program.label, (error, 10**height), (4, 1), color=program.color, **how)


def draw_ratios(axes: Axes, who: Entrants, side: str) -> None:
    """Draw the time of pendcore's best method as a share of the best peer's time, and the goals."""
    listed = [one for one in SIDES if one.peers == side]
    for one, dashes in zip(listed, ("-", (0, (2, 1.5))), strict=False):
        known = [(at.error, at.ratio) for at in compare(who, one, ERRORS) if at.ratio is not None]
        if not known:
            continue
        errors, ratios = map(np.array, zip(*known, strict=True))
        label = "pendcore / best peer" if one.ours == side else "with x86-64-v3"
        axes.plot(errors, ratios, color=LIGHT.ink, linestyle=dashes, linewidth=1.8, label=label)
        if dashes == "-":
            shade: dict[str, Any] = {"color": LIGHT.lost, "interpolate": True}
            axes.fill_between(errors, ratios, 1.0, where=ratios > 1.0, **shade)
    axes.axhline(1.0, color=LIGHT.quiet, linewidth=0.8)
    goals = [bar(listed[0], error) for error in ERRORS]
    axes.plot(ERRORS, goals, color=GOAL, linewidth=1.2, linestyle="--", label="goal")
    axes.set(yscale="log", ylim=(0.1, 4.0))
    axes.yaxis.set_major_locator(FixedLocator([0.1, 0.2, 0.5, 1, 2]))
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(NullFormatter())
    note: dict[str, Any] = {"fontsize": 8, "color": LIGHT.quiet, "va": "top"}
    axes.text(0.012, 0.97, "above 1: the other is quicker", transform=axes.transAxes, **note)
    axes.legend(loc="lower left", ncols=3)


def error_axis(axes: Axes, tightest: float, loosest: float = 0.1) -> None:
    axes.set(xscale="log", xlim=(loosest, tightest))
    grid(axes)
    axes.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
    axes.xaxis.set_minor_formatter(NullFormatter())


def draw_solves(record: Record, path: Path) -> None:
    """Draw each program at its best, and best against best below."""
    who = record.taking_part()
    four = new_axes((12.0, 8.0), 2, 2, new_figure=plt.figure, height_ratios=(3, 1))
    drawn: Any = four[0].figure
    panels = (four[:2], four[2:])
    for row in panels:
        row[1].sharey(row[0])
    errors = [error for one in who for error, _ in curve(one)]
    tightest = max(6e-16, min(errors, default=6e-16)) / 3000  # room for the names
    columns = ((COMPILED, "C++ and compiled code"), (PYTHON, "called from Python"))
    for (side, title), upper, lower in zip(columns, *panels, strict=True):
        draw_programs(upper, [one for one in who if side in one["sides"]])
        upper.set(yscale="log", title=title)
        draw_ratios(lower, who, side)
        lower.set_xlabel("largest position error / total length (more accurate to the right)")
        for axes in (upper, lower):
            error_axis(axes, tightest, loosest=1.0)
    panels[0][0].set_ylabel("time of a run (\N{MICRO SIGN}s)")
    panels[1][0].set_ylabel("time / best other's")
    drawn.suptitle(
        f"{words(record, 'names')}: what accuracy costs, each program by its best method"
    )
    drawn.text(0.01, -0.02, circumstances(record), fontsize=8, color=LIGHT.quiet)
    save(drawn, path, 150, bbox_inches="tight")


def panels_of(record: Record, rows: int, what: str, error: str) -> tuple[Figure, Any]:
    """Make a panel for each case, with times up and errors across."""
    columns = len(record.cases) // rows
    panels = new_axes((10.0, 4.0 * rows), rows, columns, new_figure=plt.figure)
    time = f"time of a {what} (\N{MICRO SIGN}s)"
    for panel, facts in zip(panels, record.cases.values(), strict=True):
        panel.sharey(panels[0])
        panel.set(yscale="log", xlabel=error, ylabel=time, title=facts["label"])
        panel.label_outer()
    return panels[0].figure, panels


def legend_below(drawn: Figure, panels: Any, columns: int) -> None:
    by_label: dict[Any, Any] = {}
    for panel in panels:
        handles, labels = panel.get_legend_handles_labels()
        by_label |= dict(zip(labels, handles, strict=True))
    how: dict[str, Any] = {"ncols": columns, "fontsize": 8, "frameon": False}
    drawn.legend(list(by_label.values()), list(by_label), loc="outside lower center", **how)


def draw_stiff(record: Record, path: Path) -> None:
    """Draw a panel for each scene, with each program at its best."""
    drawn, panels = panels_of(record, 1, "run", "largest position error / length")
    for panel, case in zip(panels, record.cases, strict=True):
        present = [one for one in record.taking_part(case) if COMPILED_V3 not in one["sides"]]
        draw_programs(panel, present)
        error_axis(panel, 1e-13)
    save(drawn, path, 150)


def draw_ensembles(record: Record, path: Path) -> None:
    """Draw pendcore's contenders as whole lines, others dashed."""
    drawn, panels = panels_of(record, 2, "trajectory", "median position error / length")
    for panel, case in zip(panels, record.cases, strict=True):
        for k, (name, facts) in enumerate(record.contenders.items()):
            points = envelope(curve({"points": record.points(name, case)}))
            if points:
                how: dict[str, Any] = {"linestyle": "-" if facts["ours"] else "--", "marker": "."}
                how |= {"color": LIGHT.links[k % 6], "label": facts["label"]}
                panel.plot(*zip(*points, strict=True), **how)
        error_axis(panel, 1e-14)
    legend_below(drawn, panels[:1], 4)
    save(drawn, path, 150)
