"""The picture of a film: axes that stay, and what moves on them from frame to frame."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from matplotlib.animation import FuncAnimation
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from pendcore import Solution
from pendcore.messages import Floats, number, positive, text
from pendcore.plotting.axes import NewFigure, Request, figure_of_pyplot
from pendcore.plotting.curve import curve_of
from pendcore.plotting.film_curves import TYPICAL, GrowingCurves, panels_of
from pendcore.plotting.frames import Moves, frame_times, moves_of
from pendcore.plotting.poses import arrows_of, draw_scale, total_length
from pendcore.plotting.sketch import direction
from pendcore.plotting.style import applied, in_legend, keep_style, theme_of

HEIGHT = 4.5
"""inches, of a film in 16:9, whatever its pixels: letters take the same share of every film."""
LETTERS, CLOCK = 14.0, 22.0
"""Points: a film 320 pixels wide has them 8 and 12 pixels high."""
_LETTERING = {"font.size": LETTERS, "legend.handlelength": 0.7, "legend.columnspacing": 0.8}
_MOST_NUMBERS = 6
"""The most joints whose forces are written: more numbers would lie on each other."""
_SIDES = np.array([0.0, 0.8, -0.8, 1.6, -1.6])
"""rad, from the direction of an arrow: where its force may be written, what is best first."""
_TAIL = 24
"""The trace fades in so many parts."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Film:
    """The runs of a film, what it shows, and how fast: see `pendcore.Solution.to_video`."""

    solutions: Sequence[Solution]
    names: Sequence[str | None] | None = None
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
            wanted = "must be >= 0 (s); inf shows the whole path"
            raise ValueError(f"trace = {float(self.trace)}: {wanted}")


def animate(film: Film) -> FuncAnimation:
    """Return matplotlib's animation; it must be kept as long as it is to move."""
    new_figure = partial(figure_of_pyplot, figsize=(HEIGHT * 16 / 9, HEIGHT))
    stage = Stage(film, new_figure)
    frames, interval = len(stage.times), 1000.0 / film.fps
    return FuncAnimation(stage.figure, stage.show, frames, interval=interval, blit=True)


def _names_of(runs: Sequence[Solution], given: Sequence[str | None] | None) -> tuple[str, ...]:
    """Return what the runs are called beside their tips; nothing for one that is alone."""
    for one in runs:
        if not isinstance(one, Solution):
            raise TypeError(f"{one!r}: must be a Solution, to be shown beside this one")
    if given is None:
        return tuple(one.name if len(runs) > 1 else "" for one in runs)
    if isinstance(given, str) or len(given) != len(runs):
        raise ValueError(f"names = {given!r}: must be {len(runs)}, one for each run")
    return tuple(text(f"names[{k}]", "" if x is None else str(x)) for k, x in enumerate(given))


class _Run(NamedTuple):
    """A run with dense output, its name, and where it is in each frame, its arrows in m."""

    asked: Request
    name: str
    moves: Moves
    arrows: Floats


class Stage:
    """A figure, and what has to be drawn anew in each of its frames, at ``times``, s, (k,)."""

    def __init__(self, film: Film, new_figure: NewFigure) -> None:
        """Open a figure once all that can fail is computed."""
        known = _names_of(film.solutions, film.names)
        self.times = frame_times(film.solutions, film.fps, film.speed)
        dense = [one.with_dense_output() for one in film.solutions]
        moves = [moves_of(one, self.times) for one in dense]
        limit = film.horizon
        ends = [None if limit is None else one.valid_until(limit) for one in film.solutions]
        pairs = zip(dense, ends, strict=True)
        asked = [Request(solution=x, horizon=limit, valid_until=end) for x, end in pairs]
        forces = np.concatenate([one.reactions.reshape(-1, 2) for one in moves])
        full = float(np.percentile(np.hypot(*forces.T), TYPICAL))
        reach = max(total_length(one.scene) for one in dense)
        arrows = [arrows_of(one.reactions, full, reach) * film.reactions for one in moves]
        runs = [_Run(*one) for one in zip(asked, known, moves, arrows, strict=True)]
        with applied(_LETTERING):
            self.figure = new_figure()
            curves = panels_of(dense, energy=film.energy, reactions=film.reactions)
            rows = sum(rows for rows, _ in curves)
            scenes, panels = _layout(self.figure, rows, film)
            self._curves = GrowingCurves(curves, panels, self.times)
            for axis in scenes:
                _frame_scene(axis, runs, reach)
            self._chains = []
            for k, one in enumerate(runs):
                axis, links = scenes[k % len(scenes)], range(len(one.asked.solution.scene.links))
                theme = theme_of(axis)
                colors = [theme.link(i) if len(runs) == 1 else theme.run(k) for i in links]
                self._chains.append(_Chain(axis, one, colors, film.trace, self.times))
            first = scenes[0]
            how: dict[str, Any] = {"transform": first.transAxes, "va": "top"}
            self._clock = first.text(0.03, 0.97, "", fontsize=CLOCK, **how)
            told = _told(asked, film.speed, panels)
            first.text(0.03, 0.87, told, color=theme_of(first).quiet, **how)
        self._moving: list[Artist] = [one for chain in self._chains for one in chain.artists]
        self._moving += [self._clock, *self._curves.artists]
        for artist in self._moving:
            artist.set_animated(True)

    def show(self, k: int) -> list[Artist]:
        """Move everything to where it is in frame k, and return it, the lowest first."""
        taken: list[tuple[Floats, Floats]] = []
        for chain in self._chains:
            chain.show(k, taken)
        self._curves.show(k)
        self._clock.set_text(f"t = {self.times[k]:.2f} s")
        return self._moving


