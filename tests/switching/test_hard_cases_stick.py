"""Dry friction that holds: exactly nothing moves, and what lets go lets go exactly when it must.

Rods of moment of inertia 1 about the pivot, so that torques are accelerations.
"""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from unit_rods import rod, solve, time_of_rest

G = 9.81
WEIGHT = 3 * G / 2  # torque of gravity on the horizontal rod


def inclined(share: float, *effects: Any) -> pc.Scene:
    """A rod for 30 degrees below the horizontal; its friction is `share` times what it needs."""
    needed = WEIGHT * np.cos(np.pi / 6)
    return rod(fx.DryJointFriction(joint=1, coulomb=share * needed), *effects, gravity=G)


def assert_never_moved(sol: pc.Solution, q: Any) -> None:
    assert sol.success
    np.testing.assert_array_equal(sol.q, np.broadcast_to(q, sol.q.shape))
    np.testing.assert_array_equal(sol.qd, np.zeros_like(sol.qd))


def test_a_rod_held_at_30_degrees_is_at_rest_for_good(method: str) -> None:
    sol = solve(inclined(2.0), np.pi / 6, 0, 1e6, method=method)
    assert sol.status == "at_rest"
    assert_never_moved(sol, np.pi / 6)


HUMS = {
    "motor": fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=5.0, angular_frequency=0.3)),
    "pivot": fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.1, angular_frequency=0.3)),
    "table": fx.Motor(joint=1, table=fx.Table(t=[0, 5e5, 1e6], torque=[0, 5, -5])),
}


@pytest.mark.unsanitized
@pytest.mark.parametrize("hum", HUMS.values(), ids=HUMS.keys())
def test_a_rod_held_at_30_degrees_under_a_hum_moves_by_nothing_in_1e6_s(
    hum: Any, method: str
) -> None:
    """Friction of twice what it needs: the hum takes up less than the other half."""
    sol = pc.simulate(
        inclined(2.0, hum), q0=np.pi / 6, qd0=0, t_span=(0, 1e6), store="steps", method=method
    )
    assert sol.t[-1] == 1e6 or sol.status == "at_rest"
    assert_never_moved(sol, np.pi / 6)


def test_friction_that_is_short_by_a_billionth_does_not_hold(method: str) -> None:
    """Above the horizontal, where a rod that begins to fall is pulled the more."""
    for share, held in ((1 + 1e-12, True), (1 - 1e-9, False)):
        sol = solve(inclined(share), -np.pi / 6, 0, 10, method=method)
        assert sol.success
        assert (sol.q[-1, 0] == -np.pi / 6) == held
        assert held or sol.q[-1, 0] > 0


@pytest.mark.parametrize("amplitude", [0.5, 3.0])
def test_two_rods_that_friction_holds_straight_swing_as_one_of_twice_the_length(
    amplitude: float, fine: Any
) -> None:
    scene = rod(fx.DryJointFriction(joint=2, coulomb=100.0), gravity=G, links=2)
    k = mpmath.sin(mpmath.mpf(amplitude) / 2)
    period = float(4 * mpmath.ellipk(k**2) * mpmath.sqrt(4 / (3 * mpmath.mpf(G))))
    start = np.pi / 2 - amplitude
    sol = solve(scene, start, 0, period, **fine | {"rtol": 1e-13})
    assert sol.status == "finished"
    np.testing.assert_allclose(sol.y[:, -1], [start, start, 0, 0], atol=1e-10)
    np.testing.assert_array_equal(sol.q[:, 0], sol.q[:, 1])
    np.testing.assert_array_equal(sol.qd[:, 0], sol.qd[:, 1])


def test_a_joint_that_is_held_bent_moves_as_a_locked_one(fine: Any) -> None:
    held = rod(fx.DryJointFriction(joint=2, coulomb=100.0), gravity=G, links=3)
    locked = rod(fx.Lock(joint=2), gravity=G, links=3)
    times = np.linspace(0, 3, 31)
    how = {"q": [0.3, 1.2, 0.9], "qd": [1.0, 1.0, -2.0], "t_end": 3, **fine}
    np.testing.assert_allclose(solve(held, **how)(times), solve(locked, **how)(times), atol=1e-9)


