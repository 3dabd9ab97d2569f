"""Events are found where they are, once each, by every method, forward and backward."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx
from pendcore import events as ev
from reference.rounding import of_dense_output, of_new_state
from swings import period_of, time_to
from turning_rod import directions, times, turning
from unit_rods import rod

METHODS = [method["name"] for method in _core.methods()]
BOOK = pc.Scene.textbook()
G = 9.81

# A torque of 2 N m turns the rod by the parabola q = w t + t^2, which every method has exactly.
TURNED = rod(fx.Motor(joint=1, constant=2.0))
RATES = [ev.RateZero(joint=1), ev.RateZero(link=1)]

# These are roundings of a step that moves by one, and of a dense output, whose weights in dop853
# are some hundreds.
STEPS = dict.fromkeys(["dop853", "dop853-radau5"], of_new_state("dop853"))
WITHIN_STEPS = dict.fromkeys(STEPS, of_dense_output("dop853"))


def parabola(span, step, method, *wanted):
    """Find events on q = t^2 - 1.5 t, which is least at t = 0.75."""
    t, how = span[0], {"method": method, "step": step, "events": wanted}
    sol = pc.simulate(TURNED, span, t * t - 1.5 * t, 2 * t - 1.5, **how)
    assert sol.success
    return sol


# In a step, at its ends, at the ends of the run -------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [2.0, 1.0, 0.5, 0.25, 0.3])
@pytest.mark.parametrize("backward", [False, True])
def test_roots_in_one_step_or_at_its_ends_are_found_once_each(method, step, backward):
    """The angle is -1/2 at 0.5 and 1: both in one step, each at the end of a step, or anywhere."""
    span = (2.0, 0.0) if backward else (0.0, 2.0)
    wanted = [ev.LinkAngle(1, -0.5), ev.JointAngle(1, -0.5), *RATES]
    wanted += [ev.Function(lambda t, q, qd: q[0] + 0.5, **how) for how in ({"samples": 16}, {})]
    normals = {1: [(np.sin(0.5), np.cos(0.5)), (-0.18, 1.0)], -1: [(-0.3, -0.2)]}
    point = (np.cos(0.5), -np.sin(0.5))
    wanted += [ev.TipLine(point, normal) for some in normals.values() for normal in some]
    first, second, joint, rate, own, usual, *tips = parabola(span, step, method, *wanted).events
    exact = [1.0, 0.5] if backward else [0.5, 1.0]
    fastest, there = 2.5, 0.5
    rounding = STEPS.get(method, 0.0) * 2.0 + WITHIN_STEPS.get(method, 0.0) * step
    last_bits = max(4e-15, rounding * fastest / there)
    for found in (first, second, own, usual):
        assert times(found) == pytest.approx(exact, abs=last_bits)
        assert directions(found) == [-1, 1]
        for one in found:
            assert one.q[0] == pytest.approx(-0.5, abs=2e-15)
            assert one.qd[0] == pytest.approx(2 * one.t - 1.5, abs=max(2e-15, 2 * rounding))
    for tip, side in zip(tips, (1, 1, -1), strict=True):
        assert times(tip) == pytest.approx(exact, abs=max(1e-14, last_bits))
        assert directions(tip) == [-side, side]
    assert times(rate) == times(joint) == pytest.approx([0.75], abs=max(1e-15, rounding))
    assert directions(rate) == [-1 if backward else 1]


CLOCKS = {
    "t0": (0.0, []),
    "a step's end": (0.5, [0.5]),
    "t_end": (2.0, [2.0]),
    "within": (0.625, [0.625]),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("zero", CLOCKS)
@pytest.mark.parametrize("direction", [-1, 0, 1])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_zero_that_lies_just_there(method, zero, direction, sense):
    """A zero at t0 is no event; one at the end of a step or run is one event, at that time."""
    at, found = CLOCKS[zero]
    clock = ev.Function(lambda t, q, qd: t - sense * at, direction=direction)
    sol = parabola((0.0, sense * 2.0), 0.5, method, clock)
    expected = found if direction in (0, sense) else []
    assert times(sol.events[0]) == [sense * t for t in expected]
    if zero != "within":
        assert all(np.array_equal(one.y, sol(one.t)) for one in sol.events[0])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [0.25, 0.3])
def test_an_angle_that_starts_at_its_value_is_an_event_when_it_comes_back(method, step):
    start = ev.LinkAngle(1, 0.0)
    sol = parabola((0.0, 2.0), step, method, start)
    assert times(sol.events[0]) == pytest.approx([1.5], abs=1e-14)
    stops = parabola((0.0, 2.0), step, method, start.replace(terminal=True))
    assert (stops.status, stops.t[-1]) == ("event", sol.events[0][0].t)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_mark_at_the_start_is_no_event_and_one_at_the_end_is_one(method, sign):
    """A rod turns at 1 rad/s; the marks at the end are where the run gets to, to the bit."""
    free, marks = turning(1, (0, sign), [], q0=0.2, method=method), []
    for angle, tip in zip(free.q[[0, -1], 0], free.positions()[[0, -1], -1], strict=True):
        marks += [ev.JointAngle(1, angle), ev.LinkAngle(1, angle), ev.TipLine(tip, (-0.18, 1.0))]
    sol = turning(1, (0, sign), marks, q0=0.2, method=method)
    assert [times(found) for found in sol.events] == [[]] * 3 + [[sign]] * 3
    assert {event.direction for found in sol.events for event in found} == {sign}
    once = [[]] * 3 + [pytest.approx([sign], abs=1e-14)] * 3
    again = turning(1, (0, sign * 1.5), marks, q0=0.2, method=method)
    for longer in (again, sol.resume(sign * 1.5)):
        assert [times(found) for found in longer.events] == once


def test_a_rate_that_is_zero_at_the_end_is_an_event(fine):
    """Friction stops the rod, to the bit, after 2 s; a step that ends there may be the last."""
    scene = rod(fx.DryJointFriction(joint=1, coulomb=0.5))
    whole = pc.simulate(scene, (0, 3), 0, 1, **fine)
    stopped = float(whole.t[np.flatnonzero(whole.qd[:, 0] == 0)[0]])
    assert stopped == pytest.approx(2.0, abs=1e-12)
    # two bits later, as a step cut where the rod is found to stop may end a bit of the rate before
    stopped += 2 * np.spacing(stopped)
    sol = pc.simulate(scene, (0, stopped), 0, 1, **fine, events=RATES)
    assert [times(found) for found in sol.events] == [[stopped]] * 2
    assert sol.events[0][0].y.tolist() == sol.y[:, -1].tolist()
    assert sol.qd[-1, 0] == 0.0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("store", ["dense", "steps", "end"])
def test_a_run_may_end_in_its_first_step(method, store):
    here = [ev.LinkAngle(1, 0.25, terminal=True)]
    sol = turning(0.5, (0, 10), here, method=method, step=1.0, store=store)
    assert (sol.status, sol.q[-1, 0]) == ("event", 0.25)
    assert sol.t[-1] == pytest.approx(0.5, rel=0, abs=WITHIN_STEPS.get(method, 0.0))
    assert sol.stats.accepted == 1
    assert len(sol.t) == (1 if store == "end" else 2)


def test_an_event_before_time_can_tell_ends_the_run_where_the_step_began():
    here = ev.LinkAngle(1, 1e-13, terminal=True)  # after 1e-18 s, and more than rounding away
    sol = turning(1e5, (1, 1.001), [here], step=1e-5)
    assert (sol.status, [*sol.t], len(sol.events[0])) == ("event", [1.0], 1)
    np.testing.assert_array_equal(sol(sol.t).T, sol.y.T)
    assert sol.resume(1.001).status == "finished"


# Touches ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [2.0, 1.0])
def test_a_touch_that_the_interpolant_proves_is_told_as_one(method, step):
    touch, clear = ev.LinkAngle(1, -0.5625), ev.LinkAngle(1, -0.5625 - 1e-13)
    sol = parabola((0.0, 2.0), step, method, touch, touch.replace(direction=1), clear)
    assert times(sol.events[0]) == pytest.approx([0.75], abs=1e-7)
    assert directions(sol.events[0]) == [0]
    assert sol.events[1:] == [[], []]


def test_a_tip_that_touches_a_line_is_told_as_touching(method):
    """The rod's tip is lowest, y = 1, at q = pi/2; the line just below is never reached."""
    lines = [ev.TipLine((0.0, 1.0 + gap), (0.0, 1.0)) for gap in (0.0, 1e-13, -1e-13)]
    touches, clear, crosses = turning(1.0, (0, 4), lines, method=method, step=4.0).events
    assert directions(touches) == [0]
    assert touches[0].t == pytest.approx(np.pi / 2, abs=1e-7)
    assert clear == []
    assert directions(crosses) == [1, -1]


