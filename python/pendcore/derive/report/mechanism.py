"""Fig. 1 of a report: the chain at its start, with frame, angles, mass centres and weights."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import Scene
from pendcore.derive.report import drawing
from pendcore.derive.report.drawing import Floats, Sketch, direction, name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

COUPLES = {"viscous_joint", "torsional_spring", "motor"}
"""Kinds of effects that act by a couple in their joint."""

CIRCLE = {"boxstyle": "circle,pad=0.22", "facecolor": "white", "edgecolor": "0.3", "lw": 0.7}
"""The circle around the number of a link."""


def joints(scene: Scene, q: Sequence[float]) -> Floats:
    """Return the pivot, the joints and the tip, (n + 1, 2), m, with the pivot at the origin."""
    steps = [link.length * direction(angle) for link, angle in zip(scene.links, q, strict=True)]
    return np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])


def mechanism(scene: Scene, q: Sequence[float], points: Sequence[str]) -> Figure:
    """Draw the chain at given angles, rad, as in the textbook's Fig. 1.

    ``points`` names the pivot, the joints and the tip in LaTeX: A, B, D in the textbook.
    """
    from matplotlib.figure import Figure

    places, lengths = joints(scene, q), [link.length for link in scene.links]
    along = [link.center * direction(angle) for link, angle in zip(scene.links, q, strict=True)]
    centers = places[:-1] + np.array(along)
    total = float(np.hypot(*np.ptp(np.vstack([places, centers]), axis=0)))
    figure = Figure(figsize=(5.6, 4.6))
    on = drawing.sketch(figure.add_axes((0.0, 0.0, 1.0, 1.0)), max(total, 0.6 * sum(lengths)))
    couples = {getattr(e, "joint", 0) for e in scene.effects if e.kind in COUPLES}
    _frame(on, scene, places)
    for i, angle in enumerate(q, start=1):
        start, end = places[i - 1], places[i]
        drawing.rod(on, start, end)
        drawing.mass_center(on, centers[i - 1])
        drawing.weight(on, centers[i - 1], rf"$\mathbf{{G}}_{{{i}}}$", 0.16)
        reach = min(0.14, 0.3 * lengths[i - 1] / on.size)
        drawing.angle_from_x(on, start, angle, rf"$q_{{{i}}}$", reach)
        if i in couples:  # around the joint, where nothing else is
            before = q[i - 2] + np.pi if i > 1 else -np.pi / 2
            x, y = drawing.clear_direction([0.0, angle, angle / 2, before, np.pi / 2])
            span = float(np.arctan2(y, x)) - 0.7, float(np.arctan2(y, x)) + 0.7
            text = rf"$\tau_{{{i}}}$"
            drawing.turning_arrow(on, start, text, radius=0.085, span=span, color=drawing.COUPLE)
    _acting(on, scene.effects, places, q[-1])
    for i, angle in enumerate(q, start=1):
        name(on, centers[i - 1], f"$C_{{{i}}}$", direction(angle - np.pi / 2))
    for i, at in enumerate(places):
        drawing.pin(on, at)
        taken = [q[j] + turn for j, turn in ((i, 0.0), (i - 1, np.pi)) if 0 <= j < len(q)]
        name(on, at, f"${points[i]}$", drawing.clear_direction([*taken, 0.0]))
    for i, angle in enumerate(q):
        parts = [places[i] + x * (places[i + 1] - places[i]) for x in (0.8, 0.7, 0.3, 0.9, 0.2)]
        name(on, parts, str(i + 1), direction(angle - np.pi / 2), fontsize=9, bbox=CIRCLE)
    drawing.finish(on, shrink=True)
    return figure


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
        drawing.arrow(on, pivot, reach * np.eye(2)[axis], text, zorder=2, lw=0.9)
    if scene.gravity:
        at = np.array([min(0.0, *places[:, 0]) - 0.28 * size, 0.14 * size])
        down = np.array([0.0, 0.16 * size * np.sign(scene.gravity)])
        drawing.arrow(on, at, down, "$g$", drawing.WEIGHT)


def _acting(on: Sketch, effects: Sequence[Any], places: Floats, last: float) -> None:
    """Draw a payload, and beside a moving pivot which way it is moved."""
    if any(effect.kind == "payload" for effect in effects):
        on.disc(places[-1], 0.045, facecolor="0.35", zorder=4)
        edge = [places[-1] + 0.045 * on.size * direction(last + turn) for turn in (0, 1, -1)]
        name(on, edge, "$m_p$", direction(last))
    side = np.array([-1.0 if places[1, 0] >= 0.0 else 1.0, 0.0])
    for effect in effects:
        if effect.kind == "driven_pivot":
            beside = 0.24 * on.size * side
            for along, law in zip(np.eye(2), (effect.x, effect.y), strict=True):
                for sense in (1, -1) if law is not None else ():
                    drawing.arrow(on, beside, 0.08 * sense * on.size * along, color=drawing.COUPLE)
            name(on, beside, r"$\mathbf{r}_A(t)$", side)
