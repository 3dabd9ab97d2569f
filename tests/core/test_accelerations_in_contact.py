"""Accelerations of a state in contact are those of the run, to the last bits of the angle."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx


@pytest.mark.parametrize("restitution", [0.0, 0.5])
def test_accelerations_in_contact_are_the_slopes_of_the_rates(restitution, method):
    """Held against a stop, joint 2 turns with joint 1; its angle is a difference of large ones.

    The joint is held where rounding put it: a last bit of 3 rad away from the stop, which is
    sixteen last bits of its 0.2 rad.
    """
    scene = pc.Scene.textbook().replace(effects=[
        fx.JointStop(joint=2, range=(-1.5, 0.2), restitution=restitution),
        fx.DryJointFriction(joint=2, coulomb=0.3),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(8.0, angular_frequency=3.0)),
    ])  # fmt: skip
    sol = pc.simulate(scene, (0, 10), 1.5, rtol=1e-9, method=method)
    phi = sol.q[:, 1] - sol.q[:, 0]
    still = sol.qd[:, 1] == sol.qd[:, 0]
    pairs = still[:-1] & still[1:] & (np.diff(sol.t) > 1e-3) & (np.abs(phi[:-1] - 0.2) < 1e-9)
    held = np.flatnonzero(pairs)
    assert held.size > 10
    assert np.abs(phi[held + 1] - 0.2).max() < 2 * np.spacing(4.0)  # the angles' own rounding
    for t in 0.5 * (sol.t[held] + sol.t[held + 1]):
        y, h = sol(t), 1e-5
        told = scene.accelerations(t, y[:2], y[2:])
        assert told[0] == pytest.approx(told[1], abs=1e-9)
        slopes = (sol(t + h) - sol(t - h))[2:] / (2 * h)
        np.testing.assert_allclose(told, slopes, rtol=1e-4, atol=1e-3)
