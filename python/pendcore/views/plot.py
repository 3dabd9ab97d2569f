"""The textbook's figure: the angles over time, an axes for each."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from io import BytesIO
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.accuracy.estimate import error_of
from pendcore.messages.arguments import Floats, positive
from pendcore.run.result import RunResult

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D
    from matplotlib.patches import Rectangle

_COLORS = ("r", "b", "g", "m", "c", "k")  # red and blue are the book's
_STYLES = ("-", "--", "-.", ":")  # for one solution after another on the same axes
_PAST: dict[str, Any] = {
    "facecolor": "0.85",
    "edgecolor": "0.45",
    "hatch": "//",
    "linewidth": 0,
    "zorder": 0,
}
_FEW = 200
"""Without dense output, points are marked if they are fewer than this."""
_LEAST_SPAN = 0.1
"""deg, the least span of the angle axis, so that rest does not look like its last bits."""


def plot(
    solution: RunResult,
    ax: Any = None,
    *,
    label: str | None = None,
    horizon: float | None = None,
    **line_properties: Any,
) -> list[Line2D]:
    """Draw the absolute angles in degrees over time, one axes each.

    Parameters
    ----------
    solution : RunResult
        What to draw; with dense output the curves are smooth, otherwise the kept points are joined,
        and marked if they are few.
    ax : Axes or array of Axes, optional
        One for each link, or one for all. Default: a new figure of pyplot's, which is not shown.
        Where curves are drawn already, the next ones are dashed.
    label : str, optional
        Name of this solution in the legend.
    horizon : float, optional
        rad. What lies past the time at which the estimated error passes it is shaded
        (`Solution.valid_until`: that takes further runs, when it is first asked for).
    **line_properties
        Passed on to matplotlib's ``Line2D``, such as ``color``, ``linestyle`` or ``linewidth``.

    Returns
    -------
    list of Line2D
        One per link; ``line.axes`` and ``line.figure`` lead to the rest.

    Raises
    ------
    TypeError
        If ``ax`` is not axes, or ``horizon`` is not a number.
    ValueError
        If the number of axes is neither one nor that of the links, or ``horizon`` is not > 0.
    """
    if horizon is not None:
        positive("horizon", horizon, "rad")
    from matplotlib.cbook import normalize_kwargs
    from matplotlib.lines import Line2D

    n = len(solution.scene.links)
    if ax is None:
        import matplotlib.pyplot as plt

        ax = _subplots(plt.figure, n)
    axes = _axes(ax, n)
    given = normalize_kwargs(line_properties, Line2D)
    t, degrees = _curves(solution)
    style = _STYLES[len(axes[0].lines) // (n // len(axes)) % len(_STYLES)]
    bare = solution.store != "dense" and len(t) < _FEW
    lines = []
    for i, angle in enumerate(degrees):
        axis, name = axes[i % len(axes)], f"q{i + 1}"
        ours = {
            "color": _COLORS[i % len(_COLORS)],
            "linestyle": style,
            "marker": "." if bare or len(t) == 1 else "",
            "label": _label(name, label, alone=len(axes) == n),
        }
        lines += axis.plot(t, angle, **{**ours, **given})
        axis.set_ylabel(f"{name} (deg)" if len(axes) == n else "q (deg)")
    for axis in axes:
        _dress(axis)
        if label is not None or len(axes) < n:
            axis.legend()
    if horizon is not None:
        _shade_past(axes, error_of(solution).valid_until(horizon), solution)
    return lines


def save_figure(
    solution: RunResult, path: str | os.PathLike[str], valid_until: float | None = None
) -> None:
    """Draw the same figure into a file; the suffix says which kind (png, pdf, svg, ...).

    What is past ``valid_until``, s, is shaded, if that is known.
    """
    from matplotlib.figure import Figure

    axes = _subplots(Figure, len(solution.scene.links))
    plot(solution, axes)
    if valid_until is not None:
        _shade_past(axes, valid_until, solution)
    drawn = BytesIO()  # matplotlib's PDF breaks off with an error of its own if the disk is full
    kind = Path(path).suffix.removeprefix(".")
    axes[0].figure.savefig(drawn, dpi=150, format=kind or None)
    Path(path).write_bytes(drawn.getvalue())


def _shade_past(axes: Iterable[Axes], valid: float, solution: RunResult) -> list[Rectangle]:
    """Shade what lies past a time, s, in each of the axes."""
    end = solution.run.t_reached
    return [] if valid == end else [axis.axvspan(valid, end, **_PAST) for axis in axes]


def _axes(ax: Any, n: int) -> list[Axes]:
    from matplotlib.axes import Axes

    axes = list(np.ravel(ax))
    if not all(isinstance(axis, Axes) for axis in axes):
        raise TypeError(f"ax = {ax!r}: must be matplotlib Axes, one, or {n}, one for each link")
    if len(axes) not in (1, n):
        raise ValueError(f"ax: {len(axes)} axes: must be one, or {n}, one for each link")
    return axes


def _label(name: str, label: str | None, *, alone: bool) -> str:
    """Return what the legend says: the curve, the solution, or both where both are needed."""
    if label is None:
        return name
    return label if alone else f"{name}, {label}"


def _dress(axis: Axes) -> None:
    from matplotlib.ticker import ScalarFormatter

    axis.set_xlabel("t (s)")
    axis.grid(True)
    axis.margins(x=0)
    for ticks in (axis.xaxis.get_major_formatter(), axis.yaxis.get_major_formatter()):
        if isinstance(ticks, ScalarFormatter):
            ticks.set_useOffset(False)
    low, high = axis.get_ylim()
    if axis.get_autoscaley_on() and abs(high - low) < _LEAST_SPAN:
        middle, half = (low + high) / 2, _LEAST_SPAN / 2
        axis.set_ylim(middle - half, middle + half, auto=True)  # curves to come may need more


def _subplots(new_figure: Callable[..., Figure], n: int) -> Any:
    figure = new_figure(figsize=(6.4, max(4.8, 1.8 * n)), layout="constrained")
    return figure.subplots(n, 1, squeeze=False)[:, 0]


def _curves(solution: RunResult) -> tuple[Floats, Floats]:
    """Return times (k,) and angles in degrees (n, k), close enough for the eye if possible."""
    t, q = solution.t, solution.q
    if solution.store == "dense" and 1 < len(t) < 1000:
        parts = ceil(2000 / (len(t) - 1))
        places = np.linspace(0, len(t) - 1, parts * (len(t) - 1) + 1)
        t = np.interp(places, np.arange(len(t)), t)
        q = solution(t)[: q.shape[1]].T
    return t, np.rad2deg(q.T)
