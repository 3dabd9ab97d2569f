"""Single pendulums in lanes of Runge-Kutta methods: the bits of `pc.simulate`."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from test_lanes import assert_same
from test_lanes_with_effects import has_lanes

E = pc.effects
METHODS = ["dopri5", "dop853", "dopri5-radau5", "dop853-radau5", "auto"]
WAVE = E.Sinusoid(3.0, 6.0, 0.4)
DRAG = E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.03)
SCENES = {
    "bare": [],
    "payload": [E.Payload(mass=0.3)],
    "rotor": [E.RotorInertia(joint=1, armature=0.2)],
    "damping and its cube": [E.ViscousJoint(joint=1, damping=0.3, damping3=0.05)],
    "spring and a constant": [E.TorsionalSpring(joint=1, stiffness=3.0), E.Motor(1, constant=2.0)],
    "controller": [E.Motor(joint=1, pd=E.PD(kp=4.0, kd=0.5, reference=0.3))],
    "driven and damped": [E.Motor(1, sinusoid=WAVE), E.ViscousJoint(joint=1, damping=0.2)],
    "a wave alone": [E.Motor(1, sinusoid=WAVE)],
    "shaken along y": [E.DrivenPivot(y=E.Sinusoid(0.05, 40.0)), E.ViscousJoint(1, damping=0.1)],
    "shaken along both axes": [E.DrivenPivot(x=E.Sinusoid(0.05, 9.0), y=E.Sinusoid(0.1, 5.0, 1.0))],
    "four waves, two pivots": [
        E.Motor(1, sinusoid=WAVE),
        E.DrivenPivot(y=E.Sinusoid(0.1, 5.0, 1.0)),
        E.Motor(1, sinusoid=E.Sinusoid(1.0, 2.5)),
        E.DrivenPivot(x=E.Sinusoid(0.05, 9.0)),
    ],
    "drag": [DRAG],
    "five waves": [E.Motor(1, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(5)],
    "drag and a shaken pivot": [DRAG, E.DrivenPivot(y=E.Sinusoid(0.05, 40.0))],
    "drag, wind, a motor and damping": [
        DRAG.replace(diameter=0.4, wind=(3.0, -1.0)),
        E.Motor(1, sinusoid=WAVE),
        E.ViscousJoint(1, damping=0.1),
    ],
}
ONE_BY_ONE = {
    "friction": [E.DryJointFriction(joint=1, coulomb=0.2)],
    "lock": [E.Lock(joint=1)],
    "table": [E.Motor(1, table=E.Table([0.0, 1.0, 4.0], [0.0, 1.0, -1.0]))],
}


def one_link(effects=()):
    link = pc.Link(mass=1.3, length=0.8)
    return pc.Scene(links=[link], gravity=9.81, effects=list(effects))


@pytest.mark.parametrize("rtol", [1e-3, 1e-7, 1e-12])
@pytest.mark.parametrize("name", SCENES)
def test_a_link_in_lanes_has_the_bits_of_single_runs(name, rtol):
    scene = one_link(SCENES[name])
    if has_lanes():
        assert scene.explain().lanes == ("dopri5", "dop853")
    q0 = pc.sampling.uniform(-np.pi, np.pi, (21, 1), seed=2)
    qd0 = pc.sampling.uniform(-6.0, 6.0, (21, 1), seed=3)
    for method in METHODS:
        same = {"method": method, "rtol": rtol, "atol": rtol / 10}
        assert assert_same(scene, q0, qd0, (0.3, 2.3), **same).success.all()
        assert_same(scene, q0, qd0, (1.0, -0.5), **same, max_steps=11)
        assert_same(scene, q0[:3], qd0[:3], (0.0, 1.0), **same, max_step=0.02)


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_other_links_run_one_by_one(name):
    scene = one_link(ONE_BY_ONE[name])
    assert scene.explain().lanes == ()
    q0 = np.full((7, 1), 0.4) if name == "lock" else pc.sampling.uniform(-1, 1, (7, 1), seed=2)
    assert_same(scene, q0, 0.0, (0, 1), method="dopri5")


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
def test_parameters_differ_from_lane_to_lane(method):
    """A motor of amplitude 0 has no wave: its member has other equations, and runs alone."""
    scene = one_link(SCENES["four waves, two pivots"])
    names = ["link[1].mass", "gravity", "effect[1].sinusoid.amplitude", "effect[2].y.amplitude"]
    values = pc.sampling.uniform(0.1, 2.0, (13, len(names)), seed=6)
    values[5, 2] = values[7, 3] = 0.0
    vary = {name: values[:, k] for k, name in enumerate(names)}
    found = pc.ensemble(scene, q0=0.4, t_span=(0, 3), vary=vary, method=method)
    for i in range(13):
        one = scene.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(one, q0=0.4, t_span=(0, 3), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])
