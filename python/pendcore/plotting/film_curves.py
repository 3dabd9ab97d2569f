"""The curves of a film, which grow with time beside or below the chain."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes

from pendcore import Solution
from pendcore.messages import Floats
from pendcore.plotting.axes import Request
from pendcore.plotting.curve import curve_of
from pendcore.plotting.over_time import draw_angles, draw_curves, draw_energy, force_name
from pendcore.plotting.style import theme_of

TYPICAL = 95
"""The percentile of forces from which on arrows grow no longer, and curves may leave their axes."""
_MOST_PANELS = 3
"""More links than these share one panel, which shows the last of them."""


Panels: TypeAlias = list[tuple[int, Callable[[list[Axes]], object]]]
"""On how many axes each kind of curves is, and what draws it there."""


def panels_of(runs: Sequence[Solution], *, energy: bool, reactions: bool) -> Panels:
    """Return the curves of a film: angles, unless others are asked for."""
    first, links, is_alone = runs[0], len(runs[0].scene.links), len(runs) == 1
    panels: Panels = []
    if energy:
        panels.append((1, lambda own: draw_energy(Request(solution=first, ax=own))))
    if reactions and is_alone:
        panels.append((1, lambda own: _draw_force_magnitudes(first, own[0])))
    if not panels and is_alone and links <= _MOST_PANELS:
        panels.append((links, lambda own: draw_angles(Request(solution=first, ax=own))))
    return panels or [(1, lambda own: _draw_last_angles(runs, own[0]))]


class GrowingCurves:
    """The curves beside or below the chain, which grow with time."""

    def __init__(self, panels: Panels, axes: Sequence[Axes], times: Floats) -> None:
        rest = list(axes)
        for rows, draw in panels if axes else ():
            draw(rest[:rows])
            rest = rest[rows:]
        self._times, sense = times, np.sign(times[-1] - times[0])
        self._lines = [line for axis in axes for line in axis.lines]
        self._data = [np.array(line.get_data()) for line in self._lines]
        self._until = [np.searchsorted(sense * t, sense * times, "right") for t, _ in self._data]
        self._now = [axis.axvline(times[0], color=theme_of(axis).ink, lw=1.0) for axis in axes]
        self.artists: list[Artist] = [*self._lines, *self._now]

    def show(self, k: int) -> None:
        """Let the curves end at frame k."""
        for line, data, until in zip(self._lines, self._data, self._until, strict=True):
            line.set_data(*data[:, : until[k]])
        for line in self._now:
            line.set_xdata(self._times[[k, k]])


def _draw_force_magnitudes(run: Solution, axis: Axes) -> None:
    """Draw the magnitude of the force at each joint, or the first six, N.

    Peaks leave the axes where they are far above what is typical.
    """
    t, q, qd, _ = curve_of(run)
    magnitudes = np.hypot(*np.moveaxis(run.scene.reactions(t, q, qd), -1, 0)).T
    colors = theme_of(axis).links
    few = enumerate(zip(magnitudes, colors, strict=False))
    curves = {f"$|{force_name(i, i + 1)}|$": one for i, one in few}
    draw_curves(Request(solution=run), [axis], t, {"force (N)": curves})
    typical = float(np.percentile(magnitudes.max(axis=0), TYPICAL))
    if magnitudes.max() > 1.5 * typical:
        axis.set_ylim(0.0, 1.5 * typical)


def _draw_last_angles(runs: Sequence[Solution], axis: Axes) -> None:
    """Draw the angle of the last link of each run, deg."""
    theme, n = theme_of(axis), {len(one.scene.links) for one in runs}
    name = f"$q_{{{n.pop()}}}$" if len(n) == 1 else "last $q$"
    for k, one in enumerate(runs):
        curve = curve_of(one)
        values = np.rad2deg(curve.q[:, -1]), theme.run(k)
        asked = Request(solution=one, properties={"linestyle": "-"})
        draw_curves(asked, [axis], curve.t, {f"{name} (deg)": {name: values}})
