"""Figures in a plane: the tip's path, the phase portrait, a Poincare section."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore._figures.axes import (
    COLORS,
    STYLES,
    NewFigure,
    in_plane,
    one_axes,
    point_style,
)
from pendcore._messages.arguments import Floats, whole_number
from pendcore._run.curve import curve_of
from pendcore._run.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.lines import Line2D

_SIZE = (5.4, 5.4)
"""inches"""
_LOST: dict[str, Any] = {"color": "0.75", "linewidth": 0.8, "zorder": 1}
"""How a curve looks past the horizon."""


def draw_path(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    label: str | None,
    valid_until: float | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw the path of the tip, m, with the chain at the start and at the end."""
    axis = one_axes(ax, new_figure, _SIZE)
    t, states, _ = curve_of(solution)
    places = solution.scene._compiled.positions(t, states[:, : len(solution.scene.links)])
    count = len(axis.lines)
    for pose, shade in ((places[0], "0.7"), (places[-1], "0.2")):
        axis.plot(*pose.T, "o-", color=shade, linewidth=1.2, markersize=3, zorder=1.5)
    tip = places[:, -1]
    ours: dict[str, Any] = {
        "color": COLORS[count // 3 % len(COLORS)],
        "linewidth": 1.0,
        "label": label or "tip",
    }
    lines = _curve(axis, t, tip, valid_until, ours | given)
    in_plane(axis)
    if label is not None:
        axis.legend()
    return lines


def draw_phase(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    label: str | None,
    valid_until: float | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw the rate of each link (rad/s) over its angle (rad)."""
    axis = one_axes(ax, new_figure, _SIZE)
    n = len(solution.scene.links)
    t, states, _ = curve_of(solution)
    lines = []
    style = STYLES[len(axis.lines) // n % len(STYLES)]
    for i in range(n):
        name = f"link {i + 1}" if label is None else f"link {i + 1}, {label}"
        ours: dict[str, Any] = {
            "color": COLORS[i % len(COLORS)],
            "linestyle": style,
            "linewidth": 1.0,
            "label": name,
        }
        curve = states[:, [i, n + i]]
        lines += _curve(axis, t, curve, valid_until, ours | given)
    _name_phase(axis, "q", "qd")
    axis.legend()
    return lines


def draw_section(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    label: str | None,
    event: int,
    link: int,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw a link's rate (rad/s) over its angle (rad, within a turn) where an event happened."""
    n = len(solution.scene.links)
    if not solution.events:
        raise ValueError(
            "what = 'section': this run looked for no event: give simulate(..., "
            "events=[pc.events.LinkAngle(1, np.pi / 2, direction=1)]), say"
        )
    number = whole_number("event", event)
    if not 0 <= number < len(solution.events):
        raise ValueError(f"event = {number}: must be 0 to {len(solution.events) - 1}")
    which = whole_number("link", link)
    if not 1 <= which <= n:
        raise ValueError(f"link = {which}: must be 1 to {n}")
    found = solution.events[number]
    axis = one_axes(ax, new_figure, _SIZE)
    turn = 2 * np.pi
    angle = (found.q[:, which - 1] + np.pi) % turn - np.pi
    ours: dict[str, Any] = {
        "linestyle": "",
        "marker": ".",
        "markersize": 2.5,
        "color": COLORS[0],
        "label": label,
    }
    lines = axis.plot(angle, found.qd[:, which - 1], **(ours | given))
    _name_phase(axis, f"q{which}", f"qd{which}")
    axis.set_xlim(-np.pi, np.pi)
    if label is not None:
        axis.legend()
    return lines


def _curve(
    axis: Axes,
    t: Floats,
    points: Floats,
    valid_until: float | None,
    given: dict[str, Any],
) -> list[Line2D]:
    """Draw a curve (k, 2), pale where it is past the horizon."""
    how: dict[str, Any] = {"marker": point_style(t), **given}
    if valid_until is None:
        return axis.plot(*points.T, **how)
    forward = t[-1] >= t[0]
    right = t <= valid_until if forward else t >= valid_until
    lines = axis.plot(*points[right].T, **how)
    if not right.all():
        axis.plot(*points[max(int(right.sum()) - 1, 0) :].T, **_LOST)
    return lines


def _name_phase(axis: Axes, angle: str, rate: str) -> None:
    axis.set_xlabel(f"{angle} (rad)")
    axis.set_ylabel(f"{rate} (rad/s)")
    axis.grid(True, alpha=0.4)
