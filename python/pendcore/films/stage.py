"""The picture of a film: axes that stay, and what moves on them from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import Solution
from pendcore.films.frames import Moves, frame_times, moves_of
from pendcore.messages import number, positive
from pendcore.plotting import draw_energies, horizon_time, in_legend, in_plane

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    Floats = npt.NDArray[np.float64]

_CHAINS = ("0.1", "tab:red", "tab:blue", "tab:green", "tab:purple", "tab:brown")
_LOST = "0.72"
"""The colour of a run past the time until which it can be trusted."""
_FORCE = "tab:orange"
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


class Stage:
    """A figure, and what has to be drawn anew in each of its frames.

    Attributes
    ----------
    figure : Figure
    times : ndarray, (k,)
        The times of the frames, s.
    """

    def __init__(
        self, solutions: Sequence[Solution], figure: Figure, choices: Choices, names: Sequence[str]
    ) -> None:
        self.figure = figure
        self.times = frame_times(solutions, choices.fps, choices.speed)
        self._players: list[_Player] = []
        dense = [one.with_dense_output() for one in solutions]
        moves = [moves_of(one, self.times) for one in dense]
        scenes, strip = _layout(figure, len(solutions), choices)
        largest = max(float(np.hypot(*np.moveaxis(one.reactions, -1, 0)).max()) for one in moves)
        length = max(one.total_length for one in moves)
        scale = _ARROW * length / (largest or 1.0) if choices.reactions else 0.0
        for axis in scenes:
            _frame_scene(axis, moves, scale)
        for k, (solution, one) in enumerate(zip(solutions, moves, strict=True)):
            axis = scenes[k % len(scenes)]
            until = _last_right_frame(solution, self.times, choices)
            player = _Player(axis, one, _CHAINS[k % len(_CHAINS)], choices, until, scale)
            self._players.append(player)
            if names[k]:
                axis.plot([], [], color=player.color, linewidth=3, label=in_legend(names[k]))
        for axis in scenes:
            if axis.get_legend_handles_labels()[0]:
                axis.legend(loc="upper right", fontsize="small")
        self._clock = scenes[0].text(
            0.02, 0.98, "", transform=scenes[0].transAxes, ha="left", va="top", family="monospace"
        )
        self._pace = "" if choices.speed == 1.0 else f"  (x{choices.speed:g})"
        self._now = None if strip is None else _energy_strip(strip, dense[0])
        for artist in self.moving():
            artist.set_animated(True)

    def moving(self) -> list[Artist]:
        """Return what has to be drawn anew in each frame, the lowest first."""
        moving = [artist for player in self._players for artist in player.artists]
        return [*moving, self._clock, *([] if self._now is None else [self._now])]

    def show(self, k: int) -> list[Artist]:
        """Move everything to where it is in frame k, and return it."""
        for player in self._players:
            player.show(k)
        self._clock.set_text(f"t = {self.times[k]:.2f} s{self._pace}")
        if self._now is not None:
            self._now.set_xdata([self.times[k], self.times[k]])
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
        self.color = color
        self._moves, self._last_right, self._scale = moves, last_right, scale
        frames = _trace(choices.trace) * choices.fps / choices.speed
        self._behind = round(min(frames, len(moves.places)))
        (self._trace,) = axis.plot([], [], "-", color=color, linewidth=1.2, alpha=0.55, zorder=2)
        (self._chain,) = axis.plot(
            [], [], "o-", color=color, linewidth=4, markersize=7, solid_capstyle="round", zorder=3
        )
        self.artists: list[Artist] = [self._trace, self._chain]
        self._arrows: Any = None
        self._sizes: list[Any] = []
        if choices.reactions:
            n = moves.reactions.shape[1]
            self._arrows = axis.quiver(
                *np.zeros((4, n)), color=_FORCE, angles="xy", scale_units="xy", scale=1.0,
                width=0.004, zorder=4,
            )  # fmt: skip
            self._sizes = [
                axis.text(0.0, 0.0, "", color=_FORCE, fontsize="small", zorder=5) for _ in range(n)
            ]
            self.artists += [self._arrows, *self._sizes]

    def show(self, k: int) -> None:
        places = self._moves.places
        color = self.color if k <= self._last_right else _LOST
        self._chain.set_data(*places[k].T)
        self._chain.set_color(color)
        if self._behind > 0:
            parts = self._moves.parts
            first = parts * max(k - self._behind, 0)
            self._trace.set_data(*self._moves.path[first : parts * k + 1].T)
            self._trace.set_color(color)
        if self._arrows is not None:
            self._arrows.set_offsets(places[k, :-1])
            force = self._scale * self._moves.reactions[k]
            self._arrows.set_UVC(force[:, 0], force[:, 1])
            for at, size, newtons in zip(
                places[k, :-1] + force, self._sizes, self._moves.reactions[k], strict=True
            ):
                size.set_position((at[0], at[1]))
                size.set_text(f" {np.hypot(*newtons):.3g} N")


def _trace(given: float | None) -> float:
    """Return how much of the tip's path is shown, s."""
    if given is None:
        return 0.0
    seconds = number("trace", given, "s")
    if not seconds >= 0:
        raise ValueError(f"trace = {seconds}: must be >= 0 (s); inf shows the whole path")
    return seconds


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


def _last_right_frame(solution: Solution, times: Floats, choices: Choices) -> int:
    if choices.horizon is not None:
        positive("horizon", choices.horizon, "rad")
    valid = horizon_time(solution, choices.horizon)
    if valid is None or valid == solution.t_reached:
        return len(times)
    past = (times - valid) * (1 if times[-1] >= times[0] else -1) > 0
    return int(np.argmax(past)) - 1 if past.any() else len(times)


def _energy_strip(axis: Axes, solution: Solution) -> Line2D:
    """Draw the energies over time, and return the line that moves along."""
    draw_energies(solution, axis)
    return axis.axvline(solution.t_span[0], color="0.2", linewidth=1.0)
