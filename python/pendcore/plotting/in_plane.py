"""Figures in a plane: the tip's path, the phase portrait, a Poincare section."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.events import Event, LinkAngle
from pendcore.messages import Floats, whole_number
from pendcore.plotting.axes import Request, grid, legend_above, named, one_axes, point_style
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
    width, height = np.ptp(places.reshape(-1, 2), axis=0)  # m, which are to fit to scale
    tall = float(np.clip(height / max(width, 1e-300), 0.3, 1.3)) * (_SIZE[0] - 0.8) + 1.1
    axis = one_axes(asked.ax, (_SIZE[0], tall), asked.new_figure)
    theme, count = theme_of(axis), _count(axis)
    color = theme.run(count) if count else theme.link(q.shape[1] - 1)
    hidden = "_" * bool(count or asked.label)
    is_right = abs(t[-1] - t[0]) <= abs(asked.until - t[0])
    end = ("o-", color) if is_right else ("o:", theme.lost)
    poses = (places[0], "start", "o-", theme.lost), (places[-1], "end", *end)
    for pose, name, style, shade in poses:
        how: dict[str, Any] = {"color": shade, "label": f"{hidden}{name}", "zorder": 2.5}
        axis.plot(*pose.T, style, linewidth=2.0, markersize=4, **how)
    ours = {"color": color, "label": asked.label or f"{hidden}tip"}
    lines = _draw(axis, t, places[:, -1], asked, ours)
    axis.set_aspect("equal", adjustable="datalim")
    axis.yaxis.set_inverted(True)
    _name(axis, "x (m)", "y (m), downwards")
    return lines


def draw_phase(asked: Request) -> list[Artist]:
    """Draw the rate of each link (rad/s) over its angle (rad; full turns within one turn)."""
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
        points = np.stack([q[:, i], qd[:, i]], axis=1)
        if np.ptp(q[:, i]) > 2 * np.pi:
            points[:, 0] = _within_a_turn(q[:, i])
            jumps = np.abs(np.diff(points[:, 0], prepend=points[0, 0])) > np.pi
            points[jumps] = np.nan  # where the curve leaves on one side and enters on the other
        lines += _draw(axis, t, points, asked, ours)
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
    angles = _within_a_turn(found.q)
    spans = np.ptp(angles, axis=0) if len(angles) else np.zeros(1)
    moving = int(np.argmax(spans > 1e-6)) + 1  # the first whose angle is not always the same, or 1
    link = _within("link", moving if asked.link is None else asked.link, 1, angles.shape[1])
    axis = one_axes(asked.ax, _SIZE, asked.new_figure)
    size = 6.0 * (50 / max(len(found), 50)) ** 0.35  # the more there are, the smaller they are
    marks: dict[str, Any] = {"marker": ".", "markersize": size}
    ours = {"color": theme_of(axis).link(link - 1), "label": asked.label or _each_time(wanted)}
    points = np.stack([angles[:, link - 1], found.qd[:, link - 1]], axis=1)
    lines = _draw(axis, found.t, points, asked, ours, {"linestyle": "", **marks})
    _name(axis, f"$q_{{{link}}}$ (rad)", rf"$\dot q_{{{link}}}$ (rad/s)")
    return lines


def _each_time(event: Event) -> str:
    """Say when an event happens, by its name if it has one."""
    if event.name is None and isinstance(event, LinkAngle):
        passes = ("falls past", "passes", "grows past")[event.direction + 1]
        return f"each time that $q_{{{event.link}}}$ {passes} {np.rad2deg(event.value):.4g} deg"
    return as_drawn(f"at each event: {event.name or event.kind.replace('_', ' ')}")


def _within_a_turn(angles: Floats) -> Floats:
    """Return angles, rad, from upright to upright: swings about hanging, pi/2, stay in one."""
    return (angles + np.pi / 2) % (2 * np.pi) - np.pi / 2


def _count(axis: Axes) -> int:
    """Return how many curves of runs are on the axes already."""
    return sum(line.get_gid() == _GID for line in axis.lines)


def _draw(
    axis: Axes,
    t: Floats,
    points: Floats,
    asked: Request,
    ours: dict[str, Any],
    marks: dict[str, Any] | None = None,
) -> list[Artist]:
    """Draw points (k, 2), pale where they are past the horizon; a name says until when.

    A curve joins them unless they are drawn as marks.
    """
    marks = marks or {}
    how = {"marker": point_style(t), "linewidth": 1.0, **marks, **ours, **asked.properties}
    count = int((np.abs(t - t[0]) <= abs(asked.until - t[0])).sum())
    lines = axis.plot(*points[:count].T, gid=_GID, **how)
    asked.say_right_to_its_end(axis)
    if count < len(t):
        said = "_" if asked.after() in named(axis) else asked.after()
        pale = {"color": theme_of(axis).lost, "linewidth": 0.8, "zorder": 1, **marks}
        first = count if marks else max(count - 1, 0)  # a curve goes on from where it was right
        axis.plot(*points[first:].T, label=said, **pale)
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
