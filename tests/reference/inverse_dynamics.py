"""Which couples in the joints a given motion of a chain takes, in multiple precision.

The couple of joint j carries all that lies beyond it: about the joint, where it is at that moment,

    tau_j = sum over i >= j of  I_i alpha_i + (C_i - P_j) x m_i (a_Ci - g)

with the mass centres' accelerations from the angles by differentiating positions twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import mpmath  # type: ignore[import-untyped]

from reference.newton_euler import Body


def joint_couples(
    bodies: Sequence[Body], gravity: float, q: Sequence[Any], qd: Sequence[Any], qdd: Sequence[Any]
) -> list[Any]:
    """Return the couple of each joint on the link beyond it, N m."""
    joint = mpmath.matrix([0, 0])
    moving = mpmath.matrix([0, 0])  # acceleration of that joint
    joints, centers, pulls, spins = [], [], [], []
    for body, angle, rate, acceleration in zip(bodies, q, qd, qdd, strict=True):
        along = mpmath.matrix([mpmath.cos(angle), mpmath.sin(angle)])
        across = mpmath.matrix([-mpmath.sin(angle), mpmath.cos(angle)])
        turning = across * acceleration - along * rate**2  # of a point at unit distance
        length, center = mpmath.mpf(body.length), mpmath.mpf(body.center)
        joints.append(joint)
        centers.append(joint + center * along)
        weightless = moving + center * turning - mpmath.matrix([0, mpmath.mpf(gravity)])
        pulls.append(mpmath.mpf(body.mass) * weightless)
        spins.append(mpmath.mpf(body.inertia) * acceleration)
        joint = joint + length * along
        moving = moving + length * turning
    couples = []
    for j, pivot in enumerate(joints):
        arms = [center - pivot for center in centers]
        beyond = range(j, len(joints))
        couples.append(
            sum(spins[i] + arms[i][0] * pulls[i][1] - arms[i][1] * pulls[i][0] for i in beyond)
        )
    return couples
