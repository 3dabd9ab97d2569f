"""Fig. 1 of a handout: the chain at its start, with frame, angles, mass centres and weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore.arguments import Floats
from pendcore.derive.handout import drawing
from pendcore.derive.handout.drawing import Sketch, direction, name
from pendcore.effects import Effect
from pendcore.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUPLES = {"viscous_joint", "torsional_spring", "motor"}
"""Kinds of effects that act by a couple in their joint."""


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
    """Draw the chain at given angles, as the textbook's Fig. 1.

    Parameters
    ----------
    scene : Scene
        Whose links and effects are drawn.
    q : sequence of float, (n,)
        Absolute angles, rad.
    points : sequence of str, (n + 1,)
        The names of the pivot, the joints and the tip, as LaTeX: A, B, D in the textbook.
    """
    from matplotlib.figure import Figure

    places, centers = joints(scene, q), mass_centers(scene, q)
    total = float(np.hypot(*np.ptp(np.vstack([places, centers]), axis=0)))
    size = max(total, 0.6 * sum(link.length for link in scene.links))
    figure = Figure(figsize=(5.6, 5.2), layout="constrained")
    on = drawing.sketch(figure.subplots(), size)
    _frame(on, scene, places)
    for i, angle in enumerate(q):
        start, end = places[i], places[i + 1]
        drawing.rod(on, start, end)
        reach = min(0.14, 0.3 * scene.links[i].length / size)
        drawing.angle_from_x(on, start, angle, rf"$q_{{{i + 1}}}$", reach)
        _weight(on, centers[i], angle, str(i + 1))
        side = start + 0.8 * (end - start) + 0.07 * size * direction(angle - np.pi / 2)
        _number(on, side, i + 1)
    _acting(on, scene.effects, places, q)
    couples = couples_of(scene)
    for i, place in enumerate(places):
        drawing.pin(on, place)
        taken = [0.0] if i < len(q) else []
        taken += [q[i], q[i] / 2] if i < len(q) else []
        taken += [q[i - 1] + np.pi] if i else [-np.pi / 2, np.pi / 2]
        if i + 1 in couples:
            aside = drawing.clear_direction(taken)
            middle = float(np.arctan2(aside[1], aside[0]))
            drawing.turning_arrow(
                on, place, rf"$\tau_{{{i + 1}}}$", radius=0.085,
                span=(middle - 0.7, middle + 0.7), color=drawing.COUPLE,
            )  # fmt: skip
            taken.append(middle)
        name(on, place, f"${points[i]}$", drawing.clear_direction(taken))
    on.axes.margins(0.07)
    return figure


def _frame(on: Sketch, scene: Scene, places: Floats) -> None:
    """Draw the ground, the axes with the origin in the pivot, and which way gravity pulls."""
    size, pivot = on.size, places[0]
    above = places[1, 1] >= -0.2 * size  # the bracket is where the first link is not
    drawing.ground(on, pivot, above=above)
    name(on, pivot + size * np.array([0.15, -0.11 if above else 0.11]), "$0$", np.zeros(2))
    for axis, text in enumerate(("$x$", "$y$")):
        in_the_way = np.abs(places[1:2, 1 - axis]).min() < 0.1 * size and places[1, axis] > 0
        reach = places[1, axis] + 0.25 * size if in_the_way else 0.52 * size
        along = reach * np.eye(2)[axis]
        drawing.arrow(on, pivot, along, text, zorder=2, lw=0.9)
    if scene.gravity:
        left = min(0.0, *places[:, 0]) - 0.28 * size
        down = np.array([0.0, 0.16 * size * np.sign(scene.gravity)])
        drawing.arrow(on, np.array([left, 0.14 * size]), down, "$g$", drawing.WEIGHT)


def _weight(on: Sketch, center: Floats, angle: float, number: str) -> None:
    """Draw a mass centre with its weight."""
    drawing.mass_center(on, center)
    side = drawing.clear_direction([angle, angle + np.pi, np.pi / 2], prefer=-np.pi / 4)
    name(on, center, f"$C_{{{number}}}$", side, 0.075)
    drawing.weight(on, center, angle, rf"$\mathbf{{G}}_{{{number}}}$", 0.16)


def _number(on: Sketch, at: Floats, number: int) -> None:
    """Write the number of a link into a circle."""
    on.axes.text(
        at[0], at[1], str(number), ha="center", va="center", fontsize=9, zorder=9,
        bbox={"boxstyle": "circle,pad=0.22", "facecolor": "white", "edgecolor": "0.3", "lw": 0.7},
    )  # fmt: skip


def _acting(on: Sketch, effects: Sequence[Effect], places: Floats, q: Sequence[float]) -> None:
    """Draw a payload and a moving pivot."""
    from matplotlib.patches import Circle

    kinds = {effect.kind for effect in effects}
    if "payload" in kinds:
        disc = Circle(tuple(places[-1]), 0.045 * on.size, facecolor="0.35", ec="k", zorder=4)
        on.axes.add_patch(disc)
        name(on, places[-1], "$m_p$", direction(q[-1]), 0.1)
    for effect in effects:
        if effect.kind == "driven_pivot":
            _path(on, effect)


def _path(on: Sketch, effect: Any) -> None:
    """Draw which way a pivot is moved, beside it."""
    beside = np.array([-0.22 * on.size, 0.0])
    for along, law in zip(np.eye(2), (effect.x, effect.y), strict=True):
        if law is not None or effect.spline is not None:
            for side in (1, -1):
                reach = 0.08 * side * on.size * along
                drawing.arrow(on, beside, reach, color=drawing.COUPLE)
    name(on, beside, r"$\mathbf{r}_A(t)$", np.array([-1.0, 0.0]), 0.15)
