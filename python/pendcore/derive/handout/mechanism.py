"""Fig. 1 of a handout: the chain at its start, with frame, angles, mass centres and weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pendcore.arguments import Floats
from pendcore.derive.handout import drawing
from pendcore.derive.handout.drawing import Sketch, direction, name
from pendcore.effects import Effect
from pendcore.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUPLES = {"viscous_joint", "torsional_spring", "motor", "dry_joint_friction"}
"""Kinds of effects that act by a couple in their joint."""


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
        drawing.angle_from_x(on, start, angle, rf"$q_{{{i + 1}}}$")
        _weight(on, centers[i], angle, str(i + 1))
        side = start + 0.8 * (end - start) + 0.07 * size * direction(angle - np.pi / 2)
        _number(on, side, i + 1)
    _acting(on, scene.effects, places, q)
    for i, place in enumerate(places):
        drawing.pin(on, place)
        taken = [0.0] if i < len(q) else []
        taken += [q[i], q[i] / 2] if i < len(q) else []
        taken += [q[i - 1] + np.pi] if i else [-np.pi / 2]
        name(on, place, f"${points[i]}$", drawing.clear_direction(taken))
    on.axes.margins(0.07)
    return figure


def _frame(on: Sketch, scene: Scene, places: Floats) -> None:
    """Draw the ground, the axes with the origin in the pivot, and which way gravity pulls."""
    size, pivot = on.size, places[0]
    drawing.ground(on, pivot)
    name(on, pivot + size * np.array([0.15, -0.11]), "$0$", np.zeros(2))
    for axis, text in enumerate(("$x$", "$y$")):
        in_the_way = np.abs(places[1:2, 1 - axis]).min() < 0.1 * size and places[1, axis] > 0
        reach = places[1, axis] + 0.25 * size if in_the_way else 0.52 * size
        along = reach * np.eye(2)[axis]
        drawing.arrow(on, pivot, along, text, zorder=2, lw=0.9)
    if scene.gravity:
        left = min(0.0, *places[:, 0]) - 0.22 * size
        down = np.array([0.0, 0.16 * size * np.sign(scene.gravity)])
        drawing.arrow(on, np.array([left, 0.08 * size]), down, "$g$", drawing.WEIGHT)


def _weight(on: Sketch, center: Floats, angle: float, number: str) -> None:
    """Draw a mass centre with its weight."""
    drawing.mass_center(on, center)
    down = np.array([0.0, 0.2 * on.size])
    drawing.arrow(on, center, down, rf"$\mathbf{{G}}_{{{number}}}$", drawing.WEIGHT)
    side = drawing.clear_direction([angle, angle + np.pi, np.pi / 2], prefer=-np.pi / 4)
    name(on, center, f"$C_{{{number}}}$", side, 0.075)


def _number(on: Sketch, at: Floats, number: int) -> None:
    """Write the number of a link into a circle."""
    on.axes.text(
        at[0], at[1], str(number), ha="center", va="center", fontsize=9, zorder=9,
        bbox={"boxstyle": "circle,pad=0.22", "facecolor": "white", "edgecolor": "0.3", "lw": 0.7},
    )  # fmt: skip


def _acting(on: Sketch, effects: Sequence[Effect], places: Floats, q: Sequence[float]) -> None:
    """Draw what acts besides gravity: couples, a payload, a moving pivot, the wind."""
    from matplotlib.patches import Circle

    with_couple = {getattr(e, "joint") for e in effects if e.kind in COUPLES}  # noqa: B009
    for joint in sorted(with_couple):
        middle = np.pi + q[joint - 1] / 2
        drawing.turning_arrow(
            on, places[joint - 1], rf"$\tau_{{{joint}}}$", radius=0.09,
            span=(middle - 1.0, middle + 1.0), color=drawing.COUPLE,
        )  # fmt: skip
    kinds = {effect.kind for effect in effects}
    if "payload" in kinds:
        disc = Circle(tuple(places[-1]), 0.045 * on.size, facecolor="0.35", ec="k", zorder=4)
        on.axes.add_patch(disc)
        name(on, places[-1], "$m_p$", direction(q[-1]), 0.1)
    if "driven_pivot" in kinds:
        reach = np.array([0.1 * on.size, 0.0])
        for side in (1, -1):
            at = np.array([0.0, -0.17 * on.size])
            drawing.arrow(on, at, side * reach, color=drawing.COUPLE)
        name(on, np.array([0.0, -0.17 * on.size]), r"$(x_0, y_0)(t)$", np.array([0.0, -1.0]))
