"""Free-body diagrams: every link alone, with its weight and the forces of its neighbours."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pendcore.derive.report import drawing
from pendcore.derive.report.drawing import Sketch, direction, name

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from pendcore import Scene
    from pendcore.derive.report.drawing import Floats

A_ROW = 3
"""The largest number of bodies side by side."""
TITLE = 18.0
"""Height of the line above a body, points of print."""


class Reaction(NamedTuple):
    """The force in a joint as an unknown: its components, and on which link they act as drawn.

    Attributes
    ----------
    x, y : str
        LaTeX of the components.
    on_outer : bool
        Whether positive components push the link that begins at the joint along +x and +y; the
        link before it is then pushed the other way. In the textbook F_01 does, and F_21 does not.
    """

    x: str
    y: str
    on_outer: bool


class Acting(NamedTuple):
    """What acts on links besides weights and joint forces, as LaTeX.

    Attributes
    ----------
    couples : dict
        By joint: the couple on the link beyond the joint; the opposite couple acts on the link
        before it.
    loads : tuple of (int, str)
        The number of a link and the name of a force across it, for each such force.
    payload : str or None
        Mass of the body at the tip.
    payload_couple : str
        Couple on that body; empty if there is none.
    """

    couples: dict[int, str]
    loads: tuple[tuple[int, str], ...] = ()
    payload: str | None = None
    payload_couple: str = ""


def free_bodies(
    scene: Scene,
    q: Sequence[float],
    points: Sequence[str],
    reactions: Sequence[Reaction],
    acting: Acting,
) -> Figure:
    """Draw each link at its angle, with what acts on it; arrows show what counts as positive.

    Parameters
    ----------
    scene : Scene
        The scene whose links are drawn.
    q : sequence of float, (n,)
        Absolute angles, rad.
    points : sequence of str, (n + 1,)
        The names of the pivot, the joints and the tip.
    reactions : sequence of Reaction
        The forces in the joints, from the pivot outwards, and that of the payload if there is one;
        empty to draw the bodies without anything that acts on them.
    acting : Acting
        What else acts.
    """
    from matplotlib.figure import Figure

    n = len(q)
    bodies = n + (acting.payload is not None)
    rows = -(-bodies // A_ROW)
    columns = -(-bodies // rows)
    figure = Figure(figsize=(3.3 * columns, 3.3 * rows))
    whole = {"left": 0.0, "right": 1.0, "bottom": 0.0, "top": 1.0, "wspace": 0.0, "hspace": 0.0}
    sheets = figure.subplots(rows, columns, squeeze=False, gridspec_kw=whole).ravel()
    for sheet in sheets[bodies:]:
        sheet.set_axis_off()
    for i, angle in enumerate(q):
        on = _link(sheets[i], scene, i, angle, points)
        if reactions:
            _on_link(on, scene.links[i].length, i + 1, angle, reactions, acting)
        _finished(on, f"link {i + 1}")
    if acting.payload is not None:
        on = drawing.sketch(sheets[n], 1.0)
        _payload(on, points[-1], reactions[-1] if reactions else None, acting)
        _finished(on, "payload")
    return figure


def _finished(on: Sketch, title: str) -> None:
    on.axes.text(0.5, 0.98, title, transform=on.axes.transAxes, ha="center", va="top")
    drawing.finish(on, above=TITLE)


def _link(axes: Axes, scene: Scene, i: int, angle: float, points: Sequence[str]) -> Sketch:
    """Draw a link with its mass centre and the names of its ends."""
    link = scene.links[i]
    on = drawing.sketch(axes, max(link.length, abs(link.center)))
    start, end = np.zeros(2), link.length * direction(angle)
    drawing.rod(on, start, end)
    center = link.center * direction(angle)
    drawing.mass_center(on, center)
    for place in (start, end):
        drawing.pin(on, place)
    name(on, center, f"$C_{{{i + 1}}}$", direction(angle - np.pi / 2))
    name(on, start, f"${points[i]}$", _clear(angle, outer=True))
    name(on, end, f"${points[i + 1]}$", _clear(angle, outer=False))
    return on


def _on_link(
    on: Sketch,
    length: float,
    number: int,
    angle: float,
    reactions: Sequence[Reaction],
    acting: Acting,
) -> None:
    """Draw all that acts on a link."""
    start, end = np.zeros(2), length * direction(angle)
    center = on.labels[0].places[0]
    drawing.weight(on, center, rf"$m_{{{number}}} g$", 0.3)
    _forces(on, start, reactions[number - 1], angle, outer=True)
    if number < len(reactions):
        _forces(on, end, reactions[number], angle + np.pi, outer=False)
    for at, joint, sense in ((start, number, 1.0), (end, number + 1, -1.0)):
        if joint in acting.couples:
            _couple(on, at, angle, acting.couples[joint], sense)
    if acting.payload_couple and reactions[number:] and number == len(reactions) - 1:
        _couple(on, end, angle, acting.payload_couple, -1.0)
    along = [text for link, text in acting.loads if link == number]
    for k, text in enumerate(along):
        across = 0.24 * on.size * direction(angle + np.pi / 2)
        drawing.arrow(
            on, (0.75 - 0.12 * k) * end, across, f"${text}$", drawing.LOAD,
            arriving=bool(np.cos(angle) > 0.0),  # on the side where the weight is not
        )  # fmt: skip


def _payload(on: Sketch, tip: str, force: Reaction | None, acting: Acting) -> None:
    """Draw the body at the tip, with its weight and what the last link does to it."""
    from matplotlib.patches import Circle

    at = np.zeros(2)
    on.axes.add_patch(Circle((0.0, 0.0), 0.09, facecolor=drawing.STEEL, ec=drawing.BLACK, zorder=3))
    on.drawn.append((at[None], 0.09))
    drawing.mass_center(on, at)
    name(on, 0.09 * direction(-np.pi / 4), f"${tip}$", direction(-np.pi / 4))
    for side in np.eye(2):  # as large as a link is drawn
        on.drawn.append((0.5 * np.array([-side, side]), 0.0))
    if force is None:
        return
    drawing.arrow(on, at, np.array([0.0, 0.36]), f"${acting.payload} g$", drawing.WEIGHT)
    for along, text in ((np.array([1.0, 0.0]), force.x), (np.array([0.0, 1.0]), force.y)):
        drawing.arrow(on, at, -0.36 * along, f"${text}$", drawing.REACTION)
    if acting.payload_couple:
        drawing.turning_arrow(
            on, at, f"${acting.payload_couple}$", radius=0.16, span=(0.3, 1.3),
            color=drawing.COUPLE,
        )  # fmt: skip


def _forces(on: Sketch, at: Floats, force: Reaction, link: float, *, outer: bool) -> None:
    """Draw the two components in the sense in which they act on this link.

    They begin at the joint; one that would lie on the link arrives there from the other side.
    """
    sign = 1.0 if outer == force.on_outer else -1.0
    for along, text in ((np.array([1.0, 0.0]), force.x), (np.array([0.0, 1.0]), force.y)):
        drawing.arrow(
            on, at, 0.3 * sign * on.size * along, f"${text}$", drawing.REACTION,
            arriving=sign * float(along @ direction(link)) > np.cos(np.radians(25)),
        )  # fmt: skip


def _couple(on: Sketch, at: Floats, angle: float, text: str, sense: float) -> None:
    """Draw a couple on a link at one of its ends, in the sense from x to y (1) or against it."""
    towards = _clear(angle, outer=not np.any(at))
    middle = float(np.arctan2(towards[1], towards[0]))
    drawing.turning_arrow(
        on, at, f"${text}$", radius=0.13,
        span=(middle - 0.7 * sense, middle + 0.7 * sense), color=drawing.COUPLE,
    )  # fmt: skip


def _clear(angle: float, *, outer: bool) -> Floats:
    """Return the direction in which an end of a link is clear of the link and of forces."""
    link = angle if outer else angle + np.pi
    return drawing.clear_direction([link, *(np.arange(4) * np.pi / 2)], prefer=-3 * np.pi / 4)
