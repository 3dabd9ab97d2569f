"""One call for every figure of a run."""

from __future__ import annotations

import os
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, NamedTuple, get_args

from pendcore import Solution
from pendcore.messages import did_you_mean, positive, text
from pendcore.plotting.axes import NewFigure, Request, figure_of_pyplot, require_name, whole_names
from pendcore.plotting.in_plane import draw_path, draw_phase, draw_section
from pendcore.plotting.over_time import draw_angles, draw_energy, draw_rates, draw_reactions
from pendcore.plotting.poses import draw_free_bodies, draw_strip
from pendcore.plotting.style import in_legend

if TYPE_CHECKING:
    from matplotlib.artist import Artist

What = Literal[
    "angles", "rates", "reactions", "energy", "path", "phase", "section", "strip", "free_bodies"
]
KINDS: tuple[str, ...] = get_args(What)


class Kind(NamedTuple):
    """A kind of figure: what draws it, and those of its parameters that not every kind has."""

    draw: Callable[[Request], list[Artist]]
    takes: tuple[str, ...] = ("label", "horizon")


_FIGURES = {
    "angles": Kind(draw_angles),
    "rates": Kind(draw_rates),
    "reactions": Kind(draw_reactions),
    "energy": Kind(draw_energy),
    "path": Kind(draw_path),
    "phase": Kind(draw_phase),
    "section": Kind(draw_section, ("event", "link", "label")),
    "strip": Kind(draw_strip, ("t",)),
    "free_bodies": Kind(draw_free_bodies, ("t",)),
}


def plot(
    solution: Solution,
    what: str,
    ax: Any,
    horizon: float | None,
    own: dict[str, Any],
    line_properties: dict[str, Any],
    *,
    new_figure: NewFigure = figure_of_pyplot,
    valid_until: float | None = None,
) -> list[Artist]:
    """Draw a figure of a run; see `pendcore.Solution.plot`.

    ``own`` has what only some kinds of figures take; None is what was not given. Without a horizon,
    what is past ``valid_until``, s, is shaded, if that is known.
    """
    from matplotlib.lines import Line2D

    if (label := own.get("label")) is not None:
        own = own | {"label": in_legend(text("label", label))}
    draw = _kind(what, own, horizon).draw
    given = whole_names(Solution.plot, Line2D, line_properties)
    if given and what == "free_bodies":
        raise TypeError(f"{next(iter(given))}: what = {what!r} has no lines: only arrows and rods")
    if horizon is not None:
        valid_until = solution.valid_until(horizon)
    return draw(
        Request(
            solution=solution,
            ax=ax,
            new_figure=new_figure,
            valid_until=valid_until,
            horizon=horizon,
            properties=given,
            **own,
        )
    )


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

    The figure is shaded past ``valid_until``, s, if that is known; ``horizon`` is as in
    `pendcore.Solution.plot`.
    """
    from matplotlib.figure import Figure

    first, *_ = plot(
        solution, what, None, horizon, {"t": t}, {}, new_figure=Figure, valid_until=valid_until
    )
    figure: Any = first.get_figure(root=True)
    drawn = BytesIO()  # matplotlib's PDF breaks off with an error of its own if the disk is full
    kind = Path(path).suffix.removeprefix(".")
    figure.savefig(drawn, dpi=150, format=kind or None)
    Path(path).write_bytes(drawn.getvalue())


def _kind(what: str, own: dict[str, Any], horizon: float | None) -> Kind:
    """Return a kind of figure; ValueError if there is none, or if it has no such parameter."""
    require_name(what)
    if what not in KINDS:
        raise ValueError(f"what = {what!r}: {did_you_mean(what, KINDS)}")
    kind = _FIGURES[what]
    for name, value in own.items():
        if value is not None and name not in kind.takes:
            having = [repr(x) for x, one in _FIGURES.items() if name in one.takes]
            raise ValueError(f"{name}: belongs to what = {' and '.join(having)}")
    if horizon is not None:
        positive("horizon", horizon, "rad")
        if "horizon" not in kind.takes:
            raise ValueError(f"horizon: what = {what!r} shows no times past which it could shade")
    return kind
