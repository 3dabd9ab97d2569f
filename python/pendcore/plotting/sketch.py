"""What a drawing of a mechanism is made of: rods, joints, ground, mass centres, arrows, angles.

Places are (x, y), m, x right and y down. Names are placed last, clear of all that is drawn.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.messages import Floats
from pendcore.plotting.labels import Label, place
from pendcore.plotting.style import Theme, theme_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MARGIN = 36.0
"""The margin around a drawing for the names at its border, points of print."""


@dataclass(slots=True)
class Sketch:
    """A sheet to draw on, with equal scales and y down; ``size`` scales the symbols, m.

    ``drawn`` are points of all lines, and half the width of each line, m: no name can be there.
    """

    axes: Axes
    size: float
    drawn: list[tuple[Floats, float]] = field(default_factory=list)
    labels: list[Label] = field(default_factory=list)
    theme: Theme = field(init=False)

    def __post_init__(self) -> None:
        self.theme = theme_of(self.axes)
        self.axes.set_aspect("equal")
        self.axes.set_axis_off()
        self.axes.invert_yaxis()

    def line(self, start: Floats, end: Floats, half: float = 0.0) -> None:
        """Remember that a straight line is drawn; ``half`` is half its width, m."""
        self.drawn.append((np.linspace(start, end, 60), half))

    def disc(self, at: Floats, radius: float, **how: Any) -> None:
        """Draw a disc; the radius is a share of the size."""
        from matplotlib.patches import Circle

        how = {"ec": self.theme.ink, "facecolor": self.theme.ground} | how
        self.axes.add_patch(Circle(tuple(at), radius * self.size, **how))
        self.drawn.append((np.atleast_2d(at), radius * self.size))

    def finish(self, *, above: float = 0.0, shrink: bool = False) -> None:
        """Fit a drawing into its axes with a margin for names, and place the names.

        `above` is the height left free at the top, points of print. With `shrink` the figure, which
        has no other axes, becomes no larger than the drawing.
        """
        points = np.vstack([points for points, _ in self.drawn])
        low, high = points.min(axis=0), points.max(axis=0)
        middle, span = (low + high) / 2, np.maximum(high - low, 0.4 * self.size)
        figure: Any = self.axes.get_figure(root=True)
        margin = np.array([2 * MARGIN, 2 * MARGIN + above])
        share = self.axes.get_position(original=True).size
        sheet = np.multiply(share, figure.get_size_inches()) * 72.0
        scale = float(((sheet - margin) / span).min())
        if shrink:
            sheet = span * scale + margin
            figure.set_size_inches(*(sheet / 72.0))
        x, y = sheet / scale / 2
        top = above / scale / 2
        self.axes.set_xlim(middle[0] - x, middle[0] + x)
        self.axes.set_ylim(middle[1] + y - top, middle[1] - y - top)
        place(self.axes, self.labels, self.drawn)

    def name(self, at: Floats | Sequence[Floats], text: str, towards: Floats, **how: Any) -> None:
        """Name a place, or the clearest of several; `finish` finds where the name goes."""
        places = np.atleast_2d(np.asarray(at, dtype=float))
        self.labels.append(Label(text, places, towards, how))

    def number(self, at: Floats | Sequence[Floats], link: int, towards: Floats) -> None:
        """Write the number of a link in a circle beside it."""
        circle = {"boxstyle": "circle,pad=0.22", "facecolor": self.theme.ground,
                  "edgecolor": self.theme.quiet, "lw": 0.7}  # fmt: skip
        self.name(at, str(link), towards, fontsize=9, bbox=circle)

    def rod(self, start: Floats, end: Floats) -> None:
        """Draw a link: a bar with round ends."""
        from matplotlib.patches import FancyBboxPatch
        from matplotlib.transforms import Affine2D

        half, (x, y) = 0.026 * self.size, end - start
        bar = FancyBboxPatch(
            (-half, -half), np.hypot(x, y) + 2 * half, 2 * half,
            boxstyle=f"round,pad=0,rounding_size={half}",
            facecolor=self.theme.line, edgecolor=self.theme.ink, linewidth=1.1, zorder=3,
        )  # fmt: skip
        turned = Affine2D().rotate(float(np.arctan2(y, x))).translate(*start)
        bar.set_transform(turned + self.axes.transData)
        self.axes.add_patch(bar)
        self.line(start, end, half)

    def pin(self, at: Floats) -> None:
        """Draw a joint."""
        self.disc(at, 0.017, lw=1.1, zorder=6)

    def ground(self, at: Floats, *, above: bool = True) -> None:
        """Draw what holds the first joint: a bracket on a hatched line, above it or below."""
        from matplotlib.patches import Polygon

        a, b = 0.05 * self.size, (0.09 if above else -0.09) * self.size
        corners = at + np.array([[0.0, 0.0], [-a, -b], [a, -b]])
        base, hatch = at + np.array([[-2 * a, -b], [2 * a, -b]]), np.array([0.55 * a, -0.39 * b])
        ink = self.theme.ink
        self.axes.add_patch(Polygon(corners, facecolor=self.theme.ground, ec=ink, lw=1.1))
        self.axes.plot(*base.T, color=ink, lw=1.4)
        for k in np.linspace(-1.75, 1.75, 8):
            start = at + np.array([k * a, -b])
            self.axes.plot(*np.array([start, start + hatch]).T, color=ink, lw=0.8)
        self.line(base[0], base[1])
        self.line(base[0] + hatch, base[1] + hatch)
        for corner in corners[1:]:
            self.line(at, corner)

    def mass_center(self, at: Floats) -> None:
        """Draw a mass centre: a disc in quarters."""
        from matplotlib.patches import Wedge

        self.disc(at, 0.022, lw=0.9, zorder=5)
        for first in (0, 180):
            how: dict[str, Any] = {"color": self.theme.ink, "zorder": 5}
            self.axes.add_patch(Wedge(tuple(at), 0.022 * self.size, first, first + 90, **how))

    def arrow(
        self,
        start: Floats,
        along: Floats,
        text: str = "",
        color: str | None = None,
        *,
        arriving: bool = False,
        zorder: int = 7,
        lw: float = 1.5,
    ) -> None:
        """Draw an arrow from a place (or arriving there), with its name at the free end."""
        color = color or self.theme.ink
        start = start - along if arriving else start
        end = start + along
        self._head(start, end, color, zorder, 13, lw)
        self.line(start, end)
        head = end - 0.04 * self.size * along / np.hypot(*along)
        self.drawn.append((head[None], 0.012 * self.size))
        if text:
            free, towards = (start, -along) if arriving else (end, along)
            self.name([free, (start + end) / 2], text, towards, color=color)

    def turning_arrow(
        self, at: Floats, text: str, *, radius: float, span: tuple[float, float], color: str
    ) -> None:
        """Draw an arrow around a place, from one angle to another (rad), with its name outside."""
        angles = np.linspace(*span, 60)
        points = at + radius * self.size * np.stack([np.cos(angles), np.sin(angles)], axis=1)
        self.axes.plot(*points[:-2].T, color=color, lw=1.1, zorder=4)
        self._head(points[-5], points[-1], color, 4, 11, 1.1)
        self.drawn.append((points, 0.006 * self.size))
        self.name(points[[30, 20, 40, 10]], text, direction(float(np.mean(span))), color=color)

    def couple(
        self, at: Floats, towards: Floats, text: str, radius: float = 0.13, sense: float = 1.0
    ) -> None:
        """Draw a couple beside a place, in the sense from x to y (1) or against it (-1)."""
        middle = float(np.arctan2(towards[1], towards[0]))
        span = middle - 0.7 * sense, middle + 0.7 * sense
        self.turning_arrow(at, text, radius=radius, span=span, color=self.theme.couple)

    def _head(
        self, start: Floats, end: Floats, color: str, zorder: int, size: int, lw: float
    ) -> None:
        how = {"arrowstyle": "-|>,head_width=0.2,head_length=0.5", "color": color, "lw": lw,
               "shrinkA": 0, "shrinkB": 0, "mutation_scale": size}  # fmt: skip
        self.axes.annotate("", xy=tuple(end), xytext=tuple(start), zorder=zorder, arrowprops=how)

    def angle_from_x(self, at: Floats, angle: float, text: str, radius: float) -> None:
        """Mark the angle of a link: a dashed line along +x, and an arc unless it is small."""
        reach, color = np.array([0.3 * self.size, 0.0]), self.theme.angle
        self.axes.plot(*np.array([at, at + reach]).T, color=color, lw=0.9, ls=(0, (5, 3)), zorder=2)
        self.line(at, at + reach)
        shown = float(np.angle(np.exp(1j * angle)))
        if abs(shown) < np.radians(8):
            self.name(at + 0.6 * reach, text, np.array([0.0, -1.0]), color=color)
            return
        self.turning_arrow(at, text, radius=radius, span=(0.0, shown), color=color)

    def weight(self, center: Floats, text: str, reach: float) -> None:
        """Draw a weight at a mass centre."""
        self.arrow(center, np.array([0.0, reach * self.size]), text, self.theme.weight)


def direction(angle: float) -> Floats:
    """Return the unit vector at an angle from +x towards +y."""
    return np.array([np.cos(angle), np.sin(angle)])


def clear_direction(taken: Iterable[float], prefer: float = np.pi) -> Floats:
    """Return the direction that is farthest from all those taken (angles, rad)."""
    candidates = prefer + np.arange(24) * (np.pi / 12)
    away = [np.abs(np.angle(np.exp(1j * (candidates - angle)))) for angle in taken]
    return direction(float(candidates[np.argmax(np.minimum(np.min(away, axis=0), 2.0))]))
