"""Everything that matplotlib draws: figures of runs, maps of ensembles, films."""

from __future__ import annotations

from pendcore.plotting.axes import grid, legend_above, new_axes, one_axes
from pendcore.plotting.map import MAP_SIZE, Axis, Shown, draw_map, shown_of, values_of
from pendcore.plotting.plot import KINDS, save_figure
from pendcore.plotting.style import DARK, LIGHT, Theme, as_drawn, css_variables, sheet, theme_of

__all__ = [
    "DARK", "KINDS", "LIGHT", "MAP_SIZE", "Axis", "Shown", "Theme", "as_drawn", "css_variables",
    "draw_map", "grid", "legend_above", "new_axes", "one_axes", "save_figure", "sheet", "shown_of",
    "theme_of", "values_of",
]  # fmt: skip
