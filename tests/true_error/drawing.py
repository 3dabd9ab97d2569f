"""What families draw with: numbers of a seed, links, starts, effects scaled by a chain's weight."""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import Any, TypeVar
from zlib import crc32

import numpy as np
import pendcore as pc

from true_error.arithmetic import Floats

E = pc.effects
T = TypeVar("T")
GRAVITIES = (9.807, 9.807, 9.807, 1.62, 0.0)


class Dice:
    """Random numbers of a family's seed: the same for the same family and seed."""

    def __init__(self, family: str, seed: int) -> None:
        self.family, self.seed = family, seed
        self.rng = np.random.default_rng([crc32(family.encode()), seed])

    def chance(self, share: float) -> bool:
        return bool(self.rng.random() < share)

    def uniform(self, low: float, high: float) -> float:
        return float(self.rng.uniform(low, high))

    def decades(self, low: float, high: float) -> float:
        """Return 10 to a power between two."""
        return float(10 ** self.rng.uniform(low, high))

    def whole(self, low: int, high: int) -> int:
        """Return a number from low to high, both included."""
        return int(self.rng.integers(low, high + 1))

    def one_of(self, values: Sequence[T]) -> T:
        return values[self.whole(0, len(values) - 1)]

    def spread(self, count: int, width: float) -> Floats:
        """Return `count` numbers between -width and width."""
        return self.rng.uniform(-width, width, count)


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


def weight_torque(links: list[pc.Link]) -> float:
    """Return the torque of all the weight at the whole length, N m: the scale of other torques."""
    return 9.8 * sum(link.mass for link in links) * sum(link.length for link in links)


def joint_inertia(links: list[pc.Link], joint: int) -> float:
    """Return the inertia about a joint of the links from there on, stretched, at least, kg m^2."""
    beyond, total = 0.0, 0.0
    for link in links[joint - 1 :]:
        total += link.inertia + link.mass * (beyond + link.center) ** 2
        beyond += link.length
    return total


def spring(dice: Dice, links: list[pc.Link], joint: int, rate: float) -> Any:
    """Return a spring that would swing the links beyond at a rate, rad/s."""
    stiffness = rate * rate * joint_inertia(links, joint)
    return E.TorsionalSpring(joint, stiffness, rest_angle=dice.uniform(-1, 1))


def damper(links: list[pc.Link], joint: int, rate: float, cubic: float = 0.0) -> Any:
    """Return a damper that would slow the links beyond at a rate, 1/s."""
    inertia = joint_inertia(links, joint)
    return E.ViscousJoint(joint, rate * inertia, damping3=cubic * inertia)


def controller(dice: Dice, links: list[pc.Link], joint: int, rate: float, limit: Any = None) -> Any:
    """Return a PD controller of a rate, rad/s, from hardly to overly damped."""
    inertia = joint_inertia(links, joint)
    pd = E.PD(rate * rate * inertia, rate * inertia * dice.decades(-1.5, 0.5), dice.uniform(-1, 1))
    return E.Motor(joint, pd=pd) if limit is None else E.Motor(joint, pd=pd, limit=limit)


def sinusoid(dice: Dice, amplitude: float, rate: float) -> Any:
    return E.Sinusoid(amplitude, rate, dice.uniform(0, 6))


def motor(dice: Dice, joint: int, strength: float, rate: float) -> Any:
    """Return a motor of a sinusoid, N m and rad/s."""
    return E.Motor(joint, sinusoid=sinusoid(dice, strength, rate))
