"""The drawings of the links: the chain at its start, Fig. 1, and every link as a free body."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from pendcore import Scene
from pendcore.derive.chain import Vector
from pendcore.derive.document import Drawing
from pendcore.derive.narration.page import Page
from pendcore.derive.report.pictures import lettering
from pendcore.derive.report.quantities import number
from pendcore.messages import Floats
from pendcore.plotting.sketch import Sketch, clear_direction, direction

A_ROW = 3
"""The largest number of bodies side by side."""
TITLE = 18.0
"""Height of the line above a body, points of print."""


@lettering
def mechanism(page: Page, q: Sequence[float]) -> Drawing:
    """Draw the chain at given angles, rad, as in the textbook's Fig. 1, with the page's names."""
    scene = page.derivation.scene
    places, lengths = scene.positions(0.0, q), [link.length for link in scene.links]
    centers = scene.mass_centers(0.0, q) - places[0]
    places -= places[0]  # a pivot that is moved is drawn at the origin
    total = float(np.hypot(*np.ptp(np.vstack([places, centers]), axis=0)))
    figure = Figure(figsize=(5.6, 4.6))
    on = Sketch(figure.add_axes((0.0, 0.0, 1.0, 1.0)), max(total, 0.6 * sum(lengths)))
    _frame(on, scene, places)
    for i, angle in enumerate(q, start=1):
        start, end = places[i - 1], places[i]
        on.rod(start, end)
        on.mass_center(centers[i - 1])
        on.weight(centers[i - 1], rf"$\mathbf{{G}}_{{{i}}}$", 0.16)
        reach = min(0.14, 0.3 * lengths[i - 1] / on.size)
        on.angle_from_x(start, angle, rf"$q_{{{i}}}$", reach)
        if i in page.equations.torques:  # around the joint, where nothing else is
            before = q[i - 2] + np.pi if i > 1 else -np.pi / 2
            clear = clear_direction([0.0, angle, angle / 2, before, np.pi / 2])
            on.couple(start, clear, rf"$\tau_{{{i}}}$", 0.085)
    _acting(on, scene.effects, places, q[-1])
    for i, angle in enumerate(q, start=1):
        on.name(centers[i - 1], f"$C_{{{i}}}$", direction(angle - np.pi / 2))
    for i, at in enumerate(places):
        on.pin(at)
        taken = [q[j] + turn for j, turn in ((i, 0.0), (i - 1, np.pi)) if 0 <= j < len(q)]
        on.name(at, f"${page.joint(i)}$", clear_direction([*taken, 0.0]))
    for i, angle in enumerate(q):
        parts = [places[i] + x * (places[i + 1] - places[i]) for x in (0.8, 0.7, 0.3, 0.9, 0.2)]
        on.number(parts, i + 1, direction(angle - np.pi / 2))
    on.finish(shrink=True)
    start = (rf"$q_{{{i}}} = {number(degrees(angle))}$°" for i, angle in enumerate(q, start=1))
    return Drawing("mechanism", f"The chain at its start: {', '.join(start)}.", figure)


def _frame(on: Sketch, scene: Scene, places: Floats) -> None:
    """Draw the ground, the axes with the origin in the pivot, and which way gravity pulls."""
    size, pivot = on.size, places[0]
    above = places[1, 1] >= -0.2 * size  # the bracket is where the first link is not
    on.ground(pivot, above=above)
    corner = pivot + size * np.array([[0.1, -0.09], [-0.1, -0.09]]) * [1.0, 1.0 if above else -1.0]
    on.name(corner, "$0$", np.array([1.0, 0.0]))
    for axis, text in enumerate(("$x$", "$y$")):
        in_the_way = np.abs(places[1:2, 1 - axis]).min() < 0.1 * size and places[1, axis] > 0
        reach = places[1, axis] + 0.25 * size if in_the_way else 0.52 * size
        on.arrow(pivot, reach * np.eye(2)[axis], text, zorder=2, lw=0.9)
    if scene.gravity:
        at = np.array([min(0.0, *places[:, 0]) - 0.28 * size, 0.14 * size])
        down = np.array([0.0, 0.16 * size * np.sign(scene.gravity)])
        on.arrow(at, down, "$g$", on.theme.weight)


def _acting(on: Sketch, effects: Sequence[Any], places: Floats, last: float) -> None:
    """Draw a payload, and beside a moving pivot which way it is moved."""
    if any(effect.kind == "payload" for effect in effects):
        on.disc(places[-1], 0.045, facecolor=on.theme.quiet, zorder=4)
        edge = [places[-1] + 0.045 * on.size * direction(last + turn) for turn in (0, 1, -1)]
        on.name(edge, "$m_p$", direction(last))
    side = np.array([-1.0 if places[1, 0] >= 0.0 else 1.0, 0.0])
    for effect in effects:
        if effect.kind == "driven_pivot":
            beside = 0.24 * on.size * side
            for along, law in zip(np.eye(2), (effect.x, effect.y), strict=True):
                for sense in (1, -1) if law is not None else ():
                    on.arrow(beside, 0.08 * sense * on.size * along, color=on.theme.couple)
            on.name(beside, r"$\mathbf{r}_A(t)$", side)


@lettering
def free_bodies(page: Page, q: Sequence[float], *, forces: bool = True) -> Drawing:
    """Draw each link at its angle, rad, with what acts on it, or alone for those who are to draw.

    Arrows show what counts as positive; the page names it all.
    """
    bodies = len(page.equations.bodies)
    rows = -(-bodies // A_ROW)
    columns = -(-bodies // rows)
    figure = Figure(figsize=(3.3 * columns, 3.3 * rows))
    whole = {"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 1.0, "wspace": 0.0, "hspace": 0.0}
    sheets = figure.subplots(rows, columns, squeeze=False, gridspec_kw=whole).ravel()
    for sheet in sheets[bodies:]:
        sheet.set_axis_off()
    for i, sheet in enumerate(sheets[:bodies], start=1):
        if i <= page.n:
            title, on = f"link {i}", _link(sheet, page, i, q[i - 1], forces=forces)
        else:
            title, on = "payload", _payload(sheet, page, forces=forces)
        sheet.text(0.5, 0.98, title, transform=sheet.transAxes, ha="center", va="top")
        on.finish(above=TITLE)
    if not forces:
        words = "The links, to be completed into free-body diagrams."
        return Drawing("links", words, figure)
    words = "The links as free bodies; the arrows show what counts as positive."
    if page.equations.loads:
        words += " The drag $D_{i}$ on rod $i$ is drawn as it is for positive $F_{d,i}$; "
        words += "its moment about the joint where the rod begins is $T_{d,i}$."
    return Drawing("free_bodies", words, figure)


def _link(axes: Axes, page: Page, i: int, angle: float, *, forces: bool) -> Sketch:
    """Draw a link with its mass centre, the names of its ends, and all that acts on it."""
    link, equations, write = page.derivation.scene.links[i - 1], page.equations, page.s.latex
    along, back = direction(angle), angle + np.pi
    on = Sketch(axes, max(link.length, abs(link.center)))
    start, end, center = np.zeros(2), link.length * along, link.center * along
    on.rod(start, end)
    on.mass_center(center)
    on.name(center, f"$C_{{{i}}}$", direction(angle - np.pi / 2))
    for place, towards, joint in ((start, angle, i - 1), (end, back, i)):
        on.pin(place)
        on.name(place, f"${page.joint(joint)}$", _clear(towards))
    if not forces:
        return on
    on.weight(center, f"${write(page.s.masses[i - 1])} g$", 0.3)
    _forces(on, start, angle, equations.near_forces[i - 1], page)
    _forces(on, end, back, equations.far_forces[i - 1], page)
    couples = [(start, angle, equations.joint_couple(i), 1.0)]
    couples.append((end, back, equations.joint_couple(i + 1), -1.0))
    if i == page.n and equations.payload is not None:
        couples.append((end, back, equations.payload.moment.inertia, -1.0))
    for place, towards, couple, sense in couples:
        if couple != 0:
            on.couple(place, _clear(towards), f"${write(couple)}$", sense=sense)
    for k, load in enumerate(load for load in equations.loads if load.link == i):
        on.arrow(
            (0.75 - 0.12 * k) * end, 0.24 * on.size * direction(angle + np.pi / 2),
            f"${page.load(load)}$", on.theme.load,
            arriving=bool(np.cos(angle) > 0.0),  # on the side where the weight is not
        )  # fmt: skip
    return on


def _payload(axes: Axes, page: Page, *, forces: bool) -> Sketch:
    """Draw the body at the tip, with its weight and what the last link does to it."""
    payload, on, at = page.equations.payload, Sketch(axes, 1.0), np.zeros(2)
    on.disc(at, 0.09, facecolor=on.theme.line, zorder=3)
    on.mass_center(at)
    on.name(0.09 * direction(-np.pi / 4), f"${page.joint(page.n)}$", direction(-np.pi / 4))
    for side in np.eye(2):  # as large as a link is drawn
        on.drawn.append((0.5 * np.array([-side, side]), 0.0))
    if forces and payload is not None:
        mass = page.s.latex(payload.mass)
        on.weight(at, f"${f'({mass})' if payload.mass.is_Add else mass} g$", 0.36)
        x, y = payload.force
        _forces(on, at, np.pi / 4, (-x, -y), page, 0.36)
        if payload.inertia != 0:
            couple = f"${page.s.latex(payload.moment.inertia)}$"
            on.couple(at, direction(0.8), couple, 0.16)
    return on


def _forces(
    on: Sketch, at: Floats, link: float, force: Vector, page: Page, reach: float = 0.3
) -> None:
    """Draw the two components in the sense in which they act on this link.

    They begin at the joint; one that would lie on the link arrives there from the other side.
    """
    for along, component in zip(np.eye(2), force, strict=True):
        if component == 0:
            continue
        sign = -1.0 if component.could_extract_minus_sign() else 1.0
        on.arrow(
            at, reach * sign * on.size * along, f"${page.s.latex(int(sign) * component)}$",
            on.theme.force,
            arriving=sign * float(along @ direction(link)) > np.cos(np.radians(25)),
        )  # fmt: skip


def _clear(link: float) -> Floats:
    """Return the direction in which an end of a link is clear of the link and of forces."""
    return clear_direction([link, *(np.arange(4) * np.pi / 2)], prefer=-3 * np.pi / 4)
