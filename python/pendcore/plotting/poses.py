"""Figures of poses: a strip of positions, and free bodies with the forces on them."""

from __future__ import annotations

from itertools import pairwise
from math import ceil, floor, log10
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from pendcore import Scene
from pendcore.effects import Payload
from pendcore.messages import Floats, finite_array, silence
from pendcore.plotting.axes import Request, one_axes
from pendcore.plotting.curve import curve_of, span_of
from pendcore.plotting.over_time import force_name
from pendcore.plotting.sketch import Sketch, direction
from pendcore.plotting.style import theme_of

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_POSES, _A_ROW = 8, 4
_LONGEST, _SHORTEST = 0.4, 0.14
"""The lengths of the longest and of the shortest arrow, as shares of the total length."""
_WIDTH = 7.2
"""inches, of figures of poses."""


def draw_strip(asked: Request) -> list[Artist]:
    """Draw the chain at some times, s, row by row, with the tip's path since the pose before."""
    dense = asked.solution.with_dense_output()
    scene, reach = dense.scene, total_length(dense.scene)
    t, q, _, _ = curve_of(dense)
    at = _times(asked.t, np.linspace(t[0], t[-1], _POSES))
    poses = scene.positions(at, np.hsplit(dense(at).T, 2)[0])
    path = scene.positions(t, q)[:, -1]
    shown = np.concatenate([poses.reshape(-1, 2), path[(t - at[0]) * (at[-1] - t) >= 0]])
    low, high = shown.min(axis=0), shown.max(axis=0)
    # One pose after the other, and one row below the other with room for the times.
    margin = np.maximum(0.08 * (high - low), 0.5 * (0.6 * reach - (high - low)))
    low, high = low - margin, high + margin + [0.0, 0.35 * reach]
    step = high - low
    columns = min(len(at), _A_ROW)
    wide, tall = step * [columns, ceil(len(at) / columns)] + [0.0, 0.4 * reach]
    size = _WIDTH, float(np.clip(_WIDTH * tall / wide, 1.5, 9.0))
    axis = one_axes(asked.ax, size, asked.new_figure)
    artists: list[Artist] = []
    before = at[0]
    for k, (time, pose) in enumerate(zip(at, poses, strict=True)):
        moved = step * [k % columns, k // columns]
        since = (t - before) * (time - t) >= 0
        how: dict[str, Any] = {"color": theme_of(axis).link(len(pose) - 2), "linewidth": 1.0}
        axis.plot(*(path[since] + moved).T, alpha=0.6, zorder=1, **how)
        artists += _draw_chain(axis, pose + moved, asked.properties)
        x, y = moved + np.array([(low[0] + high[0]) / 2, high[1] - 0.3 * reach])
        artists.append(axis.text(x, y, f"{time:.4g} s", ha="center", va="top", size="small"))
        before = time
    draw_scale(axis, low + np.array([0.1 * reach, tall - 0.2 * reach]), reach)
    axis.set_aspect("equal", adjustable="datalim")
    axis.set_xlim(low[0], low[0] + wide, auto=True)  # a figure of another shape shows more
    axis.set_ylim(low[1] + tall, low[1], auto=True)
    axis.set_axis_off()
    return artists


def _draw_chain(axis: Axes, pose: Floats, properties: dict[str, Any]) -> list[Artist]:
    """Draw each link in its colour, with the joints as dots."""
    theme = theme_of(axis)
    lines: list[Artist] = []
    ours: dict[str, Any] = {"linewidth": 2.4, "solid_capstyle": "round", "zorder": 2}
    for i, ends in enumerate(pairwise(pose)):
        lines += axis.plot(*np.array(ends).T, **{"color": theme.link(i), **ours, **properties})
    axis.plot(*pose.T, "o", color=theme.ink, markersize=min(3.0, 15 / len(pose)), zorder=3)
    return lines


def draw_scale(axis: Axes, at: Floats, reach: float) -> None:
    """Draw a bar whose length is 1, 2 or 5 times a power of ten, and say how long it is."""
    power = 10.0 ** floor(log10(0.5 * reach))
    length = max(k * power for k in (1, 2, 5) if k * power <= 0.5 * reach)
    ink, (x, y) = theme_of(axis).quiet, at
    axis.plot([x, x + length], [y, y], color=ink, linewidth=2.0)
    axis.text(x + length, y, f"  {length:g} m", color=ink, va="center")


def draw_free_bodies(asked: Request) -> list[Artist]:
    """Draw each link by itself with the forces on it, N, at a time, s.

    Arrows are as long as forces are large, but never so short that they vanish.
    """
    at = _times(asked.t, np.array(span_of(asked.solution)[:1]))
    if len(at) > 1:
        raise ValueError(f"t: {len(at)} times: must be one (s): free bodies are of an instant")
    scene, t = asked.solution.scene, float(at[0])
    q, qd = np.split(asked.solution.with_dense_output()(t), 2)
    pose, centers = scene.positions(t, q), scene.mass_centers(t, q)
    forces = forces_on_links(scene, t, q, qd)
    largest = max(float(np.hypot(*one.force)) for link in forces for one in link)
    if not np.isfinite(largest):
        raise ValueError(f"t = {t:g}: the forces are not finite there, and cannot be drawn")
    size = min(3.3 * len(q) + 0.6, 16.0), 3.9
    axis = one_axes(asked.ax, size, asked.new_figure)
    on = Sketch(axis, reach := total_length(scene))
    right = 0.0
    for i, (angle, of_link) in enumerate(zip(q, forces, strict=True)):
        ends = pose[i : i + 2]
        alongs = arrows_of(np.array([one.force for one in of_link]), largest, reach)
        pairs = [pair for pair in zip(of_link, alongs, strict=True) if pair[1].any()]
        drawn = [(one, along, _would_lie_on_link(one, along, ends)) for one, along in pairs]
        free = [one.at - along if arrives else one.at + along for one, along, arrives in drawn]
        across = np.array([*ends, *free])[:, 0]
        moved = np.array([right - across.min(), -pose[i, 1]])
        right += np.ptp(across) + 0.5 * reach
        start, end = ends + moved
        on.rod(start, end)
        on.mass_center(centers[i] + moved)
        on.pin(start)
        on.pin(end)
        parts = [start + share * (end - start) for share in (0.75, 0.3, 0.65, 0.85)]
        on.number(parts, i + 1, direction(angle - np.pi / 2))
        for one, along, arrives in drawn:
            text = f"{one.name} = {np.hypot(*one.force):.3g} N"
            color = getattr(on.theme, one.kind)
            on.arrow(one.at + moved, along, text, color, arriving=arrives)
    axis.set_title(f"t = {t:.4g} s", loc="left")
    before = len(axis.texts)
    on.finish()
    return [*axis.texts[before:]]


def arrows_of(forces: Floats, full: float, reach: float) -> Floats:
    """Return arrows, m, as long as forces (..., 2) are large, but neither too short nor too long.

    The longest are those of ``full``, N, and more; forces that are zero but for rounding have none.
    """
    sizes = np.hypot(forces[..., :1], forces[..., 1:])
    lengths = np.clip(_LONGEST * sizes / (full or 1.0), _SHORTEST, _LONGEST) * reach
    return np.asarray(forces / np.maximum(sizes, 1e-300) * lengths * (sizes > 1e-9 * full))


def _would_lie_on_link(of: Force, along: Floats, ends: Floats) -> bool:
    """Whether the arrow of a force at a joint has to arrive there, because the link is ahead."""
    far = max(ends, key=lambda end: float(np.hypot(*(end - of.at)))) - of.at
    return bool(of.kind == "force" and along @ far > 0.9 * np.hypot(*along) * np.hypot(*far))


class Force(NamedTuple):
    """A force on a link, N: its kind as in `Theme` (force, weight, load), name, and point, m."""

    kind: str
    name: str
    at: Floats
    force: Floats


def forces_on_links(scene: Scene, t: float, q: Floats, qd: Floats) -> list[list[Force]]:
    """Return the forces on each link at one instant.

    The force at the joint where a link begins, minus the next link's, the weight at the mass
    centre (the payload's at the tip), and what drag and wind make up.
    """
    n, payload = len(scene.links), _payload(scene)
    pose, centers = scene.positions(t, q), scene.mass_centers(t, q)
    reactions = scene.reactions(t, q, qd)
    drags = _drags(scene, t, q, qd)
    gravity = np.array([0.0, scene.gravity])
    found = []
    for i, link in enumerate(scene.links):
        forces = [Force("force", f"${force_name(i, i + 1)}$", pose[i], reactions[i])]
        if i + 1 < n:
            name = f"${force_name(i + 2, i + 1)}$"
            forces.append(Force("force", name, pose[i + 1], -reactions[i + 1]))
        if link.mass * scene.gravity:
            forces.append(Force("weight", f"$m_{{{i + 1}}} g$", centers[i], link.mass * gravity))
        if i + 1 == n and payload * scene.gravity:
            forces.append(Force("weight", "$m_p g$", pose[n], payload * gravity))
        if np.hypot(*drags[i]) > 1e-6 * max(np.hypot(*one.force) for one in forces):
            forces.append(Force("load", f"$D_{{{i + 1}}}$", centers[i], drags[i]))
        found.append(forces)
    return found


def _drags(scene: Scene, t: float, q: Floats, qd: Floats) -> Floats:
    """Return the forces of drag and wind on each link, N, (n, 2).

    Without drag, the forces at the joints and the weight alone move each link. So drag is what the
    changes that it makes in the forces at the joints lack to move each mass centre as much more.
    """
    n = len(scene.links)
    others = [effect for effect in scene.effects if effect.kind != "rod_drag"]
    if len(others) == len(scene.effects):
        return np.zeros((n, 2))
    with silence():  # what is implausible was said when the scene was made
        dragless = scene.replace(effects=others)
    turning = scene.accelerations(t, q, qd) - dragless.accelerations(t, q, qd)
    reactions = scene.reactions(t, q, qd) - dragless.reactions(t, q, qd)
    ends = scene.velocities(t, q, turning) - scene.velocities(t, q, 0 * q)  # without the pivot's
    needed = np.zeros((n, 2))
    for i, link in enumerate(scene.links):  # a mass centre moves as its share of both ends
        needed[i] = link.mass * (ends[i] + link.center / link.length * (ends[i + 1] - ends[i]))
    needed[-1] += _payload(scene) * ends[-1]
    return needed - reactions + np.vstack([reactions[1:], np.zeros(2)])


def _payload(scene: Scene) -> float:
    return sum(effect.mass for effect in scene.effects if isinstance(effect, Payload))


def total_length(scene: Scene) -> float:
    return float(sum(link.length for link in scene.links))


def _times(given: npt.ArrayLike | None, usual: Floats) -> Floats:
    """Return times (k,) of the run, s."""
    if given is None:
        return usual
    times = np.atleast_1d(finite_array("t", given, "s"))
    if times.ndim > 1 or not len(times):
        raise ValueError(f"t: shape {times.shape}: must be a time, or (k,) (s)")
    return times
