"""Three and four links in lanes of Runge-Kutta methods: the bits of `pc.simulate`."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from test_lanes import assert_same
from test_lanes_of_chains import OF_ANY_CHAIN, SCENES, asked, assert_bits, chain, starts
from test_lanes_with_effects import has_lanes

E = pc.effects
METHODS = ["dopri5", "dop853", "dopri5-radau5", "dop853-radau5"]
DRAG = E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.2)
ONE_BY_ONE = {
    "friction": [E.DryJointFriction(joint=2, coulomb=0.2)],
    "lock": [E.Lock(joint=2)],
}
OF_RUNGE_KUTTA = {
    **SCENES,
    **OF_ANY_CHAIN,
    "rotors in all joints, drag and damping": [
        *[E.RotorInertia(joint=k + 1, armature=0.1 + 0.05 * k) for k in range(3)],
        DRAG,
        E.ViscousJoint(joint=3, damping=0.1),
    ],
    "drag": [DRAG],
    "five waves": [E.Motor(1, sinusoid=E.Sinusoid(1.0, 6.0 + k)) for k in range(5)],
    "drag and a shaken pivot": [DRAG, E.DrivenPivot(y=E.Sinusoid(0.05, 40.0))],
    "drag and wind on two links, a motor and damping": [
        DRAG.replace(link=1, wind=(4.0, -1.0)),
        E.Motor(joint=3, sinusoid=E.Sinusoid(1.0, 5.0)),
        DRAG.replace(link=3),
        E.ViscousJoint(joint=2, damping=0.1),
    ],
}


@pytest.mark.parametrize("rtol", [1e-3, 1e-7, 1e-12])
@pytest.mark.parametrize("n", [3, 4])
@pytest.mark.parametrize("name", OF_RUNGE_KUTTA)
def test_few_links_in_lanes_have_the_bits_of_single_runs(name, n, rtol):
    scene = chain(n, OF_RUNGE_KUTTA[name])
    if has_lanes():
        assert scene.explain().lanes[:2] == ("dopri5", "dop853")
    for method in METHODS:
        how = asked(method, rtol)
        q0, qd0 = assert_bits(scene, how, 1.3)
        assert_same(scene, q0[:3], qd0[:3], (0.0, 1.0), **how, max_step=0.007)


@pytest.mark.parametrize("name", ONE_BY_ONE)
def test_what_has_no_lanes_of_runge_kutta_runs_one_by_one(name):
    scene = chain(3, ONE_BY_ONE[name])
    assert "dop853" not in scene.explain().lanes
    assert_same(scene, starts(7, 3, 2, 0.5), 0.0, (0, 1), method="dop853")


VARIED = {
    "drag and wind on two links, a motor and damping": [
        "effect[1].diameter", "effect[2].sinusoid.amplitude", "effect[4].damping",
    ],
    "rotors in all joints, drag and damping": [
        "effect[2].armature", "effect[3].armature", "effect[4].diameter",
    ],
}  # fmt: skip


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("n", [3, 4])
@pytest.mark.parametrize("effects", VARIED)
def test_parameters_differ_from_lane_to_lane(effects, n, method):
    scene = chain(n, OF_RUNGE_KUTTA[effects])
    names = ["link[1].mass", "link[3].length", "gravity", *VARIED[effects]]
    values = pc.sampling.uniform(0.1, 2.0, (13, len(names)), seed=6)
    values[5, 4] = values[7, 5] = 0.0  # which may give these members other equations
    vary = {name: values[:, k] for k, name in enumerate(names)}
    start = np.linspace(0.4, 1.2, n)
    found = pc.ensemble(scene, q0=start, t_span=(0, 2), vary=vary, method=method, workers=1)
    for i in range(13):
        one = scene.with_parameters({name: x[i] for name, x in vary.items()})
        alone = pc.simulate(one, q0=start, t_span=(0, 2), method=method)
        assert np.array_equal(found.q[i], alone.q[-1])


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
def test_times_and_events_are_those_of_simulate(method):
    scene = chain(3, [DRAG])
    event = pc.events.LinkAngle(3, -np.pi / 2, every_turn=True)
    times = np.linspace(0.0, 2.0, 7)
    q0 = starts(23, 3, 8, 3.0)
    found = pc.ensemble(
        scene, q0=q0, t_span=(0, 2), method=method, keep=pc.reducers.FirstEvent(event)
    )
    states = pc.ensemble(scene, q0=q0, t_span=(0, 2), method=method, keep="times", t_eval=times)
    for i, start in enumerate(q0):
        alone = pc.simulate(scene, q0=start, t_span=(0, 2), method=method, events=[event])
        first = [*alone.events[0].t, np.nan][0]
        assert np.array_equal(found["first_event"][i], first, equal_nan=True)
        sampled = pc.simulate(scene, q0=start, t_span=(0, 2), method=method, t_eval=times)
        assert np.array_equal(states.q[i], sampled.q)
    assert np.isfinite(found["first_event"]).any()
