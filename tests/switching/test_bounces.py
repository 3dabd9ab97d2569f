"""Stops with restitution, one rod: times, speeds and losses of every bounce are closed forms.

The rod's moment of inertia is 1, so that torques are accelerations; without gravity unless said.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from reference.rounding import U, of_new_state
from swings import time_to
from unit_rods import rod, solve, time_of_rest

FIRST = {method["name"]: method["first"] for method in pc._core.methods()}
HEIGHT, inf = 0.4, np.inf


def jumps(sol):
    """The rows after which the state jumps: a time that is there twice."""
    return np.flatnonzero(np.diff(sol.t) == 0)


def pressed(torque, **stop):
    """A constant torque towards a stop at angle 0."""
    return rod(fx.Motor(joint=1, constant=-torque), fx.JointStop(joint=1, range=(0, inf), **stop))


def stopped_below(e):
    """A pendulum with a stop where it hangs."""
    return rod(fx.JointStop(joint=1, range=(-inf, np.pi / 2), restitution=e), gravity=9.81)


@pytest.mark.parametrize(
    "bounces",
    [
        *((e, torque, 1e-9) for e in (0.0, 0.3, 0.8, 0.95) for torque in (0.7, 50.0)),
        *((0.7, 2.0, capture) for capture in (1e-2, 1e-4, 1e-7)),
    ],
    ids=lambda bounces: "e = {}, torque {}, capture {}".format(*bounces),
)
def test_accumulating_bounces_end_when_the_series_says(bounces, fine):
    """Impact speeds w_1 e^k; captured below w_c at w_k: t_1 + 2 e (w_1 - w_k)/(torque (1 - e))."""
    e, torque, capture = bounces
    first = np.sqrt(2 * torque * HEIGHT)
    speeds = [first]
    while speeds[-1] >= capture and e > 0:
        speeds.append(e * speeds[-1])
    exact = first / torque + 2 * e * (first - speeds[-1]) / (torque * (1 - e))
    scene = pressed(torque, restitution=e, capture_speed=capture)
    sol = solve(scene, HEIGHT, 0, 100, ledger=True, **fine)
    assert sol.status == "at_rest", sol.message
    assert sol.y[:, -1].tolist() == [0.0, 0.0]
    within = {"abs": 1e-10} if capture > 1e-9 else {"rel": 1e-10}
    assert time_of_rest(sol) == pytest.approx(exact, **within)
    assert sol.energy().ledger.impact[-1] == pytest.approx(first**2 / 2, rel=1e-10)
    assert len(jumps(sol)) == pytest.approx(len(speeds), abs=1)
    assert sol.stats.accepted < 100 * len(speeds)


def test_each_bounce_is_where_and_as_fast_as_it_should_be(fine):
    e, torque = 0.9, 2.0
    first = np.sqrt(2 * torque * HEIGHT)
    scene = pressed(torque, restitution=e, capture_speed=1e-3)
    sol = solve(scene, HEIGHT, 0, 100, ledger=True, **fine)
    rows = jumps(sol)
    speeds = first * e ** np.arange(len(rows))
    times = first / torque + 2 * e * (first - speeds) / (torque * (1 - e))
    np.testing.assert_allclose(sol.t[rows], times, rtol=1e-11)
    np.testing.assert_allclose(sol.qd[rows, 0], -speeds, rtol=1e-10)
    np.testing.assert_allclose(sol.qd[rows[:-1] + 1, 0], e * speeds[:-1], rtol=1e-10)
    assert not sol.q[[*rows, *rows + 1], 0].any()
    impact = sol.energy().ledger.impact
    lost = (1 - e**2) * speeds[:-1] ** 2 / 2
    np.testing.assert_allclose((impact[rows + 1] - impact[rows])[:-1], lost, rtol=1e-9)
    assert impact[0] == 0
    for row in rows[:20]:
        np.testing.assert_array_equal(sol(sol.t[row]), sol.y[:, row + 1])  # the state after
    apex, height = (times[3] + times[4]) / 2, (e * speeds[3]) ** 2 / (2 * torque)
    np.testing.assert_allclose(sol(apex), [height, 0], rtol=1e-9, atol=1e-9)


def test_between_two_stops_a_free_rod_takes_longer_each_time_by_the_restitution(fine):
    """Without torque: 2 L/(w e^k) for the k-th crossing, and it never stops."""
    e, w, crossings = 0.8, 3.0, 30
    scene = rod(fx.JointStop(joint=1, range=(-0.5, 0.7), restitution=e, capture_speed=1e-12))
    times = np.cumsum(np.append(0.7 / w, 1.2 / (w * e ** np.arange(1, crossings))))
    sol = solve(scene, 0, w, times[-1] + 1.0, **fine)
    assert sol.status == "finished"
    np.testing.assert_allclose(sol.t[jumps(sol)], times, rtol=1e-11)
    rate = w * e**crossings  # after an even number of them, upward from the lower stop
    np.testing.assert_allclose(sol.y[:, -1], [-0.5 + rate, rate], rtol=1e-10)


def test_a_captured_rod_without_a_torque_leans_on_its_stop_for_good(fine):
    sol = solve(rod(fx.JointStop(joint=1, range=(-0.5, 0.7))), 0, 3.0, 5.0, **fine)
    assert sol.success
    assert sol.y[:, -1].tolist() == [0.7, 0.0]


def test_elastic_bounces_keep_the_energy_and_their_beat(fine):
    """A thousand of 2 w_1/torque each."""
    torque, bounces = 2.0, 1000
    first = np.sqrt(2 * torque * HEIGHT)
    span = (0, first / torque * (1 + 2 * bounces))
    sol = pc.simulate(pressed(torque, restitution=1.0), span, HEIGHT, ledger=True, **fine)
    assert sol.status == "finished"
    assert len(jumps(sol)) in {bounces, bounces + 1}
    assert np.abs(sol.energy().ledger.impact).max() < 1e-12
    # every bounce is rounded alike, and all later ones are that much shorter
    method = FIRST[fine["method"]]  # nothing is stiff here
    is_derived = method in {"dop853", "taylor"}
    scale = bounces**2 * (2 * first / torque) * torque
    # of a step: the rounding of its sum, of the state at both ends, of the scale, and of the impact
    within = (of_new_state(method) + 4 * U) * scale if is_derived else 1e-10
    np.testing.assert_allclose(sol(first / torque * 2 * bounces), [HEIGHT, 0], atol=within)


@pytest.mark.parametrize("e", [0.85, 1.0])
def test_a_pendulum_on_a_stop_at_the_bottom_swings_less_by_the_restitution(e, fine):
    """1 - cos(amplitude) shrinks by e^2 each time."""
    reached, t, hits, turns = mpmath.mpf(1.2), mpmath.mpf(0), [], []
    with mpmath.mp.workdps(30):
        for _ in range(8):
            t += time_to(0, reached, 9.81)
            hits.append(float(t))
            reached = mpmath.acos(1 - mpmath.mpf(e) ** 2 * (1 - mpmath.cos(reached)))
            t += time_to(0, reached, 9.81)
            turns.append((float(t), np.pi / 2 - float(reached)))
    sol = solve(stopped_below(e), np.pi / 2 - 1.2, 0, turns[-1][0], **fine)
    np.testing.assert_allclose(sol.t[jumps(sol)], hits, rtol=1e-11)
    for time, angle in turns:
        np.testing.assert_allclose(sol(time), [angle, 0], atol=1e-9)


def test_there_and_back_over_elastic_bounces_is_where_it_began(fine):
    scene = pressed(2.0, restitution=1.0)
    there = solve(scene, 0.4, 0.1, 3, **fine)
    back = pc.simulate(scene, (3, 0), there.q[-1], there.qd[-1], **fine)
    assert back.success
    np.testing.assert_allclose(back.y[:, -1], [0.4, 0.1], atol=1e-10)
    assert len(jumps(back)) == len(jumps(there)) > 0


@pytest.mark.parametrize("e", [0.0, 0.5, 0.999])
def test_an_inelastic_stop_is_refused_backward_by_name(e):
    with pytest.raises(ValueError, match=r"joint_stop"):
        pc.simulate(pressed(2.0, restitution=e), (1, 0), 0.4)
