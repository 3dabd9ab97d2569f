"""The families that scenes are drawn from, each with seeds of its own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from math import inf, log, pi
from typing import Any

import numpy as np
import pendcore as pc

from true_error import drawing as draw
from true_error.asked import Drawn, asked, times_kept
from true_error.drawing import GRAVITIES, Dice
from true_error.own_laws import OwnLaw

E = pc.effects
ASIDE = 20.0
"""s; tables reach this far beyond any start and end."""


def mixed(seed: int) -> Drawn:
    """Mixed smooth scenes: any links, masses over up to six decades, any of the smooth effects."""
    dice = Dice("mixed", seed)
    n = dice.whole(1, 5)
    links = draw.links(dice, n, dice.one_of((0.0, 1.0, 2.0, 6.0)))
    scene = draw.scene_of(links, mixed_effects(dice, links), dice.one_of(GRAVITIES))
    start = draw.start(dice, n, (0.3, 1.0, 3.0), (0.0, 1.0, 10.0))
    span = dice.one_of((1.0, 3.0, 10.0, 30.0))
    return asked(dice, scene, start, span)


def mixed_effects(dice: Dice, links: list[pc.Link]) -> list[Any]:
    """Return some of the smooth effects."""
    n = len(links)
    found: list[Any] = []
    if dice.chance(0.2):
        mass = links[-1].mass * dice.decades(-1, 1)
        found.append(E.Payload(mass, inertia=mass * links[-1].length ** 2 * dice.decades(-4, -1)))
    if dice.chance(0.2):
        joint = dice.whole(1, n)
        armature = draw.joint_inertia(links, joint) * dice.decades(-3, 0)
        found.append(E.RotorInertia(joint, armature))
    if dice.chance(0.3):
        cubic = dice.decades(-4, -1)
        found.append(draw.damper(links, dice.whole(1, n), dice.decades(-4, 0.5), cubic))
    if dice.chance(0.2):
        found.append(draw.spring(dice, links, dice.whole(1, n), dice.decades(-1, 2)))
    if dice.chance(0.3):
        found.append(
            E.DrivenPivot(
                x=draw.sinusoid(dice, dice.decades(-3, -0.5), dice.decades(0, 1.5)),
                y=draw.sinusoid(dice, dice.decades(-3, -0.5), dice.decades(0, 1.5)),
            )
        )
    joint = dice.whole(1, n)
    strength = 10 * draw.joint_inertia(links, joint)
    if dice.chance(0.3):
        strength *= dice.uniform(0, 1)
        found.append(draw.motor(dice, joint, strength, dice.decades(-1, 2)))
    if dice.chance(0.2):
        found.append(draw.controller(dice, links, dice.whole(1, n), dice.decades(0, 1.5)))
    return found


def damped(seed: int) -> Drawn:
    """Damped and driven scenes of ordinary links; whole periods that fall in with even times."""
    dice = Dice("damped", seed)
    if dice.chance(0.06):
        return whole_periods(dice)
    n = dice.whole(1, 5)
    links = []
    for _ in range(n):
        mass, length = dice.decades(-1, 0.3), dice.decades(-0.7, 0.3)
        is_rod = dice.chance(0.5)
        inertia = mass * length * length / 12 if is_rod else 0.0
        center = length / 2 if is_rod else length
        links.append(pc.Link(mass=mass, length=length, center=center, inertia=inertia))
    scene = draw.scene_of(links, damped_effects(dice, links), 9.807)
    start = draw.start(dice, n, (0.1, 0.5, 1.2), (0.0, 1.0))
    span = dice.one_of((1.0, 3.0, 10.0, 30.0))
    return asked(dice, scene, start, span, backward=0.1, decades=(-11.5, -2.0))


def damped_effects(dice: Dice, links: list[pc.Link]) -> list[Any]:
    """Return dampers in most joints, and what drives the chain."""
    n = len(links)
    weights = [draw.weight_torque(links[joint:]) for joint in range(n)]
    found: list[Any] = [
        E.ViscousJoint(joint, weights[joint - 1] * dice.decades(-3, 0.5))
        for joint in range(1, n + 1)
        if dice.chance(0.6)
    ]
    joint = dice.whole(1, n)
    scale = draw.weight_torque(links[joint - 1 :])
    if dice.chance(0.3):
        stiffness = scale * dice.decades(-1, 1.5)
        found.append(E.TorsionalSpring(joint, stiffness, rest_angle=dice.uniform(-1, 1)))
    if dice.chance(0.3):
        pd = E.PD(scale * dice.decades(-1, 1), scale * dice.decades(-2, 0), dice.uniform(-1, 1))
        found.append(E.Motor(joint, pd=pd))
    if dice.chance(0.3):
        found.append(draw.motor(dice, joint, scale * dice.uniform(0, 0.5), dice.decades(-1, 1)))
    if dice.chance(0.2):
        found.append(E.DrivenPivot(y=E.Sinusoid(dice.decades(-3, -1), dice.decades(0, 1))))
    return found


def whole_periods(dice: Dice) -> Drawn:
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
    scene = draw.scene_of([link], found, 9.807)
    periods = dice.one_of((20, 25, 50, 100, 100, 200))
    start = [pi / 2 - wide], [0.0]
    drawn = asked(dice, scene, start, periods * period, backward=0.0, turns=inf)
    options = {name: drawn.options[name] for name in drawn.options if name in ("max_step", "store")}
    return replace(drawn, options=options)


def quarter_period(k: float) -> float:
    """Return the complete elliptic integral K of a modulus: by the arithmetic-geometric mean."""
    a, b = 1.0, float(np.sqrt(1 - k * k))
    for _ in range(8):
        a, b = (a + b) / 2, float(np.sqrt(a * b))
    return pi / (2 * a)


def chaotic(seed: int) -> Drawn:
    """Chaotic scenes, from short of where doubles know the error that is asked to beyond it."""
    dice = Dice("chaotic", seed)
    n = dice.whole(1, 5)
    is_textbook = n == 2 and dice.chance(0.5)
    links = draw.links(dice, n, 0.5) if not is_textbook else list(pc.Scene.textbook().links)
    if n == 1:
        links = [pc.Link(mass=links[0].mass, length=links[0].length)]
    found: list[Any] = []
    if n == 1 or dice.chance(0.15):
        # One rod alone is regular: what drives it makes it chaotic.
        scale = 9.8 * links[0].mass * links[0].length
        found.append(draw.motor(dice, 1, scale * dice.uniform(0.3, 1.5), dice.uniform(1.0, 4.0)))
    scene = draw.scene_of(links, found, 9.807)
    start = draw.start(dice, n, (2.0, 3.0), (0.0, 0.0, 2.0))
    drawn = asked(dice, scene, start, 1.0, backward=0.0)
    # Errors grow about so fast, and doubles know them until about here.
    rate = 0.5 if n == 1 else 0.7 * np.sqrt(9.807 * n / sum(link.length for link in links))
    span = dice.uniform(0.2, 1.3) * log(drawn.error / 1e-16) / rate
    if dice.chance(0.08):
        span *= 5
    if dice.chance(0.2):
        span = -span
    t_end = drawn.t_start + span
    options = times_kept(dice, drawn.t_start, t_end)
    options |= {name: drawn.options[name] for name in drawn.options if name == "events"}
    return replace(drawn, t_end=t_end, options=options)


def stiff(seed: int) -> Drawn:
    """Stiff scenes: dampers, springs and controllers far faster than the motion that is left."""
    dice = Dice("stiff", seed)
    n = dice.whole(1, 5)
    links = draw.links(dice, n, dice.one_of((0.3, 1.0)))
    found: list[Any] = []
    for joint in {dice.whole(1, n) for _ in range(dice.whole(1, 2))}:
        found += hard(dice, links, joint, dice.decades(2, 5))
    if dice.chance(0.3):
        found.append(draw.damper(links, dice.whole(1, n), dice.decades(-1, 1)))
    if dice.chance(0.3):
        joint = dice.whole(1, n)
        strength = draw.weight_torque(links[joint - 1 :]) * dice.uniform(0, 0.5)
        found.append(draw.motor(dice, joint, strength, dice.decades(-0.5, 1.0)))
    scene = draw.scene_of(links, found, dice.one_of(GRAVITIES))
    start = draw.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 3.0))
    # A reference by explicit series takes a step for every few of these turns.
    return asked(
        dice, scene, start, dice.one_of((1.0, 3.0, 10.0)),
        backward=0.0, turns=dice.decades(2.5, 4.3),
    )  # fmt: skip


def hard(dice: Dice, links: list[pc.Link], joint: int, rate: float) -> list[Any]:
    """Return what makes a joint stiff, of a rate, 1/s."""
    kind = dice.whole(0, 3)
    if kind == 0:
        return [draw.damper(links, joint, rate)]
    if kind == 1:
        return [draw.damper(links, joint, 0.0, cubic=rate)]
    if kind == 2:
        return [
            draw.spring(dice, links, joint, rate),
            draw.damper(links, joint, rate * dice.decades(-3, 0.3)),
        ]
    return [draw.controller(dice, links, joint, rate)]


def contact(seed: int) -> Drawn:
    """Dry friction and stops: joints that stick and slip, bounce, and come to rest at a stop."""
    dice = Dice("contact", seed)
    n = dice.whole(1, 5)
    links = draw.links(dice, n, dice.one_of((0.3, 1.0)))
    q0, qd0 = draw.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 5.0))
    joints = list(dice.rng.permutation(n) + 1)
    found: list[Any] = []
    kind = dice.whole(0, 2)
    if kind != 1:
        found += [friction(dice, links, int(joints.pop())) for _ in range(min(n, 1 + kind // 2))]
    if joints and kind != 0:
        found.append(stop(dice, int(joints.pop()), q0))
    joint = dice.whole(1, n)
    if dice.chance(0.4):
        found.append(draw.damper(links, dice.whole(1, n), dice.decades(-2, 1)))
    if dice.chance(0.4):
        strength = draw.weight_torque(links[joint - 1 :]) * dice.uniform(0, 0.5)
        found.append(draw.motor(dice, joint, strength, dice.decades(-0.5, 1)))
    if dice.chance(0.2):
        found.append(draw.spring(dice, links, dice.whole(1, n), dice.decades(0, 1)))
    scene = draw.scene_of(links, found, dice.one_of(GRAVITIES))
    span = dice.one_of((0.5, 1.0, 2.0, 4.0))
    return asked(dice, scene, (q0, qd0), span, backward=0.0, decades=(-11.0, -2.0))


def friction(dice: Dice, links: list[pc.Link], joint: int) -> Any:
    """Return dry friction that may hold a joint or hardly slows it."""
    beyond = links[joint - 1 :]
    torque = draw.weight_torque(beyond) * dice.decades(-2.5, 0)
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
        joint, (low if side != 1 else -inf, high if side != 2 else inf),
        restitution=dice.one_of((0.0, 1.0, dice.uniform(0.1, 0.9))),
        capture_speed=dice.decades(-3, -0.7),
    )  # fmt: skip


def own(seed: int) -> Drawn:
    """Functions of a user's own, tables of torque, splines of the pivot, controllers that clip."""
    dice = Dice("own", seed)
    n = dice.whole(1, 5)
    links = draw.links(dice, n, dice.one_of((0.3, 1.0)))
    start = draw.start(dice, n, (0.3, 1.0, 2.0), (0.0, 1.0, 5.0))
    kinds = [table, spline, clipped, quadratic]
    chosen = [kinds[k] for k in dice.rng.permutation(len(kinds))[: dice.whole(0, 2)]]
    if not chosen or dice.chance(0.3):
        chosen.append(own_function)
    found = [kind(dice, links) for kind in chosen]
    if dice.chance(0.4):
        found.append(draw.damper(links, dice.whole(1, n), dice.decades(-2, 1)))
    if dice.chance(0.2):
        found.append(draw.spring(dice, links, dice.whole(1, n), dice.decades(0, 1)))
    scene = draw.scene_of(links, found, dice.one_of(GRAVITIES))
    return asked(
        dice, scene, start, dice.one_of((0.3, 1.0, 3.0)), backward=0.15, decades=(-11.0, -2.0),
        turns=100.0,
    )  # fmt: skip


