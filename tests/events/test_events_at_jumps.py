"""Where the state jumps or stays (impacts, bounces, stick), events tell both states, once each."""

from __future__ import annotations

import mpmath
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from turning_rod import directions, times
from unit_rods import rod

inf = np.inf


def dropped(e):
    """A rod of inertia 1 falls with -2 from 0.4 to its stop at 0."""
    stop = fx.JointStop(joint=1, range=(0.0, inf), restitution=e, capture_speed=1e-3)
    return rod(fx.Motor(joint=1, constant=-2.0), stop)


FALL, SPEED = np.sqrt(0.4), 2 * np.sqrt(0.4)


# Impacts ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("store", ["steps", "dense"])
def test_each_bounce_is_an_event_with_the_states_on_both_sides(store, fine):
    """The rate passes zero by a jump, from -w to e w without a value between."""
    e = 0.8
    watched = [ev.JointAngle(joint=1, value=0.0), ev.RateZero(joint=1, direction=1)]
    sol = pc.simulate(dropped(e), (0, 3.0), 0.4, events=watched, store=store, **fine)
    touches, turns = sol.events
    twice = np.flatnonzero(np.diff(sol.t) == 0.0)
    assert times(touches) == times(turns) == [*sol.t[twice]]
    flights = FALL + 2 * FALL * np.cumsum([0.0, *e ** np.arange(1, len(touches))])
    assert times(touches) == pytest.approx(flights, rel=1e-11)
    assert touches[0].t == pytest.approx(FALL, rel=1e-12)
    for k, row in enumerate(twice):
        speed = SPEED * e**k
        for one in (touches[k], turns[k]):
            np.testing.assert_allclose(one.y_before, [0, -speed], rtol=1e-9, atol=1e-13)
            np.testing.assert_allclose(one.y_after, [0, e * speed], rtol=1e-9, atol=1e-13)
            np.testing.assert_array_equal(one.y, one.y_after)
            np.testing.assert_array_equal(sol.y[:, row : row + 2].T, [one.y_before, one.y_after])
            if store == "dense":
                np.testing.assert_array_equal(sol(one.t), one.y_after)


@pytest.mark.few_cases
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("joint", [2, 3])
def test_a_mark_at_the_very_angle_of_a_stop_is_met_once_an_impact(joint, e, method):
    """The angle of such a joint is a difference, and its last bits are not the stop's."""
    impacts = 0
    for bound in 0.3 + 0.07 * np.arange(12):
        stop = fx.JointStop(joint=joint, range=(-bound, bound), restitution=e)
        scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * joint, effects=[stop])
        marks = [ev.JointAngle(joint, side * bound, direction=side) for side in (1, -1)]
        rates = [0.0] * (joint - 1) + [3.0]
        sol = pc.simulate(scene, (0, 2), 0.3, rates, events=marks, method=method, rtol=1e-8)
        found = sorted((one.t, one.direction) for some in sol.events for one in some)
        struck = np.flatnonzero(np.diff(sol.t) == 0)
        turned = sol.q[struck, joint - 1] - sol.q[struck, joint - 2]
        assert found == [*zip(sol.t[struck], np.sign(turned), strict=True)], f"bound {bound}"
        for one in (one for some in sol.events for one in some):
            assert (one.y_before[joint:] != one.y_after[joint:]).any()
        impacts += len(struck)
    assert impacts > 12


def test_a_terminal_event_at_an_impact_ends_there_and_goes_on_after_it():
    end = ev.RateZero(joint=1, direction=1, terminal=True)
    sol = pc.simulate(dropped(0.5), (0, 3), 0.4, events=[end])
    assert sol.status == "event"
    assert sol.t[-1] == pytest.approx(FALL, rel=1e-12)
    whole = pc.simulate(dropped(0.5), (0, 3), 0.4)
    for _ in range(100):
        if sol.status != "event":
            break
        sol = sol.resume(3)
    assert sol.status == whole.status
    np.testing.assert_array_equal(sol.t, whole.t)
    np.testing.assert_array_equal(sol.y, whole.y)


def test_a_terminal_event_by_an_impact_at_the_start_ends_the_run_there():
    scene = rod(fx.JointStop(joint=1, range=(-3, 1), restitution=0.5))
    sol = pc.simulate(scene, (0, 2), 1.0, 2.0, events=[ev.RateZero(joint=1, terminal=True)])
    assert (sol.status, sol.t[-1]) == ("event", 0.0)


