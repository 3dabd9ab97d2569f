"""Stops with restitution, one rod: times, speeds and losses of every bounce are closed forms.

The rod's moment of inertia is 1, so that torques are accelerations; without gravity unless said.
"""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from reference.rounding import U, of_new_state
from unit_rods import rod, solve, time_of_rest

FIRST = {method["name"]: method["first"] for method in pc._core.methods()}

inf = np.inf


def jumps(sol: pc.Solution) -> Any:
    """The rows after which the state jumps: a time that is there twice."""
    return np.flatnonzero(np.diff(sol.t) == 0)


def pressed(torque: float, **stop: Any) -> pc.Scene:
    """A constant torque towards a stop at angle 0."""
    return rod(fx.Motor(joint=1, constant=-torque), fx.JointStop(joint=1, range=(0, inf), **stop))


@pytest.mark.parametrize("e", [0.0, 0.3, 0.8, 0.95])
@pytest.mark.parametrize("torque", [0.7, 50.0])
def test_accumulating_bounces_end_when_the_series_says(e: float, torque: float, fine: Any) -> None:
    """Impact speeds w_1 e^k; captured below w_c at w_k: t_1 + 2 e (w_1 - w_k)/(torque (1 - e))."""
    height, capture = 0.4, 1e-9
    first = np.sqrt(2 * torque * height)
    speeds = [first]
    while speeds[-1] >= capture and e > 0:
        speeds.append(e * speeds[-1])
    captured = speeds[-1] if e > 0 else first
    exact = first / torque + 2 * e * (first - captured) / (torque * (1 - e))
    sol = solve(
        pressed(torque, restitution=e, capture_speed=capture), height, 0, 100, ledger=True, **fine
    )
    assert sol.status == "at_rest", sol.message
    assert sol.y[:, -1].tolist() == [0.0, 0.0]
    assert time_of_rest(sol) == pytest.approx(exact, rel=1e-10)
    assert sol.energy().ledger.impact[-1] == pytest.approx(first**2 / 2, rel=1e-10)
    assert len(jumps(sol)) == pytest.approx(len(speeds), abs=1)
    assert sol.stats.accepted < 100 * len(speeds)


@pytest.mark.parametrize("capture", [1e-2, 1e-4, 1e-7])
def test_capture_shortens_the_bounces_by_what_the_series_has_left(
    capture: float, fine: Any
) -> None:
    e, torque, height = 0.7, 2.0, 0.4
    first = np.sqrt(2 * torque * height)
    k = int(np.ceil(np.log(capture / first) / np.log(e)))
    last = first * e**k
    whole = first / torque + 2 * first / torque * e / (1 - e)
    sol = solve(pressed(torque, restitution=e, capture_speed=capture), height, 0, 100, **fine)
    assert sol.status == "at_rest"
    assert whole - time_of_rest(sol) == pytest.approx(2 * last / torque * e / (1 - e), abs=1e-10)


def test_each_bounce_is_where_and_as_fast_as_it_should_be(fine: Any) -> None:
    e, torque, height = 0.9, 2.0, 0.4
    first = np.sqrt(2 * torque * height)
    scene = pressed(torque, restitution=e, capture_speed=1e-3)
    sol = solve(scene, height, 0, 100, ledger=True, **fine)
    rows = jumps(sol)
    speeds = first * e ** np.arange(len(rows))
    times = first / torque + 2 * e * (first - speeds) / (torque * (1 - e))
    np.testing.assert_allclose(sol.t[rows], times, rtol=1e-11)
    np.testing.assert_allclose(sol.qd[rows, 0], -speeds, rtol=1e-10)
    np.testing.assert_allclose(sol.qd[rows[:-1] + 1, 0], e * speeds[:-1], rtol=1e-10)
    np.testing.assert_array_equal(sol.q[rows, 0], 0)
    np.testing.assert_array_equal(sol.q[rows + 1, 0], 0)
    impact = sol.energy().ledger.impact
    np.testing.assert_allclose(
        (impact[rows + 1] - impact[rows])[:-1], (1 - e**2) * speeds[:-1] ** 2 / 2, rtol=1e-9
    )
    assert impact[0] == 0
    for row in rows[:20]:
        np.testing.assert_array_equal(sol(sol.t[row]), sol.y[:, row + 1])  # the state after
    apex = (times[3] + times[4]) / 2
    np.testing.assert_allclose(
        sol(apex), [(e * speeds[3]) ** 2 / (2 * torque), 0], rtol=1e-9, atol=1e-9
    )


def test_between_two_stops_a_free_rod_takes_longer_each_time_by_the_restitution(fine: Any) -> None:
    """Without torque: 2 L/(w e^k) for the k-th crossing, and it never stops."""
    e, w = 0.8, 3.0
    scene = rod(fx.JointStop(joint=1, range=(-0.5, 0.7), restitution=e, capture_speed=1e-12))
    crossings = 30
    times = np.cumsum(np.append(0.7 / w, 1.2 / (w * e ** np.arange(1, crossings))))
    end = times[-1] + 1.0
    sol = solve(scene, 0, w, end, **fine)
    assert sol.status == "finished"
    rows = jumps(sol)
    np.testing.assert_allclose(sol.t[rows], times, rtol=1e-11)
    side = -1.0 if crossings % 2 else 1.0
    rate = side * w * e**crossings
    assert sol.qd[-1, 0] == pytest.approx(rate, rel=1e-10)
    bound = 0.7 if crossings % 2 else -0.5
    assert sol.q[-1, 0] == pytest.approx(bound + rate * 1.0, rel=1e-10)


