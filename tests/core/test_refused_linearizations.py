"""States and inputs that have no linear system are refused, and those beside them are not."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pendcore as pc
import pytest

E = pc.effects
UPRIGHT = (-np.pi / 2, -np.pi / 2)
TEXTBOOK = pc.Scene.textbook()


REFUSED: dict[str, tuple[Any, tuple[float, ...], tuple[float, ...], float, str]] = {
    "stop": (E.JointStop(joint=1, range=(-1, 1)), (1.0, 0.0), (0.0, 0.0), 0.0, "an end of its"),
    "stuck": (
        E.DryJointFriction(joint=2, coulomb=0.3), (1.0, 0.0), (1.0, 1.0), 0.0, "joint 2 is at rest",
    ),
    "limit": (
        E.Motor(joint=1, pd=E.PD(kp=2.0, kd=0.0, reference=0.0), limit=2.0),
        (1.0, 0.0), (0.0, 0.0), 0.0, "two of its laws meet",
    ),
    "step of a table": (
        E.Motor(joint=1, table=E.Table(t=(0, 1, 2), torque=(1, 3, 2), hold=True)),
        (1.0, 0.0), (0.0, 0.0), 1.0, "jumps at t = 1.0 s",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", REFUSED)
def test_no_derivative_is_refused_by_name(name: str) -> None:
    effect, q, qd, t, told = REFUSED[name]
    scene = TEXTBOOK.replace(effects=[E.Payload(mass=1.0), effect])
    with pytest.raises(ValueError, match=rf"effect 2 \(\w+\): .*{re.escape(told)}"):
        scene.linearize(q, qd, t)
    # On either side there is one.
    for sign in (-1, 1):
        if name == "stop" and sign > 0:
            continue
        aside = np.multiply(sign, (1e-3, 0.0))
        found = scene.linearize(q + aside, np.add(qd, aside), t + sign * 1e-3)
        assert np.all(np.isfinite(found.A))


def test_a_slope_by_friction_that_is_not_there_is_refused_too() -> None:
    scene = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=2, coulomb=0.0)])
    assert np.all(np.isfinite(scene.linearize(UPRIGHT, inputs=[1]).B))
    with pytest.raises(ValueError, match="joint 2 is at rest"):
        scene.linearize(UPRIGHT, inputs=["effect[1].coulomb"])


IMPOSSIBLE = {
    "beyond a stop": (E.JointStop(joint=2, range=(-1.0, -0.5)), [0.0, 0.0], [0.0, 0.0]),
    "another angle": (E.Lock(joint=2, angle=0.5), [0.0, 0.1], [0.0, 0.0]),
    "a locked rate": (E.Lock(joint=2), [0.0, 0.1], [0.0, 1.0]),
}


@pytest.mark.parametrize("name", IMPOSSIBLE)
def test_states_that_cannot_be_are_refused(name: str) -> None:
    effect, q, qd = IMPOSSIBLE[name]
    scene = TEXTBOOK.replace(effects=[effect])
    with pytest.raises(ValueError, match=r"qd?: (angle|rate) of joint 2 = "):
        scene.linearize(q, qd)
    if not any(qd):
        with pytest.raises(ValueError, match="q: angle of joint 2 = "):
            scene.trim(q, inputs=[1])


def test_beyond_a_table_there_is_no_system() -> None:
    motor = E.Motor(joint=2, table=E.Table(t=(0, 1), torque=(0, 1)))
    scene = TEXTBOOK.replace(effects=[motor])
    with pytest.raises(ValueError, match=r"t = 5\.0: a law of an effect is not finite there"):
        scene.linearize(UPRIGHT, 0.0, 5.0)
    with pytest.raises(ValueError, match="a law of an effect is not finite there"):
        scene.trim(UPRIGHT, 5.0, inputs=[1, 2])
    with pytest.raises(ValueError, match=r"dt = .*: in this time the system grows beyond"):
        TEXTBOOK.linearize(UPRIGHT).discretize(1e6)
    with pytest.raises(ValueError, match=r"dt = inf: must be finite \(s\)"):
        TEXTBOOK.linearize(UPRIGHT).discretize(np.inf)


def test_where_laws_meet_alike_there_is_a_derivative() -> None:
    table = E.Motor(joint=1, table=E.Table(t=(0, 1, 2), torque=(1, 3, 2)))
    square = E.ViscousJoint(joint=1, damping=0.1, damping2=0.5)
    found = TEXTBOOK.replace(effects=[table, square]).linearize(UPRIGHT, 0.0, 1.0)
    motor, damper = E.Motor(joint=1, constant=3.0), E.ViscousJoint(joint=1, damping=0.1)
    plain = TEXTBOOK.replace(effects=[motor, damper]).linearize(UPRIGHT)
    np.testing.assert_allclose(found.A, plain.A, rtol=1e-14)
    np.testing.assert_allclose(found.drift, plain.drift, rtol=1e-13)


def test_slopes_of_a_corner_are_told_apart() -> None:
    """At a limit, one side has the slopes of the law, the other those of a constant torque."""
    held = E.Motor(joint=1, pd=E.PD(kp=2.0, kd=0.0, reference=0.0), limit=2.0)
    scene = TEXTBOOK.replace(effects=[held])
    inside, beyond = (scene.linearize([1.0 + by, 0.5]).A[2, 0] for by in (-1e-9, 1e-9))
    spring = TEXTBOOK.replace(effects=[E.TorsionalSpring(joint=1, stiffness=2.0)])
    assert inside == pytest.approx(spring.linearize([1.0, 0.5]).A[2, 0], rel=1e-8)
    constant = TEXTBOOK.replace(effects=[E.Motor(joint=1, constant=-2.0)])
    assert beyond == pytest.approx(constant.linearize([1.0, 0.5]).A[2, 0], rel=1e-8)
    assert abs(inside - beyond) > 1


def test_a_locked_joint_takes_no_torque() -> None:
    scene = TEXTBOOK.replace(effects=[E.Lock(joint=2)])
    with pytest.raises(ValueError, match="torque in joint 2: a Lock holds this joint"):
        scene.linearize(UPRIGHT, inputs=[2])
    found = scene.linearize(UPRIGHT, inputs=[1])
    one = pc.Scene(links=[pc.Link(mass=2.0, length=2.0)]).linearize(UPRIGHT[:1], inputs=[1])
    np.testing.assert_allclose(found.B[2:, 0], one.B[1, 0], rtol=1e-14)


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"inputs": ["torqe[1]"]}, 'parameter "torqe\\[1\\]": the scene has none of that name'),
        ({"inputs": ["link[3].mass"]}, "it has 2 links"),
        ({"inputs": [3]}, "torque in joint 3: must be one of the joints 1 to 2"),
        ({"inputs": [0]}, "torque in joint 0: must be one of"),
        ({"inputs": ["torqe[1]"]}, r'did you mean "torque\[1\]"'),
        ({"inputs": ["pivot.z"]}, r'did you mean "pivot\.x"'),
        ({"inputs": [1], "torques": [np.nan]}, r"torques\[0\] = nan: must be finite"),
        ({"outputs": ["q[3]"]}, r"outputs: 'q\[3\]': must be one of q\[i\], .*, i from 1 to 2"),
        ({"inputs": [1, "torque[1]"]}, r"inputs: 'torque\[1\]' stands twice"),
        ({"q": [1.0, np.nan]}, r"q\[1\] = nan: must be finite"),
        ({"q": [1.0, 2.0, 3.0]}, r"q: shape \(3,\): must be \(2,\)"),
        ({"q": 0.3}, r"q: shape \(\): must be \(2,\)"),
        ({"t": np.inf}, "t = inf: must be finite"),
        ({"inputs": ["qd0[2]"]}, r"inputs: 'qd0\[2\]': a start is no input: .*by which A is; inp"),
        ({"inputs": ["q[1]"]}, r"inputs: 'q\[1\]': a start is no input"),
        ({"outputs": ["energi"]}, "outputs: 'energi': must be .*: did you mean 'energy'"),
    ],
)
def test_bad_input(given: dict[str, Any], told: str) -> None:
    with pytest.raises(ValueError, match=told):
        TEXTBOOK.linearize(**({"q": UPRIGHT} | given))


def test_what_was_asked_before_does_not_matter() -> None:
    TEXTBOOK.linearize(UPRIGHT, inputs=[1])
    for other in (True, None, 1.0):
        with pytest.raises(TypeError, match=rf"inputs = {other}: must be a joint, .*, or a name"):
            TEXTBOOK.linearize(UPRIGHT, inputs=[other])


def test_one_text_is_no_list_of_inputs() -> None:
    with pytest.raises(TypeError, match=r"inputs = 'pivot\.x': must be a list"):
        TEXTBOOK.linearize(UPRIGHT, inputs="pivot.x")
    with pytest.raises(TypeError, match="inputs = 1: must be a list"):
        TEXTBOOK.linearize(UPRIGHT, inputs=1)
    with pytest.raises(TypeError, match=r"outputs = 'q\[1\]': must be a list"):
        TEXTBOOK.linearize(UPRIGHT, outputs="q[1]")
