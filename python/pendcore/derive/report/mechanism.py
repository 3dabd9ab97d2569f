"""Fig. 1 of a report: the chain at its start, with frame, angles, mass centres and weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.derive.report import drawing
from pendcore.derive.report.drawing import Sketch, direction, name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from pendcore import Scene
    from pendcore.effects import Effect
    from pendcore.derive.report.drawing import Floats

COUPLES = {"viscous_joint", "torsional_spring", "motor"}
"""Kinds of effects that act by a couple in their joint."""

CIRCLE = {"boxstyle": "circle,pad=0.22", "facecolor": "white", "edgecolor": "0.3", "lw": 0.7}
"""The circle around the number of a link."""


def couples_of(scene: Scene) -> frozenset[int]:
    """Return the joints in which something acts by a couple."""
    return frozenset(getattr(e, "joint", 0) for e in scene.effects if e.kind in COUPLES)


def joints(scene: Scene, q: Sequence[float]) -> Floats:
    """Return the pivot, the joints and the tip, (n + 1, 2), m, with the pivot at the origin."""
    steps = [link.length * direction(angle) for link, angle in zip(scene.links, q, strict=True)]
    return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])


def mass_centers(scene: Scene, q: Sequence[float]) -> Floats:
    """Return the mass centres of the links, (n, 2), m."""
    along = [link.center * direction(angle) for link, angle in zip(scene.links, q, strict=True)]
    return joints(scene, q)[:-1] + np.array(along)


def mechanism(scene: Scene, q: Sequence[float], points: Sequence[str]) -> Figure:
    """Draw the chain at given angles, as in the textbook's Fig. 1.

    Parameters
    ----------
    scene : Scene
        The scene whose links and effects are drawn.
    q : sequence of float, (n,)
        Absolute angles, rad.
    points : sequence of str, (n + 1,)
        The names of the pivot, the joints and the tip, as LaTeX: A, B, D in the textbook.
    """
    from matplotlib.figure import Figure

    places, centers = joints(scene, q), mass_centers(scene, q)
    total = float(np.hypot(*np.ptp(np.vstack([places, centers]), axis=0)))
    size = max(total, 0.6 * sum(link.length for link in scene.links))
    figure = Figure(figsize=(5.6, 4.6))
    on = drawing.sketch(figure.add_axes((0.0, 0.0, 1.0, 1.0)), size)
    couples = couples_of(scene)
    _frame(on, scene, places)
    for i, angle in enumerate(q):
        start, end = places[i], places[i + 1]
        drawing.rod(on, start, end)
        drawing.mass_center(on, centers[i])
        drawing.weight(on, centers[i], rf"$\mathbf{{G}}_{{{i + 1}}}$", 0.16)
        reach = min(0.14, 0.3 * scene.links[i].length / size)
        drawing.angle_from_x(on, start, angle, rf"$q_{{{i + 1}}}$", reach)
        taken = [0.0, angle, angle / 2, q[i - 1] + np.pi if i else -np.pi / 2, np.pi / 2]
        if i + 1 in couples:
            _couple(on, start, i + 1, taken)
    _acting(on, scene.effects, places, q)
    for i, angle in enumerate(q):
        name(on, centers[i], f"$C_{{{i + 1}}}$", direction(angle - np.pi / 2))
    for i, place in enumerate(places):
        drawing.pin(on, place)
        along = [q[j] + turn for j, turn in ((i, 0.0), (i - 1, np.pi)) if 0 <= j < len(q)]
        name(on, place, f"${points[i]}$", drawing.clear_direction([*along, 0.0]))
    for i, angle in enumerate(q):
        parts = [places[i] + x * (places[i + 1] - places[i]) for x in (0.8, 0.7, 0.3, 0.9, 0.2)]
        name(on, parts, str(i + 1), direction(angle - np.pi / 2), fontsize=9, bbox=CIRCLE)
    drawing.finish(on, shrink=True)
    return figure


def _couple(on: Sketch, joint: Floats, number: int, taken: Sequence[float]) -> None:
    """Draw a couple around a joint, on the side that is farthest from what else is there."""
    aside = drawing.clear_direction(taken)
    middle = float(np.arctan2(aside[1], aside[0]))
    drawing.turning_arrow(
        on, joint, rf"$\tau_{{{number}}}$", radius=0.085,
        span=(middle - 0.7, middle + 0.7), color=drawing.COUPLE,
    )  # fmt: skip


def _frame(on: Sketch, scene: Scene, places: Floats) -> None:
    """Draw the ground, the axes with the origin in the pivot, and which way gravity pulls."""
    size, pivot = on.size, places[0]
    above = places[1, 1] >= -0.2 * size  # the bracket is where the first link is not
    drawing.ground(on, pivot, above=above)
    corner = pivot + size * np.array([[0.1, -0.09], [-0.1, -0.09]]) * [1.0, 1.0 if above else -1.0]
    name(on, corner, "$0$", np.array([1.0, 0.0]))
    for axis, text in enumerate(("$x$", "$y$")):
        in_the_way = np.abs(places[1:2, 1 - axis]).min() < 0.1 * size and places[1, axis] > 0
        reach = places[1, axis] + 0.25 * size if in_the_way else 0.52 * size
        along = reach * np.eye(2)[axis]
        drawing.arrow(on, pivot, along, text, zorder=2, lw=0.9)
    if scene.gravity:
        left = min(0.0, *places[:, 0]) - 0.28 * size
        down = np.array([0.0, 0.16 * size * np.sign(scene.gravity)])
        drawing.arrow(on, np.array([left, 0.14 * size]), down, "$g$", drawing.WEIGHT)


def _acting(on: Sketch, effects: Sequence[Effect], places: Floats, q: Sequence[float]) -> None:
    """Draw a payload and a moving pivot."""
    from matplotlib.patches import Circle

    kinds = {effect.kind for effect in effects}
    if "payload" in kinds:
        disc = Circle(tuple(places[-1]), 0.045 * on.size, facecolor="0.35", ec="k", zorder=4)
        on.axes.add_patch(disc)
        on.drawn.append((places[-1:], 0.045 * on.size))
        edge = places[-1] + 0.045 * on.size * np.array([direction(q[-1] + x) for x in (0, 1, -1)])
        name(on, edge, "$m_p$", direction(q[-1]))
    for effect in effects:
        if effect.kind == "driven_pivot":
            _path(on, effect, -1.0 if places[1, 0] >= 0.0 else 1.0)


def _path(on: Sketch, effect: Any, side: float) -> None:
    """Draw which way a pivot is moved, beside it: to the left (-1) or to the right."""
    beside = np.array([0.24 * side * on.size, 0.0])
    for along, law in zip(np.eye(2), (effect.x, effect.y), strict=True):
        if law is not None or effect.spline is not None:
            for sense in (1, -1):
                reach = 0.08 * sense * on.size * along
                drawing.arrow(on, beside, reach, color=drawing.COUPLE)
    name(on, beside, r"$\mathbf{r}_A(t)$", np.array([side, 0.0]))
