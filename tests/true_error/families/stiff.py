"""Stiff scenes: dampers, springs and controllers far faster than the motion that is left."""

from __future__ import annotations

from typing import Any

import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act

E = pc.effects


def stiff(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("stiff", seed)
    n = dice.whole(1, 5)
    links = chains.links(dice, n, dice.one_of((0.3, 1.0)))
    found: list[Any] = []
    for joint in {dice.whole(1, n) for _ in range(dice.whole(1, 2))}:
        found += hard(dice, links, joint, dice.decades(2, 5))
    if dice.chance(0.3):
        found.append(act.damper(links, dice.whole(1, n), dice.decades(-1, 1)))
    if dice.chance(0.3):
        joint = dice.whole(1, n)
        strength = act.weight_torque(links[joint - 1 :]) * dice.uniform(0, 0.5)
        drive = act.sinusoid(dice, strength, dice.decades(-0.5, 1.0))
        found.append(E.Motor(joint, sinusoid=drive))
    scene = chains.scene_of(links, found, dice.one_of(chains.GRAVITIES))
    start = chains.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 3.0))
    # A reference by explicit series takes a step for every few of these turns.
    return asked(
        dice, "stiff", seed, scene, start, dice.one_of((1.0, 3.0, 10.0)),
        backward=0.0, turns=dice.decades(2.5, 4.3),
    )  # fmt: skip


def hard(dice: Dice, links: list[pc.Link], joint: int, rate: float) -> list[Any]:
    """Return what makes a joint stiff, of a rate, 1/s."""
    kind = dice.whole(0, 3)
    if kind == 0:
        return [act.damper(links, joint, rate)]
    if kind == 1:
        return [act.damper(links, joint, 0.0, cubic=rate)]
    if kind == 2:
        return [
            act.spring(dice, links, joint, rate),
            act.damper(links, joint, rate * dice.decades(-3, 0.3)),
        ]
    return [act.controller(dice, links, joint, rate)]
