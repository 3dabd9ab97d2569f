"""A drawn scene, and all that is asked of it: span, error, kept times, step limits, events."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf
from typing import Any

import numpy as np
import pendcore as pc

from true_error.arithmetic import Floats
from true_error.constants import inertia, smooth_torques
from true_error.drawing import Dice

SWITCHED = ("dry_joint_friction", "joint_stop", "user")
GROWTH = 3.0
"""The exponent by which dampers may let a run grow that goes back in time."""
TURNS = 1000.0
"""How often the fastest motion at the start may turn, so that a scene costs no more than others."""


@dataclass(frozen=True, kw_only=True)
class Drawn:
    """A scene of a family's seed, its start (rad and rad/s) and span (s), and how it is run."""

    family: str
    seed: int
    scene: pc.Scene
    q0: tuple[float, ...]
    qd0: tuple[float, ...]
    t_start: float
    t_end: float
    error: float
    """What is asked for, as a share of the total length."""
    options: dict[str, Any] = field(default_factory=dict)
    """Further keywords of ``simulate`` beside ``error``."""
    rtol: float
    """The tolerance of the run that is asked for its ``valid_until``."""
    limit: float
    """The limit that it is asked for, rad."""

    @property
    def span(self) -> tuple[float, float]:
        return self.t_start, self.t_end

    @property
    def is_switched(self) -> bool:
        """Whether joints stick, stops are met, or laws have kinks or jumps: see `switches`."""
        return any(
            effect.kind in SWITCHED
            or any(getattr(effect, name, None) for name in ("table", "spline", "damping2"))
            or getattr(effect, "limit", inf) < inf
            for effect in self.scene.effects
        )

    @property
    def is_dense(self) -> bool:
        """Whether the run that is asked for can be compared at any time."""
        return "t_eval" not in self.options and self.options.get("store", "dense") == "dense"


def asked(
    dice: Dice,
    scene: pc.Scene,
    start: tuple[Any, Any],
    span: float,
    *,
    backward: float = 0.2,
    decades: tuple[float, float] = (-12.0, -2.0),
    turns: float = TURNS,
) -> Drawn:
    """Return a scene with all that is asked of it, from its angles and rates at the start.

    The span, s, is shorter if the scene is fast: the fastest motion at the start may make so many
    turns. A share of runs goes back in time; the error lies between two decades.
    """
    q0, qd0 = (tuple(map(float, values)) for values in start)
    motion, decay = rates(scene, q0, qd0)
    span = min(span, turns / max(motion, decay))
    t_start = dice.one_of((0.0, 0.0, 0.0, -3.7, 12.5))
    if dice.chance(backward) and has_past(scene):
        span = -min(span, GROWTH / max(decay, 1.0))
    t_end = t_start + span
    options = times_kept(dice, t_start, t_end)
    if dice.chance(0.15):
        options["max_step"] = abs(span) * dice.decades(-3, -0.5)
    if dice.chance(0.12):
        options["events"] = [ending(dice, q0)]
    return Drawn(
        family=dice.family, seed=dice.seed, scene=scene, q0=q0, qd0=qd0, t_start=t_start,
        t_end=t_end, error=dice.decades(*decades), options=options,
        rtol=dice.decades(-11, -3), limit=dice.decades(-4, -1),
    )  # fmt: skip


def has_past(scene: pc.Scene) -> bool:
    """Whether a motion can be followed back in time.

    Under dampers of a higher power of the rate it cannot, because going back the rate may become
    infinite in a finite time.
    """
    return not any(
        getattr(effect, "damping2", 0.0)
        or getattr(effect, "damping3", 0.0)
        or getattr(getattr(effect, "function", None), "name", "") == "quadratic damper"
        for effect in scene.effects
    )


def times_kept(dice: Dice, t_start: float, t_end: float) -> dict[str, Any]:
    """Return what the run keeps: all of the curve, the steps, the end, a few times, many times."""
    kind = dice.rng.random()
    if kind < 0.25:
        few = t_start + (t_end - t_start) * dice.rng.random(dice.whole(1, 5))
        return {"t_eval": np.unique(few)[:: 1 if t_end >= t_start else -1]}
    if kind < 0.35:
        return {"t_eval": np.append(np.linspace(t_start, t_end, 101)[:-1], t_end)}
    if kind < 0.45:
        return {"store": "end"}
    if kind < 0.55:
        return {"store": "steps"}
    return {}


def ending(dice: Dice, q0: tuple[float, ...]) -> pc.events.Event:
    """Return an event that ends the run, somewhere near the start if at all."""
    link = dice.whole(1, len(q0))
    kind, aside = dice.whole(0, 2), dice.uniform(-1, 1)
    if kind == 0:
        return pc.events.LinkAngle(link, q0[link - 1] + aside, terminal=True)
    if kind == 1:
        phi = q0[link - 1] - (q0[link - 2] if link > 1 else 0.0)
        return pc.events.JointAngle(link, phi + aside, terminal=True)
    return pc.events.RateZero(link=link, terminal=dice.whole(1, 3))


def mass_matrix(scene: pc.Scene, q: tuple[float, ...]) -> Floats:
    """Return the mass matrix of the joints' angles (n, n), kg m^2."""
    n = len(q)
    values = {name: float(value) for name, value in inertia(scene).items()}
    K = np.array([[values[f"K{min(i, j)}{max(i, j)}"] for j in range(n)] for i in range(n)])
    M = K * np.cos(np.subtract.outer(q, q))
    R = np.cumsum(np.cumsum(M[::-1, ::-1], axis=0), axis=1)[::-1, ::-1]
    return R + np.diag([values[f"J{j}"] for j in range(n)])


def rates(scene: pc.Scene, q0: tuple[float, ...], qd0: tuple[float, ...]) -> tuple[float, float]:
    """Return how fast a scene moves at its start.

    The first is the fastest of its linear motion, its drives and its rates, rad/s; the second is
    the fastest decay by dampers, 1/s.
    """
    n = len(q0)
    R = mass_matrix(scene, q0)
    values = {name: float(value) for name, value in smooth_torques(scene).items()}
    constants = inertia(scene)
    weights = [float(constants["g"] * constants[f"h{i}"]) for i in range(n)]
    fall = np.array([[sum(weights[max(i, j) :]) for i in range(n)] for j in range(n)])
    stiff = fall + np.diag([values[f"k{j}"] for j in range(n)])
    w = np.diff([0.0, *qd0])
    damping = [values[f"b{j}"] + 3 * values[f"b3{j}"] * w[j] ** 2 for j in range(n)]
    frequency = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(R, stiff))).max())
    decay = np.abs(np.linalg.eigvals(np.linalg.solve(R, np.diag(damping)))).max()
    driven = max(abs(values[name]) for name in values if name.endswith("o") or name[0] == "o")
    motion = max(frequency, driven, np.abs(qd0).max(), np.abs(w).max(), 1e-3)
    return float(motion), float(decay)
