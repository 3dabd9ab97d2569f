"""Couples and waves in lanes: the bits of `pc.simulate`, and what has no lanes runs one by one."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from test_lanes import BOOK, assert_same

E = pc.effects
METHODS = ["dopri5", "dop853", "taylor", "dopri5-radau5", "dop853-radau5", "taylor-radau5"]
SCENES = {
    "damping": [E.ViscousJoint(joint=1, damping=0.1), E.ViscousJoint(joint=2, damping=0.3)],
    "spring and rotors": [
        E.TorsionalSpring(joint=2, stiffness=3.0, rest_angle=0.2),
        E.RotorInertia(joint=2, armature=0.1),
        E.RotorInertia(joint=1, armature=0.2),
    ],
    "constant motor": [E.Motor(joint=1, constant=2.0), E.Payload(mass=0.3)],
    "controller": [E.Motor(joint=2, pd=E.PD(kp=4.0, kd=0.5, reference=0.3))],
    "one wave": [E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0))],
    "two waves and damping": [
        E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0, 0.4)),
        E.Motor(joint=2, sinusoid=E.Sinusoid(1.0, 11.0)),
        E.ViscousJoint(joint=2, damping=0.1),
    ],
    "cube of a rate": [
        E.ViscousJoint(joint=2, damping=0.1, damping3=0.05),
        E.ViscousJoint(joint=1, damping=0.1),
    ],
    "drag": [E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03)],
    "drag and wind on both links, and damping": [
        E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.3, wind=(4.0, -1.0)),
        E.ViscousJoint(joint=2, damping=0.1),
        E.RodDrag(link=2, drag_coefficient=0.8, diameter=0.2),
    ],
    "drag twice on a link": [E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03)] * 2,
    "drag, motors and a shaken pivot": [
        E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, -1.0)),
        E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0)),
        E.DrivenPivot(x=E.Sinusoid(0.05, 9.0), y=E.Sinusoid(0.03, 20.0, 1.0)),
        E.Motor(joint=2, sinusoid=E.Sinusoid(1.0, 4.0)),
        E.RotorInertia(joint=2, armature=0.1),
    ],
    "five waves": [E.Motor(1 + k % 2, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(5)],
    "shaken pivot": [E.DrivenPivot(x=E.Sinusoid(0.05, 9.0)), E.ViscousJoint(joint=1, damping=0.1)],
}
ONE_BY_ONE = {
    "friction": [E.DryJointFriction(joint=2, coulomb=0.2)],
    "stop": [E.JointStop(joint=2, range=(-4.0, 4.0), restitution=0.5)],
    "lock": [E.Lock(joint=2)],
    "motor at its limit": [E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0), limit=2.0)],
}


def scene_of(effects):
    return BOOK.replace(effects=effects)


def has_lanes():
    return pc._core.instruction_set() in ("x86-64-v3", "x86-64-v4")


@pytest.mark.parametrize("rtol", [1e-3, 1e-7, 1e-11])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("name", SCENES)
def test_effects_change_no_bit_in_lanes(name, method, rtol):
    q0 = pc.sampling.uniform(-2.0, 2.0, (21, 2), seed=2)
    qd0 = pc.sampling.uniform(-3.0, 3.0, (21, 2), seed=3)
    scene = scene_of(SCENES[name])
    if "drag" in name and method.startswith("taylor"):
        pytest.skip("drag has no series")
    if has_lanes():
        series = () if "drag" in name else ("taylor",)
        assert scene.explain().lanes == ("dopri5", "dop853", *series)
    assert_same(scene, q0, qd0, (0.3, 3), method=method, rtol=rtol, atol=rtol / 10)
    assert_same(scene, q0, qd0, (1.0, 0.0), method=method, rtol=rtol, max_steps=40)


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_what_switches_runs_one_by_one(name):
    scene = scene_of(ONE_BY_ONE[name])
    assert scene.explain().lanes == ()
    assert "runs its members one by one" in str(scene.explain())
    assert_same(scene, pc.sampling.uniform(-0.5, 0.5, (9, 2), seed=2), 0.0, (0, 2), method="dopri5")


@pytest.mark.parametrize("method", ["dop853", "taylor"])
def test_parameters_of_effects_differ_from_lane_to_lane(method):
    scene = scene_of(SCENES["two waves and damping"])
    names = [
        "effect[1].sinusoid.amplitude", "effect[2].sinusoid.angular_frequency",
        "effect[3].damping", "link[1].mass",
    ]  # fmt: skip
    values = pc.sampling.uniform(0.5, 2.0, (13, len(names)), seed=6)
    vary = {name: values[:, k] for k, name in enumerate(names)}
    found = pc.ensemble(scene, q0=[0.5, 1.0], t_span=(0, 3), vary=vary, method=method)
    for i in range(13):
        one = scene.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(one, q0=[0.5, 1.0], t_span=(0, 3), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("n", [1, 2])
def test_drag_differs_from_lane_to_lane(n, method):
    links = BOOK.links[:n]
    drag = E.RodDrag(link=n, drag_coefficient=1.2, diameter=0.1, wind=(1.0, 0.5))
    scene = BOOK.replace(links=links, effects=[drag, E.ViscousJoint(joint=1, damping=0.1)])
    names = [
        "effect[1].drag_coefficient", "effect[1].wind.x", "effect[1].air_density",
        f"link[{n}].length", "effect[2].damping",
    ]  # fmt: skip
    values = pc.sampling.uniform(0.5, 2.0, (21, len(names)), seed=6)
    values[4, 0] = 0.0
    values[9, 0] = -1.0  # which is not allowed
    vary = {name: values[:, k] for k, name in enumerate(names)}
    found = pc.ensemble(
        scene, q0=0.4, t_span=(0, 3), vary=vary, method=method, workers=1, on_failure="ignore"
    )
    for i in range(21):
        if i == 9:
            assert found.status[i] == "refused"
            continue
        one = scene.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(one, q0=0.4, t_span=(0, 3), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])


@pytest.mark.parametrize("method", ["dopri5", "taylor"])
def test_a_member_whose_motor_is_at_its_limit_beside_others(method):
    scene = scene_of([E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0), limit=9.0)])
    limits = np.array([9.0, 2.0, 8.0, 1.0, 7.0, 7.5, 8.5])
    found = pc.ensemble(
        scene, q0=[0.5, 1.0], t_span=(0, 3), vary={"effect[1].limit": limits}, method=method
    )
    for i, limit in enumerate(limits):
        one = scene.with_parameters({"effect[1].limit": limit})
        alone = pc.simulate(one, q0=[0.5, 1.0], t_span=(0, 3), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])


def test_explain_names_the_methods_with_lanes():
    told = BOOK.explain()
    if has_lanes():
        assert told.lanes == ("dopri5", "dop853", "taylor")
        words = " ".join(str(told).split())
        assert (
            "a lane each, by dopri5, dop853 or taylor; it runs them one by one with events" in words
        )
        assert "and for the energy drift if effects do work or lose energy" in words
    assert told.to_dict()["lanes"] == list(told.lanes)


def test_explain_names_a_single_method_with_lanes():
    told = BOOK.replace(links=[pc.Link(mass=1.0, length=1.0)] * 5).explain()
    if has_lanes():
        words = " ".join(str(told).split())
        assert "a lane each, by taylor; it runs them one by one" in words


def test_stiffness_is_that_of_the_member_of_the_lane():
    """A stiff member among others, whose equations were made after its own."""
    scene = scene_of([E.ViscousJoint(joint=2, damping=0.1)])
    damping = np.tile([200.0, 60.0, 0.1, 0.2, 0.3, 0.4, 0.5], 6)
    found = pc.ensemble(
        scene, q0=[0.5, 1.0], t_span=(0, 20), vary={"effect[1].damping": damping},
        method="taylor-radau5",
    )  # fmt: skip
    for i, one in enumerate(damping):
        alone = pc.simulate(
            scene.with_parameters({"effect[1].damping": one}), q0=[0.5, 1.0], t_span=(0, 20),
            method="taylor-radau5",
        )  # fmt: skip
        assert np.array_equal(found.q[i], alone.q[-1]), one
