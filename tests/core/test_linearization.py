"""Linear systems agree with the reference's, differentiated in many digits; poses are held.

As in test_jacobian.py, the reference is differentiated by central differences in eighty digits. The
issue is what a controller sees, so an error is a share of the largest entry of (A, B).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath
import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from reference.arithmetic import multiple_precision
from reference.named_numbers import Numbers
from reference.random_rigs import DrawnRig, rigs
from sweeps import random_examples

MANY = multiple_precision(80)
STEP = MANY.number(10) ** -30
SMOOTH = sorted(
    set(pc.effects.kinds()) - {"user", "compiled_user", "joint_stop", "lock", "dry_joint_friction"}
)
UPRIGHT = (-np.pi / 2, -np.pi / 2)
TEXTBOOK = pc.Scene.textbook()
E = pc.effects


def accelerations(drawn: DrawnRig, changes: dict[str, Any]) -> NDArray[Any]:
    """Those of the reference, with some of the drawn numbers changed."""
    bodies, gravity, described, (t, q, qd) = drawn
    numbers = Numbers(bodies, gravity, described, [*q, *qd], MANY, begin=t)
    for name, by in changes.items():
        numbers.move(name, by)
    angles, rates = np.split(numbers.y, 2)
    return np.array(numbers.rig().motion(MANY.number(t), angles, rates).accelerations)


def exact_columns(drawn: DrawnRig, names: Sequence[str]) -> NDArray[np.float64]:
    """D qdd / d input, (n, k), from the reference."""
    columns = [
        (accelerations(drawn, {name: STEP}) - accelerations(drawn, {name: -STEP})) / (2 * STEP)
        for name in names
    ]
    return np.array(columns, dtype=float).T


def check(drawn: DrawnRig, tolerance: float = 1e-12) -> None:
    bodies, gravity, described, (t, q, qd) = drawn
    n, scene = len(bodies), scene_of(bodies, gravity, described)
    tables = {f"effect[{i}].limit" for i, (_, told) in enumerate(described, 1) if "table" in told}
    parameters = [name for name in scene.parameters() if name not in tables]
    inputs = [*(f"torque[{j}]" for j in range(1, n + 1)), "pivot.x", "pivot.y", *parameters]
    found = scene.linearize(q, qd, t, inputs=inputs)
    assert found.inputs == tuple(inputs)
    np.testing.assert_array_equal(found.drift, [*qd, *scene.accelerations(t, q, qd)])
    np.testing.assert_array_equal(found.A[n:], np.hstack(scene.jacobian(t, q, qd)))
    np.testing.assert_array_equal(found.A[:n], np.eye(n, 2 * n, k=n))
    exact = exact_columns(drawn, inputs)
    assert not found.B[:n].any()
    for column, (name, right) in enumerate(zip(inputs, exact.T, strict=True)):
        size = max(np.abs(found.A).max(), np.abs(right).max())
        assert np.abs(found.B[n:, column] - right).max() <= tolerance * size, name


@pytest.mark.parametrize("kind", SMOOTH)
def test_each_effect_alone(kind: str) -> None:
    @settings(max_examples=random_examples(6), deadline=None)
    @given(rigs([kind], st.sampled_from([1, 2, 3])))
    def check_one(drawn: DrawnRig) -> None:
        check(drawn)

    check_one()


def test_all_smooth_effects_together() -> None:
    @settings(max_examples=random_examples(12), deadline=None)
    @given(rigs([*SMOOTH, "dry_joint_friction"], st.integers(1, 6)))
    def check_one(drawn: DrawnRig) -> None:
        check(drawn)

    check_one()


def test_a_rod_stays_one_unless_its_centre_is_an_input_too() -> None:
    names = ["link[2].length", "link[2].center", "link[2].inertia"]
    how: Any = {"q": [0.3, 0.8], "qd": [1.0, -2.0]}
    alone = TEXTBOOK.linearize(**how, inputs=names[:1]).B[:, 0]
    each = TEXTBOOK.linearize(**how, inputs=names).B
    # c = L/2 and I = m L^2/12
    np.testing.assert_allclose(alone, each @ [1.0, 0.5, 1.0 / 6.0], rtol=1e-12)


def test_torques_of_a_trim_belong_to_the_linear_system() -> None:
    q = [0.2, 1.2]
    torques = TEXTBOOK.trim(q, inputs=[1, 2])
    found = TEXTBOOK.linearize(q, inputs=[1, 2], torques=torques)
    assert np.abs(found.drift).max() < 1e-13
    motors = [E.Motor(joint=j, constant=x) for j, x in zip((1, 2), torques, strict=True)]
    exact = TEXTBOOK.replace(effects=motors).linearize(q, inputs=[1, 2])
    np.testing.assert_array_equal(found.A, exact.A)
    assert np.abs(found.A - TEXTBOOK.linearize(q).A).max() > 1
    with pytest.raises(ValueError, match="torques: are of joints"):
        TEXTBOOK.linearize(q, inputs=["gravity"], torques=[1.0])


def test_outputs_are_what_they_are_called() -> None:
    n, t, step = 3, 0.3, 1e-6
    wave = E.Sinusoid(amplitude=0.2, angular_frequency=5.0)
    links = [pc.Link(mass=1.0, length=length) for length in (1.0, 0.7, 0.4)]
    scene = pc.Scene(links=links, effects=[E.DrivenPivot(x=wave)])
    q, qd = np.array([0.3, -0.8, 1.1]), np.array([1.0, -2.0, 0.5])
    kinds = ("q", "qd", "qdd", "phi", "phid", "x", "y", "vx", "vy")
    names = [f"{kind}[{i}]" for kind in kinds for i in range(1, n + 1)]

    def values(q: Any, qd: Any, torque: float = 0.0, **changed: float) -> Any:
        driven = scene.replace(effects=[*scene.effects, E.Motor(joint=2, constant=torque)])
        driven = driven.with_parameters(changed)
        ends, speeds = driven.positions(t, q)[1:], driven.velocities(t, q, qd)[1:]
        phi, phid = np.diff(q, prepend=0.0), np.diff(qd, prepend=0.0)
        return np.hstack([q, qd, driven.accelerations(t, q, qd), phi, phid, *ends.T, *speeds.T])

    changes = {"link[1].length": 1.0, "effect[1].x.amplitude": 0.2}
    found = scene.linearize(q, qd, t, inputs=[2, *changes], outputs=names)
    assert found.outputs == tuple(names)
    np.testing.assert_allclose(found.outputs_there, values(q, qd), rtol=1e-14)
    moves = [np.split(step * row, 2) for row in np.eye(2 * n)]
    C = [(values(q + a, qd + b) - values(q - a, qd - b)) / (2 * step) for a, b in moves]
    np.testing.assert_allclose(found.C, np.transpose(C), rtol=0, atol=1e-7)
    D = (values(q, qd, step) - values(q, qd, -step)) / (2 * step)
    np.testing.assert_allclose(found.D[:, 0], D, rtol=0, atol=1e-7)
    for column, (name, value) in enumerate(changes.items(), 1):
        sides = [values(q, qd, **{name: value + sign * step}) for sign in (1, -1)]
        D = (sides[0] - sides[1]) / (2 * step)
        np.testing.assert_allclose(found.D[:, column], D, rtol=0, atol=1e-6, err_msg=name)


@pytest.mark.parametrize("dt", [1e-4, 0.01, 0.5])
def test_discrete_systems_are_the_exact_solution(dt: float) -> None:
    damper = E.ViscousJoint(joint=2, damping=0.3)
    scene = TEXTBOOK.replace(effects=[damper])
    system = scene.linearize([0.4, -1.0], [1.0, 2.0], inputs=[1, 2])
    found = system.discretize(dt)
    with mpmath.workdps(40):
        both = mpmath.zeros(7)
        for i in range(4):
            for j, x in enumerate((*system.A[i], *system.B[i], system.drift[i])):
                both[i, j] = x
        exact = np.array((mpmath.expm(both * dt))[:4, :].tolist(), dtype=float)
    got = np.column_stack([found.A, found.B, found.drift])
    np.testing.assert_allclose(got, exact, rtol=0, atol=1e-14 * np.abs(exact).max())
    assert found.dt == dt
    with pytest.raises(ValueError, match="the system is discrete"):
        found.discretize(dt)


def test_python_control_takes_the_system_with_its_names() -> None:
    control = pytest.importorskip("control")
    system = TEXTBOOK.linearize(UPRIGHT, inputs=[1, "gravity"], outputs=["x[2]", "qdd[1]"])
    found = system.to_control()
    assert found.input_labels == ["torque[1]", "gravity"]
    assert found.output_labels == ["x[2]", "qdd[1]"]
    assert found.state_labels == ["q[1]", "q[2]", "qd[1]", "qd[2]"]
    for name in "ABCD":
        np.testing.assert_array_equal(getattr(found, name), getattr(system, name))
    discrete = control.c2d(found, 0.01)
    exact = system.discretize(0.01).to_control()
    assert exact.dt == 0.01
    np.testing.assert_allclose(exact.A, discrete.A, rtol=1e-12)
    np.testing.assert_allclose(exact.B, discrete.B, rtol=1e-11, atol=1e-15)
    with pytest.raises(ValueError, match=r"drift = .* the state moves"):
        TEXTBOOK.linearize([0.3, 0.4], inputs=[1]).to_control()


@pytest.mark.parametrize("limit", np.linspace(0.3, 2.9, 8))
def test_a_limit_of_a_table_has_its_slope(limit: float) -> None:
    table = E.Table(t=(0, 1, 2, 3), torque=(0, 3, -3, 2))
    for t in (0.05, 0.9, 1.3, 1.9, 2.5):
        held = [TEXTBOOK.replace(effects=[E.Motor(joint=1, table=table, limit=limit + by)])
                for by in (-1e-7, 0.0, 1e-7)]  # fmt: skip
        B = held[1].linearize(UPRIGHT, 0.0, t, inputs=["effect[1].limit"]).B[2:, 0]
        sides = [one.accelerations(t, UPRIGHT, [0.0, 0.0]) for one in (held[0], held[2])]
        np.testing.assert_allclose(B, (sides[1] - sides[0]) / 2e-7, rtol=0, atol=1e-6)


@pytest.mark.parametrize("limit", np.linspace(0.31, 2.31, 21))
def test_a_limit_has_its_slope_where_a_table_is_short(limit: float) -> None:
    """Clipped at both ends, a piece of milliseconds was off the limit by rounding: a corner."""
    table = E.Table(t=(0, 0.077190335928, 0.080750201317, 1), torque=(-0.5, -2.4659446, 0.06, 0.1))
    scene = TEXTBOOK.replace(effects=[E.Motor(joint=1, table=table, limit=limit)])
    B = scene.linearize(UPRIGHT, 0.0, 0.0772, inputs=["effect[1].limit", "torque[1]"]).B
    np.testing.assert_allclose(B[:, 0], -B[:, 1], rtol=1e-12)


@pytest.mark.parametrize("n", [1, 2, 5])
def test_inverse_dynamics_give_the_wanted_accelerations(n: int) -> None:
    @settings(max_examples=random_examples(20), deadline=None)
    @given(rigs([*SMOOTH, "user", "dry_joint_friction"], st.just(n)), st.randoms())
    def check_one(drawn: DrawnRig, random: Any) -> None:
        bodies, gravity, described, (t, q, qd) = drawn
        scene = scene_of(bodies, gravity, described)
        wanted = [random.uniform(-9, 9) for _ in range(n)]
        torques = scene.inverse_dynamics(t, q, qd, wanted)
        motors = {f"torque[{j}]": MANY.number(x) for j, x in enumerate(torques, 1)}
        got = accelerations(drawn, motors).astype(float)
        M = scene.mass_matrix(q)
        size = np.abs(torques).max() + np.abs(M @ scene.accelerations(t, q, qd)).max()
        assert np.abs(M @ (got - wanted)).max() <= 1e-12 * (size + np.abs(M).sum() * 9)

    check_one()


def test_inverse_dynamics_of_resting_friction_and_of_arrays() -> None:
    scene = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=1, coulomb=2.0, static=3.0)])
    at_rest = scene.inverse_dynamics(0.0, [0.0, 0.0], [0.0, 0.0], [0.0, 0.0])
    np.testing.assert_array_equal(at_rest, TEXTBOOK.inverse_dynamics(0, [0, 0], [0, 0], [0, 0]))
    many = scene.inverse_dynamics([0.0, 1.0], np.zeros((3, 1, 2)), [1.0, 0.0], [0.0, 0.0])
    assert many.shape == (3, 2, 2)
    # sliding, it wants two more: the coulomb friction far from Stribeck's peak
    assert many[0, 0, 0] - TEXTBOOK.inverse_dynamics(0, [0, 0], [1, 0], [0, 0])[0] == 2.0


# The torques that hold a pose, or what does not rest ----------------------------------------------


def test_trim_holds_these_angles() -> None:
    q = [0.3, -0.8]
    torques = TEXTBOOK.trim(q, inputs=[1, "torque[2]"])
    motors = [E.Motor(joint=j, constant=x) for j, x in zip((1, 2), torques, strict=True)]
    held = TEXTBOOK.replace(effects=motors).accelerations(0.0, q, [0.0, 0.0])
    np.testing.assert_allclose(held, 0.0, atol=1e-13)
    weight = 9.807 * np.cos(q)
    np.testing.assert_allclose(torques, [-1.5 * weight[0] - 0.5 * weight[1], -0.5 * weight[1]])


def test_trim_sees_a_light_link_behind_a_heavy_one() -> None:
    crane = pc.Scene(links=[pc.Link(mass=1000.0, length=10.0), pc.Link(mass=1e-4, length=0.01)])
    with pytest.raises(ValueError, match="do not rest: joint 2 takes -4"):
        crane.trim([0.0, 0.0], inputs=[1])
    with pytest.raises(ValueError, match="stands twice"):
        crane.trim([0.0, 0.0], inputs=[1, 1, 2])


@pytest.mark.parametrize(
    ("effects", "rests"),
    [
        ([], False),
        ([E.DryJointFriction(joint=2, coulomb=4.9)], False),
        ([E.DryJointFriction(joint=2, coulomb=4.91)], True),
        ([E.Lock(joint=2)], True),
        ([E.JointStop(joint=2, range=(-1, 0))], True),
        ([E.JointStop(joint=2, range=(0, 1))], False),
        ([E.TorsionalSpring(joint=2, stiffness=4.9035, rest_angle=-1.0)], True),
    ],
)
def test_trim_knows_what_holds_the_other_joints(effects: list[Any], rests: bool) -> None:
    scene = TEXTBOOK.replace(effects=effects)
    if rests:
        assert scene.trim([0.0, 0.0], inputs=[1]) == pytest.approx([-2 * 9.807])
        return
    with pytest.raises(ValueError, match=r"do not rest: joint 2 takes -4\.9035 N m, which nothing"):
        scene.trim([0.0, 0.0], inputs=[1])


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ("torqe[1]", r"inputs: 'torqe\[1\]': must be a joint, 1 to 2, .*: did you mean 'torque\[1"),
        ("torque", r"inputs: 'torque': .* such as 'torque\[1\]': did you mean 'torque\[1\]'\?"),
        ("pivot.x", r"inputs: 'pivot\.x': must be a joint, 1 to 2, or its torque, such as 'torque"),
        ("q0[1]", r"inputs: 'q0\[1\]': must be a joint, 1 to 2, or its torque, such as 'torque"),
        (2, "inputs: torque in joint 2: a Lock holds this joint, which no torque turns: choose"),
    ],
)
def test_only_torques_that_turn_a_joint_hold_it(given: Any, told: str) -> None:
    locked = TEXTBOOK.replace(effects=[E.Lock(joint=2)])
    with pytest.raises(ValueError, match=told):
        locked.trim([0.3, 0.3], inputs=[1, given])
