"""A step that lands where a law changes goes on with the right law, whatever else is there.

One uniform rod of mass 3 and length 1 on a fixed pivot without gravity, unless a test says
otherwise: its moment of inertia about the pivot is 1, so that torques are accelerations. FAINT is a
damping that turns with the sign of the rate, and is too weak to be seen in any digit: reversals
are points where the law changes, and the motion is what it is without it.

A run that has lost its end would go on for ever: max_steps ends it.
"""

from __future__ import annotations

import pickle

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from reference import rounding
from unit_rods import rod, solve

FAINT = fx.ViscousJoint(joint=1, damping=0.0, damping2=1e-30)


def assert_sound(sol: pc.Solution, t_end: float) -> None:
    """It ends where it was to, its times increase, and its pickle is the same."""
    assert (sol.status, sol.t[-1]) == ("finished", t_end), sol.message
    assert (np.diff(sol.t) > 0).all()
    again = pickle.loads(pickle.dumps(sol))
    np.testing.assert_array_equal(again.y, sol.y)
    times = np.linspace(0, t_end, 20)
    np.testing.assert_array_equal(again(times), sol(times))


# Two things at once -----------------------------------------------------------------------------


@pytest.mark.parametrize("damping2", [1e-30, 1e-12])
@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9, 1e-12])
def test_a_reversal_at_a_knot_is_followed_by_the_next_piece_of_the_table(
    rtol: float, damping2: float
) -> None:
    """Its rate is 1 - t, then -s + s^2 with s = t - 1, then s = t - 2: it is 0 at both knots.

    So it turns by 1/2 - 1/6 + 1/2.
    """
    motor = fx.Motor(joint=1, table=fx.Table(t=[0, 1, 2, 3], torque=[-1, -1, 1, 1]))
    damping = fx.ViscousJoint(joint=1, damping=0.0, damping2=damping2)
    sol = solve(rod(motor, damping), 0, 1, 3, rtol=rtol)
    np.testing.assert_allclose(sol.y[:, -1], [5 / 6, 1], rtol=1e-11)
    assert_sound(sol, 3)


@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
def test_a_reversal_at_a_knot_to_the_last_bits_is_followed_by_the_next_piece(rtol: float) -> None:
    """As above, with w0 and the knot T drawn: torque -w0/T until T, up to c over 1 s, then c.

    With a = w0/T the rate after T is -a s + (a + c) s^2/2 for a second, to (c - a)/2, and c s more.
    """
    random = np.random.default_rng(1)
    ends, exact, bare = [], [], []
    for w0, knot, c in random.uniform(0.1, 10, (200, 3)):
        a = w0 / knot
        table = fx.Table(t=[0, knot, knot + 1, knot + 2], torque=[-a, -a, c, c])
        motor = fx.Motor(joint=1, table=table)
        ends.append(solve(rod(motor, FAINT), 0, w0, knot + 2, rtol=rtol).y[:, -1])
        bare.append(solve(rod(motor), 0, w0, knot + 2, rtol=rtol).y[:, -1])
        turned = w0 * knot / 2 + (-a / 2 + (a + c) / 6) + (c - a) / 2 + c / 2
        exact.append([turned, (c - a) / 2 + c])
    np.testing.assert_allclose(bare, exact, rtol=1e-11, atol=1e-11)
    np.testing.assert_allclose(ends, exact, rtol=1e-11, atol=1e-11)


def bits_on(t: float, bits: int) -> float:
    """Return the time that is `bits` last bits later."""
    return float(t + bits * np.spacing(abs(t)))


