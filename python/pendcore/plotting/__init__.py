"""Everything that matplotlib draws: figures of runs, maps of ensembles, films."""

from __future__ import annotations

from pendcore.plotting.map import Axis, Shown, draw_map, is_wide, new_axes
from pendcore.plotting.plot import KINDS, save_figure
from pendcore.plotting.style import as_drawn

__all__ = ["KINDS", "Axis", "Shown", "as_drawn", "draw_map", "is_wide", "new_axes", "save_figure"]