# Release ----------------------------------------------------------------------------------------


def assert_released_at(sol: pc.Solution, time: float, still: Any) -> None:
    """A point of the run to the last bits, and not the least motion before it."""
    assert np.abs(sol.t - time).min() <= 1e-13 * max(time, 1)
    before = sol.t < time * (1 - 1e-12)
    assert before.any()
    assert_never_moved_before(sol, before, still)
    assert sol.qd[-1].any()


def assert_never_moved_before(sol: pc.Solution, before: Any, still: Any) -> None:
    np.testing.assert_array_equal(sol.qd[before], 0)
    np.testing.assert_array_equal(sol.q[before], np.broadcast_to(still, sol.q[before].shape))


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize("slope", [1e-3, 0.7, 40.0])
def test_a_growing_torque_sets_the_rod_free_where_it_exceeds_friction(
    slope: float, side: int, fine: Any
) -> None:
    """From friction/slope on, the rate is slope s^2/2, the angle slope s^3/6."""
    release, slide = 0.5 / slope, 2.0
    end = release + slide
    table = fx.Table(t=[0, 2 * end], torque=[0, side * slope * 2 * end])
    scene = rod(fx.Motor(joint=1, table=table), fx.DryJointFriction(joint=1, coulomb=0.5))
    sol = solve(scene, 0.3, 0, end, **fine)
    assert_released_at(sol, release, 0.3)
    went = [0.3 + side * slope * slide**3 / 6, side * slope * slide**2 / 2]
    np.testing.assert_allclose(sol.y[:, -1], went, rtol=1e-10)


@pytest.mark.parametrize("friction", [0.2, 0.5, 0.99])
def test_a_sinusoidal_torque_sets_the_rod_free_at_its_arcsine(friction: float, fine: Any) -> None:
    """From release to t the rate is (cos a - cos wt)/w - friction (t - release), a = w release."""
    w = 3.0
    motor = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=1.0, angular_frequency=w))
    angle = np.arcsin(friction)
    end = (angle + 0.05) / w
    sol = solve(rod(motor, fx.DryJointFriction(joint=1, coulomb=friction)), 0.3, 0, end, **fine)
    assert_released_at(sol, angle / w, 0.3)
    rate = mpmath.quad(lambda t: mpmath.sin(w * t) - friction, [angle / w, end])
    assert sol.qd[-1, 0] == pytest.approx(float(rate), abs=1e-12)


@pytest.mark.parametrize("q", [np.pi / 2, 0.4])
def test_a_shaken_pivot_sets_the_rod_free_where_its_inertia_exceeds_friction(
    q: float, fine: Any
) -> None:
    """Without gravity the pivot's acceleration -A w^2 sin(wt) along x turns it by a sin q of it."""
    amplitude, w, friction = 0.2, 4.0, 1.1
    drive = fx.DrivenPivot(x=fx.Sinusoid(amplitude=amplitude, angular_frequency=w))
    largest = 3 * 0.5 * amplitude * w**2 * np.sin(q)
    release = np.arcsin(friction / largest) / w
    scene = rod(drive, fx.DryJointFriction(joint=1, coulomb=friction))
    sol = solve(scene, q, 0, release + 0.1, **fine)
    assert_released_at(sol, release, q)
    assert sol.qd[-1, 0] < 0


