"""The torques that hold a pose, or what does not rest."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest

E = pc.effects
TEXTBOOK = pc.Scene.textbook()


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