@pytest.mark.parametrize("apart", [1e-10, -1e-10])
def test_a_run_cut_between_two_impacts_at_one_time_finds_what_the_whole_one_does(apart, fine):
    """Both stops are reached within the last bits of t = 1e6 s, so at one time, blow by blow."""
    t0, start, free = 1e6, ([0.3, 0.9], [1.0, 4.0]), rod(links=2)
    q1, q2 = pc.simulate(free, (0, 0.05), *start, **fine).q[-1]
    bounds = list(enumerate([q1, q2 - q1 + apart], start=1))
    stops = [fx.JointStop(joint=j, range=(-inf, x), restitution=0.5) for j, x in bounds]
    watched = [
        *(ev.JointAngle(joint=j, value=x) for j, x in bounds),
        *(ev.RateZero(joint=j) for j in (1, 2)),
        ev.Function(lambda t, q, qd: float(q1 + 1e-3 * qd[0] - q[0] - 1e-3)),
    ]

    def run(t_end=t0 + 0.1, **how):
        scene = free.replace(effects=stops)
        return pc.simulate(scene, (t0, t_end), *start, events=watched, **fine, **how)

    def told(sol):
        return [
            (k, one.t, one.direction, *(y.tolist() for y in (one.y_before, one.y_after)))
            for k, some in enumerate(sol.events) for one in some if one.y_before is not None
        ]  # fmt: skip

    whole = run()
    struck = whole.t[:-1][np.diff(whole.t) == 0]
    assert len(struck) > len(set(struck)) == 1
    cut = [run(float(struck[0]))]
    while not cut[1:] or cut[-1].status == "max_steps":
        cut.append(run(max_steps=len(cut), on_failure="ignore"))
    assert any(np.count_nonzero(sol.t == struck[0]) == 2 for sol in cut)
    for sol in cut:
        longer = sol.resume(t0 + 0.1, max_steps=10_000)
        np.testing.assert_array_equal(longer.y, whole.y)
        assert told(longer) == told(whole)


def test_an_impact_that_changes_no_rate_is_no_jump():
    """The pivot's accelerations are beyond doubles, so no impulse is found and the rate stays."""
    shaken = fx.DrivenPivot(y=fx.Sinusoid(amplitude=1e200, angular_frequency=1e120))
    scene = rod(fx.JointStop(joint=1, range=(0.7, 2.5)), shaken)
    sol = pc.simulate(scene, (0, 1), 0.7, -4.0, max_steps=1, on_failure="ignore")
    assert [*sol.t] == [0.0]
    np.testing.assert_array_equal(sol.y[:, 0], [0.7, -4.0])


class Broken(Exception):
    pass


def test_a_function_that_raises_at_an_impact_at_the_start_leaves_a_run_that_goes_on():
    is_broken = True

    def f(t, q, qd):
        if is_broken:
            raise Broken
        return float(qd[0])

    watched = {"events": [ev.RateZero(joint=1), ev.Function(f)]}
    with pytest.raises(Broken) as caught:
        pc.simulate(dropped(0.5), (0, 0.9), 0.0, -1.0, **watched)
    sol = caught.value.solution
    assert sol.status == "callback_error"
    np.testing.assert_array_equal(sol.y, [[0.0], [-1.0]])
    is_broken = False
    longer, whole = sol.resume(0.9), pc.simulate(dropped(0.5), (0, 0.9), 0.0, -1.0, **watched)
    np.testing.assert_array_equal(longer.t, whole.t)
    np.testing.assert_array_equal(longer.y, whole.y)
    for one, other in zip(longer.events, whole.events, strict=True):
        assert times(one) == times(other)
        assert one[0].t == 0.0


def test_a_jump_over_more_turns_than_an_int_holds_ends_the_run_in_words():
    """A lock may move its joint by 1e-9 of its angle at the start: here by 1.4e10 turns."""
    hold = fx.Lock(joint=1, angle=1e20), fx.JointStop(joint=3, range=(0.0, 1.0))
    turns = ev.JointAngle(joint=1, value=0.0, every_turn=True)
    start = [1.0000000009e20, 0.0, 0.0], [0.0, 0.0, -1.0]
    scene = rod(*hold, links=3, gravity=9.807)
    sol = pc.simulate(scene, (0, 1), *start, events=[turns], on_failure="ignore")
    assert sol.status == "max_turns"
    assert not sol.events[0]


