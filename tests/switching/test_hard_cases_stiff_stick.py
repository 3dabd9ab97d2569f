"""Stick beside a stiff controller, and events that end a run at rest or at its start."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx


def servo(kp: float, kd: float, reference: float, coulomb: float, length: float) -> pc.Scene:
    pd = fx.Motor(joint=2, pd=fx.PD(kp=kp, kd=kd, reference=reference))
    rub = fx.DryJointFriction(joint=2, coulomb=coulomb)
    return pc.Scene(links=[pc.Link(mass=1, length=length)] * 2, effects=[rub, pd])


@pytest.mark.parametrize("k", range(0, 25, 3))
def test_a_slipping_joint_is_not_stopped_and_friction_gives_nothing_back(k: int) -> None:
    scene = servo(1e3, 5.0, 0.8, 0.5, 0.5)
    sol = pc.simulate(scene, q0=[0.3 + 0.03 * k, 1.1 + 0.03 * k], t_span=(0, 4), ledger=True)
    ledger = sol.energy().ledger
    assert np.abs(np.diff(ledger.residual)).max() < 1e-5
    assert np.diff(ledger.dry).min() >= -1e-12


@pytest.mark.parametrize("kp", [1e4, 1e5])
@pytest.mark.parametrize("k", range(6))
def test_stick_beside_a_stiff_controller_gets_to_its_end(kp: float, k: int) -> None:
    scene = servo(kp, 1.0, 1.0, 0.3, 1.0)
    sol = pc.simulate(scene, q0=[0.5 + 0.02 * k, 1.5 + 0.02 * k], t_span=(0, 5), max_steps=300_000)
    assert sol.success, sol.message


def test_a_terminal_event_ends_a_run_at_rest() -> None:
    rod = pc.Scene(links=[pc.Link(mass=1, length=1)], effects=[fx.DryJointFriction(1, coulomb=9)])
    clock = pc.events.Function(lambda t, q, qd: t - 7.3, terminal=True)
    sol = pc.simulate(rod, q0=1.0, t_span=(0, 100), events=[clock])
    assert sol.status == "event"
    assert sol.t[-1] == pytest.approx(7.3, abs=1e-12)
    assert sol.resume(100.0).status == "at_rest"


def test_a_terminal_event_by_an_impact_at_the_start_ends_the_run_there() -> None:
    stop = fx.JointStop(joint=1, range=(-3, 1), restitution=0.5)
    rod = pc.Scene(links=[pc.Link(mass=1, length=1)], effects=[stop])
    turn = pc.events.RateZero(joint=1, terminal=True)
    sol = pc.simulate(rod, q0=1.0, qd0=2.0, t_span=(0, 2), events=[turn])
    assert sol.status == "event"
    assert sol.t[-1] == 0.0
