"""A step that lands where a law changes goes on with the right law, whatever else is there.

One uniform rod of mass 3 and length 1 on a fixed pivot without gravity, unless a test says
otherwise: its moment of inertia about the pivot is 1, so that torques are accelerations. FAINT is a
damping that turns with the sign of the rate, and is too weak to be seen in any digit: reversals
are points where the law changes, and the motion is what it is without it.

A run that has lost its end would go on for ever: max_steps ends it.
"""

from __future__ import annotations

import pickle
from typing import Any, NamedTuple

import numpy as np
import pendcore as pc
import pytest
from numpy import log, pi, sqrt
from pendcore import effects as fx
from reference import rounding
from unit_rods import rod, solve

FAINT = fx.ViscousJoint(joint=1, damping=0.0, damping2=1e-30)
BESIDE = fx.ViscousJoint(joint=1, damping=0.0, damping2=1.0)
RUBBED = fx.DryJointFriction(joint=1, coulomb=0.5)


def by_table(t, torque):
    return fx.Motor(joint=1, table=fx.Table(t=t, torque=torque))


def steady(torque):
    return fx.Motor(joint=1, constant=torque)


def clipped(w):
    """2 sin(w t), from pi/(6 w) on at its limit, 1."""
    return fx.Motor(joint=1, sinusoid=fx.Sinusoid(2.0, angular_frequency=w), limit=1.0)


def assert_sound(sol, span):
    """It ends where it was to, its times go one way, and its pickle is the same."""
    assert (sol.status, sol.t[-1]) == ("finished", span[1]), sol.message
    assert (np.diff(sol.t) * np.sign(span[1] - span[0]) > 0).all()
    again = pickle.loads(pickle.dumps(sol))
    np.testing.assert_array_equal(again.y, sol.y)
    times = np.linspace(*span, 20)
    np.testing.assert_array_equal(again(times), sol(times))


# Scenes with their ends -------------------------------------------------------------------------


class Way(NamedTuple):
    """From angle 0 and rate w0 at the start of the span to angle and rate at its end."""

    effects: list[Any]
    w0: float
    span: tuple[float, float]
    end: tuple[float, float]


def through_a_knot(w0, knot, c, faint=FAINT):
    """Torque -w0/knot until the knot, where the rod turns, up to c over 1 s, then c for 1 s.

    With a = w0/knot the rate is -a s + (a + c) s^2/2 for a second, to (c - a)/2, and c s more.
    """
    a = w0 / knot
    table = by_table([0, knot, knot + 1, knot + 2], [-a, -a, c, c])
    turned = w0 * knot / 2 + (-a / 2 + (a + c) / 6) + (c - a) / 2 + c / 2
    return Way([table, faint] if faint else [table], w0, (0, knot + 2), (turned, (c - a) / 2 + c))


def rubbed_through_a_knot(knot, a, share):
    """Torque -a until the knot, down to -2 a over 1 s, against friction: -(a - tc) s - a s^2/2."""
    tc = (0.1 + 0.08 * (share - 0.1)) * a
    effects = [by_table([0, knot, knot + 1], [-a, -a, -2 * a]), fx.DryJointFriction(1, coulomb=tc)]
    w0 = (a + tc) * knot
    end = w0 * knot / 2 - (a - tc) / 2 - a / 6, -(a - tc) - a / 2
    return Way(effects, w0, (0, knot + 1), end)


def to_its_reversal(w0, t_end):
    return Way([steady(-w0 / t_end), FAINT], w0, (0, t_end), (w0 * t_end / 2, 0.0))


def back_to_its_reversal(w0, t_end):
    return Way([steady(-w0 / t_end), FAINT], -w0, (2 * t_end, t_end), (w0 * t_end / 2, 0.0))


def to_its_limit(w):
    t_end = pi / 6 / w
    return Way([clipped(w)], 0.0, (0, t_end), ((pi / 3 - 1) / w**2, 2 * (1 - np.cos(pi / 6)) / w))


TURN = np.arctan(sqrt(2 / 3)) / sqrt(1.5)  # w' = -(1.5 + w^2) until there, then -(0.5 - w^2)
AFTER = sqrt(0.5) * (3 - TURN)
BOTH = log(2.5 / 1.5) / 2 - log(np.cosh(AFTER)), -sqrt(0.5) * np.tanh(AFTER)
TURNED = [steady(-1.0), RUBBED, BESIDE]
WAYS = {
    "friction and damping turn together": Way(TURNED, 1.0, (0, 3), BOTH),
    "damping and friction turn together": Way(TURNED[::-1], 1.0, (0, 3), BOTH),
    "from a reversal": Way(
        [steady(-1.0), BESIDE], 0.0, (0, 2), (-log(np.cosh(2)), -np.tanh(2))
    ),
    "from a reversal backward": Way(
        [steady(-1.0), BESIDE], 0.0, (0, -1), (log(np.cos(1)), np.tan(1))
    ),
}  # fmt: skip