# Backward ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("sign", [1, -1])
def test_elastic_impacts_are_events_on_the_way_back_too(sign, fine):
    """The rod strikes after T = sqrt 0.4, 3 T, 5 T, ... and is highest after 2 T, 4 T, ...

    It passes 0.3 when T/2 from its highest points. Backward, it falls with a positive rate.
    """
    watched = [ev.JointAngle(1, 0.0), ev.RateZero(joint=1), ev.JointAngle(1, 0.3)]
    sol = pc.simulate(dropped(1.0), (0, sign * 6.2), 0.4, events=watched, **fine)
    touches, zeros, passed = sol.events
    assert times(touches) == pytest.approx(sign * FALL * np.arange(1, 10, 2), abs=1e-10)
    assert times(zeros) == pytest.approx(sign * FALL * np.arange(1, 10), abs=1e-10)
    assert times(passed) == pytest.approx(sign * FALL * np.arange(0.5, 10), abs=1e-10)
    for one in [*touches, *zeros[::2]]:
        np.testing.assert_allclose(one.y_before, [0, -sign * SPEED], atol=1e-9)
        np.testing.assert_allclose(one.y_after, [0, sign * SPEED], atol=1e-9)
    assert directions(touches) == [-1] * 5  # along the run
    assert directions(zeros) == [sign, -sign] * 4 + [sign]
    assert directions(passed) == [-1, 1] * 5
    assert all(one.y_before is one.y_after is None for one in zeros[1::2])


def test_what_elastic_impacts_of_a_chain_are_found_backward_is_found_of_its_mirror(fine):
    stops = [fx.JointStop(joint=j, range=(-0.4, 0.3), restitution=1.0) for j in (2, 3)]
    scene = rod(*stops, links=3, gravity=9.81)
    watched = [
        *(ev.JointAngle(joint=2, value=x) for x in (-0.4, 0.1, 0.3)),
        ev.TipLine(point=(0.3, 1.0), normal=(1.0, 0.2)),
        ev.RateZero(joint=3),
    ]
    q, qd = [1.0, 1.1, 1.2], np.array([0.5, 2.0, -3.0])
    forward, backward = (
        pc.simulate(scene, (0, sign * 3.0), q, sign * qd, events=watched, **fine)
        for sign in (1, -1)
    )
    turned, jumps = np.array([1.0] * 3 + [-1.0] * 3), 0
    for k, (there, back) in enumerate(zip(forward.events, backward.events, strict=True)):
        assert len(there) == len(back) > 0
        for one, other in zip(there, back, strict=True):
            assert (other.t, other.direction) == (-one.t, one.direction * (-1 if k == 4 else 1))
            assert (other.y_before is None) == (one.y_before is None)
            np.testing.assert_array_equal(other.y, one.y * turned)
            if one.y_before is not None:
                jumps += 1
                np.testing.assert_array_equal(other.y_before, one.y_before * turned)
                np.testing.assert_array_equal(other.y_after, one.y_after * turned)
    assert jumps > 10


# Stick and contact ------------------------------------------------------------------------------


@pytest.mark.parametrize("rtol", [1e-5, 1e-8, 1e-11, 1e-12])
def test_entering_stick_is_one_rate_zero_in_a_run_that_goes_on(rtol, method):
    """Under 3 sin(t), with friction 1.5, the rod slides up from asin 0.5, sticks, slides down."""
    motor = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=3.0, angular_frequency=1.0))
    scene, zero = rod(fx.DryJointFriction(joint=1, coulomb=1.5), motor), ev.RateZero(joint=1)
    sol = pc.simulate(scene, (0, 20), 0.0, events=[zero], method=method, rtol=rtol)
    stops = sol.t[1:][(sol.qd[1:, 0] == 0.0) & (sol.qd[:-1, 0] != 0.0)]
    assert len(stops) >= 5
    assert times(sol.events[0]) == [*stops]
    assert all(found.qd[0] == 0.0 for found in sol.events[0])


