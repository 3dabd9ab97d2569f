"""Smooth effects, scaled by what a chain weighs, as families draw them."""

from __future__ import annotations

from typing import Any

import pendcore as pc

from true_error.dice import Dice

E = pc.effects


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
