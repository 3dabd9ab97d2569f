"""Functions of a user's own, tables of torque, splines of the pivot, controllers that clip."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act
from true_error.own_laws import OwnLaw

E = pc.effects
SPAN = (0.3, 1.0, 3.0)
ASIDE = 20.0
"""s; tables reach this far beyond any start and end."""


def own(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("own", seed)
    n = dice.whole(1, 5)
    links = chains.links(dice, n, dice.one_of((0.3, 1.0)))
    start = chains.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 5.0))
    kinds = [table, spline, clipped, quadratic]
    chosen = [kinds[k] for k in dice.rng.permutation(len(kinds))[: dice.whole(0, 2)]]
    if not chosen or dice.chance(0.3):
        chosen.append(own_function)
    found = [kind(dice, links) for kind in chosen]
    if dice.chance(0.4):
        found.append(act.damper(links, dice.whole(1, n), dice.decades(-2, 1)))
    if dice.chance(0.2):
        found.append(act.spring(dice, links, dice.whole(1, n), dice.decades(0, 1)))
    scene = chains.scene_of(links, found, dice.one_of(chains.GRAVITIES))
    return asked(
        dice, "own", seed, scene, start, dice.one_of(SPAN), backward=0.15, decades=(-11.0, -2.0),
        turns=100.0,
    )  # fmt: skip


def own_function(dice: Dice, links: list[pc.Link]) -> Any:
    """Return a law as a Python function, smooth or with a kink."""
    joint = dice.whole(1, len(links))
    inertia, scale = act.joint_inertia(links, joint), act.weight_torque(links[joint - 1 :])
    name, values = dice.one_of((
        ("cubic spring", (inertia * dice.decades(0, 2),)),
        ("detent", (scale * dice.uniform(0.1, 1.0), float(dice.whole(2, 6)))),
        ("pulse", (scale * dice.uniform(-1, 1), dice.uniform(-3, 12), dice.decades(-1.5, 0))),
        ("quadratic damper", (inertia * dice.decades(-1, 1),)),
        ("clipped spring", (inertia * dice.decades(0, 2), dice.uniform(0.1, 1.5))),
        ("one-sided spring", (inertia * dice.decades(0, 3), dice.uniform(-1, 1.5))),
    ))  # fmt: skip
    return E.User(OwnLaw(name, joint, values))


def table(dice: Dice, links: list[pc.Link]) -> Any:
    """Return a motor that follows a table: a jagged curve whose knots are anywhere."""
    joint, knots = dice.whole(1, len(links)), dice.whole(2, 12)
    t = np.sort(dice.rng.uniform(-6, 16, knots))
    t = np.concatenate([[-ASIDE], t, [ASIDE]])
    torque = act.weight_torque(links[joint - 1 :]) * dice.spread(len(t), 0.5)
    return E.Motor(joint, table=E.Table(t, torque))


def spline(dice: Dice, links: list[pc.Link]) -> Any:
    """Return a pivot that goes along a spline."""
    t = np.concatenate([[-ASIDE], np.linspace(-7.0, 16.0, dice.whole(5, 12)), [ASIDE]])
    reach = 0.3 * sum(link.length for link in links)
    along = E.Spline(t, dice.spread(len(t), reach), dice.spread(len(t), reach))
    return E.DrivenPivot(spline=along)


def clipped(dice: Dice, links: list[pc.Link]) -> Any:
    """Return a controller that saturates."""
    joint = dice.whole(1, len(links))
    limit = act.weight_torque(links[joint - 1 :]) * dice.decades(-1, 0.5)
    return act.controller(dice, links, joint, dice.decades(0, 1.3), limit)


def quadratic(dice: Dice, links: list[pc.Link]) -> Any:
    """Return quadratic damping, whose second derivative jumps where the rate is zero."""
    joint = dice.whole(1, len(links))
    return E.ViscousJoint(
        joint, 0.0, damping2=act.joint_inertia(links, joint) * dice.decades(-1, 1)
    )
