"""The picture of a film: axes that stay, and what moves on them from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats, number, positive, text
from pendcore.plotting.axes import NewFigure, figure_of_pyplot, in_plane
from pendcore.plotting.frames import Moves, frame_times, moves_of
from pendcore.plotting.over_time import draw_energies
from pendcore.plotting.style import CHAINS, LOST, REACTION, in_legend

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_ARROW = 0.4
"""How long the largest arrow is, as a share of the total length."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Choices:
    """What a film shows, and how fast: see `pendcore.Solution.to_video`."""

    speed: float = 1.0
    fps: float = 30.0
    trace: float | None = 2.0
    reactions: bool = False
    energy: bool = False
    horizon: float | None = None
    beside: bool = False

    def __post_init__(self) -> None:
        """Check what is given, before anything is computed or opened."""
        positive("fps", self.fps, "1/s")
        positive("speed", self.speed, "")
        if self.horizon is not None:
            positive("horizon", self.horizon, "rad")
        if self.trace is not None and not number("trace", self.trace, "s") >= 0:
            raise ValueError(
                f"trace = {float(self.trace)}: must be >= 0 (s); inf shows the whole path"
            )


def animate(
    solutions: Sequence[Solution], names: Sequence[str | None] | None, choices: Choices
) -> FuncAnimation:
    """Return matplotlib's animation; it must be kept as long as it is to move."""
    from matplotlib.animation import FuncAnimation

    known = names_of(solutions, names)
    width = 6.4 * (len(solutions) if choices.beside else 1)
    size = min(width, 16.0), 6.4 if choices.energy else 5.4
    stage = Stage(solutions, partial(figure_of_pyplot, figsize=size), choices, known)
    frames, interval = len(stage.times), 1000.0 / choices.fps
    return FuncAnimation(stage.figure, stage.show, frames, interval=interval, blit=True)


def names_of(runs: Sequence[Solution], given: Sequence[str | None] | None) -> tuple[str, ...]:
    """Return what the legend calls the runs; nothing for one that is alone."""
    for one in runs:
        if not isinstance(one, Solution):
            raise TypeError(f"{one!r}: must be a Solution, to be shown beside this one")
    if given is None:
        return tuple(one.name if len(runs) > 1 else "" for one in runs)
    if isinstance(given, str) or len(given) != len(runs):
        raise ValueError(f"names = {given!r}: must be {len(runs)}, one for each run")
    return tuple(
        text(f"names[{k}]", "" if one is None else str(one)) for k, one in enumerate(given)
    )


class Stage:
    """A figure, and what has to be drawn anew in each of its frames.

    Attributes
    ----------
    figure : Figure
    times : ndarray, (k,)
        The times of the frames, s.
    """

    def __init__(
        self,
        solutions: Sequence[Solution],
        new_figure: NewFigure,
        choices: Choices,
        names: Sequence[str],
    ) -> None:
        """Open a figure once all that can fail is computed."""
        self.times = frame_times(solutions, choices.fps, choices.speed)
        dense = [one.with_dense_output() for one in solutions]
        moves = [moves_of(one, self.times) for one in dense]
        last_right = [_last_right_frame(one, self.times, choices.horizon) for one in solutions]
        self.figure = new_figure()
        scenes, strip = _layout(self.figure, len(solutions), choices)
        largest = max(float(np.hypot(*np.moveaxis(one.reactions, -1, 0)).max()) for one in moves)
        length = max(one.total_length for one in moves)
        scale = _ARROW * length / (largest or 1.0) if choices.reactions else 0.0
        for axis in scenes:
            _frame_scene(axis, moves, scale)
        self._players: list[_Player] = []
        for k, (one, until) in enumerate(zip(moves, last_right, strict=True)):
            axis, color = scenes[k % len(scenes)], CHAINS[k % len(CHAINS)]
            self._players.append(_Player(axis, one, color, choices, until, scale))
            if names[k]:
                axis.plot([], [], color=color, linewidth=3, label=in_legend(names[k]))
        for axis in scenes:
            if axis.get_legend_handles_labels()[0]:
                axis.legend(loc="upper right", fontsize="small")
        corner: dict[str, Any] = {"transform": scenes[0].transAxes, "ha": "left", "va": "top"}
        self._clock = scenes[0].text(0.02, 0.98, "", family="monospace", **corner)
        self._pace = "" if choices.speed == 1.0 else f"  (x{choices.speed:g})"
        self._now: list[Any] = []
        if strip is not None:
            draw_energies(dense[0], strip)
            self._now = [strip.axvline(dense[0].t_span[0], color="0.2", linewidth=1.0)]
        for artist in self.moving():
            artist.set_animated(True)

    def moving(self) -> list[Artist]:
        """Return what has to be drawn anew in each frame, the lowest first."""
        moving = [artist for player in self._players for artist in player.artists]
        return [*moving, self._clock, *self._now]

    def show(self, k: int) -> list[Artist]:
        """Move everything to where it is in frame k, and return it."""
        for player in self._players:
            player.show(k)
        self._clock.set_text(f"t = {self.times[k]:.2f} s{self._pace}")
        for line in self._now:
            line.set_xdata([self.times[k], self.times[k]])
        return self.moving()


