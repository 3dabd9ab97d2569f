"""The picture of a film: axes that stay, and what moves on them from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats, number, positive, text
from pendcore.plotting.axes import NewFigure, Request, figure_of_pyplot
from pendcore.plotting.film_curves import TYPICAL, GrowingCurves, panels_of
from pendcore.plotting.frames import Moves, frame_times, moves_of
from pendcore.plotting.poses import draw_scale
from pendcore.plotting.style import Theme, applied, in_legend, keep_style, theme_of

if TYPE_CHECKING:
    from matplotlib.animation import FuncAnimation
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HEIGHT = 4.5
"""inches, of a film in 16:9, whatever its pixels: letters take the same share of every film."""
LETTERS, CLOCK = 14.0, 22.0
"""Points: a film 320 pixels wide has them 8 and 12 pixels high."""
_LETTERING = {"font.size": LETTERS, "legend.handlelength": 0.7, "legend.columnspacing": 0.8}
_LONGEST, _SHORTEST = 0.4, 0.14
"""The lengths of arrows as shares of the total length; the longest from this percentile on."""
_ROOM = 0.18
"""The way from the head of an arrow to its text, as a share of the total length."""
_TAIL = 24
"""The trace fades in so many parts."""


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
    size = HEIGHT * 16 / 9, HEIGHT
    stage = Stage(solutions, partial(figure_of_pyplot, figsize=size), choices, known)
    frames, interval = len(stage.times), 1000.0 / choices.fps
    return FuncAnimation(stage.figure, stage.show, frames, interval=interval, blit=True)


def names_of(runs: Sequence[Solution], given: Sequence[str | None] | None) -> tuple[str, ...]:
    """Return what the runs are called beside their tips; nothing for one that is alone."""
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
        limit = choices.horizon
        ends = [one.t_reached if limit is None else one.valid_until(limit) for one in solutions]
        pairs = zip(solutions, ends, strict=True)
        last_right = [_last_right_frame(one, self.times, end) for one, end in pairs]
        with applied(_LETTERING):
            self.figure = new_figure()
            kinds = panels_of(dense, energy=choices.energy, reactions=choices.reactions)
            scenes, panels = _layout(self.figure, len(dense), sum(kinds.values()), choices)
            self._curves = GrowingCurves(dense, kinds, panels)
            arrows = [_arrows(one, moves) if choices.reactions else None for one in moves]
            for axis in scenes:
                _frame_scene(axis, moves, [one for one in arrows if one is not None])
            self._players = []
            for k, (one, until) in enumerate(zip(moves, last_right, strict=True)):
                axis, count = scenes[k % len(scenes)], one.places.shape[1] - 1
                colors = _colors(theme_of(axis), k, count, is_alone=len(moves) == 1)
                self._players.append(
                    _Player(axis, one, colors, choices, until, arrows[k], names[k])
                )
            how: dict[str, Any] = {"transform": scenes[0].transAxes, "va": "top", "fontsize": CLOCK}
            self._clock = scenes[0].text(0.03, 0.97, "", **how)
            if limit is not None:
                _say_horizon(solutions, choices, ends, scenes[0], panels)
        self._pace = "" if choices.speed == 1.0 else f"  (x{choices.speed:g})"
        for artist in self.moving():
            artist.set_animated(True)

    def moving(self) -> list[Artist]:
        """Return what has to be drawn anew in each frame, the lowest first."""
        moving = [artist for player in self._players for artist in player.artists]
        return [*moving, self._clock, *self._curves.artists]

    def show(self, k: int) -> list[Artist]:
        """Move everything to where it is in frame k, and return it."""
        taken: list[Floats] = []
        for player in self._players:
            player.show(k, taken)
        self._curves.show(self.times[k])
        self._clock.set_text(f"t = {self.times[k]:.2f} s{self._pace}")
        return self.moving()


class _Player:
    """One chain: its links, the trace of its tip, the forces at its joints, its name."""

    def __init__(
        self,
        axis: Axes,
        moves: Moves,
        colors: Sequence[str],
        choices: Choices,
        last_right: int,
        arrows: Floats | None,
        name: str,
    ) -> None:
        from matplotlib.collections import LineCollection

        self._axis, self._colors, self._moves = axis, colors, moves
        self._theme, self._last_right, self._forces = theme_of(axis), last_right, arrows
        frames = (choices.trace or 0.0) * choices.fps / choices.speed
        self._behind = round(min(frames, len(moves.places)))
        alpha = np.linspace(0.05, 0.8, _TAIL)
        self._trace = LineCollection([], linewidths=1.8, alpha=alpha, capstyle="butt", zorder=2)
        axis.add_collection(self._trace, autolim=False)
        slim = min(1.0, 12 / len(colors))  # where there are many links
        how: dict[str, Any] = {
            "linewidth": max(6 * slim**0.5, 3.0),
            "solid_capstyle": "round",
            "zorder": 3,
        }
        self._links = [axis.plot([], [], color=color, **how)[0] for color in colors]
        ink = self._theme.ink
        (self._joints,) = axis.plot([], [], "o", color=ink, markersize=6.5 * slim, zorder=4)
        self.artists: list[Artist] = [self._trace, *self._links, self._joints]
        self._name: Any = None
        if arrows is not None:
            n, color = arrows.shape[1], self._theme.force
            self._arrows: Any = axis.quiver(
                *np.zeros((4, n)), color=color, angles="xy", scale_units="xy", scale=1.0,
                width=0.008, headwidth=3.6, headlength=4.0, headaxislength=4.0, zorder=5,
            )  # fmt: skip
            self._sizes = [self._text(color, ha="center", va="center") for _ in range(n)]
            self.artists += [self._arrows, *self._sizes]
        if name:
            self._name = self._text(self._colors[-1], va="center")
            self._name.set_text(in_legend(name))
            self.artists.append(self._name)

    def _text(self, color: str, **how: Any) -> Any:
        """Return a text that can be read in front of anything."""
        from matplotlib.patheffects import withStroke

        halo = withStroke(linewidth=4.0, foreground=self._theme.ground)
        return self._axis.text(0.0, 0.0, "", color=color, path_effects=[halo], zorder=6, **how)

    def show(self, k: int, taken: list[Floats]) -> None:
        """Move everything to frame k; names keep clear of those of others, ``taken``."""
        places, is_right = self._moves.places[k], k <= self._last_right
        colors = self._colors if is_right else [self._theme.lost] * len(self._links)
        for i, (link, color) in enumerate(zip(self._links, colors, strict=True)):
            link.set_data(*places[i : i + 2].T)
            link.set_color(color)
        self._joints.set_data(*places.T)
        if self._behind > 0:
            parts = self._moves.parts
            tail = self._moves.path[parts * max(k - self._behind, 0) : parts * k + 1]
            cuts = np.linspace(0, len(tail) - 1, _TAIL + 1).astype(int)
            self._trace.set_segments([tail[i : j + 1] for i, j in pairwise(cuts)])
            self._trace.set_color(colors[-1])
        if self._forces is not None:
            self._show_forces(places, self._forces[k], self._moves.reactions[k])
        if self._name is not None:
            self._show_name(places, taken)

    def _show_forces(self, places: Floats, arrows: Floats, forces: Floats) -> None:
        """Draw the arrows, m, and write the forces, N, at their heads, off the rods."""
        newtons = np.hypot(*forces.T)
        self._arrows.set_offsets(places[:-1])
        self._arrows.set_UVC(*arrows.T)
        room = _ROOM * self._moves.total_length
        for joint, along, size, force in zip(places, arrows, self._sizes, newtons, strict=False):
            length = np.hypot(*along) or 1.0
            ahead, aside = room * along / length, room * along[::-1] / length * [1.0, -1.0]
            sides = [ahead, 0.7 * ahead + aside, 0.7 * ahead - aside]
            spots = joint + along + np.array(sides)
            clear = [_distance(spot, places) for spot in spots]
            best = 0 if clear[0] > 0.7 * room else int(np.argmax(clear))
            size.set_position(spots[best])
            size.set_text(f"{force:.3g} N" if np.any(along) else "")

    def _show_name(self, places: Floats, taken: list[Floats]) -> None:
        """Write the name beyond the tip, as the last link points, and clear of other names."""
        left, right = self._axis.get_xlim()
        low, high = sorted(self._axis.get_ylim())
        line = LETTERS / 72 / HEIGHT * 1.2 * (high - low)
        wide = 0.5 * line * len(self._name.get_text())
        tip, along = places[-1], places[-1] - places[-2]
        side = 1.0 if along[0] >= 0 else -1.0
        if not left < tip[0] + side * (wide + line) < right:
            side = -side
        begin = tip[0] + 0.5 * side * line
        left, right = sorted([begin, begin + side * wide])
        height = tip[1]
        while any(
            left < other[1] and other[0] < right and abs(height - other[2]) < 0.99 * line
            for other in taken
        ):
            height += line if along[1] >= 0 else -line
        taken.append(np.array([left, right, height]))
        self._name.set_position((begin, height))
        self._name.set_ha("left" if side > 0 else "right")


def _colors(theme: Theme, k: int, links: int, *, is_alone: bool) -> list[str]:
    """Return the colours of the links of run k: their own if it is alone and they are few."""
    if is_alone:
        return list(theme.links[:links]) if links <= len(theme.links) else [theme.blue] * links
    return [theme.runs[k % len(theme.runs)]] * links


def _arrows(moves: Moves, runs: Sequence[Moves]) -> Floats:
    """Return the arrows of the forces, m, (k, n, 2): neither so long nor so short as they are."""
    every = np.concatenate([np.hypot(*np.moveaxis(x.reactions, -1, 0)).ravel() for x in runs])
    typical = float(np.percentile(every, TYPICAL)) or 1.0
    sizes = np.hypot(*np.moveaxis(moves.reactions, -1, 0))[..., np.newaxis]
    longest, shortest = np.array([_LONGEST, _SHORTEST]) * max(x.total_length for x in runs)
    lengths = np.clip(longest * sizes / typical, shortest, longest) * (sizes > 1e-6 * typical)
    arrows: Floats = moves.reactions / np.maximum(sizes, 1e-300) * lengths
    return arrows


def _distance(spot: Floats, places: Floats) -> float:
    """Return how far a spot is from the nearest of the links between places, m."""
    begin, along = places[:-1], np.diff(places, axis=0)
    squares = np.maximum((along**2).sum(axis=1), 1e-300)
    share = np.clip(((spot - begin) * along).sum(axis=1) / squares, 0.0, 1.0)
    return float(np.hypot(*(begin + share[:, np.newaxis] * along - spot).T).min())


def _layout(
    figure: Figure, count: int, rows: int, choices: Choices
) -> tuple[list[Axes], list[Axes]]:
    """Return the axes of ``count`` chains, which fill their part of the figure, and of curves.

    In a wide frame the curves stand beside a square stage. In another they stand below, where they
    are asked for; so they do where chains are side by side.
    """
    width, height = figure.get_size_inches()
    is_wide = width > 1.5 * height and not choices.beside
    stage: Any = figure
    panels: list[Axes] = []
    if is_wide or choices.energy or choices.reactions:
        figure.set_layout_engine("constrained")
        parts: Any
        if is_wide:
            parts = figure.subfigures(1, 2, width_ratios=[height, width - height])
        else:
            parts = figure.subfigures(2, 1, height_ratios=[2, rows])
        stage, beside = parts
        panels = list(beside.subplots(rows, 1, squeeze=False, sharex=True)[:, 0])
        for axis in panels:
            keep_style(axis)
    columns = count if choices.beside else 1
    return [stage.add_axes((k / columns, 0.0, 1 / columns, 1.0)) for k in range(columns)], panels


def _frame_scene(axis: Axes, moves: Sequence[Moves], arrows: Sequence[Floats]) -> None:
    """Fix the limits so that nothing ever leaves the picture, and draw pivots and a scale."""
    reach = moves[0].total_length
    ends = [one.places[:, :-1] + along for one, along in zip(moves, arrows, strict=False)]
    places = np.concatenate([x.reshape(-1, 2) for x in (*(one.places for one in moves), *ends)])
    low, high = places.min(axis=0), places.max(axis=0)
    room = 2 * _ROOM * reach if len(arrows) else 0.0  # for the texts beyond the heads
    margin = max(0.12 * max(float((high - low).max()), 0.2 * reach), room)
    clock = [0.0, 0.12 * float((high - low).max())]
    axis.plot(*np.array([low - margin - clock, high + margin]).T, alpha=0.0)
    axis.set_aspect("equal", adjustable="datalim")
    axis.margins(0.0)
    axis.invert_yaxis()
    axis.set_axis_off()
    theme = theme_of(axis)
    pivots = np.unique(np.concatenate([one.places[:1, 0] for one in moves]), axis=0)
    axis.plot(*pivots.T, "^", color=theme.quiet, markersize=12, zorder=1, linestyle="")
    draw_scale(axis, np.array([low[0] - 0.7 * margin, high[1] + 0.7 * margin]), reach)


def _say_horizon(runs: Sequence[Solution], choices: Choices, ends: Sequence[float],
                 stage: Axes, panels: Sequence[Axes]) -> None:  # fmt: skip
    """Write below the clock until when all runs are right, and shade the curves after that."""
    first = min(range(len(runs)), key=lambda k: abs(ends[k] - runs[k].t_span[0]))
    asked = Request(solution=runs[first], horizon=choices.horizon, valid_until=ends[first])
    asked.shade(panels)
    if ends[first] != runs[first].t_reached:
        color = theme_of(stage).quiet
        how: dict[str, Any] = {"transform": stage.transAxes, "va": "top", "color": color}
        stage.text(0.03, 0.87, asked.until(), **how)


def _last_right_frame(solution: Solution, times: Floats, until: float) -> int:
    """Return the last frame in which a run is right, if it is right until a time, s."""
    if until == solution.t_reached:
        return len(times)
    past = (times - until) * (1 if times[-1] >= times[0] else -1) > 0
    return int(np.argmax(past)) - 1 if past.any() else len(times)
