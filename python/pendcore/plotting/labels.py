"""Where the names in a drawing go: each to the clearest of a few places beside what it names.

All lengths here are points of print, except in what is drawn: that is in the axes' own coordinates.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pendcore.messages import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

GAPS = np.array([4.0, 6.0, 9.0, 13.0, 18.0, 24.0, 31.0])
"""Gaps between a name and what it names; the first is half a letter."""
AROUND = 24
"""Directions in which a name is tried."""
CLEAR = 6.0
"""Room around a name beyond which more is no better."""
BLOCKED = 1000.0
"""The cost of lying on something else, which is larger than all other costs."""


class Label(NamedTuple):
    """A name, with LaTeX between dollars, and the points that it may stand beside, m.

    The best point is the first; ``towards`` is the side that is tried first, y down.
    """

    text: str
    places: Floats
    towards: Floats
    style: dict[str, Any]


def place(axes: Axes, labels: Sequence[Label], drawn: Sequence[tuple[Floats, float]]) -> None:
    """Write names where they are clear of each other and of what is drawn.

    The axes have their final limits, y down. The names with the least choice of place come first.
    ``drawn`` are points of lines, and half the width of each line, m.
    """
    to_points = 72.0 / axes.figure.dpi
    sheet = axes.get_window_extent().get_points() * to_points
    scale = float(np.ptp(sheet[:, 0]) / np.ptp(axes.get_xlim()))
    spots = np.vstack([axes.transData.transform(points) for points, _ in drawn]) * to_points
    radii = np.concatenate([np.full(len(points), radius * scale) for points, radius in drawn])
    taken: list[tuple[Floats, Floats]] = []  # centre and half the size of a box
    for label in labels:
        style: dict[str, Any] = {"ha": "center", "va": "center", "zorder": 9} | label.style
        text = axes.text(label.places[0, 0], label.places[0, 1], label.text, **style)
        box = text.get_window_extent()
        half = np.array([box.width, box.height]) * to_points / 2 + 4.0 * ("bbox" in style)
        anchors = axes.transData.transform(label.places) * to_points
        found, worth = _candidates(anchors, label.towards * np.array([1.0, -1.0]), half)
        reach = half + CLEAR + radii[:, None]  # what lies farther away takes no room
        near = (spots > found.min(axis=0) - reach) & (spots < found.max(axis=0) + reach)
        here = near.all(axis=1)
        outside = np.maximum(np.abs(found[:, None] - spots[here]) - half, 0.0)
        room = np.hypot(*np.moveaxis(outside, -1, 0)) - radii[here]
        room = room.min(axis=1, initial=CLEAR)
        for center, extent in taken:
            apart = np.maximum(np.abs(found - center) - half - extent, 0.0)
            room = np.minimum(room, np.hypot(*apart.T))
        inside = (found - half > sheet[0]).all(axis=1) & (found + half < sheet[1]).all(axis=1)
        best = found[int(np.argmax(worth + 1.2 * room - BLOCKED * (~inside | (room < 1.5))))]
        x, y = axes.transData.inverted().transform(best / to_points)
        text.set_position((float(x), float(y)))
        taken.append((best, half))


def _candidates(anchors: Floats, towards: Floats, half: Floats) -> tuple[Floats, Floats]:
    """Return centres of a box around anchors, and their worth: more if near and as wished."""
    turns = np.arange(AROUND) * (2 * np.pi / AROUND)
    angles = np.arctan2(towards[1], towards[0]) + turns
    sides = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = 1.0 / np.maximum(np.abs(sides) / half, 1e-9).max(axis=1)  # to the border of the box
    found = anchors[:, None, None] + sides[:, None] * (reach[:, None] + GAPS)[..., None]
    worth = (2.0 * (np.cos(turns) - 1.0))[:, None] - 0.5 * GAPS
    worth = worth - 1.5 * np.arange(len(anchors))[:, None, None]
    return found.reshape(-1, 2), worth.reshape(-1)
