"""The curves at the end of a report: angles, reactions and energies over time, with units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pendcore._figures.plot import plot
from pendcore._messages.arguments import Floats
from pendcore._run.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


MOST_TICKS = 7
"""The largest number of ticks on an axis that is drawn into by hand."""


def sheets(rows: int, height: float = 2.1) -> tuple[Figure, list[Axes]]:
    """Return a figure with axes one below the other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.6, max(3.0, height * rows)), layout="constrained")
    return figure, list(figure.subplots(rows, 1, squeeze=False, sharex=True)[:, 0])


def angles(solution: Solution) -> Figure:
    """Draw the angles in degrees over time, as the textbook does."""
    figure, axes = sheets(len(solution.scene.links))
    plot(solution, axes)
    for axis in axes[:-1]:
        axis.set_xlabel("")
    return figure


def empty_axes(solution: Solution) -> Figure:
    """Draw the axes of the angles with nothing in them: the scale gives nothing away."""
    from matplotlib.ticker import AutoMinorLocator

    figure, axes = sheets(len(solution.scene.links))
    span = solution.t[0], solution.t[-1]
    if span[0] == span[1]:  # a run that failed at once: the span that was asked for
        span = solution._run.arguments["t_start"], solution._run.arguments["t_end"]
    for i, axis in enumerate(axes, start=1):
        axis.set(xlim=span, ylabel=f"q{i} (deg)")
        low, high, step = whole_ticks(np.degrees(solution.q[:, i - 1]))
        axis.set_ylim(low, high)
        axis.set_yticks(np.arange(low, high + 1.0, step))
        axis.set_yticks(np.arange(low, high + 1.0, step / 3.0), minor=True)
        axis.xaxis.set_minor_locator(AutoMinorLocator(5))
        axis.grid(True, which="major", color="0.6", linewidth=0.6)
        axis.grid(True, which="minor", color="0.85", linewidth=0.5)
    axes[-1].set_xlabel("t (s)")
    return figure


def whole_ticks(angles: Floats) -> tuple[float, float, float]:
    """Return ends and step of an axis for angles, deg: at most seven ticks, at whole 30 degrees."""
    for step in (30.0, 45.0, 90.0, 180.0, *(360.0 * 2.0 ** np.arange(20))):
        low = step * np.floor(min(0.0, float(angles.min())) / step)
        high = step * np.ceil(max(90.0, float(angles.max()) + 0.05 * step) / step)
        if (high - low) / step <= MOST_TICKS - 1:
            break
    return float(low), float(high), float(step)


def reactions(t: Floats, forces: Floats, names: Sequence[str]) -> Figure:
    """Draw the components and the size of the joint forces over time.

    Parameters
    ----------
    t : ndarray, (k,)
        s.
    forces : ndarray, (k, n, 2)
        N.
    names : sequence of str, (n,)
        LaTeX of the forces, such as ``F_{01}``.
    """
    figure, axes = sheets(len(names), 2.4)
    for i, (axis, name) in enumerate(zip(axes, names, strict=True)):
        stem = name.removesuffix("}")
        axis.plot(t, forces[:, i, 0], "r-", label=f"${stem}x}}$")
        axis.plot(t, forces[:, i, 1], "b--", label=f"${stem}y}}$")
        size = rf"$\left|\mathbf{{F}}_{stem[2:]}}}\right|$"
        axis.plot(t, np.hypot(*forces[:, i].T), "k-", lw=0.8, label=size)
        axis.set_ylabel(f"${name}$ (N)")
        _dress(axis)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    axes[-1].set_xlabel("t (s)")
    return figure


def energies(t: Floats, curves: dict[str, Floats], residual: Floats) -> Figure:
    """Draw energies over time, and below them what their balance leaves over.

    Parameters
    ----------
    t : ndarray, (k,)
        s.
    curves : dict
        Energies by name, J, each (k,).
    residual : ndarray, (k,)
        J.
    """
    figure, (above, below) = sheets(2, 2.4)
    for (name, curve), style in zip(curves.items(), ("r-", "b--", "k-", "g-.", "m:"), strict=False):
        above.plot(t, curve, style, label=name)
    above.set_ylabel("energy (J)")
    above.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    below.plot(t, residual, "k-", lw=0.8)
    below.set_ylabel("balance (J)")
    below.set_xlabel("t (s)")
    for axis in (above, below):
        _dress(axis)
    below.ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
    return figure


def _dress(axis: Axes) -> None:
    axis.grid(True, color="0.85", linewidth=0.6)
    axis.margins(x=0)
