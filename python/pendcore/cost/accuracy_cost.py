"""What a sweep found: points of error and time, as numbers, as a table, as a figure."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from math import inf
from textwrap import shorten, wrap
from typing import TYPE_CHECKING, Any

from pendcore.cost.point import Point, duration, front, seconds_at
from pendcore.cost.runs import line_style
from pendcore.messages import as_json, positive, whole_file
from pendcore.plotting import Theme, as_drawn, grid, legend_above, one_axes, theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

UNITS = ((1e-4, 1e6, "\N{MICRO SIGN}s"), (0.1, 1e3, "ms"), (inf, 1.0, "s"))
"""The unit of times in a figure: below so many s, how many make one s, its name."""
FIGURE_SIZE = (7.6, 4.6)
"""Its width and height, inches."""


@dataclass(frozen=True, slots=True, kw_only=True, repr=False)
class AccuracyCost:
    """What accuracy costs on a scene. Print it, `plot` it, ask it for the `best`.

    Errors are the largest distance of a joint or the tip from the reference over a fixed grid of
    times, as a share of the total length.

    Attributes
    ----------
    name : str
        What was run, for people.
    t_span : (float, float)
        Start and end of what was measured, s.
    asked_t_span : (float, float)
        Start and end of what was asked for, s; beyond ``t_span`` double precision cannot follow.
    times : int
        How many times the grid has.
    points : tuple of Point
        What each method did at each tolerance, failures among them.
    uncertainty : float
        The uncertainty of the reference: smaller errors cannot be told apart.
    references : (str, str)
        How the two runs were made whose distance is the uncertainty.
    timed : str
        What was timed, and how.
    remarks : tuple of str
        What one should know: a span that was cut, a time that was up.
    machine : str
        The processor on which times were measured.
    version : str
        The version of pendcore.

    Examples
    --------
    >>> scene = pc.Scene.textbook()
    >>> cost = pc.accuracy_cost(
    ...     scene, q0=0.5, t_span=(0, 1), methods="dop853", rtol=[1e-3, 1e-9], repeats=1
    ... )
    >>> [point.setting for point in cost]
    ['rtol 0.001', 'rtol 1e-09']
    >>> cost.best(1e-8).setting, cost.best(1e-8).error < 1e-8
    ('rtol 1e-09', True)
    """

    name: str
    t_span: tuple[float, float]
    asked_t_span: tuple[float, float]
    times: int
    points: tuple[Point, ...]
    uncertainty: float
    references: tuple[str, str]
    timed: str
    remarks: tuple[str, ...]
    machine: str
    version: str

    def pareto(self) -> list[Point]:
        """Return the points that no other beats in both error and time, the cheapest first."""
        return front(self.points, self.uncertainty)

    def best(self, error: float) -> Point:
        """Return the cheapest point that keeps an error when the uncertainty is added to its own.

        Parameters
        ----------
        error : float
            The error to keep, as a share of the total length.

        Raises
        ------
        ValueError
            If no point does; the message says what was reached.
        """
        asked = positive("error", error, "of the total length")
        kept = [p for p in self.points if p.error + self.uncertainty <= asked]
        if not kept:
            reached = min((p.error for p in self.points), default=inf) + self.uncertainty
            if not self.points:
                raise ValueError(f"error = {asked!r}: nothing was measured before it was stopped")
            if reached == inf:
                raise ValueError(f"error = {asked!r}: no run got to the end; the table says why")
            raise ValueError(
                f"error = {asked!r}: nothing measured here reaches it; the best was {reached:.1e}, "
                f"uncertain by {self.uncertainty:.1e} of the length"
            )
        return min(kept, key=lambda p: p.seconds)

    def sentence(self, error: float = 1e-6) -> str:
        """Return in words what to take for an error, and what ten times the accuracy costs."""
        error = positive("error", error, "of the total length")
        try:
            best = self.best(error)
        except ValueError as reason:
            return str(reason)
        length = abs(self.t_span[1] - self.t_span[0])
        advice = (
            f"for {error:.3g} of the length over {length:.3g} s take {best.method} at "
            f"{best.setting}: {duration(best.seconds)}"
        )
        curve = self.pareto()
        here = seconds_at(error, curve, self.uncertainty)
        there = seconds_at(error / 10, curve, self.uncertainty)
        if here is None or there is None:
            return f"{advice}; ten times the accuracy was not reached"
        if there < 1.05 * here:
            return f"{advice}; ten times the accuracy costs hardly more"
        return f"{advice}; ten times the accuracy costs {there / here:.2g} times the time"

    def plot(self, ax: Any = None, *, y: str = "time", **line_properties: Any) -> list[Line2D]:
        """Draw time, or right-hand sides, against error; both axes logarithmic.

        Filled marks lie on the Pareto front: no other point is both more accurate and faster. In
        the shaded region errors cannot be told apart, as the reference is uncertain by as much.

        Parameters
        ----------
        ax : Axes, optional
            They get no title. Default: a new figure of pyplot's, which is not shown.
        y : {"time", "nfev"}
            The vertical axis shows the least time of a call, or the number of right-hand sides.
        **line_properties
            Passed on to matplotlib's ``Line2D``.

        Returns
        -------
        list of Line2D
            One per method.
        """
        if y not in ("time", "nfev"):
            raise ValueError(f'y = {y!r}: must be "time" or "nfev"')
        axis = one_axes(ax, FIGURE_SIZE)
        theme = theme_of(axis)
        best = self.pareto()
        drawn = [p for p in self.points if not p.failure and p.error > 0]
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
        _dress(axis, self, y, unit)
        start, end = self.t_span
        title = f"What accuracy costs: {self.name or 'chain of links'}, {start:.4g} to {end:.4g} s"
        told = as_drawn(title) if ax is None else None
        legend_above(axis, [*lines, *_others(theme, self, y)], title=told)
        return lines

    def to_dict(self) -> dict[str, Any]:
        """Return everything as JSON can hold it: infinite numbers become None."""
        best = self.pareto()
        points = [{**asdict(p), "pareto": p in best} for p in self.points]
        return dict(as_json(asdict(self) | {"points": points}))

    def to_json(self, path: str | os.PathLike[str] | None = None) -> str:
        """Return the same as JSON text, and write it to a file if one is named."""
        written = json.dumps(self.to_dict(), indent=2)
        if path is not None:
            with whole_file(path) as name:
                name.write_text(written + "\n", encoding="utf-8")
        return written

    def __iter__(self) -> Iterator[Point]:
        return iter(self.points)

    def __len__(self) -> int:
        return len(self.points)

    def __repr__(self) -> str:
        return text(self)


def text(cost: AccuracyCost, error: float = 1e-6) -> str:
    """Return everything that was measured, and what to take for an error."""
    start, end = cost.t_span
    head = [
        f"What accuracy costs: {cost.name or 'chain of links'}, {start:.6g} ... {end:.6g} s",
        *_wrapped(
            "error",
            f"largest distance of a joint or the tip from the reference at {cost.times} times, "
            "as a share of the total length",
        ),
        *_wrapped("reference", f"{cost.references[0]}; the other way round {cost.references[1]}"),
        *_wrapped("uncertainty", f"{cost.uncertainty:.1e}: the distance of the two"),
        *_wrapped("time", cost.timed),
        *_wrapped("machine", cost.machine),
    ]
    for remark in cost.remarks:
        head += _wrapped("note", remark)
    return "\n".join([*head, "", *_rows(cost), "", *wrap(cost.sentence(error), 96)]) + "\n"


def _rows(cost: AccuracyCost) -> Iterator[str]:
    best = cost.pareto()
    yield "    method   setting           error      time    median  right-hand sides    steps"
    for point in cost.points:
        mark = "*" if point in best else " "
        yield f"  {mark} {_row(point)}"
    yield "  * no other is both more accurate and faster"
    if any(point.method == "taylor" and not point.failure for point in cost.points):
        yield "  taylor: its expansions are counted; each takes as long as many right-hand sides"


def _row(point: Point) -> str:
    name = f"{point.method:8} {point.setting:14}"
    if point.failure:
        return f"{name} {shorten(point.failure, 76, placeholder=' ...')}"
    times = f"{duration(point.seconds):>9} {duration(point.median):>9}"
    return f"{name} {point.error:8.1e} {times} {point.nfev:17d} {point.accepted:8d}"


def _wrapped(name: str, sentence: str) -> list[str]:
    return wrap(sentence, 96, initial_indent=f"  {name:11} ", subsequent_indent=14 * " ")


def _dress(ax: Axes, cost: AccuracyCost, y: str, unit: str) -> None:
    from matplotlib.ticker import LogFormatterSciNotation, LogLocator, NullFormatter

    theme = theme_of(ax)
    if not ax.lines:  # without points matplotlib finds no powers of ten to label
        ax.set(xlim=(1.0, 1e-17), ylim=(1.0, 10.0))
    ax.set(xscale="log", yscale="log")
    ax.set_xlabel("largest position error / total length\n(more accurate to the right)")
    counted = "right-hand sides"
    if any(p.method == "taylor" for p in cost.points):
        counted += " (of taylor: expansions)"
    ax.set_ylabel(f"time of a run ({unit})" if y == "time" else counted)
    if not ax.xaxis_inverted():
        ax.invert_xaxis()
    if cost.uncertainty < inf:
        left, right = ax.get_xlim()
        edge = max(cost.uncertainty, 1e-17)
        right = min(right, edge / 3)
        ax.set_xlim(left, right)
        ax.axvspan(right, edge, color=theme.line, zorder=0)
    ax.xaxis.set_major_locator(LogLocator(base=100, numticks=20))
    ax.xaxis.set_minor_formatter(NullFormatter())
    if y == "time":  # labels also between powers of ten where there are few powers
        ax.yaxis.set_minor_formatter(LogFormatterSciNotation(minor_thresholds=(1.5, 0.5)))
    grid(ax)


def _others(theme: Theme, cost: AccuracyCost, y: str) -> list[Artist]:
    """Return what the legend names besides the methods that are drawn."""
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    named: list[Artist] = []
    if y == "time":
        named.append(Line2D([], [], ls="", marker="o", color=theme.ink, label="Pareto front"))
    if cost.uncertainty < inf:
        named.append(Patch(color=theme.line, label="not resolved"))
    fine = {p.method for p in cost.points if not p.failure}
    if failed := [m for m in dict.fromkeys(p.method for p in cost.points) if m not in fine]:
        why = "too slow here, or failed:\n" + "\n".join(failed)
        named.append(Patch(color="none", label=why))
    return named