def late(
    method: str, scene: pc.Scene, w0: float, t_span: tuple[float, float]
) -> tuple[pc.Solution, float]:
    """A run, and a bound of the rounding of its state in the steps' sums; torques are up to w0."""
    sol = pc.simulate(scene, q0=0, qd0=w0, t_span=t_span, method=method, max_steps=10_000)
    assert (sol.status, sol.t[-1]) == ("finished", t_span[1]), sol.message
    assert (np.diff(sol.t) > 0).all()
    stages = rounding.of_new_state(method) * abs(w0) * (t_span[1] - t_span[0])
    return sol, sol.stats.accepted * rounding.U * float(np.abs(sol.y).max()) + stages


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("bits", [1, 2, 4, 16, 10**6])
@pytest.mark.parametrize("start", [0.0, 7.0, -1e3, 1e6])
def test_a_jump_of_the_torque_where_the_rod_reverses_is_a_jump(
    start: float, bits: int, method: str
) -> None:
    """Stopped by -w0 within a second, it goes on with -c w0: two knots a few bits apart.

    So its rate after another second is -c w0, but for the time between the two knots.
    """
    jump = start + 1
    after = bits_on(jump, bits)
    of_time = rounding.of_late_times(method, jump)
    for w0 in (1.0, -1.0, 0.7, 3.3):
        for c in (1.0, 0.3, 0.0, -1.0):
            table = fx.Table(t=[start, jump, after, start + 2], torque=[-w0, -w0, -c * w0, -c * w0])
            scene = rod(fx.Motor(joint=1, table=table), FAINT)
            sol, of_sums = late(method, scene, w0, (start, start + 2))
            rate = -w0 * (c * (start + 2 - after) + (1 + c) / 2 * (after - jump))
            jumped = abs((1 - c) * w0)  # = slope times duration
            assert abs(sol.qd[-1, 0] - rate) <= jumped * of_time + of_sums


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("start", [1e3, 1e6, -1e6])
def test_knots_late_in_time_are_landed_on_as_well(start: float, method: str) -> None:
    """The motion of the first test, with rates w0 times as large: it turns by 5/6 w0."""
    of_time = rounding.of_late_times(method, start)
    for w0 in np.random.default_rng(6).uniform(0.5, 5, 50):
        table = fx.Table(t=start + np.arange(4), torque=[-w0, -w0, w0, w0])
        scene = rod(fx.Motor(joint=1, table=table), FAINT)
        sol, of_sums = late(method, scene, w0, (start, start + 3))
        impulse = 2 * w0 * of_time  # along the slope of 2 w0, a second long, and two before the end
        off = np.abs(sol.y[:, -1] - [5 / 6 * w0, w0])
        assert (off <= [2 * impulse + of_sums, impulse + of_sums]).all()


def test_a_torque_that_meets_its_limit_at_a_knot_of_another_is_followed_by_both() -> None:
    """2 sin(pi t/6) meets 1 at t = 1 and t = 5, which are knots of the table.

    Its impulse is 12 (1 - cos(pi/6))/pi until 1 and after 5, and 4 between; the table's is -1, 0
    and 1.
    """
    torque = fx.Sinusoid(amplitude=2.0, angular_frequency=np.pi / 6)
    table = fx.Table(t=[0, 1, 5, 6], torque=[-1, -1, 1, 1])
    motors = fx.Motor(joint=1, sinusoid=torque, limit=1.0), fx.Motor(joint=1, table=table)
    arc = 12 * (1 - np.cos(np.pi / 6)) / np.pi
    there = solve(rod(*motors), 0, 0, 5, rtol=1e-11)
    assert_sound(there, 5)
    assert there.qd[-1, 0] == pytest.approx(arc - 1 + 4, rel=1e-10)
    on = there.resume(6, max_steps=10_000)
    assert_sound(on, 6)
    assert on.qd[-1, 0] == pytest.approx(arc - 1 + 4 + arc + 1, rel=1e-10)


@pytest.mark.parametrize("links", [2, 3])
def test_joints_that_all_reverse_at_once_retrace_their_way(links: int) -> None:
    """Thrown up so that it is at rest after 1 s, a chain is back after another, the same way."""
    joints = range(1, links + 1)
    faint = [fx.ViscousJoint(joint=joint, damping=0.0, damping2=1e-30) for joint in joints]
    scene = rod(*faint, gravity=9.81, links=links)
    fallen = solve(scene, np.linspace(0.3, 1.0, links), 0, 1, rtol=1e-12)
    assert_sound(fallen, 1)
    thrown = solve(scene, fallen.q[-1], -fallen.qd[-1], 2, rtol=1e-12)
    assert_sound(thrown, 2)
    np.testing.assert_allclose(thrown(1)[:links], fallen.q[0], atol=1e-8)
    np.testing.assert_allclose(thrown.q[-1], fallen.q[-1], atol=1e-7)
    np.testing.assert_allclose(thrown.qd[-1], fallen.qd[-1], atol=1e-7)


# At an end of the run ---------------------------------------------------------------------------


@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
def test_a_reversal_at_the_end_is_where_the_run_ends_and_goes_on_from(rtol: float) -> None:
    """Slowed by w0/T the rod has turned by w0 T/2 at T, and is back at 2 T."""
    random = np.random.default_rng(2)
    for w0, t_end in random.uniform(0.1, 10, (200, 2)):
        motor = fx.Motor(joint=1, constant=-w0 / t_end)
        sol = solve(rod(motor, FAINT), 0, w0, t_end, rtol=rtol)
        assert_sound(sol, t_end)
        np.testing.assert_allclose(sol.y[:, -1], [w0 * t_end / 2, 0], rtol=1e-12, atol=1e-13 * w0)
        on = sol.resume(2 * t_end, max_steps=10_000)
        assert_sound(on, 2 * t_end)
        np.testing.assert_allclose(on.y[:, -1], [0, -w0], rtol=1e-12, atol=1e-12 * w0 * t_end)


