"""One call for every figure of a run."""

from __future__ import annotations

import os
from collections.abc import Callable
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal, get_args

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


_ALONG_CURVES = ("label", "horizon")
_FIGURES: dict[str, tuple[Callable[[Request], list[Artist]], tuple[str, ...]]] = {
    "angles": (draw_angles, _ALONG_CURVES),
    "rates": (draw_rates, _ALONG_CURVES),
    "reactions": (draw_reactions, _ALONG_CURVES),
    "energy": (draw_energy, _ALONG_CURVES),
    "path": (draw_path, _ALONG_CURVES),
    "phase": (draw_phase, _ALONG_CURVES),
    "section": (draw_section, ("event", "link", *_ALONG_CURVES)),
    "strip": (draw_strip, ("t",)),
    "free_bodies": (draw_free_bodies, ("t",)),
}
"""What draws each kind of figure, and those of its parameters that not every kind has."""


def plot(
    solution: Solution,
    what: str,
    ax: Any,
    own: dict[str, Any],
    line_properties: dict[str, Any],
    *,
    new_figure: NewFigure = figure_of_pyplot,
    valid_until: float | None = None,
) -> list[Artist]:
    """Draw a figure of a run; see `pendcore.Solution.plot`.

    ``own`` has what only some kinds of figures take; None is what was not given. Without a horizon
    in it, what is past ``valid_until``, s, is shaded, if that is known.
    """
    from matplotlib.lines import Line2D

    require_name(what)
    if what not in KINDS:
        raise ValueError(f"what = {what!r}: {did_you_mean(what, KINDS)}")
    draw, takes = _FIGURES[what]
    own = {name: x for name, x in own.items() if x is not None}
    for name in own:
        if name not in takes:
            having = [repr(kind) for kind, (_, others) in _FIGURES.items() if name in others]
            raise ValueError(f"{name}: belongs to what = {' and '.join(having)}")
    if "label" in own:
        own["label"] = in_legend(text("label", own["label"]))
    given = whole_names(Solution.plot, Line2D, line_properties)
    if given and what == "free_bodies":
        raise TypeError(f"{next(iter(given))}: what = {what!r} has no lines: only arrows and rods")
    if "horizon" in own:
        valid_until = solution.valid_until(positive("horizon", own["horizon"], "rad"))
    own |= {"ax": ax, "new_figure": new_figure, "properties": given}
    return draw(Request(solution=solution, valid_until=valid_until, **own))


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

    own = {"t": t, "horizon": horizon}
    first, *_ = plot(solution, what, None, own, {}, new_figure=Figure, valid_until=valid_until)
    figure: Any = first.get_figure(root=True)
    drawn = BytesIO()  # matplotlib's PDF breaks off with an error of its own if the disk is full
    kind = Path(path).suffix.removeprefix(".")
    figure.savefig(drawn, dpi=150, format=kind or None)
    Path(path).write_bytes(drawn.getvalue())
