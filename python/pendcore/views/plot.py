"""The textbook's figure: the angles over time, an axes for each."""

from __future__ import annotations

import os
from collections.abc import Callable
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.arguments import Floats
from pendcore.solution import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

_COLORS = ("r", "b", "g", "m", "c", "k")  # red and blue are the book's


def plot(solution: Solution, ax: Any = None) -> list[Line2D]:
    """Draw the absolute angles in degrees over time, one axes each.

    Parameters
    ----------
    solution : Solution
        What to draw; with dense output the curves are smooth, otherwise the kept points are joined.
    ax : Axes or array of Axes, optional
        One for each link, or one for all. Default: a new figure of pyplot's, which is not shown.

    Returns
    -------
    list of Line2D
        One per link; ``line.axes`` and ``line.figure`` lead to the rest.

    Raises
    ------
    ValueError
        If the number of axes is neither one nor that of the links.
    """
    n = len(solution.scene.links)
    if ax is None:
        import matplotlib.pyplot as plt

        ax = _subplots(plt.figure, n)
    axes = np.ravel(ax)
    if len(axes) not in (1, n):
        raise ValueError(f"ax: {len(axes)} axes: must be one, or {n}, one for each link")
    t, degrees = _curves(solution)
    marker = "." if len(t) == 1 else ""
    lines = []
    for i, angle in enumerate(degrees):
        axis = axes[i % len(axes)]
        color, label = _COLORS[i % len(_COLORS)], f"q{i + 1}"
        lines += axis.plot(t, angle, color=color, label=label, marker=marker)
        axis.set_ylabel(f"{label} (deg)" if len(axes) == n else "q (deg)")
        axis.set_xlabel("t (s)")
        axis.grid(True)
        axis.margins(x=0)
    if len(axes) < n:
        axes[0].legend()
    return lines


def save_figure(solution: Solution, path: str | os.PathLike[str]) -> None:
    """Draw the same figure into a file; the suffix says which kind (png, pdf, svg, ...)."""
    from matplotlib.figure import Figure

    axes = _subplots(Figure, len(solution.scene.links))
    plot(solution, axes)
    axes[0].figure.savefig(path, dpi=150)


def _subplots(new_figure: Callable[..., Figure], n: int) -> Any:
    figure = new_figure(figsize=(6.4, max(4.8, 1.8 * n)), layout="constrained")
    return figure.subplots(n, 1, squeeze=False)[:, 0]


def _curves(solution: Solution) -> tuple[Floats, Floats]:
    """Return times (k,) and angles in degrees (n, k), close enough for the eye if it can be."""
    t, q = solution.t, solution.q
    if solution.store == "dense" and 1 < len(t) < 1000:
        parts = ceil(2000 / (len(t) - 1))
        places = np.linspace(0, len(t) - 1, parts * (len(t) - 1) + 1)
        t = np.interp(places, np.arange(len(t)), t)
        q = solution(t)[: q.shape[1]].T
    return t, np.rad2deg(q.T)