@pytest.mark.parametrize("way", WAYS)
def test_a_rod_goes_on_beyond_its_reversal_with_the_law_of_the_other_side(way):
    effects, w0, span, end = WAYS[way]
    sol = pc.simulate(rod(*effects), span, 0, w0, rtol=1e-11, max_steps=10_000)
    assert_sound(sol, span)
    np.testing.assert_allclose(sol.y[:, -1], end, rtol=1e-9)
    if "together" in way:
        assert np.abs(sol.t - TURN).min() < 1e-10


DRAWN = {  # the way from numbers within 0.1 to 10, how many there are, rtol of the run, tolerance
    "through a knot": (through_a_knot, 3, [1e-3, 1e-9], 1e-11),
    "through a knot, nothing else": (
        lambda *x: through_a_knot(*x, faint=None), 3, [1e-3, 1e-9], 1e-11
    ),
    "reversing at two knots": (
        lambda w0, knot: through_a_knot(w0, knot, w0 / knot), 2, [1e-3, 1e-6, 1e-9, 1e-12], 1e-11
    ),
    "through a knot with friction": (rubbed_through_a_knot, 3, [1e-9], 1e-10),
    "to a reversal": (to_its_reversal, 2, [1e-3, 1e-9], 1e-12),
    "back to a reversal": (back_to_its_reversal, 2, [1e-9], 1e-12),
    "to a limit": (to_its_limit, 1, [1e-11], 1e-9),
}  # fmt: skip


@pytest.mark.parametrize("ways", DRAWN)
def test_a_reversal_at_a_knot_or_an_end_to_the_last_bits_is_passed_or_met(ways):
    way, count, tolerances, within = DRAWN[ways]
    for numbers in np.random.default_rng(1).uniform(0.1, 10, (200, count)):
        effects, w0, span, end = way(*numbers)
        absolute = within if "knot" in ways else within * abs(w0) / 10
        for rtol in tolerances:
            sol = pc.simulate(rod(*effects), span, 0, w0, rtol=rtol, max_steps=10_000)
            assert_sound(sol, span)
            np.testing.assert_allclose(sol.y[:, -1], end, rtol=within, atol=absolute)
            if ways == "to a reversal":
                on = sol.resume(2 * span[1], max_steps=10_000)
                assert_sound(on, (0, 2 * span[1]))
                last = [0, -w0]
                np.testing.assert_allclose(on.y[:, -1], last, rtol=1e-12, atol=1e-12 * w0 * span[1])


# Late and a few bits away -----------------------------------------------------------------------


def bits_on(t, bits):
    """Return the time that is `bits` last bits later."""
    return float(t + bits * np.spacing(abs(t)))


def late(method, scene, w0, span):
    """A run, and a bound of the rounding of its state in the steps' sums; torques are up to w0."""
    sol = pc.simulate(scene, span, 0, w0, method=method, max_steps=10_000)
    assert_sound(sol, span)
    stages = rounding.of_new_state(method) * abs(w0) * (span[1] - span[0])
    return sol, sol.stats.accepted * rounding.U * float(np.abs(sol.y).max()) + stages


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("bits", [1, 2, 4, 16, 10**6])
@pytest.mark.parametrize("start", [0.0, 7.0, -1e3, 1e6])
def test_a_jump_of_the_torque_where_the_rod_reverses_is_a_jump(start, bits, method):
    """Stopped by -w0 within a second, it goes on with -c w0: two knots a few bits apart.

    So its rate after another second is -c w0, but for the time between the two knots.
    """
    jump = start + 1
    after = bits_on(jump, bits)
    of_time = rounding.of_late_times(method, jump)
    for w0 in (1.0, -1.0, 0.7, 3.3):
        for c in (1.0, 0.3, 0.0, -1.0):
            torque = [-w0, -w0, -c * w0, -c * w0]
            scene = rod(by_table([start, jump, after, start + 2], torque), FAINT)
            sol, of_sums = late(method, scene, w0, (start, start + 2))
            rate = -w0 * (c * (start + 2 - after) + (1 + c) / 2 * (after - jump))
            jumped = abs((1 - c) * w0)  # = slope times duration
            assert abs(sol.qd[-1, 0] - rate) <= jumped * of_time + of_sums


