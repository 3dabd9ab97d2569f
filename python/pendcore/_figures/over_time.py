"""Figures over time: angles, as in the textbook, rates, reactions, energy."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pendcore._figures.axes import (
    COLORS,
    STYLES,
    NewFigure,
    axes_among,
    point_style,
    stacked,
)
from pendcore._messages.arguments import Floats
from pendcore._run.curve import curve_of
from pendcore._run.energy import LOSSES, Energy, energy_over
from pendcore._run.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

_LEAST_SPAN = 0.1
"""deg, the least span of the angle axis, so that rest does not look like its last bits."""


class Panel(NamedTuple):
    """What one of several axes shows.

    Attributes
    ----------
    t : ndarray, (k,)
        s.
    label : str
        What the vertical axis is called, with the unit.
    curves : list of (str, ndarray (k,))
        Name and values of each curve.
    """

    t: Floats
    label: str
    curves: list[tuple[str, Floats]]


def draw_links(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    what: str,
    label: str | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw an angle (deg) or a rate (rad/s) of each link; ``what`` says which."""
    n = len(solution.scene.links)
    axes = axes_among(stacked(new_figure, n) if ax is None else ax, (1, n), "one for each link")
    t, states, _ = curve_of(solution)
    is_angle = what == "angles"
    values = np.rad2deg(states[:, :n]) if is_angle else states[:, n:]
    symbol, unit = ("q", "deg") if is_angle else ("qd", "rad/s")
    style = STYLES[len(axes[0].lines) // (n // len(axes)) % len(STYLES)]
    lines = []
    for i, curve in enumerate(values.T):
        axis, name = axes[i % len(axes)], f"{symbol}{i + 1}"
        ours = {
            "color": COLORS[i % len(COLORS)],
            "linestyle": style,
            "marker": point_style(t),
            "label": _label(name, label, alone=len(axes) == n),
        }
        lines += axis.plot(t, curve, **{**ours, **given})
        axis.set_ylabel(f"{name} ({unit})" if len(axes) == n else f"{symbol} ({unit})")
    for axis in axes:
        dress(axis, _LEAST_SPAN if is_angle else 0.0)
        if label is not None or len(axes) < n:
            axis.legend()
    return lines


def draw_reactions(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    label: str | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw the force on each link at its joint, N: x, y (downwards) and size."""
    t, states, _ = curve_of(solution)
    n = len(solution.scene.links)
    forces = solution.scene._compiled.reactions(t, states[:, :n], states[:, n:])
    panels = []
    for i, force in enumerate(np.moveaxis(forces, 1, 0)):
        name = f"F_{i}{i + 1}" if n < 10 else f"F_{i},{i + 1}"
        size = np.hypot(force[:, 0], force[:, 1])
        curves = [(f"{name} x", force[:, 0]), (f"{name} y", force[:, 1]), (f"|{name}|", size)]
        panels.append(Panel(t, f"{name} (N)", curves))
    if ax is None:
        ax = stacked(new_figure, n)
    return _draw_panels(solution, panels, ax, "one for each joint", label, given)


def draw_energy(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    label: str | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw kinetic, potential and total energy, J, and below them the entries of the ledger."""
    t, energy = _energy(solution)
    panels = [_energies(t, energy)]
    if energy.ledger is not None:
        booked = [
            (f"{name} (lost)" if name in LOSSES else name, x) for name, x in energy.ledger.items()
        ]
        panels.append(Panel(t, "work and loss (J)", booked))
    if ax is None:
        ax = stacked(new_figure, len(panels))
    which = "one for the energies and one for the ledger"
    return _draw_panels(solution, panels, ax, which, label, given)


def draw_energies(solution: Solution, axis: Axes) -> list[Line2D]:
    """Draw kinetic, potential and total energy, J, on one axes, whatever else there is."""
    panels = [_energies(*_energy(solution))]
    return _draw_panels(solution, panels, axis, "", None, {})


def _energy(solution: Solution) -> tuple[Floats, Energy]:
    t, states, ledger = curve_of(solution)
    return t, energy_over(solution.scene, solution._run.arguments, t, states, ledger)


def _energies(t: Floats, energy: Energy) -> Panel:
    names = ("kinetic", "potential", "total")
    return Panel(t, "energy (J)", [(name, getattr(energy, name)) for name in names])


def _draw_panels(
    solution: Solution,
    panels: list[Panel],
    ax: Any,
    which: str,
    label: str | None,
    given: dict[str, Any],
) -> list[Line2D]:
    axes = axes_among(ax, (len(panels),), which)
    lines = []
    for axis, panel in zip(axes, panels, strict=True):
        style = STYLES[len(axis.lines) // len(panel.curves) % len(STYLES)]
        for k, (name, curve) in enumerate(panel.curves):
            is_sum = name.startswith("|") or name == "total"
            ours = {
                "color": "0.4" if is_sum else COLORS[k % len(COLORS)],
                "linestyle": style,
                "linewidth": 1.0 if is_sum else 1.5,
                "marker": point_style(panel.t),
                "label": _label(name, label, alone=False),
            }
            lines += axis.plot(panel.t, curve, **{**ours, **given})
        axis.set_ylabel(panel.label)
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), fontsize="small", frameon=False)
        dress(axis)
    return lines


def _label(name: str, label: str | None, *, alone: bool) -> str:
    """Return what the legend says: the curve, the solution, or both where both are needed."""
    if label is None:
        return name
    return label if alone else f"{name}, {label}"


def dress(axis: Axes, least_span: float = 0.0) -> None:
    """Name the time, and let rest look like rest: no offsets, no axis of last bits."""
    from matplotlib.ticker import ScalarFormatter

    axis.set_xlabel("t (s)")
    axis.grid(True)
    axis.margins(x=0)
    for ticks in (axis.xaxis.get_major_formatter(), axis.yaxis.get_major_formatter()):
        if isinstance(ticks, ScalarFormatter):
            ticks.set_useOffset(False)
    low, high = axis.get_ylim()
    if axis.get_autoscaley_on() and abs(high - low) < least_span:
        middle, half = (low + high) / 2, least_span / 2
        axis.set_ylim(middle - half, middle + half, auto=True)  # curves to come may need more
