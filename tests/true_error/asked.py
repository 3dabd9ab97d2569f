"""The run of a drawn scene that is asked for: span, error, kept times, step limits, events."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc

from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.rates import rates

GROWTH = 3.0
"""The exponent by which dampers may let a run grow that goes back in time."""
TURNS = 1000.0
"""How often the fastest motion at the start may turn, so that a scene costs no more than others."""


def asked(
    dice: Dice,
    family: str,
    seed: int,
    scene: pc.Scene,
    start: tuple[Any, Any],
    span: float,
    *,
    backward: float = 0.2,
    decades: tuple[float, float] = (-12.0, -2.0),
    turns: float = TURNS,
) -> Drawn:
    """Return a scene with all that is asked of it.

    Parameters
    ----------
    dice, family, seed
        What it is drawn from.
    scene, start
        The scene, and its angles and rates at the start, rad and rad/s.
    span : float
        The longest span, s; it is shorter if the scene is fast.
    backward : float
        The share of runs that go back in time.
    decades : (float, float)
        The decades between which the error lies.
    turns : float
        The most turns that the fastest motion at the start may make.
    """
    q0, qd0 = (tuple(map(float, values)) for values in start)
    fast = rates(scene, q0, qd0)
    span = min(span, turns / fast.fastest)
    t_start = dice.one_of((0.0, 0.0, 0.0, -3.7, 12.5))
    if dice.chance(backward) and has_past(scene):
        span = -min(span, GROWTH / max(fast.decay, 1.0))
    t_end = t_start + span
    options = times_kept(dice, t_start, t_end)
    if dice.chance(0.15):
        options["max_step"] = abs(span) * dice.decades(-3, -0.5)
    if dice.chance(0.12):
        options["events"] = [ending(dice, q0)]
    return Drawn(
        family=family, seed=seed, scene=scene, q0=q0, qd0=qd0, t_start=t_start, t_end=t_end,
        error=dice.decades(*decades), options=options,
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
