"""Figures of poses: a strip of positions, and free bodies with the forces on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from pendcore._figures.axes import NewFigure, in_plane, one_axes
from pendcore._messages.arguments import Floats, finite_array
from pendcore._run.curve import curve_of, span_of
from pendcore._run.dense_output import with_dense_output
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene

if TYPE_CHECKING:
    from matplotlib.artist import Artist

_POSES = 8
_SHARE = 0.45
"""How long the largest arrow is, as a share of the total length."""
_FORCES = {
    "joint": ("r", "force at a joint"),
    "weight": ("0.35", "weight"),
    "other": ("g", "other forces on the link"),
}


def draw_strip(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    times: npt.ArrayLike | None,
    given: dict[str, Any],
) -> list[Artist]:
    """Draw the chain at some times, s, from left to right, each with the tip's path until then."""
    solution = with_dense_output(solution)
    t, states, _ = curve_of(solution)
    at = _times(times, np.linspace(t[0], t[-1], _POSES))
    n = len(solution.scene.links)
    poses = solution.scene._compiled.positions(at, solution._run.evaluate(at)[:, :n])
    path = solution.scene._compiled.positions(t, states[:, :n])[:, -1]
    reach = float(sum(link.length for link in solution.scene.links))
    pivot = poses[:, 0, 0]
    step = 1.15 * float(np.ptp(np.concatenate([poses[..., 0].ravel(), path[:, 0]])) or reach)
    axis = one_axes(ax, new_figure, (min(2.0 * len(at), 16.0), 3.2))
    artists: list[Artist] = []
    before = at[0]
    lowest = max(float(poses[..., 1].max()), float(path[:, 1].max())) + 0.12 * reach
    for k, (time, pose) in enumerate(zip(at, poses, strict=True)):
        moved = np.array([k * step, 0.0])
        since = (t - before) * (time - t) >= 0
        axis.plot(*(path[since] + moved).T, color="b", linewidth=0.8, alpha=0.5, zorder=1)
        how = {"color": "k", "linewidth": 1.6, "marker": "o", "markersize": 3, **given}
        artists += axis.plot(*(pose + moved).T, **how)
        artists.append(
            axis.text(float(pivot[k]) + k * step, lowest, f"{time:.4g} s", ha="center", va="top")
        )
        before = time
    in_plane(axis)
    axis.set_xlabel("x (m), each pose moved to the right")
    return artists


def draw_free_bodies(
    solution: Solution,
    ax: Any,
    new_figure: NewFigure,
    t: npt.ArrayLike | None,
    given: dict[str, Any],
) -> list[Artist]:
    """Draw each link by itself with the forces on it, N, at a time, s."""
    at = _times(t, np.array(span_of(solution)[:1]))
    if len(at) > 1:
        raise ValueError(f"t: {len(at)} times: must be one (s): free bodies are of an instant")
    state = with_dense_output(solution)._run.evaluate(at)
    scene, n = solution.scene, len(solution.scene.links)
    q, qd = state[:, :n], state[:, n:]
    pose = scene._compiled.positions(at, q)[0]
    centers = scene._compiled.mass_centers(at, q)[0]
    forces = forces_on_links(scene, at, q, qd)
    sizes = [np.hypot(*force) for link in forces for _, _, force in link]
    reach = float(sum(link.length for link in scene.links))
    scale = _SHARE * reach / max(max(sizes), 1e-300)
    axis = one_axes(ax, new_figure, (3.2 * n + 1.6, 5.0))
    artists: list[Artist] = []
    named: set[str] = set()
    for i, arrows in enumerate(forces):
        moved = np.array([1.2 * i * reach, 0.0])
        body = np.array([pose[i], pose[i + 1]]) + moved
        how = {"color": "k", "linewidth": 3.0, "solid_capstyle": "round", "zorder": 2, **given}
        artists += axis.plot(*body.T, **how)
        axis.plot(
            *(centers[i] + moved), "o", color="w", markeredgecolor="k", markersize=5, zorder=3
        )
        for kind, place, force in arrows:
            color, name = _FORCES[kind]
            end = place + moved + scale * force
            artists.append(
                axis.annotate(
                    "",
                    xy=end,
                    xytext=place + moved,
                    arrowprops={"arrowstyle": "-|>", "color": color, "linewidth": 1.4},
                    zorder=4,
                )
            )
            axis.plot(*end, alpha=0)  # arrows do not count for the limits of axes
            newtons = f" {np.hypot(*force):.3g} N"
            axis.text(end[0], end[1], newtons, color=color, fontsize="small", zorder=5)
            if name not in named:
                named.add(name)
                axis.plot([], [], color=color, label=name)
        middle = body.mean(axis=0)
        axis.text(middle[0], middle[1], f"  link {i + 1}", va="center", fontsize="small")
    in_plane(axis)
    axis.set_xlabel("x (m), each link moved to the right")
    axis.set_title(f"t = {at[0]:.4g} s")
    axis.legend(fontsize="small")
    return artists


