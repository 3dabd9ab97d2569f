"""Derivatives through impacts, stick and release: exact answers, complex numbers, and refusals."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from derivatives.campaign import ALLOWED, judged
from described_scenes import scene_of
from reference.newton_euler import Body
from slopes_of_runs import assert_slopes

E = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
HEAVY, WEIGHTLESS = pc.Scene(links=[ROD]), pc.Scene(links=[ROD], gravity=0.0)
INERTIA = 1 / 3
TEXTBOOK = pc.Scene.textbook()
EXACTLY: Any = {"rtol": 1e-13, "atol": 1e-16}


def derivatives(scene: pc.Scene, t: float, q0: Any, qd0: Any, names: list[str]) -> Any:
    sol = pc.simulate(scene, (0, t), q0, qd0, store="end", sensitivities=names, **EXACTLY)
    return sol.sensitivities[-1]


# Exact answers ----------------------------------------------------------------------------------


def test_a_rod_that_slides_to_rest() -> None:
    """It stops after w I / t_c, at q0 + I w^2 / (2 t_c)."""
    w, friction = 3.0, 0.7
    scene = WEIGHTLESS.replace(effects=[E.DryJointFriction(joint=1, coulomb=friction)])
    names = ["q0[1]", "qd0[1]", "effect[1].coulomb", "link[1].inertia"]
    heavy = scene.replace(links=[pc.Link(mass=1.0, length=1.0, center=0.5, inertia=1 / 12)])
    angle = [1, INERTIA * w / friction, -INERTIA * w**2 / (2 * friction**2), w**2 / (2 * friction)]
    found = derivatives(heavy, 3.0, 0.1, w, names)
    np.testing.assert_allclose(found, [angle, [0] * 4], rtol=0, atol=1e-12)


def test_a_lock_makes_one_link_of_two() -> None:
    """d(q, qd)/d(q0) of two rods with a lock between them is that of a rod twice as long."""
    locked = TEXTBOOK.replace(effects=[E.Lock(joint=2)])
    single = pc.Scene(links=[pc.Link(mass=2.0, length=2.0)])
    names = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]", "gravity"]
    one = derivatives(single, 1.2, 0.4, 1.0, ["q0[1]", "qd0[1]", "gravity"])
    with pytest.warns(pc.PendcoreWarning, match=r'none by "qd0\[1\]": joint 2 is locked'):
        two = derivatives(locked, 1.2, [0.4, 0.4], [1.0, 1.0], names)
    assert np.isnan(two[:, 2:4]).all()
    for link in (0, 1):
        rows = two[[link, 2 + link]]
        np.testing.assert_allclose(rows[:, 0] + rows[:, 1], one[:, 0], rtol=0, atol=1e-11)
        np.testing.assert_allclose(rows[:, 4], one[:, 2], rtol=0, atol=1e-11)


@pytest.mark.parametrize("restitution", [0.3, 0.6, 0.85])
def test_bounces_without_end(restitution: float) -> None:
    """Forty of them come to rest in a moment; whether all are taken or the last few left out."""
    ends = []
    for capture in (1e-5, None):
        stop = E.JointStop(joint=2, range=(-2, 1), restitution=restitution, capture_speed=capture)
        spring = E.TorsionalSpring(joint=2, stiffness=30.0, rest_angle=2.0)
        scene = TEXTBOOK.replace(effects=[stop, spring])
        names = ["q0[1]", "gravity", "effect[1].restitution", "effect[1].range.upper"]
        ends.append(derivatives(scene, 1.2, [1.2, 1.7], [-1.5, 3.0], names))
    np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-11)


# Random runs ------------------------------------------------------------------------------------


@pytest.mark.few_cases
# A reduced sweep takes 0, 16, 55 and the last, whose joint with friction starts at rest.
@pytest.mark.parametrize("seed", [0, 3, 10, 15, 16, 21, 33, 39, 50, 55, 303, 305, 428, 304])
def test_random_runs_have_the_derivatives_of_complex_numbers(seed: int) -> None:
    verdict = judged(seed)
    assert verdict.kind == "right", verdict
    assert verdict.events > 0
    assert verdict.error <= ALLOWED


def test_impacts_whose_order_rounding_decides_are_refused() -> None:
    """Three stops are struck 1e-24 s after each other, and bring all joints to rest."""
    verdict = judged(207)
    assert verdict.kind == "refused", verdict
    assert "after t = 0.576467884" in verdict.told
    assert "stops are struck in an order that rounding decides" in verdict.told


def test_back_in_time() -> None:
    """A plain bounce is undone by the run backwards, and so is its transition matrix."""
    stop = E.JointStop(joint=2, range=(-0.5, 0.8), restitution=1.0)
    scene = TEXTBOOK.replace(effects=[stop])
    names = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]"]
    there = pc.simulate(scene, (0, 1), [0.3, 0.5], [0.0, 1.0], sensitivities=names, **EXACTLY)
    back = pc.simulate(scene, (1, 0), there.q[-1], there.qd[-1], sensitivities=names, **EXACTLY)
    product = back.sensitivities[-1] @ there.sensitivities[-1]
    np.testing.assert_allclose(product, np.eye(4), rtol=0, atol=1e-8)


TABLE = E.Table(t=[0, 0.5, 3], torque=[0.0, 6.0, 6.0], hold=True)
RAMP = E.Table(t=[0, 0.3, 0.6, 1.0, 1.5], torque=[0.0, 3.0, -4.0, 5.0, 0.0])
LOADS = [
    E.Motor(joint=joint, table=E.Table(t=[0, 0.5, 1], torque=[low, high, high], hold=True))
    for joint, low, high in ((1, 0.6, 3.6), (2, 0.0, 2.8))
]
HARDLY_DRIVEN = E.Table(t=[-1, 0.50001, 2], torque=[1e-6, 2e-6, 2e-6], hold=True)
BREAKS: dict[str, tuple[pc.Scene, Any, Any, list[str]]] = {
    "a load that jumps sets a joint free": (
        pc.Scene(links=[ROD], effects=[
            E.DryJointFriction(joint=1, coulomb=2.0), E.Motor(joint=1, table=TABLE),
            E.Motor(joint=1, sinusoid=E.Sinusoid(amplitude=0.5, angular_frequency=2.0)),
        ]), (0, 1), [np.pi / 2, 0.0], ["q0[1]", "effect[1].coulomb", "gravity"],
    ),
    "a motor that sets a joint free from its static friction": (
        WEIGHTLESS.replace(effects=[
            E.DryJointFriction(joint=1, coulomb=0.5, static=0.9, stribeck_velocity=0.2),
            E.Motor(joint=1, sinusoid=E.Sinusoid(amplitude=2.0, angular_frequency=0.9)),
        ]), (0, 1.6), [0.0, 0.0], ["effect[2].sinusoid.amplitude"],
    ),
    "a rod that turns and tears the one that friction holds free": (
        pc.Scene(links=[ROD, ROD], gravity=0.0, effects=[E.DryJointFriction(joint=1, coulomb=1.2)]),
        (0, 0.6), [0.0, 0.0, 0.0, 2.0], ["q0[2]", "qd0[2]"],
    ),
    "a light hand that friction lets go beside a stiff joint": (
        pc.Scene(links=[pc.Link(mass=10.0, length=1.0), pc.Link(mass=0.01, length=0.03)], effects=[
            E.TorsionalSpring(joint=1, stiffness=1e4, rest_angle=1.2),
            E.DryJointFriction(joint=2, coulomb=0.01978),
        ]), (0, 0.0908), [0.96037, 0.3, 0.0, 0.0], ["q0[1]"],
    ),
    "back in time over the points of a table": (
        pc.Scene(links=[ROD, ROD], effects=[E.Motor(joint=1, table=RAMP)]),
        (1.2, 0.1), [0.5, 0.2, 0.3, 1.0], ["q0[1]", "gravity"],
    ),
    "a table that meets a limit": (
        pc.Scene(links=[ROD], effects=[
            E.Motor(joint=1, limit=3.5, table=E.Table(t=[0, 1, 2], torque=[0, 6, 6])),
        ]), (0, 1), [0.5, 0.0], ["q0[1]", "effect[1].limit"],
    ),
    "a joint that friction locks beside one that bounces to rest": (
        pc.Scene(links=[ROD, ROD], effects=[
            E.JointStop(joint=2, range=(-0.8, 1.0), restitution=0.4),
            E.DryJointFriction(joint=1, coulomb=30.0),
        ]), (0, 1), [0.3, 0.5, 0.0, 0.0], ["q0[1]"],
    ),
    "two loads that jump at once on joints that friction holds": (
        pc.Scene(links=[pc.Link(mass=0.67, length=0.4), pc.Link(mass=0.77, length=0.8)], effects=[
            E.DryJointFriction(joint=1, coulomb=0.5, static=2.7),
            E.DryJointFriction(joint=2, coulomb=1.24), *LOADS,
        ]), (0, 0.6), [1.459, 1.499, 0.0, 0.0], ["q0[2]"],
    ),
    "an impact a little before a weak load jumps": (
        WEIGHTLESS.replace(effects=[
            E.JointStop(joint=1, range=(-9, 1.0), restitution=0.5),
            E.Motor(joint=1, table=HARDLY_DRIVEN),
        ]), (0, 1.0), [0.0, 2.0], ["q0[1]"],
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", BREAKS)
def test_derivatives_where_laws_change_are_the_slopes_of_runs(case: str) -> None:
    """Also what only looks like a coincidence has derivatives; over 2e-5 rad, it might be one.

    Beside a stiff joint, friction holds up to 64 eps 1e4 N m, here 7e-9 of itself, too long.
    """
    scene, span, start, names = BREAKS[case]
    sol = pc.simulate(scene, span, *np.split(np.array(start), 2), store="end", sensitivities=names,
                      **EXACTLY)  # fmt: skip

    def end(there: pc.Scene, y: list[float]) -> Any:
        return pc.simulate(there, span, *np.split(np.array(y), 2), store="end", **EXACTLY).y[:, -1]

    by = {"an impact a little before a weak load jumps": (1e-6, 1e-5),
          "a light hand that friction lets go beside a stiff joint": (1e-5, 7e-9)}  # fmt: skip
    step, atol = by.get(case, (1e-4, 1e-9))
    assert_slopes(sol.sensitivities[-1], end, scene, start, names, atol=atol, step=step)


def test_one_name_without_a_derivative_leaves_those_of_the_others() -> None:
    effects = [E.JointStop(joint=2, range=(-0.8, 1.0)), E.DryJointFriction(joint=1, coulomb=0.3)]
    scene = pc.Scene(links=[ROD, pc.Link(mass=0.8, length=0.7)], effects=effects)
    alone = derivatives(scene, 2.0, [0.3, 0.5], 0.0, ["gravity"])
    with pytest.warns(pc.PendcoreWarning, match=r'none by "effect\[1\]\.restitution" after'):
        both = derivatives(scene, 2.0, [0.3, 0.5], 0.0, ["gravity", "effect[1].restitution"])
    np.testing.assert_allclose(both[:, 0], alone[:, 0], rtol=1e-9)
    assert np.isnan(both[:, 1]).all()


def test_a_corner_of_one_name_leaves_the_others() -> None:
    """From 0.5 s on, the table is just at its limit."""
    table = E.Table(t=(0, 0.5, 1, 3), torque=(0, 3, 3, 0))
    scene = TEXTBOOK.replace(effects=[E.Motor(joint=1, table=table, limit=3.0)])

    def found(names: list[str]) -> Any:
        how = {"t_eval": [0.4, 2], "rtol": 1e-12, "atol": 1e-15, "sensitivities": names}
        return pc.simulate(scene, (0, 2), [0.3, 0.5], **how)

    told = r'none by "effect\[1\]\.limit" after t = 0\.5 s: a law has a corner at this value'
    with pytest.warns(pc.PendcoreWarning, match=told):
        both = found(["q0[1]", "effect[1].limit", "gravity"]).sensitivities
    np.testing.assert_array_equal(both[0, :, 1], 0.0)
    assert np.isnan(both[1, :, 1]).all()
    alone = found(["q0[1]", "gravity"]).sensitivities
    np.testing.assert_allclose(both[:, :, [0, 2]], alone, rtol=1e-11)


# Where they are kept ----------------------------------------------------------------------------


def test_a_rod_that_returns_at_rest_to_its_stop_whatever_changes_has_derivatives() -> None:
    """A plastic impact leaves it at rest; from there it comes back to that angle, no farther."""
    verdict = judged(258)
    assert verdict.kind == "right", verdict


def test_before_and_after_an_impact_both_are_kept() -> None:
    """Up to t* = (s - q0)/w, phi = q0 + w t, and from there on phi = s - e w (t - t*)."""
    q0, w, s, e = 0.2, 3.0, 0.8, 0.6
    scene = WEIGHTLESS.replace(effects=[E.JointStop(joint=1, range=(-9, s), restitution=e)])
    names = ["q0[1]", "qd0[1]", "effect[1].range.upper", "effect[1].restitution"]
    hit = (s - q0) / w

    def run(**options: Any) -> pc.Solution:
        return pc.simulate(scene, (0, 0.5), q0, w, sensitivities=names, **EXACTLY, **options)

    def after(t: float) -> Any:
        return [[-e, -e * t, 1 + e, -w * (t - hit)], [0, -e, 0, -w]]

    for sol in (run(), run(store="steps")):
        assert len(sol.sensitivities) == len(sol.t)
        at = int(np.flatnonzero(np.diff(sol.t) == 0)[0])
        assert sol.t[at] == pytest.approx(hit)
        right = [[[1, hit, 0, 0], [0, 1, 0, 0]], after(hit)]
        np.testing.assert_allclose(sol.sensitivities[at : at + 2], right, rtol=0, atol=1e-12)
        np.testing.assert_allclose(sol.sensitivities[-1], after(0.5), rtol=0, atol=1e-12)
    chosen = run(t_eval=[0.1, sol.t[at], 0.4]).sensitivities
    assert chosen.shape == (3, 2, 4)
    np.testing.assert_allclose(chosen[:, 0, 0], [1, -e, -e], atol=1e-12)


# Refused ----------------------------------------------------------------------------------------

BOUNCE = E.JointStop(joint=1, range=(-9, 0.8), restitution=0.6)
IN_TWO = scene_of(
    [Body(1.0, 1.0, 0.5, 1 / 12), Body(1.0, 1.0, 0.0, 0.1)],
    0.0,
    [("joint_stop", {"joint": joint, "range": (-9.0, 0.5)}) for joint in (1, 2)],
)
"""Neither link moves the other: the second one turns about its mass centre."""
REFUSED: dict[str, tuple[pc.Scene, float, Any, Any, list[str], str]] = {
    "a graze": (
        HEAVY.replace(effects=[E.JointStop(joint=1, range=(-9, np.pi - 1e-9))]),
        3.0, 0.0, 0.0, ["q0[1]"], "joint 1 grazes its stop",
    ),
    "two stops at once": (
        IN_TWO, 1.0, [0.0, 0.0], [1.0, 2.0], ["q0[1]"],
        "at once|two of its laws change at that time",
    ),
    "a start with an impact": (
        WEIGHTLESS.replace(effects=[BOUNCE]), 1.0, 0.8, 1.0, ["q0[1]"],
        "none: the run starts with an impact",
    ),
    "a start at a stop": (
        WEIGHTLESS.replace(effects=[BOUNCE]), 1.0, 0.8, -1.0, ["q0[1]"],
        r'none by "q0\[1\]": joint 1 is at its stop, and moves from there to one side only',
    ),
    "a start that friction holds": (
        WEIGHTLESS.replace(effects=[E.DryJointFriction(joint=1, coulomb=1.0)]), 1.0, 0.8, 0.0,
        ["qd0[1]"], r'none by "qd0\[1\]": joint 1 is at rest, where its friction differs to either',
    ),
    "a start at rest that friction does not hold": (
        HEAVY.replace(effects=[E.DryJointFriction(joint=1, coulomb=1.0)]), 1.0,
        0.3, 0.0, ["qd0[1]"], r'none by "qd0\[1\]": joint 1 is at rest, where its friction differs',
    ),
    "a start at rest at a stop that it leaves": (
        HEAVY.replace(effects=[E.JointStop(joint=1, range=(0.3, 9.0))]), 1.0, 0.3, 0.0, ["qd0[1]"],
        r'none by "qd0\[1\]": joint 1 is at its stop',
    ),
    **{f"friction just at its limit, {by:+} of it": (
        HEAVY.replace(effects=[E.DryJointFriction(joint=1, coulomb=9.807 / 2 * (1 + by))]),
        1.0, 0.0, 0.0, ["q0[1]"], "the torques on joint 1 only just hold it",
    ) for by in (-1e-12, 0.0, 1e-12)},
    "a rod that hangs at its stop": (
        HEAVY.replace(effects=[E.JointStop(joint=1, range=(-3, np.pi / 2))]), 1.0, np.pi / 2, 0.0,
        ["torque[1]"], "the torques on joint 1 only just hold it",
    ),
    "an impact when a load jumps": (
        WEIGHTLESS.replace(effects=[
            E.JointStop(joint=1, range=(-9, 1.0), restitution=0.5),
            E.Motor(joint=1, table=E.Table(t=(-1, 0.5, 2), torque=(0.0, 0.1, 0.1), hold=True)),
        ]), 1.0, 0.0, 2.0, ["q0[1]", "torque[1]"], "two of its laws change at that time",
    ),
    "a joint that comes to rest when a load jumps": (
        WEIGHTLESS.replace(effects=[
            E.DryJointFriction(joint=1, coulomb=4 / 3),
            E.Motor(joint=1, table=E.Table(t=(-1, 0.5, 2), torque=(0.0, 2.0, 2.0), hold=True)),
        ]), 1.0, 0.0, 2.0, ["qd0[1]"], "two of its laws change at that time",
    ),
    "a load that jumps to what friction just holds": (
        WEIGHTLESS.replace(effects=[
            E.DryJointFriction(joint=1, coulomb=1.0),
            E.Motor(joint=1, table=E.Table(t=(0, 0.5, 2), torque=(0.0, 1.0, 1.0), hold=True)),
        ]), 1.0, 0.0, 0.0, ["torque[1]"], "the torques on joint 1 only just hold it",
    ),
    "a load that falls to what a stop just holds": (
        WEIGHTLESS.replace(effects=[
            E.JointStop(joint=1, range=(-9, 1.0)),
            E.Motor(joint=1, table=E.Table(t=(0, 0.7, 2), torque=(1.0, 0.0, 0.0))),
        ]), 1.0, 0.0, 2.0, ["torque[1]"], "the torques on joint 1 only just hold it",
    ),
    "a graze that the run's own error passes by": (
        HEAVY.replace(effects=[E.JointStop(joint=1, range=(-9, np.pi - 0.3), restitution=0.5)]),
        2.0, 0.3, 0.0, ["q0[1]"], "joint 1 grazes its stop",
    ),
    "a motor that slows a sliding joint nearly to rest": (
        WEIGHTLESS.replace(effects=[
            E.DryJointFriction(joint=1, coulomb=1.0),
            E.Motor(joint=1, table=E.Table(t=(0, 2), torque=(0.0, 2.0))),
        ]), 2.0, 0.0, 1.5 + 1e-9, ["qd0[1]"], "joint 1 nearly comes to rest",
    ),
    "a graze from which a step begins": (
        HEAVY.replace(effects=[
            E.JointStop(joint=1, range=(-9, np.pi - 1.1842660210100773 + 5e-8), restitution=0.5)
        ]), 1.4, 1.1842660210100773, 0.0, ["q0[1]"], "joint 1 grazes its stop",
    ),
    "a graze of a heavy link": (
        pc.Scene(links=[pc.Link(mass=1e6, length=1.0)]).replace(effects=[
            E.JointStop(joint=1, range=(-9, np.pi - 0.3 + 5e-8), restitution=0.5)
        ]), 1.5, 0.3, 0.0, ["torque[1]"], "joint 1 grazes its stop",
    ),
    "a graze beside one that the name does not move": (
        scene_of([Body(1.0, 1.0, 0.5, 1 / 12), Body(0.5, 0.4, 0.0, 0.02)], 9.807, [
            ("joint_stop", {"joint": 1, "range": (-9, np.pi - 0.3 + 5e-8), "restitution": 0.5}),
            ("joint_stop", {"joint": 2, "range": (1.3 - np.pi - 5e-8, 9), "restitution": 0.5}),
        ]), 1.5, [0.3, 1.0], 0.0, ["q0[2]"], "joint 2 grazes its stop",
    ),
    "a restitution that is zero": (
        HEAVY.replace(effects=[E.JointStop(joint=1, range=(-9, 0.8))]), 1.0, 0.2,
        3.0, ["effect[1].restitution"], "the restitution of joint 1 is 0, and can only grow",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_what_has_no_derivative_is_refused_by_name(name: str) -> None:
    scene, t, q0, qd0, names, told = REFUSED[name]
    with pytest.warns(pc.PendcoreWarning, match=told):
        sol = pc.simulate(scene, (0, t), q0, qd0, rtol=1e-10, sensitivities=names)
    assert sol.success
    assert len(sol.sensitivities) == len(sol.t)
    assert np.isnan(sol.sensitivities[-1]).all()
