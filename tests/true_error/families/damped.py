"""Damped and driven scenes of ordinary links, and whole periods that fall in with even times."""

from __future__ import annotations

from dataclasses import replace
from math import pi
from typing import Any

import numpy as np
import pendcore as pc

from true_error.asked import asked
from true_error.dice import Dice
from true_error.drawn import Drawn
from true_error.families import chains
from true_error.families import smooth_effects as act

E = pc.effects


def damped(seed: int) -> Drawn:
    """Return the scene of a seed."""
    dice = Dice("damped", seed)
    if dice.chance(0.06):
        return whole_periods(dice, seed)
    n = dice.whole(1, 5)
    links = []
    for _ in range(n):
        mass, length = dice.decades(-1, 0.3), dice.decades(-0.7, 0.3)
        is_rod = dice.chance(0.5)
        inertia = mass * length * length / 12 if is_rod else 0.0
        center = length / 2 if is_rod else length
        links.append(pc.Link(mass=mass, length=length, center=center, inertia=inertia))
    scene = chains.scene_of(links, effects(dice, links), 9.807)
    start = chains.start(dice, n, (0.1, 0.5, 1.2), (0.0, 1.0))
    span = dice.one_of((1.0, 3.0, 10.0, 30.0))
    return asked(dice, "damped", seed, scene, start, span, backward=0.1, decades=(-11.5, -2.0))


def effects(dice: Dice, links: list[pc.Link]) -> list[Any]:
    """Return dampers in most joints, and what drives the chain."""
    n = len(links)
    weights = [act.weight_torque(links[joint:]) for joint in range(n)]
    found: list[Any] = [
        E.ViscousJoint(joint, weights[joint - 1] * dice.decades(-3, 0.5))
        for joint in range(1, n + 1)
        if dice.chance(0.6)
    ]
    joint = dice.whole(1, n)
    scale = act.weight_torque(links[joint - 1 :])
    if dice.chance(0.3):
        stiffness = scale * dice.decades(-1, 1.5)
        found.append(E.TorsionalSpring(joint, stiffness, rest_angle=dice.uniform(-1, 1)))
    if dice.chance(0.3):
        pd = E.PD(scale * dice.decades(-1, 1), scale * dice.decades(-2, 0), dice.uniform(-1, 1))
        found.append(E.Motor(joint, pd=pd))
    if dice.chance(0.3):
        drive = act.sinusoid(dice, scale * dice.uniform(0, 0.5), dice.decades(-1, 1))
        found.append(E.Motor(joint, sinusoid=drive))
    if dice.chance(0.2):
        found.append(E.DrivenPivot(y=E.Sinusoid(dice.decades(-3, -1), dice.decades(0, 1))))
    return found


def whole_periods(dice: Dice, seed: int) -> Drawn:
    """Return a swing or a rod that a motor drives, over whole periods.

    Times that divide the run evenly fall on the same phase each time. An error of phase may be
    hidden there, because a rod turns back at that phase and hardly moves.
    """
    link = pc.Link(mass=1.0, length=1.0, center=1.0, inertia=0.0)
    wide = dice.uniform(0.3, 2.0)
    period = 4 * quarter_period(np.sin(wide / 2)) / np.sqrt(9.807)
    found: list[Any] = []
    if dice.chance(0.4):
        found = [E.ViscousJoint(1, 2.0), E.Motor(1, sinusoid=E.Sinusoid(5.0, 2 * pi / period))]
    scene = chains.scene_of([link], found, 9.807)
    periods = dice.one_of((20, 25, 50, 100, 100, 200))
    start = [pi / 2 - wide], [0.0]
    drawn = asked(dice, "damped", seed, scene, start, periods * period, backward=0.0, turns=np.inf)
    options = {name: drawn.options[name] for name in drawn.options if name in ("max_step", "store")}
    return replace(drawn, options=options)


def quarter_period(k: float) -> float:
    """Return the complete elliptic integral K of a modulus: by the arithmetic-geometric mean."""
    a, b = 1.0, float(np.sqrt(1 - k * k))
    for _ in range(8):
        a, b = (a + b) / 2, float(np.sqrt(a * b))
    return pi / (2 * a)
