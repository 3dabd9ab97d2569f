"""Links and starts, as families draw them."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pendcore as pc

from true_error.arrays import Floats
from true_error.dice import Dice

GRAVITIES = (9.807, 9.807, 9.807, 1.62, 0.0)


def links(dice: Dice, n: int, decades: float) -> list[pc.Link]:
    """Return n links whose masses span some decades: rods, points and bodies of any kind."""
    found = []
    for _i in range(n):
        mass, length = dice.decades(-decades, 0.3), dice.decades(-1, 0.3)
        rod = mass * length * length / 12
        kind = dice.whole(0, 2)
        if kind == 0:
            center, inertia = length / 2, rod
        elif kind == 1:
            center, inertia = length, 0.0
        else:
            center = length * dice.uniform(-0.5, 1.5)
            inertia = mass * length * length * dice.decades(-4, -1)
        found.append(pc.Link(mass=mass, length=length, center=center, inertia=inertia))
    return found


def start(
    dice: Dice, n: int, wide: tuple[float, ...], fast: tuple[float, ...]
) -> tuple[Floats, Any]:
    """Return angles around hanging, rad, and rates, rad/s."""
    q0 = np.pi / 2 + dice.spread(n, dice.one_of(wide))
    return q0, dice.spread(n, dice.one_of(fast))


def scene_of(found: list[pc.Link], effects: list[Any], gravity: float) -> pc.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=found, effects=effects, gravity=gravity)
