"""Figures in a plane: the tip's path, the phase portrait, a Poincare section."""

from __future__ import annotations

import re
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.messages import Floats, whole_number
from pendcore.plotting.axes import Request, grid, legend_above, one_axes, point_style
from pendcore.plotting.curve import curve_of
from pendcore.plotting.style import DASHES, as_drawn, theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_SIZE = (5.4, 5.4)
"""inches"""
_GID = "a curve of a run"
"""Marks the lines by which dashes and colours are counted."""


def draw_path(asked: Request) -> list[Artist]:
    """Draw the path of the tip, m, and the chain: pale at the start, in its colour at the end."""
    t, q, _, _ = curve_of(asked.solution)
    places = asked.solution.scene.positions(t, q)
    axis = one_axes(asked.ax, _fitting(places), asked.new_figure)
    theme, count = theme_of(axis), _count(axis)
    color = theme.run(count) if count else theme.link(q.shape[1] - 1)
    hidden = "_" * bool(count or asked.label)
    for pose, shade, name in ((places[0], theme.lost, "start"), (places[-1], color, "end")):
        how: dict[str, Any] = {"color": shade, "label": f"{hidden}{name}", "zorder": 2.5}
        axis.plot(*pose.T, "o-", linewidth=2.0, markersize=4, **how)
    ours = {"color": color, "label": asked.label or f"{hidden}tip"}
    lines = _draw(axis, t, places[:, -1], asked, ours)
    # New axes are as large as what is drawn; others show more of the plane.
    axis.set_aspect("equal", adjustable="box" if asked.ax is None else "datalim")
    axis.yaxis.set_inverted(True)
    _name(axis, "x (m)", "y (m), downwards")
    return lines


def draw_phase(asked: Request) -> list[Artist]:
    """Draw the rate of each link (rad/s) over its angle (rad), each on its own axes or on one."""
    t, q, qd, _ = curve_of(asked.solution)
    n = q.shape[1]
    axes = asked.several_axes((1, n), "one for each link", columns=3)
    lines: list[Artist] = []
    is_apart = len(axes) == n
    for i in range(n):
        axis, index = (axes[i], f"_{{{i + 1}}}") if is_apart else (axes[0], "")
        dashes = DASHES[_count(axis) * len(axes) // n % len(DASHES)]
        name = f"link {i + 1}"
        called = asked.label or f"_{name}" if is_apart else asked.name_of(name)
        ours = {"color": theme_of(axis).link(i), "linestyle": dashes, "label": called}
        lines += _draw(axis, t, np.stack([q[:, i], qd[:, i]], axis=1), asked, ours)
        _name(axis, f"$q{index}$ (rad)", rf"$\dot q{index}$ (rad/s)")
    return lines


def draw_section(asked: Request) -> list[Artist]:
    """Draw a link's rate (rad/s) over its angle (rad, within a turn) where an event happened."""
    events = asked.solution.events
    if not events:
        raise ValueError(
            "what = 'section': this run looked for no event: give simulate(..., "
            "events=[pc.events.LinkAngle(1, np.pi / 2, direction=1)]), say"
        )
    event = _within("event", asked.event, 0, len(events) - 1)
    found, wanted = events[event], asked.solution.events_asked_for()[event]
    angles = (found.q + np.pi) % (2 * np.pi) - np.pi
    usual = _moving(angles) if asked.link is None else asked.link
    link = _within("link", usual, 1, angles.shape[1])
    axis = one_axes(asked.ax, _SIZE, asked.new_figure)
    in_few_digits = re.sub(r"\d+\.\d+", lambda number: f"{float(number[0]):.4g}", repr(wanted))
    happened = as_drawn(f"a point at each\n{wanted.name or in_few_digits}")
    size = 3.0 if len(found) > 50 else 6.0
    ours: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": size}
    ours |= {"color": theme_of(axis).link(link - 1), "label": asked.label or happened}
    lines = axis.plot(angles[:, link - 1], found.qd[:, link - 1], **{**ours, **asked.properties})
    axis.set_xlim(-np.pi, np.pi)
    _name(axis, f"$q_{{{link}}}$ (rad)", rf"$\dot q_{{{link}}}$ (rad/s)")
    return [*lines]


def _count(axis: Axes) -> int:
    """Return how many curves of runs are on the axes already."""
    return sum(line.get_gid() == _GID for line in axis.lines)


def _moving(angles: Floats) -> int:
    """Return the first link whose angle is not the same at every event, or 1."""
    spans = np.ptp(angles, axis=0) if len(angles) else np.zeros(1)
    return int(np.argmax(spans > 1e-6)) + 1


def _fitting(places: Floats) -> tuple[float, float]:
    """Return the size of a figure, inches, into which places (..., 2), m, fit to scale."""
    width, height = np.ptp(places.reshape(-1, 2), axis=0)
    across, down = _SIZE[0] - 0.8, float(np.clip(height / max(width, 1e-300), 0.3, 1.3))
    return _SIZE[0], across * down + 0.9


def _draw(
    axis: Axes, t: Floats, points: Floats, asked: Request, ours: dict[str, Any]
) -> list[Artist]:
    """Draw a curve (k, 2), pale where it is past the horizon; its name says until when."""
    how = {"marker": point_style(t), "linewidth": 1.0, **ours, **asked.properties}
    last = t[-1] if asked.valid_until is None else asked.valid_until
    right = t <= last if t[-1] >= t[0] else t >= last
    lines = axis.plot(*points[right].T, gid=_GID, **how)
    if not right.all():
        past = points[max(int(right.sum()) - 1, 0) :]
        known = {line.get_label() for line in axis.lines}
        said = asked.after()
        pale: dict[str, Any] = {"color": theme_of(axis).lost, "linewidth": 0.8, "zorder": 1}
        axis.plot(*past.T, label="_" if said in known else said, **pale)
    return [*lines]


def _within(name: str, given: int | None, least: int, most: int) -> int:
    """Return a number as it was given, or the least; ValueError if it is out of range."""
    value = least if given is None else whole_number(name, given)
    if not least <= value <= most:
        raise ValueError(f"{name} = {value}: must be {least} to {most}")
    return value


def _name(axis: Axes, x_label: str, y_label: str) -> None:
    axis.set(xlabel=x_label, ylabel=y_label)
    grid(axis)
    legend_above(axis)