def test_a_reversal_at_the_end_of_a_run_backward_is_where_it_ends() -> None:
    """The same motion, from where it is -w0 fast to where it reverses."""
    random = np.random.default_rng(3)
    for w0, t_end in random.uniform(0.1, 10, (200, 2)):
        scene = rod(fx.Motor(joint=1, constant=-w0 / t_end), FAINT)
        sol = pc.simulate(scene, q0=0, qd0=-w0, t_span=(2 * t_end, t_end), max_steps=10_000)
        assert (sol.status, sol.t[-1]) == ("finished", t_end), sol.message
        assert (np.diff(sol.t) < 0).all()
        np.testing.assert_allclose(sol.y[:, -1], [w0 * t_end / 2, 0], rtol=1e-12, atol=1e-13 * w0)
        np.testing.assert_array_equal(pickle.loads(pickle.dumps(sol)).y, sol.y)


def test_an_end_or_a_start_a_few_bits_from_a_reversal_is_met() -> None:
    """Torque -w0/T until T, then rising: the end lies some bits before, at or after T."""
    random = np.random.default_rng(10)
    for w0, knot in random.uniform(0.1, 10, (60, 2)):
        table = fx.Table(t=[0, knot, knot + 1], torque=[-w0 / knot, -w0 / knot, 1])
        for motor in (fx.Motor(joint=1, table=table), fx.Motor(joint=1, constant=-w0 / knot)):
            for bits in range(-5, 6):
                t_end = bits_on(knot, bits)
                assert_sound(solve(rod(motor, FAINT), 0, w0, t_end), t_end)
        rising = fx.Motor(joint=1, table=fx.Table(t=[0, knot, knot + 1], torque=[-w0, -w0, w0]))
        for bits in range(-5, 6):
            span = bits_on(knot, bits), knot + 1
            sol = pc.simulate(rod(rising, FAINT), q0=0, qd0=0, t_span=span, max_steps=10_000)
            assert (sol.status, sol.t[-1]) == ("finished", knot + 1), sol.message
            assert (np.diff(sol.t) > 0).all()
            assert abs(sol.qd[-1, 0]) < 1e-12 * w0 * (1 + knot)  # as much forth as back


def test_a_torque_that_meets_its_limit_at_the_end_of_the_run() -> None:
    """2 sin(w t) meets 1 at t = pi/(6 w); its impulse until then is 2 (1 - cos(pi/6))/w."""
    random = np.random.default_rng(5)
    for w in random.uniform(0.1, 10, 100):
        torque = fx.Sinusoid(amplitude=2.0, angular_frequency=w)
        motor = fx.Motor(joint=1, sinusoid=torque, limit=1.0)
        t_end = np.pi / 6 / w
        sol = solve(rod(motor), 0, 0, t_end, rtol=1e-11)
        assert_sound(sol, t_end)
        assert sol.qd[-1, 0] == pytest.approx(2 * (1 - np.cos(np.pi / 6)) / w, rel=1e-9)


def test_a_rod_that_starts_where_it_reverses_is_damped_as_it_goes() -> None:
    """From rest, w' = -(1 - w^2) gives w = -tanh(t); before, w' = -(1 + w^2) and w = -tan(t)."""
    scene = rod(fx.Motor(joint=1, constant=-1.0), fx.ViscousJoint(1, damping=0.0, damping2=1.0))
    sol = solve(scene, 0, 0, 2, rtol=1e-11)
    assert_sound(sol, 2)
    assert sol.qd[-1, 0] == pytest.approx(-np.tanh(2), rel=1e-9)
    before = pc.simulate(scene, q0=0, qd0=0, t_span=(0, -1), rtol=1e-11, max_steps=10_000)
    assert before.status == "finished"
    assert before.qd[-1, 0] == pytest.approx(np.tan(1), rel=1e-9)


def test_a_run_across_knots_limits_and_reversals_goes_on_bitwise_from_anywhere() -> None:
    table = fx.Table(t=[0, 0.5, 1, 2, 3], torque=[-1, 2, -2, 1, 1])
    wave = fx.Sinusoid(amplitude=2.0, angular_frequency=5.0)
    motors = fx.Motor(joint=1, table=table), fx.Motor(joint=1, sinusoid=wave, limit=1.0)
    scene = rod(*motors, fx.ViscousJoint(joint=1, damping=0.1, damping2=0.3), gravity=9.81)
    whole = solve(scene, 0.3, 0, 3)
    assert_sound(whole, 3)
    for t_end in [*np.random.default_rng(11).uniform(0, 3, 50), *whole.t[1:-1]]:
        on = solve(scene, 0.3, 0, t_end).resume(3, max_steps=10_000)
        np.testing.assert_array_equal(on.t, whole.t)
        np.testing.assert_array_equal(on.y, whole.y)
