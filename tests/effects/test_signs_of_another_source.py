"""Angles, torques and controllers of an arm that counts counter-clockwise, as conventions.md says.

The arm is the planar elbow manipulator of Spong, Hutchinson, Vidyasagar, Robot Modeling and Control
(2006), section 7.4: relative angles psi, psi_1 from +x, y upward.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

MASS, LENGTH, CENTER, INERTIA = (1.3, 0.8), (0.7, 0.5), (0.3, 0.2), (0.05, 0.02)
G = 9.81
KP, KD = 20.0, 3.0
TARGET = np.array([0.4, -0.3])
"""The angles psi at which springs and controllers rest, rad."""
PSI, PSI_DOT = np.array([0.9, -1.4]), np.array([1.1, -2.0])
THETA = np.cumsum(PSI)
CONVENTIONS = {
    "from x": -THETA,
    "from hanging": pc.angles_from_vertical(THETA + np.pi / 2),
    "from upright": pc.angles_from_vertical(THETA - np.pi / 2, zero="upright"),
}


def arm(torques: np.ndarray) -> np.ndarray:
    """Return the accelerations of psi, by the equations of the book."""
    (m1, m2), l1, (c1, c2), (i1, i2) = MASS, LENGTH[0], CENTER, INERTIA
    cosine, (w1, w2) = np.cos(PSI[1]), PSI_DOT
    d12 = m2 * (c2**2 + l1 * c2 * cosine) + i2
    d11 = m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * cosine) + i1 + i2
    h = -m2 * l1 * c2 * np.sin(PSI[1])
    weight = m2 * c2 * G * np.cos(THETA[1])
    rest = [
        h * w2 * w1 + h * (w1 + w2) * w2 + (m1 * c1 + m2 * l1) * G * np.cos(PSI[0]) + weight,
        -h * w1**2 + weight,
    ]
    return np.linalg.solve([[d11, d12], [d12, m2 * c2**2 + i2]], torques - rest)


PULLED = -KP * (PSI - TARGET) - KD * PSI_DOT
# Joint 1 from +x; joint 2 is relative, and has the same minus.
RESTS = [(1, -TARGET[0]), (2, -TARGET[1])]
CASES = {
    "constant": (
        np.array([2.5, -1.7]),
        [fx.Motor(joint=1, constant=-2.5), fx.Motor(joint=2, constant=1.7)],
    ),
    "controller": (
        PULLED,
        [fx.Motor(joint, pd=fx.PD(kp=KP, kd=KD, reference=rest)) for joint, rest in RESTS],
    ),
    "spring and damper": (
        PULLED,
        [fx.TorsionalSpring(joint, stiffness=KP, rest_angle=rest) for joint, rest in RESTS]
        + [fx.ViscousJoint(joint, damping=KD) for joint in (1, 2)],
    ),
    # A torque from the ground on the second link turns both of the arm's angles.
    "from the ground": (np.array([1.9, 1.9]), [fx.User(lambda t, q, qd: [0.0, -1.9])]),
}


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("case", CASES)
def test_what_turns_an_arm_counter_clockwise_has_a_minus_here(case, convention):
    torques, effects = CASES[case]
    links = [
        pc.Link(mass=m, length=length, center=c, inertia=i)
        for m, length, c, i in zip(MASS, LENGTH, CENTER, INERTIA, strict=True)
    ]
    scene = pc.Scene(links=links, gravity=G, effects=effects)
    qdd = scene.accelerations(0.0, CONVENTIONS[convention], -np.cumsum(PSI_DOT))
    assert not np.allclose(arm(torques), arm(np.zeros(2)), rtol=0.1)
    np.testing.assert_allclose(-np.diff(qdd, prepend=0.0), arm(torques), rtol=1e-12)