def test_a_servo_lets_go_where_a_second_motor_takes_the_sum_beyond_friction(fine: Any) -> None:
    """Kp (reference - phi) stands still while the joint does: 0.3 of 0.5, and 0.2 t beside it."""
    servo = fx.Motor(joint=1, pd=fx.PD(kp=3.0, kd=0.5, reference=0.4))
    ramp = fx.Motor(joint=1, table=fx.Table(t=[0, 9], torque=[0, 1.8]))
    scene = rod(servo, ramp, fx.DryJointFriction(joint=1, coulomb=0.5))
    sol = solve(scene, 0.3, 0, 1.2, **fine)
    assert_released_at(sol, 1.0, 0.3)
    # phi'' = 0.2 s - 3 phi - 0.5 phi' from rest: the exponential of its matrix
    s = mpmath.mpf("0.2")
    a = mpmath.matrix([[0, 1, 0, 0], [-3, -0.5, 0.2, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    exact = mpmath.expm(a * s) * mpmath.matrix([0, 0, 0, 1])
    assert sol.q[-1, 0] - 0.3 == pytest.approx(float(exact[0]), abs=1e-12)
    assert sol.qd[-1, 0] == pytest.approx(float(exact[1]), abs=1e-12)


def test_static_friction_above_the_sliding_one_lets_go_at_the_static_one(fine: Any) -> None:
    table = fx.Motor(joint=1, table=fx.Table(t=[0, 10], torque=[0, 10]))
    friction = fx.DryJointFriction(joint=1, coulomb=0.4, static=0.9, stribeck_velocity=0.01)
    sol = solve(rod(table, friction), 0.3, 0, 1.5, **fine)
    assert_released_at(sol, 0.9, 0.3)
    # the peak of friction is passed within 0.04 rad/s, from where 0.4 acts against t
    assert sol.qd[-1, 0] == pytest.approx((1.5**2 - 0.9**2) / 2 - 0.4 * 0.6, abs=0.05)


# Springs ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("amplitude", [1.03, 0.06, 0.72])
def test_a_rod_on_a_spring_rests_for_good_where_the_spring_cannot_move_it(
    amplitude: float, fine: Any
) -> None:
    """Static friction of twice the sliding one: it rests once k abs(A) <= ts."""
    k, coulomb = 2.0, 0.1
    spring = fx.TorsionalSpring(joint=1, stiffness=k, rest_angle=0.3)
    friction = fx.DryJointFriction(
        joint=1, coulomb=coulomb, static=2 * coulomb, stribeck_velocity=1e-7
    )
    turns = [amplitude]
    while k * abs(turns[-1]) > 2 * coulomb:
        turns.append(-(turns[-1] - np.sign(turns[-1]) * 2 * coulomb / k))
    sol = solve(rod(spring, friction), 0.3 + amplitude, 0, 100, **fine)
    assert sol.status == "at_rest"
    # each half swing passes the peak of friction twice, which takes 2 ts ws of impulse or so
    assert sol.q[-1, 0] - 0.3 == pytest.approx(turns[-1], abs=1e-5)
    assert sol.qd[-1, 0] == 0.0
    assert time_of_rest(sol) == pytest.approx(np.pi / np.sqrt(k) * (len(turns) - 1), abs=1e-4)


def test_two_rods_at_rest_are_held_if_and_only_if_both_joints_can(method: str) -> None:
    """At rest: a_2 g cos q_2 at joint 2, that and a_1 g cos q_1 at joint 1."""
    q = np.array([0.4, -0.7])
    at_2 = 3 * 0.5 * G * np.cos(q[1])
    at_1 = 3 * 1.5 * G * np.cos(q[0]) + at_2
    for first, second in ((1, 1), (1, -1), (-1, 1)):
        scene = rod(
            fx.DryJointFriction(joint=1, coulomb=at_1 * (1 + first * 1e-9)),
            fx.DryJointFriction(joint=2, coulomb=at_2 * (1 + second * 1e-9)),
            gravity=G,
            links=2,
        )
        sol = solve(scene, q, 0, 0.5, method=method)
        held = (first, second) == (1, 1)
        assert sol.success
        assert (sol.status == "at_rest" and time_of_rest(sol) == 0.0) == held
        assert bool((sol.q[-1] == q).all()) == held