def own_function(dice: Dice, links: list[pc.Link]) -> Any:
    """Return a law as a Python function, smooth or with a kink."""
    joint = dice.whole(1, len(links))
    inertia, scale = draw.joint_inertia(links, joint), draw.weight_torque(links[joint - 1 :])
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
    torque = draw.weight_torque(links[joint - 1 :]) * dice.spread(len(t), 0.5)
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
    limit = draw.weight_torque(links[joint - 1 :]) * dice.decades(-1, 0.5)
    return draw.controller(dice, links, joint, dice.decades(0, 1.3), limit)


def quadratic(dice: Dice, links: list[pc.Link]) -> Any:
    """Return quadratic damping, whose second derivative jumps where the rate is zero."""
    joint = dice.whole(1, len(links))
    return E.ViscousJoint(
        joint, 0.0, damping2=draw.joint_inertia(links, joint) * dice.decades(-1, 1)
    )


def short_links(seed: int) -> Drawn:
    """Chains with a link so short that its angle may be lost while all positions are still right.

    The error that is asked for is from a third of the link's share of the length to ten times that.
    """
    dice = Dice("short_links", seed)
    n = dice.whole(2, 3)
    share = dice.decades(-2.5, -1.0)
    short = dice.whole(1, n)
    links = []
    for number in range(1, n + 1):
        length = share if number == short else dice.uniform(0.5, 1.0)
        mass = dice.decades(-0.5, 0.5)
        links.append(dice.one_of((pc.Link.point_mass, pc.Link))(mass=mass, length=length))
    scene = draw.scene_of(links, [], 9.807)
    start = draw.start(dice, n, (1.0, 2.0, 3.0), (0.0, 0.0, 2.0))
    drawn = asked(dice, scene, start, dice.uniform(1.0, 30.0))
    total = sum(link.length for link in links)
    return replace(drawn, error=float(np.clip(share / total * dice.decades(-0.5, 1.0), 1e-4, 0.2)))


FAMILIES: dict[str, Callable[[int], Drawn]] = {
    draw_one.__name__: draw_one
    for draw_one in (mixed, damped, chaotic, stiff, contact, own, short_links)
}
