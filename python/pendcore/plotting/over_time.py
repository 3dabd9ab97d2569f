"""Figures over time: angles, as in the textbook, rates, reactions, energy."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import cycle
from math import floor, log10
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from pendcore.messages import Floats
from pendcore.plotting.axes import Request, grid, legend_above, point_style
from pendcore.plotting.curve import curve_of
from pendcore.plotting.style import DASHES, Theme, theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_PREFIXES = {-6: "\N{MICRO SIGN}", -9: "n", -12: "p", -15: "f", -18: "a"}
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
    """Draw the force on each link at its joint, N: x, y (downwards) and magnitude."""
    t, q, qd, _ = curve_of(asked.solution)
    forces = np.moveaxis(asked.solution.scene.reactions(t, q, qd), 1, 0)
    axes = asked.several_axes((len(forces),), "one for each joint")
    theme = theme_of(axes[0])
    panels: dict[str, Curves] = {}
    for i, force in enumerate(forces):
        x, y = force.T
        parts = {"x": x, "y, downwards": y, "$|F|$": np.hypot(x, y)}
        panels[f"${force_name(i, i + 1)}$ (N)"] = in_colors(parts, theme, ["$|F|$"])
    return draw_curves(asked, axes, t, panels)


def draw_energy(asked: Request) -> list[Artist]:
    """Draw kinetic, potential and total energy, J, and below them the ledger and its residual.

    A single axes has the energies alone.
    """
    curve = curve_of(asked.solution)
    energy = curve.energy()
    parts = {"kinetic": energy.kinetic, "potential": energy.potential, "total": energy.total}
    panels = {"energy (J)": [*parts]}
    if energy.ledger is not None:
        losses = energy.ledger.losses
        booked = {f"{x} (lost)" if x in losses else x: y for x, y in energy.ledger.items()}
        works = [name for name in booked if name != "residual"]
        panels |= {"work, loss (J)": works} if works else {}
        panels["residual (J)"] = ["residual"]
        parts |= booked
    which = "for the energies, the ledger and its residual"
    axes = asked.several_axes((1, len(panels)), which, last=0.6)
    curves = in_colors(parts, theme_of(axes[0]), ("total", "residual"))
    shown = {label: {name: curves[name] for name in names} for label, names in panels.items()}
    return draw_curves(asked, axes, curve.t, shown)


def force_name(first: int, second: int) -> str:
    """Return the name in LaTeX of the force that a link exerts on another; 0 is the ground."""
    comma = "," if max(first, second) > 9 else ""
    return f"F_{{{first}{comma}{second}}}"


def in_colors(parts: dict[str, Floats], theme: Theme, sums: Sequence[str]) -> Curves:
    """Return curves in the colours of parts, but in ink what they make up."""
    colors = cycle(theme.parts)
    return {name: (x, theme.ink if name in sums else next(colors)) for name, x in parts.items()}


def _draw_links(
    asked: Request, t: Floats, values: Floats, symbol: str, unit: str, least_span: float = 0.0
) -> list[Artist]:
    """Draw a number of each link, (k, n), each on its own axes or all on one."""
    axes = asked.several_axes((1, values.shape[1]), "one for each link")
    theme = theme_of(axes[0])
    curves = {f"${symbol}_{{{i + 1}}}$": (x, theme.link(i)) for i, x in enumerate(values.T)}
    panels = {f"${symbol}$ ({unit})": curves}
    if len(axes) == len(curves):
        panels = {f"{name} ({unit})": {name: x} for name, x in curves.items()}
    return draw_curves(asked, axes, t, panels, least_span)


def draw_curves(
    asked: Request,
    axes: Sequence[Axes],
    t: Floats,
    panels: dict[str, Curves],
    least_span: float = 0.0,
) -> list[Artist]:
    """Draw panels over time, each on its axes, as many as there are; a legend names each curve.

    It leaves out what the axes above name; a curve that its axes name is called by its run alone.
    """
    lines: list[Artist] = []
    known: set[tuple[str, str]] = set()
    for axis, (y_label, curves) in zip(axes, panels.items(), strict=False):
        dashes = DASHES[len(axis.lines) // len(curves) % len(DASHES)]
        for name, (values, color) in curves.items():
            is_told = (name, color) in known
            called = asked.name_of(name)
            if y_label.startswith(name):
                is_told, called = asked.label is None, asked.label or name
            known.add((name, color))
            ours = {"linestyle": dashes, "marker": point_style(t), "color": color}
            ours["label"] = f"_{called}" if is_told else called
            lines += axis.plot(t, values, **(ours | asked.properties))
        _dress(axis, y_label, least_span)
    asked.shade(axes)
    for axis, curves in zip(axes, panels.values(), strict=False):
        legend_above(axis, columns=len(curves) if len(curves) > 1 else 3)  # a row for each run
    return lines


def _dress(axis: Axes, y_label: str, least_span: float) -> None:
    """Name the axes, and let rest look like rest: no offsets, no axis of last bits."""
    from matplotlib.ticker import ScalarFormatter

    if axis.xaxis.get_tick_params()["labelbottom"]:  # not where axes below have the same times
        axis.set_xlabel("t (s)")
    grid(axis)
    axis.margins(x=0)
    low, high = axis.get_ylim()
    if axis.get_autoscaley_on() and abs(high - low) < least_span:
        middle, half = (low + high) / 2, least_span / 2
        axis.set_ylim(middle - half, middle + half, auto=True)  # curves to come may need more
    for ticks in (axis.xaxis.get_major_formatter(), axis.yaxis.get_major_formatter()):
        if isinstance(ticks, ScalarFormatter):
            ticks.set_useOffset(False)
    power = 3 * floor(log10(max(-low, high)) / 3)
    if isinstance(ticks, ScalarFormatter):  # a prefix of the unit, no power of ten in a corner
        prefix = _PREFIXES.get(power, "")
        ticks.set_powerlimits((power, power) if prefix else (-5, 6))
        axis.yaxis.get_offset_text().set_visible(not prefix)
        y_label = y_label.replace("(", f"({prefix}")
    axis.set_ylabel(y_label)
