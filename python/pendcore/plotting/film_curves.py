"""The curves of a film, which grow with time beside or below the chain."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from pendcore import Solution
from pendcore.plotting.axes import Request, grid
from pendcore.plotting.curve import curve_of
from pendcore.plotting.over_time import draw_angles, draw_energies, draw_force_sizes
from pendcore.plotting.style import theme_of

if TYPE_CHECKING:
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

TYPICAL = 95
"""The percentile of forces from which on arrows grow no longer, and curves may leave their axes."""
_MOST_PANELS = 3
"""More links than these share one panel, which shows the last of them."""


def panels_of(runs: Sequence[Solution], *, energy: bool, reactions: bool) -> dict[str, int]:
    """Return which curves a film shows, and on how many axes: angles, unless others are asked."""
    kinds = {"energy": 1} if energy else {}
    kinds |= {"reactions": 1} if reactions and len(runs) == 1 else {}
    n = len(runs[0].scene.links)
    return kinds or {"angles": n if len(runs) == 1 and n <= _MOST_PANELS else 1}


class GrowingCurves:
    """The curves beside or below the chain, which grow with time."""

    def __init__(
        self, runs: Sequence[Solution], panels: dict[str, int], axes: Sequence[Axes]
    ) -> None:
        begin = 0
        for kind, rows in panels.items() if axes else ():
            own, begin = list(axes[begin : begin + rows]), begin + rows
            asked = Request(solution=runs[0], ax=own)
            if kind == "energy":
                draw_energies(asked)
            elif kind == "reactions":
                draw_force_sizes(asked, TYPICAL)
            elif len(own) == len(runs[0].scene.links):
                draw_angles(asked)
            else:
                _draw_last_angles(runs, own[0])
        self._lines = [line for axis in axes for line in axis.lines]
        self._data = [np.array(line.get_data()) for line in self._lines]
        self._direction = 1.0 if runs[0].t_reached >= runs[0].t_span[0] else -1.0
        begin_at = runs[0].t_span[0]
        self._now = [axis.axvline(begin_at, color=theme_of(axis).ink, lw=1.0) for axis in axes]
        self.artists: list[Artist] = [*self._lines, *self._now]

    def show(self, time: float) -> None:
        """Let the curves end at a time, s."""
        for line, (t, values) in zip(self._lines, self._data, strict=True):
            until = int(np.searchsorted(self._direction * t, self._direction * time, "right"))
            line.set_data(t[:until], values[:until])
        for line in self._now:
            line.set_xdata([time, time])


def _draw_last_angles(runs: Sequence[Solution], axis: Axes) -> None:
    """Draw the angle of the last link of each run, deg."""
    theme = theme_of(axis)
    for k, one in enumerate(runs):
        curve = curve_of(one)
        axis.plot(curve.t, np.rad2deg(curve.q[:, -1]), color=theme.runs[k % len(theme.runs)])
    n = {len(one.scene.links) for one in runs}
    name = f"$q_{{{n.pop()}}}$" if len(n) == 1 else "last $q$"
    axis.set(xlabel="t (s)", ylabel=f"{name} (deg)")
    axis.margins(x=0)
    grid(axis)
