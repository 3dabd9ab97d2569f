"""Dry friction where something else changes as well: a knot, damping, an end, a lock, time itself.

One uniform rod of mass 3 and length 1 on a fixed pivot without gravity, unless a test says
otherwise: its moment of inertia about the pivot is 1, so that torques are accelerations.
"""

from __future__ import annotations

import pickle
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from unit_rods import rod, solve


def assert_finished(sol: pc.Solution, t_end: float) -> None:
    assert (sol.status, sol.t[-1]) == ("finished", t_end), sol.message
    assert (np.diff(sol.t) > 0).all()


# Friction that slides ---------------------------------------------------------------------------


def test_friction_that_turns_round_at_a_knot_is_followed_by_the_next_piece() -> None:
    """Torque -a until T, down to -2 a over 1 s, against friction tc < a; it starts (a + tc) T fast.

    So it is at rest at T, and then its rate is -(a - tc) s - a s^2/2.
    """
    random = np.random.default_rng(9)
    ends, exact = [], []
    for knot, a, share in zip(
        *random.uniform(0.1, 10, (2, 200)), random.uniform(0.1, 0.9, 200), strict=True
    ):
        coulomb = share * a
        table = fx.Table(t=[0, knot, knot + 1], torque=[-a, -a, -2 * a])
        effects = fx.Motor(joint=1, table=table), fx.DryJointFriction(joint=1, coulomb=coulomb)
        w0 = (a + coulomb) * knot
        sol = solve(rod(*effects), 0, w0, knot + 1)
        assert_finished(sol, knot + 1)
        ends.append(sol.y[:, -1])
        exact.append([w0 * knot / 2 - (a - coulomb) / 2 - a / 6, -(a - coulomb) - a / 2])
    np.testing.assert_allclose(ends, exact, rtol=1e-10, atol=1e-10)


def test_friction_and_damping_in_one_joint_turn_round_together() -> None:
    """Until the reversal w' = -(1.5 + w^2), from there w' = -(0.5 - w^2).

    From 1 the first takes atan(sqrt(2/3))/sqrt(1.5); then w = -sqrt(0.5) tanh(sqrt(0.5) s).
    """
    motor = fx.Motor(joint=1, constant=-1.0)
    friction = fx.DryJointFriction(joint=1, coulomb=0.5)
    damping = fx.ViscousJoint(joint=1, damping=0.0, damping2=1.0)
    turn = np.arctan(np.sqrt(2 / 3)) / np.sqrt(1.5)
    rate = -np.sqrt(0.5) * np.tanh(np.sqrt(0.5) * (3 - turn))
    for effects in ((motor, friction, damping), (damping, friction, motor)):
        sol = solve(rod(*effects), 0, 1, 3, rtol=1e-11)
        assert_finished(sol, 3)
        assert sol.qd[-1, 0] == pytest.approx(rate, rel=1e-9)
        assert np.abs(sol.t - turn).min() < 1e-10


def test_friction_that_stops_the_rod_at_the_end_never_stops_it_later() -> None:
    """It slides for w0/tc: whether the run finishes there or finds rest is a matter of a bit."""
    random = np.random.default_rng(4)
    for w0, coulomb in random.uniform(0.1, 10, (200, 2)):
        t_end = w0 / coulomb
        friction = fx.DryJointFriction(joint=1, coulomb=coulomb)
        sol = solve(rod(friction), 0, w0, t_end)
        assert sol.status in {"finished", "at_rest"}, sol.message
        assert t_end * (1 - 1e-13) <= sol.t[-1] <= t_end
        assert (np.diff(sol.t) > 0).all()
        np.testing.assert_allclose(sol.y[:, -1], [w0 * t_end / 2, 0], rtol=1e-12, atol=1e-12 * w0)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(sol)).y, sol.y)


# Friction that holds ----------------------------------------------------------------------------


@pytest.mark.parametrize(("links", "joint"), [(2, 1), (2, 2), (3, 2)])
def test_friction_in_a_locked_joint_changes_nothing(links: int, joint: int) -> None:
    lock = fx.Lock(joint=joint)
    friction = fx.DryJointFriction(joint=joint, coulomb=0.3, static=0.5)
    locked = solve(rod(lock, gravity=9.81, links=links), 0.3, 0, 2, rtol=1e-11)
    times = np.linspace(0, 2, 50)
    for effects in ((lock, friction), (friction, lock)):
        both = solve(rod(*effects, gravity=9.81, links=links), 0.3, 0, 2, rtol=1e-11)
        assert_finished(both, 2)
        np.testing.assert_allclose(both(times), locked(times), atol=1e-8)
        np.testing.assert_array_equal(both.relative_angles()[:, joint - 1], 0.3 * (joint == 1))


SETS_FREE_LATER = {
    "sinusoid": fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=1.0, angular_frequency=3.0)),
    "table": fx.Motor(joint=1, table=fx.Table(t=[0, 9], torque=[0, 9])),
    "sinusoidal pivot": fx.DrivenPivot(y=fx.Sinusoid(amplitude=0.1, angular_frequency=3.0)),
    "spline": fx.DrivenPivot(spline=fx.Spline(t=[0, 4, 5, 9], x=[0, 0, 9, 0], y=[0, 0, 0, 0])),
    "function": fx.User(lambda t, q, qd: np.array([t])),
}


@pytest.mark.parametrize("w0", [0.0, 0.01])
@pytest.mark.parametrize("effect", SETS_FREE_LATER.values(), ids=SETS_FREE_LATER.keys())
def test_rest_that_will_not_last_is_not_said_to_be_for_good(effect: Any, w0: float) -> None:
    """The torque grows from zero and exceeds friction later: the rod sticks, and slides again."""
    friction = fx.DryJointFriction(joint=1, coulomb=0.5)
    sol = solve(rod(friction, effect), np.pi / 2 - 1, w0, 8)
    assert sol.status == "finished"
    assert (sol.qd[:-1, 0] == 0.0).sum() > 1
    assert abs(sol.qd[:, 0]).max() > 0.01


def test_rest_that_lasts_is_told_without_a_reservation() -> None:
    friction = fx.DryJointFriction(joint=1, coulomb=0.5)
    for effect in (fx.Motor(joint=1, constant=0.4), fx.TorsionalSpring(joint=1, stiffness=0.1)):
        sol = solve(rod(friction, effect), 0, 0.1, 8)
        assert sol.status == "at_rest"
        assert "for good" in sol.message


# Time itself ------------------------------------------------------------------------------------


def test_a_joint_that_sticks_before_the_least_double_of_time_sticks_at_once() -> None:
    """The friction of the fuzzer's case 6105 stops the joint within w/tc = 1.5e-434 s."""
    friction = fx.DryJointFriction(joint=1, coulomb=1.8e150, stribeck_velocity=2.1e-61)
    sol = pc.simulate(
        rod(friction), q0=0.0, qd0=2.8e-284, t_span=(0.0, 3.1e-322), first_step=1.5e-151
    )
    assert (sol.status, sol.stats.accepted, *sol.t) == ("at_rest", 0, 0.0, 3.1e-322)
    assert sol.qd[0] == sol.qd[-1] == 0.0