@pytest.mark.parametrize("method", ["dopri5", "dop853"])
@pytest.mark.parametrize("start", [1e3, 1e6, -1e6])
def test_knots_late_in_time_are_landed_on_as_well(start, method):
    """The rod that reverses at two knots, with rates w0 times as large: it turns by 5/6 w0."""
    of_time = rounding.of_late_times(method, start)
    for w0 in np.random.default_rng(6).uniform(0.5, 5, 50):
        scene = rod(by_table(start + np.arange(4), [-w0, -w0, w0, w0]), FAINT)
        sol, of_sums = late(method, scene, w0, (start, start + 3))
        impulse = 2 * w0 * of_time  # along the slope of 2 w0, a second long, and two before the end
        off = np.abs(sol.y[:, -1] - [5 / 6 * w0, w0])
        assert (off <= [2 * impulse + of_sums, impulse + of_sums]).all()


def test_an_end_or_a_start_a_few_bits_from_a_reversal_is_met():
    """Torque -w0/T until T, then rising: the end lies some bits before, at or after T."""
    for w0, knot in np.random.default_rng(10).uniform(0.1, 10, (60, 2)):
        slowing = by_table([0, knot, knot + 1], [-w0 / knot, -w0 / knot, 1])
        rising = rod(by_table([0, knot, knot + 1], [-w0, -w0, w0]), FAINT)
        for t in (bits_on(knot, bits) for bits in range(-5, 6)):
            for motor in (slowing, steady(-w0 / knot)):
                assert_sound(solve(rod(motor, FAINT), 0, w0, t), (0, t))
            sol = pc.simulate(rising, (t, knot + 1), 0, max_steps=10_000)
            assert_sound(sol, (t, knot + 1))
            assert abs(sol.qd[-1, 0]) < 1e-12 * w0 * (1 + knot)  # as much forth as back


# Several laws -----------------------------------------------------------------------------------


def test_a_torque_that_meets_its_limit_at_a_knot_of_another_is_followed_by_both():
    """2 sin(pi t/6) meets 1 at t = 1 and t = 5, which are knots of the table.

    Its impulse is 12 (1 - cos(pi/6))/pi until 1 and after 5, and 4 between; the table's is -1, 0
    and 1.
    """
    motors = clipped(pi / 6), by_table([0, 1, 5, 6], [-1, -1, 1, 1])
    arc = 12 * (1 - np.cos(pi / 6)) / pi
    there = solve(rod(*motors), 0, 0, 5, rtol=1e-11)
    assert_sound(there, (0, 5))
    assert there.qd[-1, 0] == pytest.approx(arc - 1 + 4, rel=1e-10)
    on = there.resume(6, max_steps=10_000)
    assert_sound(on, (0, 6))
    assert on.qd[-1, 0] == pytest.approx(arc - 1 + 4 + arc + 1, rel=1e-10)


@pytest.mark.parametrize("links", [2, 3])
def test_joints_that_all_reverse_at_once_retrace_their_way(links):
    """Thrown up so that it is at rest after 1 s, a chain is back after another, the same way."""
    faint = [fx.ViscousJoint(joint=j, damping=0.0, damping2=1e-30) for j in range(1, links + 1)]
    scene = rod(*faint, gravity=9.81, links=links)
    fallen = solve(scene, np.linspace(0.3, 1.0, links), 0, 1, rtol=1e-12)
    assert_sound(fallen, (0, 1))
    thrown = solve(scene, fallen.q[-1], -fallen.qd[-1], 2, rtol=1e-12)
    assert_sound(thrown, (0, 2))
    np.testing.assert_allclose(thrown(1)[:links], fallen.q[0], atol=1e-8)
    np.testing.assert_allclose(thrown.y[:, -1], fallen.y[:, -1], atol=1e-7)


@pytest.mark.parametrize("after", [-40.0, -10.0, 20.0, 40.0])
def test_a_jump_of_the_load_lets_a_held_joint_go(after):
    """The run goes on as one does that begins there, even if the load falls off again at once."""
    dry, torque = fx.DryJointFriction(joint=2, coulomb=2.3), [4.4, 4.4, after, after]
    scene = pc.Scene.textbook().replace(effects=[dry, by_table([0, 0.05, 0.05, 1], torque)])
    start, exactly = ([2.84, 2.66], [2.6, 2.6]), {"rtol": 1e-10, "atol": 1e-12}
    till_then = pc.simulate(scene, (0, 0.05), *start, **exactly)
    assert till_then.qd[-1, 0] == till_then.qd[-1, 1]  # held
    there = till_then.q[-1], till_then.qd[-1]
    from_then = scene.replace(effects=[dry, steady(after)])
    on = pc.simulate(from_then, (0.05, 0.15), *there, **exactly)
    assert abs(on.qd[-1, 0] - on.qd[-1, 1]) > 0.1
    through = pc.simulate(scene, (0, 0.15), *start, **exactly)
    np.testing.assert_allclose(through.y[:, -1], on.y[:, -1], rtol=0, atol=1e-8)
