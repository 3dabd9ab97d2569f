"""Chains in lanes of Taylor series: the bits of `pc.simulate`."""

from __future__ import annotations

from itertools import product

import numpy as np
import pendcore as pc
import pytest
from test_lanes import assert_same
from test_lanes_with_effects import has_lanes

E = pc.effects
SCENES = {
    "bare": [],
    "payload and a rotor in joint 1": [E.Payload(mass=0.3), E.RotorInertia(joint=1, armature=0.2)],
    "damping": [E.ViscousJoint(joint=1, damping=0.1), E.ViscousJoint(joint=3, damping=0.3)],
    "spring and the cube of a rate": [
        E.TorsionalSpring(joint=2, stiffness=3.0, rest_angle=0.2),
        E.ViscousJoint(joint=2, damping=0.1, damping3=0.05),
    ],
    "two waves": [
        E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0, 0.4)),
        E.Motor(joint=3, sinusoid=E.Sinusoid(1.0, 11.0)),
    ],
    "controller": [E.Motor(joint=2, pd=E.PD(kp=4.0, kd=0.5, reference=0.3))],
}
OF_ANY_CHAIN = {
    "rotor between links": [E.RotorInertia(joint=2, armature=0.2)],
    "three waves": [E.Motor(joint=1, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(3)],
    "shaken pivot": [E.DrivenPivot(x=E.Sinusoid(0.05, 9.0))],
    "pivot shaken both ways, with damping and the cube of a rate": [
        E.DrivenPivot(x=E.Sinusoid(0.05, 9.0), y=E.Sinusoid(0.1, 4.0, 1.0)),
        E.ViscousJoint(joint=1, damping=0.2, damping3=0.03),
    ],
    "two shaken pivots and a motor": [
        E.DrivenPivot(y=E.Sinusoid(0.02, 20.0)),
        E.DrivenPivot(x=E.Sinusoid(0.1, 3.0)),
        E.Motor(joint=2, sinusoid=E.Sinusoid(1.0, 5.0)),
    ],
}
"""Effects with which chains of two to four links have no series but that of any chain."""
ONE_BY_ONE = {
    "friction": [E.DryJointFriction(joint=2, coulomb=0.2)],
    "drag": [E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03)],
}


def chain(n, effects=()):
    links = [pc.Link(mass=1.0 + 0.2 * i, length=1.0 - 0.1 * i) for i in range(n)]
    return pc.Scene(links=links, gravity=9.81, effects=list(effects))


def starts(count, n, seed, reach):
    return pc.sampling.uniform(-reach, reach, (count, n), seed=seed)


def asked(method, rtol):
    return {"method": method, "rtol": rtol, "atol": rtol / 10}


def assert_bits(scene, how, t_end):
    """Assert the bits of members, to their ends and out of steps; return their starts."""
    n = len(scene.links)
    q0, qd0 = starts(21, n, 2, np.pi), starts(21, n, 3, 4.0)
    q0[5], qd0[5] = 0.0, 0.0
    assert assert_same(scene, q0, qd0, (0.3, t_end), **how).success.all()
    assert_same(scene, q0, qd0, (1.0, 0.0), **how, max_steps=11)
    return q0, qd0


@pytest.mark.parametrize("rtol", [1e-3, 1e-7, 1e-12])
@pytest.mark.parametrize("n", [3, 4])
@pytest.mark.parametrize("name", SCENES)
def test_chains_in_lanes_have_the_bits_of_single_runs(name, n, rtol):
    scene = chain(n, SCENES[name])
    if has_lanes():
        assert scene.explain().lanes == ("dopri5", "dop853", "taylor")
    for method in ("taylor", "taylor-radau5"):
        how = asked(method, rtol)
        q0, qd0 = assert_bits(scene, how, 2.3)
        assert_same(scene, q0[:3], qd0[:3], (0.0, 1.0), **how, max_step=0.02)


@pytest.mark.parametrize("rtol", [1e-3, 1e-7, 1e-12])
@pytest.mark.parametrize(
    ("n", "name"),
    [*product([2, 3, 4, 5, 9], OF_ANY_CHAIN), *product([5, 8], SCENES)],
)
def test_any_chain_in_lanes_has_the_bits_of_single_runs(name, n, rtol):
    scene = chain(n, (OF_ANY_CHAIN | SCENES)[name])
    if has_lanes():
        assert "taylor" in scene.explain().lanes
    how = asked("taylor", rtol)
    q0, qd0 = assert_bits(scene, how, 2.3)
    assert_same(scene, q0, qd0, (0.0, 1.0), **how, max_step=0.007)  # looks whether it is stiff


