"""Outputs of a state: places, velocities, energies, and how they change with state and names.

Arrays have the axes of times in front, written ``(...)``.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pendcore._messages.arguments import Floats, suggestion
from pendcore._messages.warning import silence
from pendcore._scene.scene import Scene
from pendcore.effects import DrivenPivot, Payload, RotorInertia, TorsionalSpring

KINDS = ("q", "qd", "qdd", "phi", "phid", "x", "y", "vx", "vy")
ENERGIES = {
    "kinetic": np.array([[1.0], [0.0]]),
    "potential": np.array([[0.0], [1.0]]),
    "energy": np.array([[1.0], [1.0]]),
}
"""What each takes of kinetic and potential energy."""
WITH_ENERGY = (Payload, RotorInertia, TorsionalSpring)
"""The effects, beside a driven pivot, that energies depend on."""
PUSHES = ("pivot.x", "pivot.y")
_NAME = re.compile(rf"({'|'.join(KINDS)})\[([1-9]\d*)\]")
_OF_EFFECT = re.compile(r"effect\[(\d+)\]\.(.+)")
_WAVE = re.compile(r"([xy])\.(amplitude|angular_frequency|phase)")


class Rows(NamedTuple):
    """Values of m outputs, and their derivatives at a fixed time.

    Attributes
    ----------
    values : ndarray, (..., m)
    by_state : ndarray, (..., m, 2n)
    by_names : ndarray, (..., m, k)
        At a fixed state.
    """

    values: Floats
    by_state: Floats
    by_names: Floats


def outputs_at(
    scene: Scene,
    t: Floats,
    x: Floats,
    names: Sequence[str],
    outputs: Sequence[str],
    accelerations: Rows | None = None,
    since: Floats | float = 0.0,
) -> Rows:
    """Return outputs at times (...) and states (..., 2n), and their derivatives.

    A torque changes ``accelerations`` alone, which only outputs "qdd[i]" need. So do "pivot.x" and
    "pivot.y", unless the pivot has been pushed for some time, ``since`` (...), s.
    """
    n = len(scene.links)
    places = [_place_of(name, n) for name in outputs]
    q, qd = np.split(x, 2, axis=-1)
    on_q, on_qd = np.split(np.eye(2 * n), 2)
    joint = np.eye(n) - np.eye(n, k=-1)
    none = np.zeros((n, len(names)))
    rows = {
        "q": Rows(q, on_q, none),
        "qd": Rows(qd, on_qd, none),
        "phi": Rows(q @ joint.T, joint @ on_q, none),
        "phid": Rows(qd @ joint.T, joint @ on_qd, none),
    }
    if accelerations is not None:
        rows["qdd"] = accelerations
    wanted = {kind for kind, _ in places}
    if not wanted.isdisjoint(KINDS[5:]):
        rows |= _ends(scene, t, q, qd, names, since)
    if not wanted.isdisjoint(ENERGIES):
        rows |= _energies(scene, t, q, qd, names, since)
    p, lead = len(outputs), x.shape[:-1]
    result = Rows(*(np.zeros((*lead, p, *more)) for more in ((), (2 * n,), (len(names),))))
    for row, (kind, i) in enumerate(places):
        result.values[..., row] = rows[kind].values[..., i]
        result.by_state[..., row, :] = rows[kind].by_state[..., i, :]
        result.by_names[..., row, :] = rows[kind].by_names[..., i, :]
    return result


def _place_of(name: object, n: int) -> tuple[str, int]:
    """Return the kind of an output, and its place among those of this kind."""
    if isinstance(name, str) and name in ENERGIES:
        return name, 0
    place = _NAME.fullmatch(name) if isinstance(name, str) else None
    if place is not None and int(place[2]) <= n:
        return place[1], int(place[2]) - 1
    known = [*ENERGIES, *(f"{kind}[{i}]" for kind in KINDS for i in range(1, n + 1))]
    raise ValueError(
        f"outputs: {name!r}: must be one of {', '.join(f'{kind}[i]' for kind in KINDS)}, i from 1 "
        f"to {n}, or {', '.join(ENERGIES)}{suggestion(name, known)}"
    )


def _ends(
    scene: Scene, t: Floats, q: Floats, qd: Floats, names: Sequence[str], since: Floats | float
) -> dict[str, Rows]:
    """Return places and velocities of the ends of the links.

    With u = (cos q, sin q) along each link, the end of link i moves with all links up to i.
    """
    n = len(scene.links)
    on_q, on_qd = np.split(np.eye(2 * n), 2)
    up_to = np.tri(n) * [link.length for link in scene.links]
    x = up_to * np.cos(q)[..., np.newaxis, :]
    y = up_to * np.sin(q)[..., np.newaxis, :]
    rates = qd[..., np.newaxis, :]
    by_state = (
        -y @ on_q,
        x @ on_q,
        -(x * rates) @ on_q - y @ on_qd,
        -(y * rates) @ on_q + x @ on_qd,
    )
    ends = np.concatenate([scene.positions(t, q), scene.velocities(t, q, qd)], axis=-1)
    by_names = np.zeros((*q.shape[:-1], 4, n, len(names)))
    for k, name in enumerate(names):
        by_names[..., k] = _of_the_pivot(scene, name, t, since)[..., np.newaxis]
        if place := re.fullmatch(r"link\[(\d+)\]\.length", name):
            i = int(place[1]) - 1  # the end of this link, and those of the links beyond it
            s, c, rate = np.sin(q[..., i]), np.cos(q[..., i]), qd[..., i]
            by_names[..., i:, k] = np.stack([c, s, -s * rate, c * rate], axis=-1)[..., np.newaxis]
    return {
        kind: Rows(ends[..., 1:, i], by_state[i], by_names[..., i, :, :])
        for i, kind in enumerate(KINDS[5:])
    }


def _of_the_pivot(scene: Scene, name: str, t: Floats, since: Floats | float) -> Floats:
    """Return the derivatives of x, y, vx and vy of the pivot by a name, (..., 4)."""
    found = np.zeros((*np.shape(t), 4))
    if name in PUSHES:
        axis = PUSHES.index(name)
        found[..., axis], found[..., axis + 2] = 0.5 * np.square(since), since
        return found
    effect, field = _effect_of(scene, name)
    if (place := _WAVE.fullmatch(field)) and isinstance(effect, DrivenPivot):
        wave = getattr(effect, place[1])
        A, w, phase = wave.amplitude, wave.angular_frequency, wave.phase
        s, c = np.sin(w * t + phase), np.cos(w * t + phase)
        slopes = {
            "amplitude": (s, w * c),
            "angular_frequency": (A * t * c, A * c - A * w * t * s),
            "phase": (A * c, -A * w * s),
        }
        axis = "xy".index(place[1])
        found[..., axis], found[..., axis + 2] = slopes[place[2]]
    return found


def _effect_of(scene: Scene, name: str) -> tuple[object, str]:
    """Return the effect of a parameter, and what is named of it."""
    place = _OF_EFFECT.fullmatch(name)
    return (scene.effects[int(place[1]) - 1], place[2]) if place else (None, "")


def _energies(
    scene: Scene, t: Floats, q: Floats, qd: Floats, names: Sequence[str], since: Floats | float
) -> dict[str, Rows]:
    """Return kinetic, potential and total energy; their derivatives are exact to rounding.

    In a rate, energies are polynomials of the second degree, which central differences of any width
    differentiate exactly. In an angle they are a + b cos q + c sin q and, by springs, a polynomial
    of the second degree: half the difference between q + pi/2 and q - pi/2 is the slope of the
    sines and pi/2 times that of the polynomial, and between q + pi and q - pi the sines are equal.
    """
    x = np.concatenate([q, qd], axis=-1)
    values = _both(scene, t, x)

    def half_difference(on: Floats) -> Floats:
        return np.asarray(0.5 * (_both(scene, t, x + on) - _both(scene, t, x - on)))

    on_q, on_qd = np.split(np.eye(x.shape[-1]), 2)
    by_q = [
        half_difference(0.5 * np.pi * on) - (0.5 - 1 / np.pi) * half_difference(np.pi * on)
        for on in on_q
    ]
    by_state = np.stack([*by_q, *map(half_difference, on_qd)], axis=-1)
    by_names = np.zeros((*values.shape, len(names)))
    for k, name in enumerate(names):
        effect, _ = _effect_of(scene, name)
        if isinstance(effect, DrivenPivot) or name in PUSHES:
            by_the_pivot = _of_the_pivot(scene, name, t, since)
            by_names[..., k] = _energies_by_the_pivot(scene, by_the_pivot, t, q, qd)
        elif isinstance(effect, WITH_ENERGY) or name == "gravity" or name.startswith("link["):
            step, further = _on_from(scene, name, names)
            one, two = (_both(other, t, x) for other in further)
            by_names[..., k] = (4 * one - 3 * values - two) / (2 * step)
    return {
        kind: Rows(values @ share, share.T @ by_state, share.T @ by_names)
        for kind, share in ENERGIES.items()
    }


def _both(scene: Scene, t: Floats, x: Floats) -> Floats:
    """Return kinetic and potential energy, (..., 2), J."""
    return np.stack(scene.energy(t, *np.split(x, 2, axis=-1)), axis=-1)


def _on_from(scene: Scene, name: str, names: Sequence[str]) -> tuple[float, list[Scene]]:
    """Return a step, and the scenes whose parameter is larger by one step and by two.

    In these parameters energies are polynomials of the second degree, too, and larger values are
    allowed where smaller ones may not be. As in the run, a uniform rod stays one unless its centre
    or its inertia is another of the names.
    """
    known = scene.parameters()
    given = {one: known[one] for one in names if one in known}
    step = max(1.0, abs(known[name]))
    with silence():  # what is implausible was said of the scene itself
        changed = [given | {name: known[name] + k * step} for k in (1, 2)]
        return step, [scene.with_parameters(one) for one in changed]


def _energies_by_the_pivot(
    scene: Scene, by_the_pivot: Floats, t: Floats, q: Floats, qd: Floats
) -> Floats:
    """Return the derivatives of both energies by what moves the pivot, (..., 2).

    They are those by the pivot's velocity, which is the momentum, and by its depth.
    """
    at_joints = np.zeros(len(scene.links) + 1)  # kg: a mass centre moves as its share of both ends
    for i, link in enumerate(scene.links):
        share = link.center / link.length
        at_joints[i : i + 2] += [link.mass * (1 - share), link.mass * share]
    at_joints[-1] += sum(one.mass for one in scene.effects if isinstance(one, Payload))
    momentum = at_joints @ scene.velocities(t, q, qd)
    _, y, vx, vy = np.moveaxis(by_the_pivot, -1, 0)
    kinetic = momentum[..., 0] * vx + momentum[..., 1] * vy
    return np.stack([kinetic, -scene.gravity * at_joints.sum() * y], axis=-1)