def test_a_rod_at_rest_has_no_event():
    wanted = [
        ev.LinkAngle(1, 0.5), ev.RateZero(joint=1), ev.TipLine((np.cos(0.5), 0.0), (1.0, 0.0)),
        ev.Function(lambda t, q, qd: qd[0]),
    ]  # fmt: skip
    sol = pc.simulate(rod(links=2), (0, 100), 0.5, events=wanted)
    assert sol.success
    assert sol.events == [[]] * 4


# Swings -----------------------------------------------------------------------------------------


@pytest.mark.few_cases
@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("short", [1e-2, 1e-5, 1e-8, -1e-9])
def test_both_passages_of_a_mark_just_short_of_the_turn_are_found_in_every_swing(short, sign, fine):
    """At 1e-8 rad short of the turn the passages are 0.12 ms apart, in steps of tens of ms."""
    whole, first = float(period_of(1.0, G)), float(time_to(max(short, 0.0) - 1.0, 1.0, G))
    known = [n * whole + t for n in range(20) for t in (first, whole - first)]
    mark = ev.JointAngle(joint=1, value=np.pi / 2 - (1.0 - short))
    span = 0, sign * 20 * whole
    sol, without = (
        pc.simulate(rod(gravity=G), span, np.pi / 2 + 1.0, events=events, **fine)
        for events in ([mark], [])
    )
    assert sol.success
    found = sign * np.array(times(sol.events[0]))
    # an angle's error of 1e-10 is a time's of 1e-10/rate, and the rate is sqrt(2 short) or so
    np.testing.assert_allclose(found, known if short > 0 else [], atol=1e-10 / abs(short) ** 0.5)
    np.testing.assert_array_equal(sol.y, without.y)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_rod_swings_with_the_period_of_elliptic_integrals(sign, fine):
    """It is let go at rest, which is no event."""
    wanted = [ev.LinkAngle(1, np.pi / 2), *RATES, ev.TipLine((0.0, 0.0), (1.0, 0.0))]
    fine = fine | {"rtol": 1e-13, "atol": 1e-15}
    sol = pc.simulate(rod(gravity=G), (0, sign * 10), np.pi / 2 - 2.5, events=wanted, **fine)
    half, (through, turns, also, line) = float(period_of(2.5, G)) / 2, sol.events
    passed = half * (np.arange(int(10 / half + 0.5)) + 0.5)
    assert times(through) == pytest.approx(sign * passed, abs=2e-10)
    turned = half * (np.arange(int(10 / half)) + 1)
    assert times(turns) == times(also) == pytest.approx(sign * turned, abs=2e-10)
    assert times(line) == pytest.approx(times(through), abs=1e-14)
    assert directions(through)[:2] == [1, -1]
    assert len(set(directions(through)[::2])) == len(set(directions(through)[1::2])) == 1