class _Chain:
    """One chain: its links, the trace of its tip, the forces at its joints, its name."""

    def __init__(
        self, axis: Axes, run: _Run, colors: Sequence[str], trace: float | None, times: Floats
    ) -> None:
        self._axis, self._run, self._colors, self._theme = axis, run, colors, theme_of(axis)
        sense = np.sign(times[-1] - times[0])
        asked = run.asked
        self._is_right = asked.is_right_to_its_end | (sense * (times - asked.until) <= 0)
        t, q, _, _ = curve_of(asked.solution)
        self._path = asked.solution.scene.positions(t, q)[:, -1]
        ends = sense * times - np.array([[trace or 0.0], [0.0]])
        self._tails = np.searchsorted(sense * t, ends, "right").T
        alpha = np.linspace(0.05, 0.8, _TAIL)
        self._trace = LineCollection([], linewidths=1.8, alpha=alpha, capstyle="butt", zorder=2)
        axis.add_collection(self._trace, autolim=False)
        slim = min(1.0, 12 / len(colors))  # where there are many links
        how: dict[str, Any] = {"linewidth": max(6 * slim**0.5, 3.0), "solid_capstyle": "round"}
        self._links = [axis.plot([], [], color=color, zorder=3, **how)[0] for color in colors]
        ink = self._theme.ink
        (self._joints,) = axis.plot([], [], "o", color=ink, markersize=6.5 * slim, zorder=4)
        self.artists: list[Artist] = [self._trace, *self._links, self._joints]
        self._newtons: list[Any] = []
        if run.arrows.any():
            n, color = len(colors), self._theme.force
            self._arrows: Any = axis.quiver(
                *np.zeros((4, n)), color=color, angles="xy", scale_units="xy", scale=1.0,
                width=0.008, headwidth=3.6, headlength=4.0, headaxislength=4.0, zorder=5,
            )  # fmt: skip
            few = n if n <= _MOST_NUMBERS else 0
            self._newtons = [self._text("", color) for _ in range(few)]
            self.artists += [self._arrows, *self._newtons]
        self._name = self._text(in_legend(run.name), colors[-1])
        self.artists += [self._name] * bool(run.name)

    def _text(self, text: str, color: str) -> Any:
        """Return a text that can be read in front of anything."""
        halo = withStroke(linewidth=4.0, foreground=self._theme.ground)
        how: dict[str, Any] = {"path_effects": [halo], "ha": "center", "va": "center", "zorder": 6}
        return self._axis.text(0.0, 0.0, text, color=color, **how)

    def show(self, k: int, taken: list[tuple[Floats, Floats]]) -> None:
        """Move everything to frame k; names keep clear of those of others, ``taken``."""
        places = self._run.moves.places[k]
        colors = self._colors if self._is_right[k] else [self._theme.lost] * len(self._links)
        for i, (link, color) in enumerate(zip(self._links, colors, strict=True)):
            link.set_data(*places[i : i + 2].T)
            link.set_color(color)
        self._joints.set_data(*places.T)
        tail = np.vstack([self._path[slice(*self._tails[k])], places[-1:]])
        cuts = np.linspace(0, len(tail) - 1, _TAIL + 1).astype(int)
        self._trace.set_segments([tail[i : j + 1] for i, j in pairwise(cuts)])
        self._trace.set_color(colors[-1])
        if self._run.arrows.any():
            self._show_forces(places, self._run.arrows[k], self._run.moves.reactions[k])
        if self._run.name:
            self._show_name(places, taken)

    def _show_forces(self, places: Floats, arrows: Floats, forces: Floats) -> None:
        """Draw the arrows, m, and write the forces, N, at their heads, off the rods and arrows."""
        self._arrows.set_offsets(places[:-1])
        self._arrows.set_UVC(*arrows.T)
        heads = places[:-1] + arrows
        drawn = np.linspace([*places[:-1], *places[:-1]], [*places[1:], *heads], 30).reshape(-1, 2)
        for head, along, size, force in zip(heads, arrows, self._newtons, forces, strict=False):
            size.set_text(f"{np.hypot(*force):.3g} N")
            size.set_visible(bool(along.any()))
            sides = np.arctan2(along[1], along[0]) + _SIDES
            spots = [self._beyond(size, head, direction(side)) for side in sides]
            rooms = [(np.abs(drawn - spot) - half).max(axis=1).min() for spot, half in spots]
            size.set_position(spots[int(np.argmax(np.minimum(rooms, 0.0)))][0])

    def _show_name(self, places: Floats, taken: list[tuple[Floats, Floats]]) -> None:
        """Write the name beyond the tip, as the last link points, and clear of other names."""
        along = places[-1] - places[-2]
        spot, half = self._beyond(self._name, places[-1], along / np.hypot(*along))
        step = np.copysign([0.0, 0.01 * np.ptp(self._axis.get_ylim())], along[1])
        while any((np.abs(spot - other) < half + room).all() for other, room in taken):
            spot = spot + step
        taken.append((spot, half))
        self._name.set_position(spot)

    def _beyond(self, text: Any, at: Floats, towards: Floats) -> tuple[Floats, Floats]:
        """Return where a text lies just beyond a point, but in the picture, and half its size."""
        box = text.get_window_extent().transformed(self._axis.transData.inverted())
        half = np.abs([box.width, box.height]) / 2
        reach = 0.5 * half[1] + 1.0 / np.maximum(np.abs(towards) / half, 1e-9).max()
        low, high = np.sort([self._axis.get_xlim(), self._axis.get_ylim()], axis=1).T
        edge = half + 0.3 * half[1]
        return np.clip(at + reach * towards, low + edge, high - edge), half


