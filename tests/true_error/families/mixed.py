"""Mixed smooth scenes: any links, masses over up to six decades, any of the smooth effects."""

from __future__ import annotations

from typing import Any

import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act

E = pc.effects


def mixed(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("mixed", seed)
    n = dice.whole(1, 5)
    links = chains.links(dice, n, dice.one_of((0.0, 1.0, 2.0, 6.0)))
    scene = chains.scene_of(links, effects(dice, links), dice.one_of(chains.GRAVITIES))
    start = chains.start(dice, n, (0.3, 1.0, 3.0), (0.0, 1.0, 10.0))
    span = dice.one_of((1.0, 3.0, 10.0, 30.0))
    return asked(dice, "mixed", seed, scene, start, span)


def effects(dice: Dice, links: list[pc.Link]) -> list[Any]:
    """Return some of the smooth effects."""
    n = len(links)
    found: list[Any] = []
    if dice.chance(0.2):
        mass = links[-1].mass * dice.decades(-1, 1)
        found.append(E.Payload(mass, inertia=mass * links[-1].length ** 2 * dice.decades(-4, -1)))
    if dice.chance(0.2):
        joint = dice.whole(1, n)
        armature = act.joint_inertia(links, joint) * dice.decades(-3, 0)
        found.append(E.RotorInertia(joint, armature))
    if dice.chance(0.3):
        cubic = dice.decades(-4, -1)
        found.append(act.damper(links, dice.whole(1, n), dice.decades(-4, 0.5), cubic))
    if dice.chance(0.2):
        found.append(act.spring(dice, links, dice.whole(1, n), dice.decades(-1, 2)))
    if dice.chance(0.3):
        found.append(
            E.DrivenPivot(
                x=act.sinusoid(dice, dice.decades(-3, -0.5), dice.decades(0, 1.5)),
                y=act.sinusoid(dice, dice.decades(-3, -0.5), dice.decades(0, 1.5)),
            )
        )
    joint = dice.whole(1, n)
    strength = 10 * act.joint_inertia(links, joint)
    if dice.chance(0.3):
        drive = act.sinusoid(dice, strength * dice.uniform(0, 1), dice.decades(-1, 2))
        found.append(E.Motor(joint, sinusoid=drive))
    if dice.chance(0.2):
        found.append(act.controller(dice, links, dice.whole(1, n), dice.decades(0, 1.5)))
    return found
