"""Figures in a plane: the tip's path, the phase portrait, a Poincare section."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.messages import Floats, whole_number
from pendcore.plotting.axes import Request, in_plane, point_style
from pendcore.plotting.curve import curve_of
from pendcore.plotting.style import COLORS, DASHES, PALE

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_SIZE = (5.4, 5.4)
"""inches"""


def draw_path(asked: Request) -> list[Artist]:
    """Draw the path of the tip, m, with the chain at the start and at the end."""
    axis = asked.one_axes(_SIZE)
    t, q, _, _ = curve_of(asked.solution)
    places = asked.solution.scene.positions(t, q)
    color = COLORS[len(axis.lines) // 3 % len(COLORS)]
    for pose, shade in ((places[0], "0.7"), (places[-1], "0.2")):
        axis.plot(*pose.T, "o-", color=shade, linewidth=1.2, markersize=3, zorder=1.5)
    ours = {"color": color, "label": asked.label or "tip"}
    lines = _draw(axis, t, places[:, -1], asked, ours)
    in_plane(axis)
    if asked.label is not None:
        axis.legend()
    return lines


def draw_phase(asked: Request) -> list[Artist]:
    """Draw the rate of each link (rad/s) over its angle (rad)."""
    axis = asked.one_axes(_SIZE)
    t, q, qd, _ = curve_of(asked.solution)
    dashes = DASHES[len(axis.lines) // q.shape[1] % len(DASHES)]
    lines: list[Artist] = []
    for i, curve in enumerate(np.stack([q, qd], axis=-1).swapaxes(0, 1)):
        color, name = COLORS[i % len(COLORS)], asked.name_of(f"link {i + 1}")
        lines += _draw(axis, t, curve, asked, {"color": color, "linestyle": dashes, "label": name})
    _name_phase(axis, "q", "qd")
    axis.legend()
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
    link = _within("link", asked.link, 1, len(asked.solution.scene.links))
    axis = asked.one_axes(_SIZE)
    found = events[event]
    angle = (found.q[:, link - 1] + np.pi) % (2 * np.pi) - np.pi
    ours: dict[str, Any] = {"linestyle": "", "marker": ".", "markersize": 2.5, "color": COLORS[0]}
    ours = {**ours, "label": asked.label, **asked.properties}
    lines = axis.plot(angle, found.qd[:, link - 1], **ours)
    _name_phase(axis, f"q{link}", f"qd{link}")
    axis.set_xlim(-np.pi, np.pi)
    if asked.label is not None:
        axis.legend()
    return [*lines]


def _draw(
    axis: Axes, t: Floats, points: Floats, asked: Request, ours: dict[str, Any]
) -> list[Artist]:
    """Draw a curve (k, 2), pale where it is past the horizon."""
    how = {"marker": point_style(t), "linewidth": 1.0, **ours, **asked.properties}
    last = t[-1] if asked.valid_until is None else asked.valid_until
    right = t <= last if t[-1] >= t[0] else t >= last
    lines = axis.plot(*points[right].T, **how)
    if not right.all():
        axis.plot(*points[max(int(right.sum()) - 1, 0) :].T, **PALE)
    return [*lines]


def _within(name: str, given: int | None, least: int, most: int) -> int:
    """Return a number as it was given, or the least; ValueError if it is out of range."""
    value = least if given is None else whole_number(name, given)
    if not least <= value <= most:
        raise ValueError(f"{name} = {value}: must be {least} to {most}")
    return value


def _name_phase(axis: Axes, angle: str, rate: str) -> None:
    axis.set_xlabel(f"{angle} (rad)")
    axis.set_ylabel(f"{rate} (rad/s)")
    axis.grid(True, alpha=0.4)
