"""Figures of poses: a strip of positions, and free bodies with the forces on them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from pendcore import Scene
from pendcore.messages import Floats, finite_array, silence
from pendcore.plotting.axes import Request, in_plane
from pendcore.plotting.curve import curve_of, span_of
from pendcore.plotting.style import FORCES

if TYPE_CHECKING:
    import numpy.typing as npt
    from matplotlib.artist import Artist
    from matplotlib.axes import Axes

_POSES = 8
_SHARE = 0.45
"""How long the largest arrow is, as a share of the total length."""


def draw_strip(asked: Request) -> list[Artist]:
    """Draw the chain at some times, s, from left to right, each with the tip's path until then."""
    dense = asked.solution.with_dense_output()
    scene, reach = dense.scene, _total_length(dense.scene)
    t, q, _, _ = curve_of(dense)
    at = _times(asked.t, np.linspace(t[0], t[-1], _POSES))
    poses = scene.positions(at, np.hsplit(dense(at).T, 2)[0])
    path = scene.positions(t, q)[:, -1]
    shown = np.concatenate([poses.reshape(-1, 2), path])
    step = 1.15 * float(np.ptp(shown[:, 0]) or reach)
    lowest = float(shown[:, 1].max()) + 0.12 * reach
    axis = asked.one_axes((min(2.0 * len(at), 16.0), 3.2))
    artists: list[Artist] = []
    before = at[0]
    how = {"color": "k", "linewidth": 1.6, "marker": "o", "markersize": 3, **asked.properties}
    for k, (time, pose) in enumerate(zip(at, poses, strict=True)):
        moved = np.array([k * step, 0.0])
        since = (t - before) * (time - t) >= 0
        axis.plot(*(path[since] + moved).T, color="b", linewidth=0.8, alpha=0.5, zorder=1)
        artists += axis.plot(*(pose + moved).T, **how)
        middle = float(pose[0, 0]) + k * step
        artists.append(axis.text(middle, lowest, f"{time:.4g} s", ha="center", va="top"))
        before = time
    in_plane(axis)
    axis.set_xlabel("x (m), each pose moved to the right")
    return artists


def draw_free_bodies(asked: Request) -> list[Artist]:
    """Draw each link by itself with the forces on it, N, at a time, s."""
    at = _times(asked.t, np.array(span_of(asked.solution)[:1]))
    if len(at) > 1:
        raise ValueError(f"t: {len(at)} times: must be one (s): free bodies are of an instant")
    scene, t = asked.solution.scene, float(at[0])
    q, qd = np.split(asked.solution.with_dense_output()(t), 2)
    pose, centers = scene.positions(t, q), scene.mass_centers(t, q)
    forces = forces_on_links(scene, t, q, qd)
    reach = _total_length(scene)
    largest = max(float(np.hypot(*force)) for link in forces for _, _, force in link)
    scale = _SHARE * reach / max(largest, 1e-300)
    axis = asked.one_axes((3.2 * len(q) + 1.6, 5.0))
    artists: list[Artist] = []
    how: dict[str, Any] = {"color": "k", "linewidth": 3.0, "solid_capstyle": "round", "zorder": 2}
    for i, arrows in enumerate(forces):
        moved = np.array([1.2 * i * reach, 0.0])
        body = pose[i : i + 2] + moved
        artists += axis.plot(*body.T, **(how | asked.properties))
        center = centers[i] + moved
        axis.plot(*center, "o", color="w", markeredgecolor="k", markersize=5, zorder=3)
        for kind, place, force in arrows:
            artists.append(_draw_force(axis, FORCES[kind][0], place + moved, force, scale))
        x, y = body.mean(axis=0)
        axis.text(x, y, f"  link {i + 1}", va="center", fontsize="small")
    for kind in dict.fromkeys(kind for arrows in forces for kind, _, _ in arrows):
        color, name = FORCES[kind]
        axis.plot([], [], color=color, label=name)
    in_plane(axis)
    axis.set_xlabel("x (m), each link moved to the right")
    axis.set_title(f"t = {t:.4g} s")
    axis.legend(fontsize="small")
    return artists


def _draw_force(axis: Axes, color: str, begin: Floats, force: Floats, scale: float) -> Artist:
    """Draw a force, N, as an arrow of ``scale`` m a newton, with its size."""
    end: Any = begin + scale * force
    how = {"arrowstyle": "-|>", "color": color, "linewidth": 1.4}
    arrow = axis.annotate("", xy=end, xytext=(begin[0], begin[1]), arrowprops=how, zorder=4)
    axis.plot(*end, alpha=0)  # arrows do not count for the limits of axes
    newtons = f" {np.hypot(*force):.3g} N"
    axis.text(end[0], end[1], newtons, color=color, fontsize="small", zorder=5)
    return arrow


def forces_on_links(
    scene: Scene, t: float, q: Floats, qd: Floats
) -> list[list[tuple[str, Floats, Floats]]]:
    """Return the forces on each link at one instant: kind, point (2,), m, and force (2,), N.

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
        forces = [("joint", pose[i], reactions[i])]
        if i + 1 < n:
            forces.append(("joint", pose[i + 1], -reactions[i + 1]))
        if link.mass > 0:
            forces.append(("weight", centers[i], link.mass * gravity))
        if i + 1 == n and payload > 0:
            forces.append(("weight", pose[n], payload * gravity))
        if np.hypot(*drags[i]) > 1e-6 * max(np.hypot(*force) for _, _, force in forces):
            forces.append(("other", centers[i], drags[i]))
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
    turned = turning[:, np.newaxis] * np.stack([-np.sin(q), np.cos(q)], axis=-1)
    lengths, centers, masses = (
        np.array([getattr(link, name) for link in scene.links])[:, np.newaxis]
        for name in ("length", "center", "mass")
    )
    ends = np.cumsum(lengths * turned, axis=0)
    needed: Floats = masses * (ends + (centers - lengths) * turned)
    needed[-1] += _payload(scene) * ends[-1]
    return needed - reactions + np.vstack([reactions[1:], np.zeros(2)])


def _payload(scene: Scene) -> float:
    values = scene.parameters()
    return sum(
        values[f"effect[{i}].mass"]
        for i, effect in enumerate(scene.effects, 1)
        if effect.kind == "payload"
    )


def _total_length(scene: Scene) -> float:
    return float(sum(link.length for link in scene.links))


def _times(given: npt.ArrayLike | None, usual: Floats) -> Floats:
    """Return times (k,) of the run, s."""
    if given is None:
        return usual
    times = np.atleast_1d(finite_array("t", given, "s"))
    if times.ndim > 1 or not len(times):
        raise ValueError(f"t: shape {times.shape}: must be a time, or (k,) (s)")
    return times
