"""Free-body diagrams: every link alone, with its weight and the forces of its neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from sympy import Expr

from pendcore.derive.chain import Vector
from pendcore.derive.narration.page import Page
from pendcore.derive.report import drawing
from pendcore.derive.report.drawing import Floats, Sketch, direction, name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

A_ROW = 3
"""The largest number of bodies side by side."""
TITLE = 18.0
"""Height of the line above a body, points of print."""


def free_bodies(page: Page, q: Sequence[float], *, forces: bool = True) -> Figure:
    """Draw each link at its angle, rad, with what acts on it, or alone, as the page names it all.

    Arrows show what counts as positive.
    """
    from matplotlib.figure import Figure

    has_payload = page.equations.payload is not None
    bodies = page.n + has_payload
    rows = -(-bodies // A_ROW)
    columns = -(-bodies // rows)
    figure = Figure(figsize=(3.3 * columns, 3.3 * rows))
    whole = {"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 1.0, "wspace": 0.0, "hspace": 0.0}
    sheets = figure.subplots(rows, columns, squeeze=False, gridspec_kw=whole).ravel()
    for sheet in sheets[bodies:]:
        sheet.set_axis_off()
    titles = [f"link {i}" for i in range(1, page.n + 1)] + ["payload"] * has_payload
    for i, (sheet, title) in enumerate(zip(sheets, titles, strict=False), start=1):
        if i <= page.n:
            on = _link(sheet, page, i, q[i - 1], forces=forces)
        else:
            on = _payload(sheet, page, forces=forces)
        sheet.text(0.5, 0.98, title, transform=sheet.transAxes, ha="center", va="top")
        drawing.finish(on, above=TITLE)
    return figure


def _link(axes: Axes, page: Page, i: int, angle: float, *, forces: bool) -> Sketch:
    """Draw a link with its mass centre, the names of its ends, and all that acts on it."""
    link, equations, write = page.derivation.scene.links[i - 1], page.equations, page.s.latex
    along, back = direction(angle), angle + np.pi
    on = drawing.sketch(axes, max(link.length, abs(link.center)))
    start, end, center = np.zeros(2), link.length * along, link.center * along
    drawing.rod(on, start, end)
    drawing.mass_center(on, center)
    name(on, center, f"$C_{{{i}}}$", direction(angle - np.pi / 2))
    for place, towards, number in ((start, angle, i - 1), (end, back, i)):
        drawing.pin(on, place)
        name(on, place, f"${page.joint(number)}$", _clear(towards))
    if not forces:
        return on
    drawing.weight(on, center, f"${write(page.s.masses[i - 1])} g$", 0.3)
    _forces(on, start, angle, equations.near_force(i), page)
    _forces(on, end, back, equations.far_force(i), page)
    couples = [(start, angle, equations.joint_couple(i), 1.0)]
    couples.append((end, back, equations.joint_couple(i + 1), -1.0))
    if i == page.n and equations.payload is not None:
        couples.append((end, back, equations.payload.inertia * page.s.qdd[-1], -1.0))
    for place, towards, couple, sense in couples:
        _couple(on, place, _clear(towards), couple, sense, page)
    for k, load in enumerate(load for load in equations.loads if load.link == i):
        drawing.arrow(
            on, (0.75 - 0.12 * k) * end, 0.24 * on.size * direction(angle + np.pi / 2),
            f"${page.load(load)}$", drawing.LOAD,
            arriving=bool(np.cos(angle) > 0.0),  # on the side where the weight is not
        )  # fmt: skip
    return on


def _payload(axes: Axes, page: Page, *, forces: bool) -> Sketch:
    """Draw the body at the tip, with its weight and what the last link does to it."""
    payload, on, at = page.equations.payload, drawing.sketch(axes, 1.0), np.zeros(2)
    on.disc(at, 0.09, facecolor=drawing.STEEL, zorder=3)
    drawing.mass_center(on, at)
    name(on, 0.09 * direction(-np.pi / 4), f"${page.joint(page.n)}$", direction(-np.pi / 4))
    for side in np.eye(2):  # as large as a link is drawn
        on.drawn.append((0.5 * np.array([-side, side]), 0.0))
    if forces and payload is not None:
        mass = page.s.latex(payload.mass)
        drawing.weight(on, at, f"${f'({mass})' if payload.mass.is_Add else mass} g$", 0.36)
        x, y = payload.force
        _forces(on, at, np.pi / 4, (-x, -y), page, 0.36)
        turning = payload.inertia * page.s.qdd[-1]
        _couple(on, at, direction(0.8), turning, 1.0, page, 0.16)
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
        drawing.arrow(
            on, at, reach * sign * on.size * along, f"${page.s.latex(int(sign) * component)}$",
            drawing.REACTION,
            arriving=sign * float(along @ direction(link)) > np.cos(np.radians(25)),
        )  # fmt: skip


def _couple(
    on: Sketch, at: Floats, towards: Floats, couple: Expr, sense: float, page: Page,
    radius: float = 0.13,
) -> None:  # fmt: skip
    """Draw a couple on a link at one of its ends, in the sense from x to y (1) or against it."""
    if couple != 0:
        middle = float(np.arctan2(towards[1], towards[0]))
        drawing.turning_arrow(
            on, at, f"${page.s.latex(couple)}$", radius=radius,
            span=(middle - 0.7 * sense, middle + 0.7 * sense), color=drawing.COUPLE,
        )  # fmt: skip


def _clear(link: float) -> Floats:
    """Return the direction in which an end of a link is clear of the link and of forces."""
    return drawing.clear_direction([link, *(np.arange(4) * np.pi / 2)], prefer=-3 * np.pi / 4)
