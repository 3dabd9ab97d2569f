"""Figures over time: angles, as in the textbook, rates, reactions, energy."""

from __future__ import annotations

from itertools import cycle
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from pendcore import Energy, Solution
from pendcore.messages import Floats
from pendcore.plotting.axes import Request, point_style
from pendcore.plotting.curve import curve_of
from pendcore.plotting.style import COLORS, DASHES, OUTSIDE, SUM

if TYPE_CHECKING:
    from collections.abc import Sequence

    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_LEAST_SPAN = 0.1
"""deg, the least span of the angle axis, so that rest does not look like its last bits."""


Curves: TypeAlias = "dict[str, tuple[Floats, dict[str, Any]]]"
"""The values of each curve, (k,), by its name, and how it is drawn."""


def draw_angles(asked: Request) -> list[Artist]:
    """Draw the angle of each link, deg."""
    curve = curve_of(asked.solution)
    return _draw_links(asked, curve.t, np.rad2deg(curve.q), "q", "deg", _LEAST_SPAN)


def draw_rates(asked: Request) -> list[Artist]:
    """Draw the rate of each link, rad/s."""
    curve = curve_of(asked.solution)
    return _draw_links(asked, curve.t, curve.qd, "qd", "rad/s")


def draw_reactions(asked: Request) -> list[Artist]:
    """Draw the force on each link at its joint, N: x, y (downwards) and size."""
    t, q, qd, _ = curve_of(asked.solution)
    scene, panels = asked.solution.scene, {}
    n = len(scene.links)
    for i, force in enumerate(np.moveaxis(scene.reactions(t, q, qd), 1, 0)):
        name = f"F_{i}{i + 1}" if n < 10 else f"F_{i},{i + 1}"
        x, y = force.T
        sizes = {f"|{name}|": np.hypot(x, y)}
        panels[f"{name} (N)"] = _colored({f"{name} x": x, f"{name} y": y}, sizes)
    axes = asked.stacked_axes((n,), "one for each joint")
    return _draw(asked, axes, t, panels, legend=OUTSIDE)


def draw_energy(asked: Request) -> list[Artist]:
    """Draw kinetic, potential and total energy, J, and below them the entries of the ledger."""
    curve = curve_of(asked.solution)
    energy = curve.energy()
    panels = _energies(energy)
    if energy.ledger is not None:
        losses = energy.ledger.losses
        booked = {f"{x} (lost)" if x in losses else x: y for x, y in energy.ledger.items()}
        panels["work and loss (J)"] = _colored(booked)
    which = "one for the energies and one for the ledger"
    axes = asked.stacked_axes((len(panels),), which)
    return _draw(asked, axes, curve.t, panels, legend=OUTSIDE)


def draw_energies(solution: Solution, axis: Axes) -> None:
    """Draw kinetic, potential and total energy, J, on one axes, whatever else there is."""
    curve = curve_of(solution)
    asked = Request(solution=solution)
    _draw(asked, [axis], curve.t, _energies(curve.energy()), legend=OUTSIDE)


def _energies(energy: Energy) -> dict[str, Curves]:
    parts = {"kinetic": energy.kinetic, "potential": energy.potential}
    return {"energy (J)": _colored(parts, {"total": energy.total})}


def _colored(parts: dict[str, Floats], sums: dict[str, Floats] | None = None) -> Curves:
    """Return curves in colours, and those that are made of them in grey."""
    colors = cycle(COLORS)
    curves: Curves = {name: (x, {"color": next(colors)}) for name, x in parts.items()}
    return curves | {name: (x, SUM) for name, x in (sums or {}).items()}


def _draw_links(
    asked: Request, t: Floats, values: Floats, symbol: str, unit: str, least_span: float = 0.0
) -> list[Artist]:
    """Draw a number of each link, (k, n), each on its own axes or all on one."""
    n = values.shape[1]
    axes = asked.stacked_axes((1, n), "one for each link")
    curves = _colored({f"{symbol}{i + 1}": x for i, x in enumerate(values.T)})
    is_apart = len(axes) == n
    panels = {f"{symbol} ({unit})": curves}
    if is_apart:
        panels = {f"{name} ({unit})": {name: x} for name, x in curves.items()}
    legend: dict[str, Any] | None = None if is_apart and asked.label is None else {}
    return _draw(asked, axes, t, panels, legend, is_apart=is_apart, least_span=least_span)


def _draw(
    asked: Request,
    axes: Sequence[Axes],
    t: Floats,
    panels: dict[str, Curves],
    legend: dict[str, Any] | None,
    *,
    is_apart: bool = False,
    least_span: float = 0.0,
) -> list[Artist]:
    """Draw each panel on its axes; the legend calls a curve that is apart by its solution alone."""
    lines: list[Artist] = []
    for axis, (y_label, curves) in zip(axes, panels.items(), strict=True):
        dashes = DASHES[len(axis.lines) // len(curves) % len(DASHES)]
        for name, (values, own) in curves.items():
            is_named = is_apart and asked.label is not None
            label = asked.label if is_named else asked.name_of(name)
            ours = {"linestyle": dashes, "marker": point_style(t), "label": label}
            lines += axis.plot(t, values, **(ours | own | asked.properties))
        axis.set_ylabel(y_label)
        if legend is not None:
            axis.legend(**legend)
        _dress(axis, least_span)
    asked.shade(axes)
    return lines


def _dress(axis: Axes, least_span: float) -> None:
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