@pytest.mark.parametrize("name", ["textbook", "textbook_long", "unequal", "three_links"])
def test_sections_are_where_the_multiple_precision_references_are(name, reference_case):
    """The run passes the angle that the reference has at a time, at that time."""
    case = reference_case(name)
    wanted, expected = [], []
    for k in range(1, len(case.t) - 1):
        if (np.abs(case.qd[k]) > 0.1).all():
            for i, (q, qd) in enumerate(zip(case.q[k], case.qd[k], strict=True), start=1):
                wanted.append(ev.LinkAngle(i, q, direction=int(np.sign(qd))))
                expected.append((case.t[k], case.q[k], case.qd[k]))
    scene, how = case.scene, {"rtol": 1e-14, "atol": 1e-15}
    sol = pc.simulate(scene, (0, case.t[-1]), case.q0, case.qd0, events=wanted, **how)
    assert len(expected) > 20
    for found, (t, q, qd) in zip(sol.events, expected, strict=True):
        nearest = min(found, key=lambda one: abs(one.t - t))
        assert nearest.t == pytest.approx(t, abs=1e-9)
        assert nearest.q == pytest.approx(q, abs=1e-8)
        assert nearest.qd == pytest.approx(qd, abs=1e-7)


# Order and number -------------------------------------------------------------------------------


@pytest.mark.parametrize("sense", [1, -1])
def test_events_a_hair_apart_come_in_their_order(sense):
    near = [ev.Function(lambda t, q, qd, at=at: t - sense * at) for at in (2e-8, 1e-8, 0.5 + 1e-8)]
    angle = ev.LinkAngle(1, sense * 0.5 * 1e-8)
    sol = turning(0.5, (0, sense), [*near, angle, angle], step=1.0)
    for found, t in zip(sol.events, (2e-8, 1e-8, 0.5 + 1e-8, 1e-8, 1e-8), strict=True):
        assert times(found) == pytest.approx([sense * t], abs=1e-16)
    assert times(sol.events[3]) == times(sol.events[4])


def test_simultaneous_events_are_all_found_and_the_first_that_was_asked_for_ends_the_run():
    here = ev.LinkAngle(1, 0.25)
    wanted = [here, here.replace(terminal=True, name="b"), here.replace(terminal=True, name="c")]
    sol = turning(0.5, (0, 1), [*wanted, here], method="dopri5", step=1.0)
    assert [times(found) for found in sol.events] == [[0.5]] * 4
    assert sol.message == "stopped at a terminal event (at t = 0.5 s: event 2 (link_angle, 'b'))"


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("direction", [0, 1, -1])
def test_a_run_ends_at_as_many_occurrences_in_the_direction_that_counts(count, direction):
    down = ev.LinkAngle(1, np.pi / 2, direction=direction)
    free, sol = (
        pc.simulate(BOOK, (0, 20), [0.8, 1.0], events=[event])
        for event in (down, down.replace(terminal=count))
    )
    assert sol.status == "event"
    assert sol.success
    assert times(sol.events[0]) == times(free.events[0])[:count]
    assert sol.t[-1] == sol.events[0][-1].t
    assert np.array_equal(sol.y[:, -1], sol.events[0][-1].y)
    assert set(directions(sol.events[0])) <= ({direction} if direction else {1, -1})
