"""How far to trust a run, drawn: what is past it, exponents over time, validity and work."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.horizon.lyapunov import LyapunovExponents
from pendcore.horizon.work import HorizonWork
from pendcore.solution import Solution

if TYPE_CHECKING:
    from collections.abc import Iterable

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

_PAST: dict[str, Any] = {
    "facecolor": "0.85",
    "edgecolor": "0.45",
    "hatch": "//",
    "linewidth": 0,
    "zorder": 0,
}
# Read in grey too: a marker and a dash for each.
_MARKS = {
    "dopri5": ("o", "-", "C0"),
    "dop853": ("s", "--", "C3"),
    "taylor": ("^", "-.", "C2"),
}
NARROW, FEW_DECADES = 6, 200
"""Ranges of so much have hardly a number of one digit to label, and hardly a power of ten."""


def shade_past(axes: Iterable[Axes], solution: Solution, limit: float) -> list[Rectangle]:
    """Shade what lies past `Solution.valid_until` (limit, rad) in each of the axes."""
    valid, end = solution.valid_until(limit), solution._run.t_reached
    return [] if valid == end else [axis.axvspan(valid, end, **_PAST) for axis in axes]


def plot_exponents(
    found: LyapunovExponents, ax: Axes | None = None, **line_properties: Any
) -> list[Line2D]:
    """Draw finite-time exponents over time, a line each, on the axes or on new ones of pyplot's."""
    if ax is None:
        import matplotlib.pyplot as plt

        ax = plt.figure(figsize=(6.4, 4.0), layout="constrained").subplots()
    lines = ax.plot(
        found.t, found.finite_time, **{"color": "k", "linewidth": 1.2, **line_properties}
    )
    ax.set_xlabel("t (s)")
    ax.set_ylabel("finite-time Lyapunov exponents (1/s)")
    ax.axhline(0.0, color="0.6", linewidth=0.8, zorder=0)
    ax.margins(x=0)
    ax.grid(True, alpha=0.4)
    return lines


def plot_work(work: HorizonWork) -> Figure:
    """Draw seconds of validity against the digits that are right early, and computing time."""
    import matplotlib.pyplot as plt

    figure = plt.figure(figsize=(9.6, 4.2), layout="constrained")
    draw_work(work, figure)
    return figure


def draw_work(work: HorizonWork, figure: Figure) -> None:
    """Draw it into an empty figure, legends beside the data."""
    by_digits, by_cost = figure.subplots(1, 2, sharey=True)
    for method in work.methods:
        points = work.of(method)
        marker, style, color = _MARKS.get(method, ("x", ":", "k"))
        valid = [point.valid for point in points]
        properties = {"marker": marker, "linestyle": style, "color": color, "markersize": 5}
        by_digits.plot([point.early for point in points], valid, label=method, **properties)
        by_cost.plot([1e6 * point.seconds for point in points], valid, **properties)
        to_the_end = [point for point in points if work.is_to_the_end(point)]
        hollow = {**properties, "linestyle": "", "markerfacecolor": "w", "zorder": 3}
        valid = [point.valid for point in to_the_end]
        if to_the_end:
            by_digits.plot([point.early for point in to_the_end], valid, **hollow)
            by_cost.plot([1e6 * point.seconds for point in to_the_end], valid, **hollow)
    if work.growth is not None:
        _as_neighbours_part(by_digits, work)
    columns = len(work.methods) + 1
    if any(work.is_to_the_end(point) for point in work.points):
        columns += 1
        by_digits.plot([], [], "o", color="k", markerfacecolor="w", label="hollow: to the end")
    by_digits.set_xscale("log")
    by_digits.invert_xaxis()
    by_digits.set_xlabel(f"error of the angles after {work.early:.2g} s (rad)")
    by_digits.set_ylabel(f"time until an angle is off by {work.limit:g} rad (s)")
    by_cost.set_xscale("log")
    by_cost.set_xlabel("computing time for these seconds (\N{MICRO SIGN}s)")
    for axis in (by_digits, by_cost):
        axis.grid(True, alpha=0.4)
        axis.set_ylim(bottom=0)
        _few_ticks(axis)
    figure.legend(loc="outside upper center", ncols=columns, frameon=False)


def _few_ticks(axis: Axes) -> None:
    """Label a few round numbers where there are hardly any powers of ten to label."""
    from matplotlib.ticker import FuncFormatter, LogLocator, MaxNLocator, NullFormatter

    low, high = sorted(axis.get_xlim())
    if 0 < high < FEW_DECADES * low:
        is_narrow = high < NARROW * low
        ticks = MaxNLocator(4) if is_narrow else LogLocator(subs=(1, 3), numticks=20)
        axis.xaxis.set_major_locator(ticks)
        axis.xaxis.set_major_formatter(FuncFormatter(lambda x, _: f"{x:g}"))
        axis.xaxis.set_minor_formatter(NullFormatter())


def _as_neighbours_part(axis: Axes, work: HorizonWork) -> None:
    """How the early error of a run depends on its horizon by the variational equations.

    But for a factor, the middle one of the points: an exponent says how fast, not how much.
    """
    assert work.growth is not None
    horizons = np.abs(work.growth.t - work.t_span[0])
    grown = np.maximum.accumulate(work.growth.growth[:, 0])
    at_points = np.interp([point.valid for point in work.points], horizons, grown)
    known = np.array([point.early > 0 for point in work.points])
    early = np.log([point.early for point in work.points if point.early > 0])
    axis.plot(
        np.exp(np.median(early + at_points[known]) - grown),
        horizons,
        color="0.5",
        linewidth=4,
        alpha=0.5,
        zorder=1,
        label=rf"as neighbours part: ln(10)/$\lambda$ = {work.seconds_a_digit:.2f} s a digit",
    )
