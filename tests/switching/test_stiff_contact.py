"""Friction, stops and events after a pair has changed to radau5, beside a joint that is locked.

A damper of 1e5 N m s/rad in joint 2 lets the joint turn at its load divided by that; a lock would
not let it turn.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev

WATCHED = [
    ev.JointAngle(1, 1.5),
    ev.RateZero(joint=1),
    ev.TipLine((0.0, 0.0), (1.0, 0.0)),
    ev.Function(lambda t, q, qd: q[0] - 1.4),
]
CONTACTS = {
    "friction": fx.DryJointFriction(joint=1, coulomb=0.8),
    "a stop": fx.JointStop(joint=1, range=(-9.0, 1.7)),
}


@pytest.mark.parametrize("contact", CONTACTS)
def test_what_changes_after_the_change_of_method_is_found_as_under_a_lock(contact: str) -> None:
    def run(joint_2: Any, **how: Any) -> pc.Solution:
        scene = pc.Scene.textbook().replace(effects=[joint_2, CONTACTS[contact]])
        return pc.simulate(scene, q0=0.5, qd0=0, t_span=(0, 3), events=WATCHED, **how)

    stiff = run(fx.ViscousJoint(joint=2, damping=1e5), method="dopri5-radau5", rtol=1e-8)
    locked = run(fx.Lock(joint=2), rtol=1e-10)
    assert stiff.stats.njev > 20  # it has gone over, and early
    assert stiff.stats.accepted < 10_000
    np.testing.assert_allclose(stiff.y[:, -1], locked.y[:, -1], atol=1e-4)
    for found, expected in zip(stiff.events, locked.events, strict=True):
        assert [one.t for one in found] == pytest.approx([one.t for one in expected], abs=1e-4)
        assert [one.direction for one in found] == [one.direction for one in expected]
        assert expected


@pytest.mark.parametrize("held_by", ["a stop", "friction"])
@pytest.mark.parametrize("damping", [300.0, 3e3])
def test_the_rate_of_a_joint_that_is_held_is_nothing_in_and_between_stiff_steps(
    damping: float, held_by: str, method: str
) -> None:
    """Leaning on its stop, or stuck, while link 2 creeps through honey: no zero of the rate."""
    hold: Any = fx.JointStop(joint=1, range=(-0.3, 1.1))
    rate = 0.1
    if held_by == "friction":
        hold, rate = fx.DryJointFriction(joint=1, coulomb=9.0), 0.0
    scene = pc.Scene(
        links=[pc.Link(mass=1.0, length=0.6)] * 2,
        effects=[hold, fx.ViscousJoint(joint=2, damping=damping)],
    )
    watched = [ev.RateZero(joint=1), ev.RateZero(link=1), ev.JointAngle(joint=1, value=1.1)]
    sol = pc.simulate(
        scene, q0=[1.1, 1.6], qd0=[0, rate], t_span=(0, 1), method=method, rtol=1e-6, events=watched
    )
    assert sol.status == "finished"
    assert abs(sol.qd[-1, 1]) > 1e-6
    assert [list(found) for found in sol.events] == [[], [], []]
    states = np.column_stack([sol.y, sol(np.linspace(0, 1, 1001))])
    assert set(states[0]) == {1.1}
    assert not states[2].any()
