"""What a drawing of a mechanism is made of: rods, joints, ground, mass centres, arrows, angles.

Places are (x, y), m, x right and y down, as everywhere; `size` is the length by which the symbols
are scaled, m. Names are placed last, where they are clear of all that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.derive.report.labels import Label, place

if TYPE_CHECKING:
    from pathlib import Path

    import numpy.typing as npt
    from matplotlib.axes import Axes

    from pendcore.derive.document import Drawing

    Floats = npt.NDArray[np.float64]

BLACK, STEEL = "#1a1a1a", "#d5dde5"
REACTION, WEIGHT, COUPLE, ANGLE = "#b3261e", "#1f5fa8", "#7a4a9e", "#2e6b3f"
LOAD = "#a35a00"

MARGIN = 36.0
"""The margin around a drawing for the names at its border, points of print."""

_FONT: Any = {
    "mathtext.fontset": "stix",
    "font.family": "STIXGeneral",
    "font.size": 11,
    "axes.titlesize": 11,
    "svg.hashsalt": "pendcore",
}


def lettering() -> AbstractContextManager[None]:
    """Draw figures with the letters of the equations, and save them the same every time."""
    import matplotlib as mpl

    return mpl.rc_context(_FONT)


def save(drawing: Drawing, path: Path) -> None:
    """Write a picture into a file, of the kind that its suffix says, the same every time."""
    dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}.get(path.suffix)
    with lettering():
        drawing.figure.draw_without_rendering()
        drawing.figure.set_layout_engine("none")  # every picture has the first one's layout
        drawing.figure.savefig(path, dpi=150, metadata=dates)


@dataclass(slots=True)
class Sketch:
    """A sheet to draw on.

    Attributes
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    size : float
        The length by which symbols are scaled, m.
    drawn : list of (ndarray (k, 2), float)
        Points of all lines, and half the width of each line, m: no name can be there.
    labels : list of Label
        Names that `finish` places.
    """

    axes: Axes
    size: float
    drawn: list[tuple[Floats, float]] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)

    def line(self, start: Floats, end: Floats, half: float = 0.0) -> None:
        """Remember that a straight line is drawn; ``half`` is half its width, m."""
        self.drawn.append((np.linspace(start, end, 60), half))


def sketch(axes: Axes, size: float) -> Sketch:
    """Make axes a sheet to draw on: equal scales, y down, no frame."""
    axes.set_aspect("equal")
    axes.set_axis_off()
    axes.invert_yaxis()
    return Sketch(axes, size)


def finish(on: Sketch, *, above: float = 0.0, shrink: bool = False) -> None:
    """Fit a drawing into its axes with a margin for names, and place the names.

    `above` is the height left free at the top, points of print. With `shrink` the figure, which has
    no other axes, becomes no larger than the drawing.
    """
    points = np.vstack([points for points, _ in on.drawn])
    low, high = points.min(axis=0), points.max(axis=0)
    middle, span = (low + high) / 2, np.maximum(high - low, 0.4 * on.size)
    figure = on.axes.get_figure(root=True)
    assert figure is not None
    margin = np.array([2 * MARGIN, 2 * MARGIN + above])
    sheet = np.multiply(on.axes.get_position(original=True).size, figure.get_size_inches()) * 72.0
    scale = float(((sheet - margin) / span).min())
    if shrink:
        sheet = span * scale + margin
        figure.set_size_inches(*(sheet / 72.0))
    x, y = sheet / scale / 2
    top = above / scale / 2
    on.axes.set_xlim(middle[0] - x, middle[0] + x)
    on.axes.set_ylim(middle[1] + y - top, middle[1] - y - top)
    on.axes.apply_aspect()
    place(on.axes, on.labels, on.drawn)


def direction(angle: float) -> Floats:
    """Return the unit vector at an angle from +x towards +y."""
    return np.array([np.cos(angle), np.sin(angle)])


def clear_direction(taken: Iterable[float], prefer: float = np.pi) -> Floats:
    """Return the direction that is farthest from all those taken (angles, rad)."""
    candidates = prefer + np.arange(24) * (np.pi / 12)
    away = np.array([np.abs(np.angle(np.exp(1j * (candidates - angle)))) for angle in taken])
    room = np.minimum(away.min(axis=0), 2.0) if len(away) else np.ones(24)
    return direction(float(candidates[np.argmax(room)]))


def name(
    on: Sketch, at: Floats | Sequence[Floats], text: str, towards: Floats | None = None, **how: Any
) -> None:
    """Name a place, or the clearest of several; `finish` finds where the name goes beside it."""
    places = np.atleast_2d(np.asarray(at, dtype=float))
    on.labels.append(Label(text, places, np.zeros(2) if towards is None else towards, how))


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
    on.line(start, end, half)


def pin(on: Sketch, at: Floats) -> None:
    """Draw a joint."""
    from matplotlib.patches import Circle

    on.axes.add_patch(
        Circle(tuple(at), 0.017 * on.size, facecolor="white", edgecolor=BLACK, lw=1.1, zorder=6)
    )


def ground(on: Sketch, at: Floats, *, above: bool = True) -> None:
    """Draw what holds the first joint: a bracket on a hatched line, above or below the joint."""
    from matplotlib.patches import Polygon

    a, b = 0.05 * on.size, (0.09 if above else -0.09) * on.size
    x, y = at
    base = np.array([[x - 2 * a, y - b], [x + 2 * a, y - b]])
    on.line(base[0], base[1])
    on.line(base[0] - [0.0, 0.39 * b], base[1] + [0.1 * a, -0.39 * b])
    for side in (-a, a):
        on.line(at, at + np.array([side, -b]))
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
    on.drawn.append((np.atleast_2d(at), radius))
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
    on.line(start, end)
    head = end - 0.04 * on.size * along / np.hypot(*along)
    on.drawn.append((head[None], 0.012 * on.size))
    if text:
        free = start if arriving else end
        name(on, [free, (start + end) / 2], text, -along if arriving else along, color=color)


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
    on.drawn.append((np.stack([x, y], axis=1), 0.006 * on.size))
    places = np.stack([x, y], axis=1)[[30, 20, 40, 10]]
    name(on, places, text, direction(float(np.mean(span))), color=color)


def angle_from_x(on: Sketch, at: Floats, angle: float, text: str, radius: float) -> None:
    """Mark the angle of a link: a dashed line along +x, and an arc unless the angle is small."""
    reach = 0.3 * on.size
    x, y = at
    on.axes.plot([x, x + reach], [y, y], color=ANGLE, lw=0.9, ls=(0, (5, 3)), zorder=2)
    on.line(at, at + np.array([reach, 0.0]))
    shown = float(np.angle(np.exp(1j * angle)))
    if abs(shown) < np.radians(8):
        name(on, at + np.array([0.6 * reach, 0.0]), text, np.array([0.0, -1.0]), color=ANGLE)
        return
    turning_arrow(on, at, text, radius=radius, span=(0.0, shown), color=ANGLE)


def weight(on: Sketch, center: Floats, text: str, reach: float) -> None:
    """Draw a weight at a mass centre."""
    arrow(on, center, np.array([0.0, reach * on.size]), text, WEIGHT)
