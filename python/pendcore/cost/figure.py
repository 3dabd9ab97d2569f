"""The work-precision diagram of a sweep: time against error, a line for each method."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf
from typing import TYPE_CHECKING, Any

from pendcore.cost.point import Point
from pendcore.cost.runs import line_style
from pendcore.plotting import Theme, as_drawn, grid, legend_above, one_axes, theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

UNITS = ((1e-4, 1e6, "\N{MICRO SIGN}s"), (0.1, 1e3, "ms"), (inf, 1.0, "s"))


def plot(
    points: Sequence[Point],
    best: Sequence[Point],
    uncertainty: float,
    title: str,
    ax: Any = None,
    *,
    y: str = "time",
    **line_properties: Any,
) -> list[Line2D]:
    """Draw points and their Pareto front, ``best``; see `AccuracyCost.plot`."""
    if y not in ("time", "nfev"):
        raise ValueError(f'y = {y!r}: must be "time" or "nfev"')
    axis = one_axes(ax, (7.6, 4.6))
    theme = theme_of(axis)
    drawn = [p for p in points if not p.failure and p.error > 0]
    least = min((p.seconds for p in drawn), default=1.0)
    factor, unit = next((factor, unit) for below, factor, unit in UNITS if least < below)
    lines = []
    for method in dict.fromkeys(p.method for p in drawn):
        ours = [p for p in drawn if p.method == method]
        usual = {"markerfacecolor": theme.ground, "markersize": 5, "label": method}
        given = {**usual, **line_style(method, theme), **line_properties}
        height = [factor * p.seconds if y == "time" else p.nfev for p in ours]
        (line,) = axis.plot([p.error for p in ours], height, **given)
        lines.append(line)
        on_front = [(p.error, h) for p, h in zip(ours, height, strict=True) if p in best]
        if on_front and y == "time":
            axis.plot(
                *zip(*on_front, strict=True), linestyle="", marker=line.get_marker(),
                color=line.get_color(), markersize=line.get_markersize() + 1.5, zorder=3,
            )  # fmt: skip
    _dress(axis, points, uncertainty, y, unit)
    title = as_drawn(f"What accuracy costs: {title}")
    legend_above(axis, [*lines, *_others(theme, points, uncertainty, y)], title=title)
    return lines


def _dress(ax: Axes, points: Sequence[Point], uncertainty: float, y: str, unit: str) -> None:
    from matplotlib.ticker import LogFormatter, LogLocator, NullFormatter

    theme = theme_of(ax)
    ax.set(xscale="log", yscale="log")
    ax.set_xlabel("largest position error / total length\n(more accurate to the right)")
    counted = "right-hand sides"
    if any(p.method == "taylor" for p in points):
        counted += " (of taylor: expansions)"
    ax.set_ylabel(f"time of a run ({unit})" if y == "time" else counted)
    if not ax.xaxis_inverted():
        ax.invert_xaxis()
    if uncertainty < inf:
        left, right = ax.get_xlim()
        edge = max(uncertainty, 1e-17)
        right = min(right, edge / 3)
        ax.set_xlim(left, right)
        ax.axvspan(right, edge, color=theme.line, zorder=0)
    ax.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
    ax.xaxis.set_minor_formatter(NullFormatter())
    if y == "time":  # plain numbers, also between powers of ten where there are few powers
        ax.yaxis.set_major_formatter(LogFormatter())
        ax.yaxis.set_minor_formatter(LogFormatter(labelOnlyBase=False, minor_thresholds=(1.5, 0.5)))
    grid(ax)


def _others(theme: Theme, points: Sequence[Point], uncertainty: float, y: str) -> list[Artist]:
    """Return what the legend names besides the methods that are drawn."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    named: list[Artist] = []
    if y == "time":
        named.append(Line2D([], [], ls="", marker="o", color=theme.ink, label="Pareto front"))
    if uncertainty < inf:
        named.append(Patch(color=theme.line, label="not resolved"))
    fine = {p.method for p in points if not p.failure}
    if failed := [m for m in dict.fromkeys(p.method for p in points) if m not in fine]:
        why = "too slow here, or failed:\n" + "\n".join(failed)
        named.append(Patch(color="none", label=why))
    return named