def test_a_captured_rod_without_a_torque_leans_on_its_stop_for_good(fine: Any) -> None:
    scene = rod(fx.JointStop(joint=1, range=(-0.5, 0.7)))
    sol = solve(scene, 0, 3.0, 5.0, **fine)
    assert sol.success
    assert sol.y[:, -1].tolist() == [0.7, 0.0]


# Elastic ----------------------------------------------------------------------------------------


def test_elastic_bounces_keep_the_energy_and_their_beat(fine: Any) -> None:
    """A thousand of 2 w_1/torque each."""
    torque, height = 2.0, 0.4
    first = np.sqrt(2 * torque * height)
    bounces = 1000
    end = first / torque * (1 + 2 * bounces)
    scene = pressed(torque, restitution=1.0)
    sol = pc.simulate(scene, q0=height, qd0=0, t_span=(0, end), ledger=True, **fine)
    assert sol.status == "finished"
    assert len(jumps(sol)) in {bounces, bounces + 1}
    assert np.abs(sol.energy().ledger.impact).max() < 1e-12
    apex = sol(first / torque * 2 * bounces)
    # every bounce is rounded alike, and all later ones are that much shorter
    method = FIRST[fine["method"]]  # nothing is stiff here
    is_derived = method in {"dop853", "taylor"}
    scale = bounces**2 * (2 * first / torque) * torque
    # of a step: the rounding of its sum, of the state at both ends, of the scale, and of the impact
    within = (of_new_state(method) + 4 * U) * scale if is_derived else 1e-10
    np.testing.assert_allclose(apex, [height, 0], atol=within)


def test_an_elastic_stop_at_the_bottom_halves_the_period_of_a_pendulum(fine: Any) -> None:
    """From 1 rad to the vertical and back in 2 K(k) sqrt(2L/3g)."""
    gravity, amplitude = 9.81, 1.0
    scene = rod(fx.JointStop(joint=1, range=(-inf, np.pi / 2), restitution=1.0), gravity=gravity)
    k = mpmath.sin(mpmath.mpf(amplitude) / 2)
    half = float(2 * mpmath.ellipk(k**2) * mpmath.sqrt(2 / (3 * mpmath.mpf(gravity))))
    start = np.pi / 2 - amplitude
    sol = solve(scene, start, 0, 10 * half, **fine)
    np.testing.assert_allclose(sol.y[:, -1], [start, 0], atol=1e-9)
    np.testing.assert_allclose(sol.t[jumps(sol)], half * (np.arange(10) + 0.5), rtol=1e-11)


def test_a_pendulum_on_a_stop_at_the_bottom_swings_less_by_the_restitution(fine: Any) -> None:
    """1 - cos(amplitude) shrinks by e^2 each time."""
    gravity, amplitude, e = 9.81, 1.2, 0.85
    scene = rod(fx.JointStop(joint=1, range=(-inf, np.pi / 2), restitution=e), gravity=gravity)
    start = np.pi / 2 - amplitude
    with mpmath.mp.workdps(30):
        reached, t = mpmath.mpf(amplitude), mpmath.mpf(0)
        turns = []
        for _ in range(8):
            unit = mpmath.sqrt(2 / (3 * mpmath.mpf(gravity)))
            t += mpmath.ellipk(mpmath.sin(reached / 2) ** 2) * unit
            reached = mpmath.acos(1 - mpmath.mpf(e) ** 2 * (1 - mpmath.cos(reached)))
            t += mpmath.ellipk(mpmath.sin(reached / 2) ** 2) * unit
            turns.append((float(t), np.pi / 2 - float(reached)))
    sol = solve(scene, start, 0, turns[-1][0], **fine)
    for time, angle in turns:
        np.testing.assert_allclose(sol(time), [angle, 0], atol=1e-9)


def test_there_and_back_over_elastic_bounces_is_where_it_began(fine: Any) -> None:
    scene = pressed(2.0, restitution=1.0)
    there = solve(scene, 0.4, 0.1, 3, **fine)
    back = pc.simulate(scene, q0=there.q[-1], qd0=there.qd[-1], t_span=(3, 0), **fine)
    assert back.success
    np.testing.assert_allclose(back.y[:, -1], [0.4, 0.1], atol=1e-10)
    assert len(jumps(back)) == len(jumps(there)) > 0


@pytest.mark.parametrize("e", [0.0, 0.5, 0.999])
def test_an_inelastic_stop_is_refused_backward_by_name(e: float) -> None:
    with pytest.raises(ValueError, match=r"joint_stop"):
        pc.simulate(pressed(2.0, restitution=e), q0=0.4, qd0=0, t_span=(1, 0))
