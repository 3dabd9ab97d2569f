"""What is asked of a figure, and the axes on which it is drawn."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from inspect import signature
from math import ceil
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from pendcore import Solution
from pendcore.messages import require_known
from pendcore.plotting.style import applied, keep_style, theme_of

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NewFigure: TypeAlias = Callable[..., "Figure"]
"""Makes a new figure: pyplot's, or one of its own."""


def figure_of_pyplot(*args: Any, **named: Any) -> Figure:
    """Return a new figure that pyplot shows when it is asked to."""
    import matplotlib.pyplot as plt

    return plt.figure(*args, **named)


@dataclass(frozen=True, slots=True, kw_only=True)
class Request:
    """What is asked of a figure; `pendcore.Solution.plot` says what ``ax`` to ``link`` mean.

    What lies past ``valid_until``, s, is shaded or pale; the error reaches ``horizon``, rad, then.
    The properties are those of the lines; ``new_figure`` is called where no axes are given.
    """

    solution: Solution
    ax: Any = None
    label: str | None = None
    t: npt.ArrayLike | None = None
    event: int | None = None
    link: int | None = None
    new_figure: NewFigure = figure_of_pyplot
    valid_until: float | None = None
    horizon: float | None = None
    properties: dict[str, Any] = field(default_factory=dict)

    def several_axes(
        self, counts: Sequence[int], which: str, columns: int = 1, last: float = 1.0
    ) -> list[Axes]:
        """Return the axes that were given, or the most of ``counts`` in a new figure.

        The last row is ``last`` times as high as the others.
        """
        if self.ax is not None:
            return checked_axes(self.ax, counts, which)
        count = max(counts)
        rows = ceil(count / columns)
        columns = ceil(count / rows)
        heights = [1.0] * (rows - 1) + [last]
        tall = max(3.6, 0.6 + 1.8 * sum(heights))
        size = (6.4, tall) if columns == 1 else (3.2 * columns, 3.2 * rows)
        shared = "col" if columns == 1 else "none"
        how: dict[str, Any] = {"sharex": shared, "height_ratios": heights}
        axes = new_axes(size, rows, columns, self.new_figure, **how)
        for unused in axes[count:]:
            unused.remove()
        return axes[:count]

    def name_of(self, curve: str) -> str:
        """Return what the legend calls a curve: with the solution's label, if that has one."""
        return curve if self.label is None else f"{curve}, {self.label}"

    @property
    def until(self) -> float:
        """The time until which the run is right, s, as far as is known."""
        return self.solution.t_reached if self.valid_until is None else self.valid_until

    @property
    def is_right_to_its_end(self) -> bool:
        return self.until == self.solution.t_reached

    def shade(self, axes: Sequence[Axes]) -> None:
        """Shade the times past which nothing is right; the legend of the first axes says so."""
        if self.is_right_to_its_end:
            self.say_right_to_its_end(axes[0])
            return
        for k, axis in enumerate(axes):
            how: dict[str, Any] = {"facecolor": theme_of(axis).line, "alpha": 0.6, "zorder": 0}
            how["label"] = "_" * k + self.after()
            axis.axvspan(self.until, self.solution.t_reached, **how)

    def say_right_to_its_end(self, axis: Axes) -> None:
        """Let the legend say that the run is right to its end, if it was asked until when it is."""
        said = f"{self._whose()}{self.right()}\nto the end"
        if self.horizon is not None and self.is_right_to_its_end and said not in named(axis):
            axis.scatter([], [], s=0.0, label=said)

    def _whose(self) -> str:
        return "" if self.label is None else f"{self.label}: "

    def right(self) -> str:
        """Return the words for what is right."""
        return "right" if self.horizon is None else f"right to {self.horizon:g} rad"

    def after(self) -> str:
        """Return the words for what lies past the time until which a run is right."""
        return f"{self._whose()}not {self.right()}\nafter {self.until:.4g} s"


def named(axis: Axes) -> set[str]:
    """Return what the legends of all axes of a figure name."""
    return {x for other in axis.figure.axes for x in other.get_legend_handles_labels()[1]}


def new_axes(
    size: tuple[float, float],
    rows: int = 1,
    columns: int = 1,
    new_figure: NewFigure = figure_of_pyplot,
    **grid_properties: Any,
) -> list[Axes]:
    """Return the axes of a new figure in the house's style, row by row; columns share their x."""
    how = {"squeeze": False, "sharex": "col", **grid_properties}
    with applied():
        figure = new_figure(figsize=size, layout="constrained")
        axes = list(figure.subplots(rows, columns, **how).ravel())
        for axis in axes:
            keep_style(axis)
    return axes


def one_axes(ax: Any, size: tuple[float, float], new_figure: NewFigure = figure_of_pyplot) -> Axes:
    """Return the axes that were given, or those of a new figure of a size, inches."""
    return new_axes(size, new_figure=new_figure)[0] if ax is None else checked_axes(ax, (1,), "")[0]


def legend_above(
    axis: Axes, handles: Sequence[Artist] | None = None, columns: int = 3, title: str | None = None
) -> None:
    """Name the curves, or the handles, above the axes, where no curve is, row by row."""
    handles = axis.get_legend_handles_labels()[0] if handles is None else handles
    for count in range(columns if handles else 0, 0, -1):
        by_rows = [handle for k in range(count) for handle in handles[k::count]]
        with applied():
            legend = axis.legend(
                handles=by_rows, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=count,
                borderaxespad=0.2, borderpad=0.0, title=title, alignment="left",
            )  # fmt: skip
        if legend.get_window_extent().width < 1.1 * axis.get_window_extent().width:
            return  # constrained layout will make the axes a little wider


def checked_axes(ax: Any, counts: Sequence[int], which: str) -> list[Axes]:
    """Return the given axes as a list; TypeError or ValueError unless they are one of `counts`."""
    from matplotlib.axes import Axes

    axes = list(np.ravel(ax))
    told = ", or ".join(dict.fromkeys("one" if k == 1 else f"{k}, {which}" for k in counts))
    if not all(isinstance(axis, Axes) for axis in axes):
        raise TypeError(f"ax = {ax!r}: must be matplotlib Axes, {told}")
    if len(axes) not in counts:
        raise ValueError(f"ax: {len(axes)} axes: must be {told}")
    return axes


def require_name(what: object) -> None:
    """Raise a TypeError unless what is drawn is given by its name."""
    if not isinstance(what, str):
        kind = type(what).__name__
        raise TypeError(f"what: is of type {kind}: must name what is drawn; axes are given by ax=")


def whole_names(
    plot: Callable[..., Any],
    artist: type[Artist],
    given: dict[str, Any],
    others: Sequence[str] = (),
) -> dict[str, Any]:
    """Return properties of what a method draws by their whole names.

    TypeError for one that neither the artist has nor matplotlib takes besides (``others``).
    """
    from matplotlib.artist import ArtistInspector
    from matplotlib.cbook import normalize_kwargs

    whole: dict[str, Any] = normalize_kwargs(given, artist)
    _, *own, _ = signature(plot).parameters
    ours = {"array", "data", "xdata", "ydata", "figure"}
    known = {*ArtistInspector(artist).get_setters(), *others} - ours
    require_known(plot.__qualname__, whole, [*own, *sorted(known)])
    return whole


def grid(axis: Axes) -> None:
    """Draw the house's grid."""
    axis.grid(True, color=theme_of(axis).line, linewidth=0.6)
    axis.set_axisbelow(True)


def point_style(t: npt.NDArray[np.float64]) -> str:
    """Return how points are marked: a single one can be seen, those of a curve cannot."""
    return "." if len(t) == 1 else ""
