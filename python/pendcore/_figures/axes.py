"""What the figures of a run share: axes, and the shade past the horizon."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from pendcore._accuracy.estimate import error_of
from pendcore._messages.arguments import Floats
from pendcore._run.solution import Solution

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLORS = ("r", "b", "g", "m", "c", "k")  # red and blue are the book's
STYLES = ("-", "--", "-.", ":")  # for one solution after another on the same axes
PAST: dict[str, Any] = {
    "facecolor": "0.85",
    "edgecolor": "0.45",
    "hatch": "//",
    "linewidth": 0,
    "zorder": 0,
}
NewFigure: TypeAlias = Callable[..., "Figure"]
"""Makes a new figure: pyplot's, or one of its own."""


def figure_of_pyplot(*args: Any, **named: Any) -> Figure:
    """Return a new figure that pyplot shows when it is asked to."""
    import matplotlib.pyplot as plt

    return plt.figure(*args, **named)


def stacked(new_figure: NewFigure, rows: int) -> Any:
    """Return as many axes of a new figure, one above the other."""
    figure = new_figure(figsize=(6.4, max(4.8, 1.8 * rows)), layout="constrained")
    return figure.subplots(rows, 1, squeeze=False)[:, 0]


def axes_among(ax: Any, counts: Sequence[int], which: str) -> list[Axes]:
    """Return the given axes as a list; TypeError or ValueError unless they are one of `counts`."""
    from matplotlib.axes import Axes

    axes = list(np.ravel(ax))
    told = ", or ".join(dict.fromkeys("one" if k == 1 else f"{k}, {which}" for k in counts))
    if not all(isinstance(axis, Axes) for axis in axes):
        remedy = "; a figure is chosen by what=" if isinstance(ax, str) else ""
        raise TypeError(f"ax = {ax!r}: must be matplotlib Axes, {told}{remedy}")
    if len(axes) not in counts:
        raise ValueError(f"ax: {len(axes)} axes: must be {told}")
    return axes


def one_axes(ax: Any, new_figure: NewFigure, size: tuple[float, float]) -> Axes:
    """Return the axes that were given, or those of a new figure of a size, inches."""
    if ax is None:
        ax = new_figure(figsize=size, layout="constrained").subplots()
    return axes_among(ax, (1,), "")[0]


def as_drawn(text: str) -> str:
    """Return a user's text as matplotlib has to be told it, so that any can be drawn.

    What stands between dollars is mathematics where matplotlib can read it, else it stays as it is.
    """
    from matplotlib.cbook import is_math_text
    from matplotlib.mathtext import MathTextParser

    if is_math_text(text):
        try:
            MathTextParser("path").parse(text)
        except ValueError:
            return text.replace("$", r"\$")
    return text


def in_legend(name: str) -> str:
    """Return a user's name for a legend, which leaves out what begins with an underscore."""
    return as_drawn(f" {name}" if name.startswith("_") else name)


def in_plane(axis: Axes) -> None:
    """Let the axes show the plane as the project has it: to scale, with y downwards."""
    axis.set_aspect("equal", adjustable="datalim")
    if not axis.yaxis_inverted():
        axis.invert_yaxis()
    axis.set_xlabel("x (m)")
    axis.set_ylabel("y (m), downwards")
    axis.grid(True, alpha=0.4)


def point_style(t: Floats) -> str:
    """Return how points are marked: a single one can be seen, those of a curve cannot."""
    return "." if len(t) == 1 else ""


def horizon_time(solution: Solution, horizon: float | None) -> float | None:
    """Return the time past which the error is above the horizon, rad; None if none is asked for."""
    return None if horizon is None else error_of(solution).valid_until(horizon)


def shade_past(axes: Iterable[Axes], valid: float | None, solution: Solution) -> list[Artist]:
    """Shade what lies past a time, s, in each of the axes."""
    end = solution._run.t_reached
    if valid is None or valid == end:
        return []
    return [axis.axvspan(valid, end, **PAST) for axis in axes]
