"""Figures over time: angles, as in the textbook, rates, reactions, energy."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from pendcore import Energy
from pendcore.messages import Floats
from pendcore.plotting.axes import Request, grid, legend_above, point_style
from pendcore.plotting.curve import curve_of
from pendcore.plotting.style import DASHES, Theme, theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_LEAST_SPAN = 0.1
"""deg, the least span of the angle axis, so that rest does not look like its last bits."""


Curves: TypeAlias = "dict[str, tuple[Floats, str]]"
"""The values of each curve, (k,), and its colour, by its name."""


def draw_angles(asked: Request) -> list[Artist]:
    """Draw the angle of each link, deg."""
    curve = curve_of(asked.solution)
    return _draw_links(asked, curve.t, np.rad2deg(curve.q), "q", "deg", _LEAST_SPAN)


def draw_rates(asked: Request) -> list[Artist]:
    """Draw the rate of each link, rad/s."""
    curve = curve_of(asked.solution)
    return _draw_links(asked, curve.t, curve.qd, r"\dot q", "rad/s")


def draw_reactions(asked: Request) -> list[Artist]:
    """Draw the force on each link at its joint, N: x, y (downwards) and size."""
    t, q, qd, _ = curve_of(asked.solution)
    forces = np.moveaxis(asked.solution.scene.reactions(t, q, qd), 1, 0)
    axes = asked.stacked_axes((len(forces),), "one for each joint")
    theme = theme_of(axes[0])
    panels: dict[str, Curves] = {}
    for i, force in enumerate(forces):
        x, y = force.T
        parts = {"x": x, "y, downwards": y}
        panels[f"${force_name(i, i + 1)}$ (N)"] = with_sum(parts, {"size": np.hypot(x, y)}, theme)
    return _draw(asked, axes, t, panels, named=1)


def draw_energy(asked: Request) -> list[Artist]:
    """Draw kinetic, potential and total energy, J, and below them the ledger and its residual."""
    curve = curve_of(asked.solution)
    energy = curve.energy()
    booked = {} if energy.ledger is None else dict(energy.ledger.items())
    losses = () if energy.ledger is None else energy.ledger.losses
    residual = booked.pop("residual", None)
    count = 1 + bool(booked) + (residual is not None)
    axes = asked.stacked_axes((count,), "for the energies, the ledger and its residual")
    theme = theme_of(axes[0])
    panels = {"energy (J)": _energies(energy, theme)}
    if booked:
        parts = {f"{x} (lost)" if x in losses else x: y for x, y in booked.items()}
        panels["work and loss (J)"] = with_sum(parts, {}, theme)
    if residual is not None:
        panels["residual (J)"] = {"residual": (residual, theme.ink)}
    return _draw(asked, axes, curve.t, panels, named=2)


def draw_energies(asked: Request) -> list[Artist]:
    """Draw kinetic, potential and total energy, J, on one axes, whatever else there is."""
    curve = curve_of(asked.solution)
    axes = asked.stacked_axes((1,), "")
    panels = {"energy (J)": _energies(curve.energy(), theme_of(axes[0]))}
    return _draw(asked, axes, curve.t, panels, named=1)


def draw_force_sizes(asked: Request, percentile: float) -> list[Artist]:
    """Draw the size of the force at each joint, or the first six, N, on one axes.

    Peaks leave the axes where they are far above what a percentile of the sizes is.
    """
    t, q, qd, _ = curve_of(asked.solution)
    sizes = np.hypot(*np.moveaxis(asked.solution.scene.reactions(t, q, qd), -1, 0)).T
    axes = asked.stacked_axes((1,), "")
    colors = theme_of(axes[0]).links
    few = list(enumerate(sizes))[: len(colors)]  # the first, where there are many joints
    curves = {f"$|{force_name(i, i + 1)}|$": (x, colors[i]) for i, x in few}
    lines = _draw(asked, axes, t, {"force (N)": curves}, named=1)
    typical = float(np.percentile(sizes.max(axis=0), percentile))
    if sizes.max() > 1.5 * typical:
        axes[0].set_ylim(0.0, 1.5 * typical)
    return lines


def force_name(first: int, second: int) -> str:
    """Return the name in LaTeX of the force that a link exerts on another; 0 is the ground."""
    comma = "," if max(first, second) > 9 else ""
    return f"F_{{{first}{comma}{second}}}"


def with_sum(parts: dict[str, Floats], sums: dict[str, Floats], theme: Theme) -> Curves:
    """Return curves in colours, and what they make up in ink, behind them."""
    own = {
        name: (x, theme.parts[k % len(theme.parts)]) for k, (name, x) in enumerate(parts.items())
    }
    return own | {name: (x, theme.ink) for name, x in sums.items()}


def _energies(energy: Energy, theme: Theme) -> Curves:
    parts = {"kinetic": energy.kinetic, "potential": energy.potential}
    return with_sum(parts, {"total": energy.total}, theme)


def _draw_links(
    asked: Request, t: Floats, values: Floats, symbol: str, unit: str, least_span: float = 0.0
) -> list[Artist]:
    """Draw a number of each link, (k, n), each on its own axes or all on one."""
    n = values.shape[1]
    axes = asked.stacked_axes((1, n), "one for each link")
    colors = theme_of(axes[0]).links
    curves = {
        f"${symbol}_{{{i + 1}}}$": (x, colors[i % len(colors)]) for i, x in enumerate(values.T)
    }
    is_apart = len(axes) == n
    panels = {f"${symbol}$ ({unit})": curves}
    if is_apart:
        panels = {f"{name} ({unit})": {name: x} for name, x in curves.items()}
    named = 0 if is_apart and asked.label is None else n
    return _draw(asked, axes, t, panels, named, is_apart=is_apart, least_span=least_span)


def _draw(
    asked: Request,
    axes: Sequence[Axes],
    t: Floats,
    panels: dict[str, Curves],
    named: int,
    *,
    is_apart: bool = False,
    least_span: float = 0.0,
) -> list[Artist]:
    """Draw each panel on its axes; the first few, ``named``, name their curves in a legend.

    The legend calls a curve that is apart by its solution alone.
    """
    lines: list[Artist] = []
    for k, (axis, (y_label, curves)) in enumerate(zip(axes, panels.items(), strict=True)):
        dashes = DASHES[len(axis.lines) // len(curves) % len(DASHES)]
        for name, (values, color) in curves.items():
            called = asked.name_of(name) if asked.label is None or not is_apart else asked.label
            ours = {"linestyle": dashes, "marker": point_style(t), "color": color}
            ours["label"] = called if k < named else f"_{called}"
            lines += axis.plot(t, values, **(ours | asked.properties))
        axis.set_ylabel(y_label)
        _dress(axis, least_span)
    asked.label_outer(axes)
    asked.shade(axes)
    for axis, curves in zip(axes[: max(named, 1)], panels.values(), strict=False):
        legend_above(axis, columns=max(len(curves), 2))  # a row for each run
    return lines


def _dress(axis: Axes, least_span: float) -> None:
    """Name the time, and let rest look like rest: no offsets, no axis of last bits."""
    from matplotlib.ticker import ScalarFormatter

    axis.set_xlabel("t (s)")
    grid(axis)
    axis.margins(x=0)
    for ticks in (axis.xaxis.get_major_formatter(), axis.yaxis.get_major_formatter()):
        if isinstance(ticks, ScalarFormatter):
            ticks.set_useOffset(False)
    low, high = axis.get_ylim()
    if axis.get_autoscaley_on() and abs(high - low) < least_span:
        middle, half = (low + high) / 2, least_span / 2
        axis.set_ylim(middle - half, middle + half, auto=True)  # curves to come may need more
