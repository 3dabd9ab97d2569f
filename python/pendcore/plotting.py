"""What figures of runs share: axes to scale, the horizon, energies, maps, files."""

from __future__ import annotations

from pendcore._ensemble.figure import Axis, Shown, draw_map, is_wide, new_axes
from pendcore._figures.axes import as_drawn, figure_of_pyplot, horizon_time, in_legend, in_plane
from pendcore._figures.over_time import draw_energies
from pendcore._figures.plot import KINDS, save_figure

__all__ = [
    "KINDS",
    "Axis",
    "Shown",
    "as_drawn",
    "draw_energies",
    "draw_map",
    "figure_of_pyplot",
    "horizon_time",
    "in_legend",
    "in_plane",
    "is_wide",
    "new_axes",
    "save_figure",
]
