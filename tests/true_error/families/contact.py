"""Dry friction and stops: joints that stick and slip, bounce, and come to rest at a stop."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act

E = pc.effects


def contact(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("contact", seed)
    n = dice.whole(1, 5)
    links = chains.links(dice, n, dice.one_of((0.3, 1.0)))
    q0, qd0 = chains.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 5.0))
    joints = list(dice.rng.permutation(n) + 1)
    found: list[Any] = []
    kind = dice.whole(0, 2)
    if kind != 1:
        found += [friction(dice, links, int(joints.pop())) for _ in range(min(n, 1 + kind // 2))]
    if joints and kind != 0:
        found.append(stop(dice, int(joints.pop()), q0))
    joint = dice.whole(1, n)
    if dice.chance(0.4):
        found.append(act.damper(links, dice.whole(1, n), dice.decades(-2, 1)))
    if dice.chance(0.4):
        strength = act.weight_torque(links[joint - 1 :]) * dice.uniform(0, 0.5)
        drive = act.sinusoid(dice, strength, dice.decades(-0.5, 1))
        found.append(E.Motor(joint, sinusoid=drive))
    if dice.chance(0.2):
        found.append(act.spring(dice, links, dice.whole(1, n), dice.decades(0, 1)))
    scene = chains.scene_of(links, found, dice.one_of(chains.GRAVITIES))
    span = dice.one_of((0.5, 1.0, 2.0, 4.0))
    return asked(dice, "contact", seed, scene, (q0, qd0), span, backward=0.0, decades=(-11.0, -2.0))


def friction(dice: Dice, links: list[pc.Link], joint: int) -> Any:
    """Return dry friction that may hold a joint or hardly slows it."""
    beyond = links[joint - 1 :]
    torque = act.weight_torque(beyond) * dice.decades(-2.5, 0)
    if dice.chance(0.5):
        return E.DryJointFriction(joint, torque)
    return E.DryJointFriction(
        joint, torque, static=torque * dice.uniform(1.05, 2.0),
        stribeck_velocity=dice.decades(-1.5, 0), exponent=dice.one_of((1.0, 2.0)),
    )  # fmt: skip


def stop(dice: Dice, joint: int, q0: Any) -> Any:
    """Return stops on both sides of where a joint is at the start, or on one."""
    phi = float(q0[joint - 1] - (q0[joint - 2] if joint > 1 else 0.0))
    low, high = phi - dice.decades(-1.5, 0.3), phi + dice.decades(-1.5, 0.3)
    side = dice.whole(0, 3)
    return E.JointStop(
        joint, (low if side != 1 else -np.inf, high if side != 2 else np.inf),
        restitution=dice.one_of((0.0, 1.0, dice.uniform(0.1, 0.9))),
        capture_speed=dice.decades(-3, -0.7),
    )  # fmt: skip