def _layout(figure: Figure, rows: int, film: Film) -> tuple[list[Axes], list[Axes]]:
    """Return the axes of chains, which fill their part of the figure, and of rows of curves.

    In a wide frame the curves stand beside a square stage. In another they stand below, where they
    are asked for; so they do where chains are side by side.
    """
    width, height = figure.get_size_inches()
    is_wide = width > 1.5 * height and not film.beside
    stage: Any = figure
    panels: list[Axes] = []
    if is_wide or film.energy or film.reactions:
        figure.set_layout_engine("constrained")
        shape: dict[str, Any] = {"nrows": 2, "height_ratios": [2, rows]}
        if is_wide:
            shape = {"ncols": 2, "width_ratios": [height, width - height]}
        stage, beside = figure.subfigures(**shape)
        panels = list(beside.subplots(rows, 1, squeeze=False, sharex=True)[:, 0])
        for axis in panels:
            keep_style(axis)
    columns = len(film.solutions) if film.beside else 1
    return [stage.add_axes((k / columns, 0.0, 1 / columns, 1.0)) for k in range(columns)], panels


def _frame_scene(axis: Axes, runs: Sequence[_Run], reach: float) -> None:
    """Fix the limits so that nothing ever leaves the picture, and draw pivots and a scale."""
    joints = [one.moves.places for one in runs]
    heads = [one.moves.places[:, :-1] + one.arrows for one in runs]
    drawn = np.concatenate([x.reshape(-1, 2) for x in (*joints, *heads)])
    low, high = drawn.min(axis=0), drawn.max(axis=0)
    span = float((high - low).max())
    room = 0.36 * reach * any(one.arrows.any() for one in runs)  # for the texts beyond the heads
    margin = max(0.12 * span, 0.024 * reach, room)
    clock = [0.0, 0.12 * span]
    axis.plot(*np.array([low - margin - clock, high + margin]).T, alpha=0.0)
    axis.set_aspect("equal", adjustable="datalim")
    axis.margins(0.0)
    axis.invert_yaxis()
    axis.set_axis_off()
    pivots = np.unique([places[0, 0] for places in joints], axis=0)
    how: dict[str, Any] = {"color": theme_of(axis).quiet, "markersize": 12, "zorder": 1}
    axis.plot(*pivots.T, "^", linestyle="", **how)
    draw_scale(axis, np.array([low[0] - 0.7 * margin, high[1] + 0.7 * margin]), reach)
    axis.apply_aspect()


def _told(asked: Sequence[Request], speed: float, panels: Sequence[Axes]) -> str:
    """Say how fast time passes, and until when all runs are right; shade the curves after that."""
    told = [] if speed == 1.0 else [f"{speed:g} \N{MULTIPLICATION SIGN} real time"]
    all_of_them = "all " if len(asked) > 1 else ""
    if wrong := [one for one in asked if not one.is_right_to_its_end]:
        first = min(wrong, key=lambda one: abs(one.until - one.solution.t_span[0]))
        first.shade(panels)
        told.append(f"{all_of_them}{first.right()} until {first.until:.4g} s")
    elif asked[0].horizon is not None:
        told.append(f"{all_of_them}{asked[0].right()} to the end")
    return "\n".join(told)