class _Player:
    """One chain: its links, the trace of its tip, the forces at its joints."""

    def __init__(
        self,
        axis: Axes,
        moves: Moves,
        color: str,
        choices: Choices,
        last_right: int,
        scale: float,
    ) -> None:
        self._color, self._moves = color, moves
        self._last_right, self._scale = last_right, scale
        frames = (choices.trace or 0.0) * choices.fps / choices.speed
        self._behind = round(min(frames, len(moves.places)))
        (self._trace,) = axis.plot([], [], "-", color=color, linewidth=1.2, alpha=0.55, zorder=2)
        (self._chain,) = axis.plot(
            [], [], "o-", color=color, linewidth=4, markersize=7, solid_capstyle="round", zorder=3
        )
        self.artists: list[Artist] = [self._trace, self._chain]
        self._arrows: Any = None
        if choices.reactions:
            n = moves.reactions.shape[1]
            self._arrows = axis.quiver(
                *np.zeros((4, n)), color=REACTION, angles="xy", scale_units="xy", scale=1.0,
                width=0.004, zorder=4,
            )  # fmt: skip
            how: dict[str, Any] = {"color": REACTION, "fontsize": "small", "zorder": 5}
            self._sizes = [axis.text(0.0, 0.0, "", **how) for _ in range(n)]
            self.artists += [self._arrows, *self._sizes]

    def show(self, k: int) -> None:
        places = self._moves.places[k]
        color = self._color if k <= self._last_right else LOST
        self._chain.set_data(*places.T)
        self._chain.set_color(color)
        if self._behind > 0:
            parts = self._moves.parts
            first = parts * max(k - self._behind, 0)
            self._trace.set_data(*self._moves.path[first : parts * k + 1].T)
            self._trace.set_color(color)
        if self._arrows is not None:
            newtons = self._moves.reactions[k]
            force = self._scale * newtons
            self._arrows.set_offsets(places[:-1])
            self._arrows.set_UVC(*force.T)
            for at, size, one in zip(places[:-1] + force, self._sizes, newtons, strict=True):
                size.set_position(at)
                size.set_text(f" {np.hypot(*one):.3g} N")


def _layout(figure: Figure, count: int, choices: Choices) -> tuple[list[Axes], Axes | None]:
    columns = count if choices.beside else 1
    figure.set_layout_engine("constrained")
    rows = 2 if choices.energy else 1
    grid = figure.add_gridspec(rows, columns, height_ratios=[4, 1][:rows])
    scenes = [figure.add_subplot(grid[0, k]) for k in range(columns)]
    return scenes, figure.add_subplot(grid[1, :]) if choices.energy else None


def _frame_scene(axis: Axes, moves: Sequence[Moves], scale: float) -> None:
    """Fix the limits so that nothing ever leaves the picture; arrows have `scale` m a newton."""
    ends = [one.places[:, :-1] + scale * one.reactions for one in moves]
    places = np.concatenate([x.reshape(-1, 2) for x in (*(one.places for one in moves), *ends)])
    low, high = places.min(axis=0), places.max(axis=0)
    margin = 0.06 * max(float((high - low).max()), 0.2 * moves[0].total_length)
    corners = np.array([low - margin, high + margin])
    axis.plot(*corners.T, alpha=0.0)
    in_plane(axis)
    pivots = np.unique(np.concatenate([one.places[:1, 0] for one in moves]), axis=0)
    axis.plot(*pivots.T, "^", color="0.5", markersize=9, zorder=1, linestyle="")


def _last_right_frame(solution: Solution, times: Floats, horizon: float | None) -> int:
    if horizon is None:
        return len(times)
    valid = solution.valid_until(horizon)
    if valid == solution.t_reached:
        return len(times)
    past = (times - valid) * (1 if times[-1] >= times[0] else -1) > 0
    return int(np.argmax(past)) - 1 if past.any() else len(times)