def forces_on_links(
    scene: Scene, t: Floats, q: Floats, qd: Floats
) -> list[list[tuple[str, Floats, Floats]]]:
    """Return the forces on each link at one instant: kind, point (2,), m, and force (2,), N.

    The force at the joint where a link begins, minus the next link's, the weight at the mass
    centre (the payload's at the tip), and the rest: what Newton's law for the mass centre lacks,
    which drag and wind, say, make up.
    """
    n = len(scene.links)
    pose = scene._compiled.positions(t, q)[0]
    centers = scene._compiled.mass_centers(t, q)[0]
    reactions = scene._compiled.reactions(t, q, qd)[0]
    payload = _payload(scene)
    found = []
    rest = _other_forces(scene, t, q, qd)
    for i, link in enumerate(scene.links):
        forces = [("joint", pose[i], reactions[i])]
        if i + 1 < n:
            forces.append(("joint", pose[i + 1], -reactions[i + 1]))
        weight = np.array([0.0, scene.gravity])
        if link.mass > 0:
            forces.append(("weight", centers[i], link.mass * weight))
        if i + 1 == n and payload > 0:
            forces.append(("weight", pose[n], payload * weight))
        if np.hypot(*rest[i]) > 1e-6 * max(np.hypot(*force) for _, _, force in forces):
            forces.append(("other", centers[i], rest[i]))
        found.append(forces)
    return found


def _other_forces(scene: Scene, t: Floats, q: Floats, qd: Floats) -> Floats:
    """Return what acts on each link beside joints and weights, N, (n, 2): drag and wind."""
    n = len(scene.links)
    others = [effect for effect in scene.effects if effect.kind != "rod_drag"]
    if len(others) == len(scene.effects):
        return np.zeros((n, 2))
    # Without drag nothing else acts, so that the motion of a link tells how the pivot accelerates.
    dragless = Scene._unpickled(scene.links, scene.gravity, others)
    lacking = _lacking_forces(dragless, t, q, qd, np.zeros(2))
    masses = np.array([link.mass for link in scene.links])
    masses[-1] += _payload(scene)
    heaviest = int(np.argmax(masses))
    pivot = -lacking[heaviest] / masses[heaviest]
    return _lacking_forces(scene, t, q, qd, pivot)


def _lacking_forces(scene: Scene, t: Floats, q: Floats, qd: Floats, pivot: Floats) -> Floats:
    """Return what joints and weights lack to move each link's mass centre, N, (n, 2).

    ``pivot`` is the acceleration of the pivot, m/s^2, (2,).
    """
    n = len(scene.links)
    turning_rate = scene._compiled.accelerations(t, q, qd)[0]
    sine, cosine = np.sin(q[0]), np.cos(q[0])
    along, across = np.stack([cosine, sine], -1), np.stack([-sine, cosine], -1)
    turning = turning_rate[:, np.newaxis] * across - (qd[0] ** 2)[:, np.newaxis] * along
    reactions = np.vstack([scene._compiled.reactions(t, q, qd)[0], np.zeros(2)])
    lacking = np.zeros((n, 2))
    place = pivot
    for i, link in enumerate(scene.links):
        end = place + link.length * turning[i]
        momentum = link.mass * (place + link.center * turning[i])
        mass = link.mass
        if i + 1 == n:
            momentum = momentum + _payload(scene) * end
            mass += _payload(scene)
        lacking[i] = momentum - reactions[i] + reactions[i + 1] - [0.0, mass * scene.gravity]
        place = end
    return lacking


def _payload(scene: Scene) -> float:
    values = scene.parameters()
    return sum(
        values[f"effect[{i}].mass"]
        for i, effect in enumerate(scene.effects, 1)
        if effect.kind == "payload"
    )


def _times(given: npt.ArrayLike | None, usual: Floats) -> Floats:
    """Return times (k,) of the run, s."""
    if given is None:
        return usual
    times = np.atleast_1d(finite_array("t", given, "s"))
    if times.ndim > 1 or not len(times):
        raise ValueError(f"t: shape {times.shape}: must be a time, or (k,) (s)")
    return times