@pytest.mark.few_cases
def test_leaving_a_contact_is_no_rate_zero_and_coming_into_it_is_one(fine):
    """A rod of inertia 1 under -(sin t + 0.2) leaves a plastic stop where sin t = -0.2."""
    push = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=-1.0, angular_frequency=1.0))
    lean = fx.Motor(joint=1, constant=-0.2)
    watched = [ev.RateZero(joint=1), ev.JointAngle(joint=1, value=0.0)]
    off = np.pi + np.arcsin(0.2)

    def rate(t):
        return mpmath.cos(t) - mpmath.cos(off) - 0.2 * (t - off)

    turns = [float(mpmath.findroot(rate, near)) for near in (7.9, 11.8, 12.9)]
    back = float(mpmath.findroot(lambda t: mpmath.quad(rate, [off, t]), 14.2))
    scene = rod(push, lean, fx.JointStop(joint=1, range=(0.0, inf)))
    sol = pc.simulate(scene, (0, 20), 0.0, events=watched, **fine)
    assert sol.qd[-1, 0] > 0.1  # the rod left again, one turn of the push after the first time
    rests, touches = sol.events
    assert times(rests) == pytest.approx([*turns, back], abs=1e-10)
    assert directions(rests) == [-1, 1, -1, 1]
    assert times(touches) == [rests[-1].t]
    assert touches[0].y_after.tolist() == [0.0, 0.0]


@pytest.mark.few_cases
@pytest.mark.parametrize("held_by", ["a stop", "friction"])
@pytest.mark.parametrize("joint", [1, 2])
def test_what_is_let_go_sets_out_one_way_at_ordinary_tolerances_too(joint, held_by, method):
    """A fine run says how often the joint turns; a mark at its stop is met once per impact."""
    middle = np.pi / 2 if joint == 1 else 0.0
    hum = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=20.0, angular_frequency=2.0))
    for bound in np.linspace(0.1, 0.9, 9):
        ends = (middle - bound, middle + bound)
        hold = fx.JointStop(joint=joint, range=ends)
        if held_by == "friction":
            hold = fx.DryJointFriction(joint=joint, coulomb=4.0 + 2.0 * bound)
        scene = rod(hold, hum, gravity=9.81, links=2)
        watched = [ev.RateZero(joint=joint), *(ev.JointAngle(joint=joint, value=x) for x in ends)]
        exact, *runs = (
            pc.simulate(scene, (0, 2), np.pi / 2, events=watched, method=method, rtol=rtol)
            for rtol in (1e-12, 1e-5, 1e-6, 1e-8)
        )
        for sol in runs:
            assert len(sol.events[0]) == len(exact.events[0]), f"bound {bound}"
            if held_by == "a stop":
                struck = sol.t[:-1][np.diff(sol.t) == 0]
                met = sorted(one.t for some in sol.events[1:] for one in some)
                assert met == [*struck], f"bound {bound}"


def test_rest_by_friction_is_found_once_and_a_terminal_event_ends_a_run_at_rest():
    scene = rod(fx.DryJointFriction(joint=1, coulomb=0.5))
    watched = [ev.RateZero(joint=1), ev.RateZero(link=1, direction=1)]
    watched += [ev.Function(lambda t, q, qd: t - 7.3, terminal=True)]
    sol = pc.simulate(scene, (0, 100), 0.0, 1.0, events=watched)
    assert times(sol.events[0]) == pytest.approx([2.0], abs=1e-14)
    assert sol.events[0][0].qd[0] == 0.0
    assert sol.events[1] == []
    assert sol.status == "event"
    assert sol.t[-1] == pytest.approx(7.3, abs=1e-12)
    assert sol.resume(100.0).status == "at_rest"


def test_a_joint_that_is_held_passes_no_mark_beside_its_angle():
    """Its links turn, and the last bits of their difference change."""
    at, q1 = 0.2138899652813533, 0.34787724978537016
    friction = fx.DryJointFriction(joint=2, coulomb=50.0)
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 2, effects=[friction])
    marks = [ev.JointAngle(joint=2, value=at + k * 1e-16) for k in range(-30, 31)]
    sol = pc.simulate(scene, (0, 3), [q1, q1 + at], [1.0, 1.0], events=marks)
    assert sol.success
    assert (sol.qd[:, 0] == sol.qd[:, 1]).all()
    assert [found for found in sol.events if found] == []