@pytest.mark.parametrize("n", [5, 8, 9])
def test_effects_of_all_rows_of_joints_have_lanes(n):
    effects = [
        E.ViscousJoint(joint=4, damping=0.1, damping3=0.05),
        E.ViscousJoint(joint=n, damping=0.2, damping3=0.02),
        E.Motor(joint=5, sinusoid=E.Sinusoid(1.0, 5.0)),
        E.TorsionalSpring(joint=n, stiffness=2.0),
        E.RotorInertia(joint=n, armature=0.05),
    ]
    scene = chain(n, effects)
    if has_lanes():
        assert scene.explain().lanes == ("taylor",)
    q0, qd0 = starts(21, n, 2, np.pi), starts(21, n, 3, 4.0)
    found = assert_same(scene, q0, qd0, (0.3, 1.3), method="taylor", rtol=1e-8)
    assert found.success.all()


def long_chain(n):
    return pc.Scene(links=[pc.Link(mass=0.1, length=0.1)] * n)


@pytest.mark.parametrize("n", [33, 100])
def test_long_chains_in_lanes_have_the_bits_of_single_runs(n):
    scene = long_chain(n)
    if has_lanes():
        assert scene.explain().lanes == ("taylor",)
    found = assert_same(scene, starts(11, n, 2, 0.5), 0.0, (0, 0.2), method="taylor", rtol=1e-6)
    assert found.success.all()


def test_chains_that_are_too_long_for_lanes():
    scene = long_chain(101)
    assert scene.explain().lanes == ()
    assert_same(scene, starts(5, 101, 2, 0.5), 0.0, (0, 0.05), method="taylor")


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_other_chains_run_one_by_one(name):
    scene = chain(5, ONE_BY_ONE[name])
    assert scene.explain().lanes == ()
    method = "dop853" if name == "drag" else "taylor"
    assert_same(scene, starts(7, 5, 2, 0.5), 0.0, (0, 1), method=method)


VARIED = ["link[1].mass", "link[1].length", "gravity"]


@pytest.mark.parametrize(
    ("n", "effects", "names"),
    [
        (3, "two waves", ["effect[2].sinusoid.amplitude"]),
        (4, "two waves", ["effect[2].sinusoid.amplitude"]),
        (2, "shaken pivot", ["effect[1].x.amplitude", "effect[1].x.angular_frequency"]),
        (5, "spring and the cube of a rate", ["effect[1].stiffness", "effect[2].damping3"]),
        (6, "rotor between links", ["effect[1].armature"]),
        (9, "shaken pivot", ["effect[1].x.amplitude"]),
        (5, "three waves", ["effect[3].sinusoid.amplitude", "effect[1].sinusoid.phase"]),
    ],
)
def test_parameters_of_chains_differ_from_lane_to_lane(n, effects, names):
    scene = chain(n, (OF_ANY_CHAIN | SCENES)[effects])
    names = [*VARIED, *names]
    values = pc.sampling.uniform(0.5, 2.0, (13, len(names)), seed=6)
    values[4, 3] = 0.0  # which may give that member other equations, so that it runs alone
    values[7, -1] = 0.0
    vary = {name: values[:, k] for k, name in enumerate(names)}
    start = np.linspace(0.4, 1.2, n)
    found = pc.ensemble(scene, q0=start, t_span=(0, 3), vary=vary, method="taylor", workers=1)
    for i in range(13):
        one = scene.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(one, q0=start, t_span=(0, 3), method="taylor")
        assert np.array_equal(found.q[i], alone.q[-1])


@pytest.mark.parametrize("terminal", [False, True])
def test_first_events_of_chains_are_those_of_simulate(terminal):
    scene = chain(3)
    event = pc.events.LinkAngle(3, -np.pi / 2, every_turn=True, terminal=terminal)
    q0 = starts(23, 3, 8, 3.0)
    found = pc.ensemble(
        scene, q0=q0, t_span=(0, 3), method="taylor", keep=pc.reducers.FirstEvent(event), rtol=1e-9
    )
    for i, start in enumerate(q0):
        alone = pc.simulate(
            scene, q0=start, t_span=(0, 3), method="taylor", events=[event], rtol=1e-9
        )
        first = alone.events[0].t[:1]
        assert np.array_equal(found["first_event"][i : i + 1][: len(first)], first)
        assert (found.t[i], *found.q[i]) == (alone.t[-1], *alone.q[-1])
    assert np.isfinite(found["first_event"]).any()


def test_a_heavy_payload_on_light_links_agrees_with_another_method():
    """The factors of the inverse lose nothing where the links are light."""
    light = [pc.Link(mass=1e-3, length=1.0)] * 3
    scene = pc.Scene(links=light, gravity=9.807, effects=[E.Payload(mass=10.0)])
    start = [0.3, 0.9, -0.2]
    ends = [
        pc.simulate(scene, q0=start, t_span=(0, 2), method=m, rtol=1e-13, atol=1e-13).q[-1]
        for m in ("taylor", "dop853")
    ]
    np.testing.assert_allclose(*ends, rtol=0, atol=5e-10)
