"""What a drawing of a mechanism is made of: rods, joints, ground, mass centres, arrows, angles.

Places are (x, y), m, x right and y down, as everywhere; `size` is the length by which the symbols
are scaled, m. Where a name goes is chosen so that it is clear of what meets there.
"""

from __future__ import annotations

from collections.abc import Iterable
from contextlib import AbstractContextManager
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pendcore.arguments import Floats

if TYPE_CHECKING:
    from matplotlib.axes import Axes

BLACK, STEEL = "#1a1a1a", "#d5dde5"
REACTION, WEIGHT, COUPLE, ANGLE = "#b3261e", "#1f5fa8", "#7a4a9e", "#2e6b3f"

_FONT: Any = {
    "mathtext.fontset": "stix",
    "font.family": "STIXGeneral",
    "font.size": 11,
    "axes.titlesize": 11,
    "svg.hashsalt": "pendcore",
}


def lettering() -> AbstractContextManager[None]:
    """Within, figures are drawn with letters as in the equations, and saved the same every time."""
    import matplotlib as mpl

    return mpl.rc_context(_FONT)


class Sketch(NamedTuple):
    """Axes and the length that its symbols are scaled by, m."""

    axes: Axes
    size: float


def sketch(axes: Axes, size: float) -> Sketch:
    """Make axes a sheet to draw on: equal scales, y down, no frame."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.invert_yaxis()
    return Sketch(axes, size)


def direction(angle: float) -> Floats:
    """Return the unit vector at an angle from +x towards +y."""
    return np.array([np.cos(angle), np.sin(angle)])


def clear_direction(taken: Iterable[float], prefer: float = np.pi) -> Floats:
    """Return the direction that is farthest from all those taken (angles, rad)."""
    candidates = prefer + np.arange(24) * (np.pi / 12)
    away = np.array([np.abs(np.angle(np.exp(1j * (candidates - angle)))) for angle in taken])
    room = np.minimum(away.min(axis=0), 2.0) if len(away) else np.ones(24)
    return direction(float(candidates[np.argmax(room)]))


def name(on: Sketch, at: Floats, text: str, towards: Floats, distance: float = 0.07) -> None:
    """Write a name beside a place."""
    x, y = at + distance * on.size * np.asarray(towards)
    on.axes.text(x, y, text, ha="center", va="center", zorder=9)


def rod(on: Sketch, start: Floats, end: Floats) -> None:
    """Draw a link: a bar with round ends."""
    from matplotlib.patches import FancyBboxPatch
    from matplotlib.transforms import Affine2D

    half = 0.026 * on.size
    along = end - start
    length = float(np.hypot(*along))
    turned = Affine2D().rotate(float(np.arctan2(along[1], along[0]))).translate(*start)
    bar = FancyBboxPatch(
        (-half, -half), length + 2 * half, 2 * half, boxstyle=f"round,pad=0,rounding_size={half}",
        facecolor=STEEL, edgecolor=BLACK, linewidth=1.1, zorder=3,
    )  # fmt: skip
    bar.set_transform(turned + on.axes.transData)
    on.axes.add_patch(bar)
    on.axes.update_datalim(np.array([start, end]))


def pin(on: Sketch, at: Floats) -> None:
    """Draw a joint."""
    from matplotlib.patches import Circle

    on.axes.add_patch(
        Circle(tuple(at), 0.017 * on.size, facecolor="white", edgecolor=BLACK, lw=1.1, zorder=6)
    )


def ground(on: Sketch, at: Floats, *, above: bool = True) -> None:
    """Draw what the first joint is held by: a bracket on a hatched line, above it or below."""
    from matplotlib.patches import Polygon

    a, b = 0.05 * on.size, (0.09 if above else -0.09) * on.size
    x, y = at
    on.axes.add_patch(
        Polygon([(x, y), (x - a, y - b), (x + a, y - b)], facecolor="white", ec=BLACK, lw=1.1)
    )
    on.axes.plot([x - 2 * a, x + 2 * a], [y - b, y - b], color=BLACK, lw=1.4)
    for k in np.linspace(-1.75, 1.75, 8):
        on.axes.plot(
            [x + k * a, x + (k + 0.55) * a], [y - b, y - b - 0.39 * b], color=BLACK, lw=0.8
        )


def mass_center(on: Sketch, at: Floats) -> None:
    """Draw a mass centre: a disc in quarters."""
    from matplotlib.patches import Circle, Wedge

    radius = 0.022 * on.size
    on.axes.add_patch(Circle(tuple(at), radius, facecolor="white", ec=BLACK, lw=0.9, zorder=5))
    for first in (0, 180):
        on.axes.add_patch(Wedge(tuple(at), radius, first, first + 90, color=BLACK, zorder=5))


def arrow(
    on: Sketch,
    start: Floats,
    along: Floats,
    text: str = "",
    color: str = BLACK,
    *,
    arriving: bool = False,
    **how: Any,
) -> None:
    """Draw an arrow from a place (or arriving there), with its name at the free end."""
    if arriving:
        start = start - along
    end = start + along
    on.axes.annotate(
        "", xy=tuple(end), xytext=tuple(start), zorder=how.pop("zorder", 7),
        arrowprops={"arrowstyle": "-|>,head_width=0.22,head_length=0.5", "color": color, "lw": 1.5,
                    "shrinkA": 0, "shrinkB": 0, "mutation_scale": 13, **how},
    )  # fmt: skip
    on.axes.update_datalim(np.array([start, end]))
    if text:
        outwards = 0.055 * on.size * along / np.hypot(*along)
        x, y = start - outwards if arriving else end + outwards
        on.axes.text(x, y, text, color=color, ha="center", va="center", zorder=9)


def turning_arrow(
    on: Sketch, at: Floats, text: str, *, radius: float, span: tuple[float, float], color: str
) -> None:
    """Draw an arrow around a place, from one angle to another (rad), with its name outside."""
    angles = np.linspace(*span, 60)
    x, y = at[:, None] + radius * on.size * np.array([np.cos(angles), np.sin(angles)])
    on.axes.plot(x[:-2], y[:-2], color=color, lw=1.1, zorder=4)
    on.axes.annotate(
        "", xy=(x[-1], y[-1]), xytext=(x[-5], y[-5]), zorder=4,
        arrowprops={"arrowstyle": "-|>,head_width=0.18,head_length=0.4", "color": color, "lw": 1.1,
                    "shrinkA": 0, "shrinkB": 0, "mutation_scale": 11},
    )  # fmt: skip
    beside = at + (radius + 0.055) * on.size * direction(float(np.mean(span)))
    on.axes.text(beside[0], beside[1], text, color=color, ha="center", va="center", zorder=9)


def angle_from_x(on: Sketch, at: Floats, angle: float, text: str, radius: float) -> None:
    """Mark the angle of a link: a dashed line along +x, and an arc to the link if it shows."""
    reach = 0.3 * on.size
    x, y = at
    on.axes.plot([x, x + reach], [y, y], color=ANGLE, lw=0.9, ls=(0, (5, 3)), zorder=2)
    shown = float(np.angle(np.exp(1j * angle)))
    if abs(shown) < np.radians(8):
        name(on, at + np.array([0.6 * reach, 0.0]), text, np.array([0.0, 1.0]), 0.08)
        return
    turning_arrow(on, at, text, radius=radius, span=(0.0, shown), color=ANGLE)


def weight(on: Sketch, center: Floats, link: float, text: str, reach: float) -> None:
    """Draw a weight at a mass centre; where it lies along the link its name stands beside it.

    `link` is the angle of the link, rad.
    """
    down = np.array([0.0, reach * on.size])
    on_the_link = abs(np.cos(link)) < 0.35
    arrow(on, center, down, "" if on_the_link else text, WEIGHT)
    if on_the_link:
        x, y = center + 0.8 * down - np.array([0.05 * on.size, 0.0])
        on.axes.text(x, y, text, color=WEIGHT, ha="right", va="center", zorder=9)
