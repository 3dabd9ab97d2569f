"""Free-body diagrams: every link alone, with its weight and the forces of its neighbours."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from pendcore.arguments import Floats
from pendcore.derive.handout import drawing
from pendcore.derive.handout.drawing import Sketch, direction, name
from pendcore.scene import Scene

if TYPE_CHECKING:
    from matplotlib.figure import Figure

A_ROW = 3
"""Links side by side."""


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


def free_bodies(
    scene: Scene,
    q: Sequence[float],
    points: Sequence[str],
    reactions: Sequence[Reaction],
    couples: Mapping[int, str],
) -> Figure:
    """Draw each link at its angle, with what acts on it; arrows show what counts as positive.

    Parameters
    ----------
    scene : Scene
        Whose links are drawn.
    q : sequence of float, (n,)
        Absolute angles, rad.
    points : sequence of str, (n + 1,)
        The names of the pivot, the joints and the tip.
    reactions : sequence of Reaction
        Of the joints, from the pivot outwards, and of the payload if there is one; empty for the
        links without anything that acts on them.
    couples : dict of int to str
        LaTeX of the couple at a joint, where there is one.
    """
    from matplotlib.figure import Figure

    n = len(q)
    rows = -(-n // A_ROW)
    columns = -(-n // rows)
    figure = Figure(figsize=(3.7 * columns, 3.6 * rows), layout="constrained")
    sheets = figure.subplots(rows, columns, squeeze=False).ravel()
    for sheet in sheets[n:]:
        sheet.set_axis_off()
    for i, angle in enumerate(q):
        link = scene.links[i]
        on = drawing.sketch(sheets[i], max(link.length, abs(link.center)))
        start, end = np.zeros(2), link.length * direction(angle)
        drawing.rod(on, start, end)
        weight = rf"$m_{{{i + 1}}} g$" if reactions else ""
        _center(on, link.center * direction(angle), angle, weight, i + 1)
        name(on, start, f"${points[i]}$", _clear(angle, outer=True), 0.11)
        name(on, end, f"${points[i + 1]}$", _clear(angle, outer=False), 0.11)
        if reactions:
            _forces(on, start, reactions[i], angle, outer=True)
            _couples(on, (start, end), angle, i + 1, couples)
        if i + 1 < len(reactions):
            _forces(on, end, reactions[i + 1], angle + np.pi, outer=False)
        for place in (start, end):
            drawing.pin(on, place)
        on.axes.margins(0.16)
        on.axes.set_title(f"link {i + 1}", pad=16)
    return figure


def _center(on: Sketch, center: Floats, angle: float, weight: str, number: int) -> None:
    """Draw a mass centre, with its weight unless that has no name."""
    drawing.mass_center(on, center)
    side = drawing.clear_direction([angle, angle + np.pi, np.pi / 2], prefer=-np.pi / 4)
    name(on, center, f"$C_{{{number}}}$", side, 0.11)
    if weight:
        drawing.weight(on, center, angle, weight, 0.3)


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


def _couples(
    on: Sketch, ends: tuple[Floats, Floats], angle: float, number: int, couples: Mapping[int, str]
) -> None:
    """Draw the couple of the link's own joint, and against it that of the next one."""
    for end, joint, sense in ((0, number, 1.0), (1, number + 1, -1.0)):
        if joint in couples:
            outer = end == 0
            at_name = np.arctan2(*_clear(angle, outer=outer)[::-1])
            towards = _clear(angle, outer=outer, taken=float(at_name))
            middle = float(np.arctan2(towards[1], towards[0]))
            drawing.turning_arrow(
                on, ends[end], f"${couples[joint]}$", radius=0.13,
                span=(middle - 0.8 * sense, middle + 0.8 * sense), color=drawing.COUPLE,
            )  # fmt: skip


def _clear(angle: float, *, outer: bool, taken: float | None = None) -> Floats:
    """Return where a name at a joint is clear of the link, the forces and what else is there."""
    link = angle if outer else angle + np.pi
    others = [] if taken is None else [taken]
    return drawing.clear_direction(
        [link, *others, *(np.arange(4) * np.pi / 2)], prefer=-3 * np.pi / 4
    )
