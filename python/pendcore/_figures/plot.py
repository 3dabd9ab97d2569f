"""One call for every figure of a run."""

from __future__ import annotations

import os
from inspect import signature
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

import numpy.typing as npt

from pendcore._figures.axes import (
    NewFigure,
    figure_of_pyplot,
    horizon_time,
    in_legend,
    shade_past,
)
from pendcore._figures.in_plane import draw_path, draw_phase, draw_section
from pendcore._figures.over_time import draw_energy, draw_links, draw_reactions
from pendcore._figures.poses import draw_free_bodies, draw_strip
from pendcore._messages.arguments import did_you_mean, positive, text
from pendcore._run.solution import Solution

if TYPE_CHECKING:
    from matplotlib.artist import Artist

What = Literal[
    "angles", "rates", "reactions", "energy", "path", "phase", "section", "strip", "free_bodies"
]
KINDS: tuple[str, ...] = get_args(What)
OVER_TIME = KINDS[:4]
_OWN = {
    "t": ("strip", "free_bodies"),
    "event": ("section",),
    "link": ("section",),
    "label": tuple(kind for kind in KINDS if kind not in ("strip", "free_bodies")),
}
"""The parameters that only some figures have, and which."""


def plot(
    solution: Solution,
    ax: Any = None,
    *,
    what: What = "angles",
    label: str | None = None,
    horizon: float | None = None,
    t: npt.ArrayLike | None = None,
    event: int | None = None,
    link: int | None = None,
    **line_properties: Any,
) -> list[Artist]:
    """Draw a figure of a run; `pendcore.Solution.plot` has the parameters.

    Raises
    ------
    TypeError
        If ``ax`` is not axes, ``horizon`` is not a number, or a property is not one of lines.
    ValueError
        If there is no such figure, or the number of axes is not that of the figure, or a parameter
        is not one of this figure.
    """
    own = _Own(t, event, link, None if label is None else in_legend(text("label", label)))
    _check(what, own, horizon)
    from matplotlib.artist import ArtistInspector
    from matplotlib.cbook import normalize_kwargs
    from matplotlib.lines import Line2D

    given = normalize_kwargs(line_properties, Line2D)
    properties = {*ArtistInspector(Line2D).get_setters()} - {"data", "xdata", "ydata", "figure"}
    for name in given:
        if name not in properties:
            listed = [one for one in signature(plot).parameters if one != "line_properties"]
            known = [*listed[1:], *sorted(properties)]
            raise TypeError(
                f"Solution.plot: has no parameter {name!r}: {did_you_mean(name, known)}"
            )
    valid = horizon_time(solution, horizon)
    return _drawn(solution, ax, figure_of_pyplot, what, valid, own, given)


class _Own(NamedTuple):
    """What only some figures have."""

    t: npt.ArrayLike | None = None
    event: int | None = None
    link: int | None = None
    label: str | None = None


def _check(what: str, own: _Own, horizon: float | None) -> None:
    """Raise a ValueError for a figure that does not exist, or has no such parameter."""
    if what not in KINDS:
        raise ValueError(f"what = {what!r}: {did_you_mean(str(what), KINDS)}")
    for name, kinds in _OWN.items():
        if getattr(own, name) is not None and what not in kinds:
            raise ValueError(f"{name}: belongs to what = {' and '.join(map(repr, kinds))}")
    if horizon is not None:
        positive("horizon", horizon, "rad")
        if what not in (*OVER_TIME, "path", "phase"):
            raise ValueError(f"horizon: what = {what!r} shows no times past which it could shade")


def _drawn(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    what: str,
    valid_until: float | None,
    own: _Own,
    given: dict[str, Any],
) -> list[Artist]:
    place, label = (solution, ax, new_figure), own.label
    if what == "path":
        return [*draw_path(*place, label, valid_until, given)]
    if what == "phase":
        return [*draw_phase(*place, label, valid_until, given)]
    if what == "section":
        event = 0 if own.event is None else own.event
        link = 1 if own.link is None else own.link
        return [*draw_section(*place, label, event, link, given)]
    if what == "strip":
        return draw_strip(*place, own.t, given)
    if what == "free_bodies":
        return draw_free_bodies(*place, own.t, given)
    if what == "reactions":
        lines = draw_reactions(*place, label, given)
    elif what == "energy":
        lines = draw_energy(*place, label, given)
    else:
        lines = draw_links(*place, what, label, given)
    axes: list[Any] = [*dict.fromkeys(line.axes for line in lines)]
    shade_past(axes, valid_until, solution)
    return [*lines]


def save_figure(
    solution: Solution,
    path: str | os.PathLike[str],
    valid_until: float | None = None,
    *,
    what: str = "angles",
    t: float | None = None,
    horizon: float | None = None,
) -> None:
    """Draw a figure into a file; the suffix says which kind (png, pdf, svg, ...).

    The figure is shaded past ``valid_until``, s, if that is known; ``horizon`` is as in `plot`.
    """
    from matplotlib.figure import Figure

    _check(what, _Own(t), horizon)
    if horizon is not None:
        valid_until = horizon_time(solution, horizon)

    artists = _drawn(solution, None, Figure, what, valid_until, _Own(t), {})
    figure: Any = artists[0].get_figure(root=True)
    drawn = BytesIO()  # matplotlib's PDF breaks off with an error of its own if the disk is full
    kind = Path(path).suffix.removeprefix(".")
    figure.savefig(drawn, dpi=150, format=kind or None)
    Path(path).write_bytes(drawn.getvalue())
