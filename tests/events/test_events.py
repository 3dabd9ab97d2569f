"""Events are found where they are, once each, by every method, forward and backward."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import events as ev
from reference.rounding import of_dense_output, of_new_state
from unit_rods import rod

METHODS = [method["name"] for method in _core.methods()]
BOOK = pc.Scene.textbook()

# A torque of 2 N m turns the rod by the parabola q = w t + t^2, which every method has exactly.
TURNED = rod(pc.effects.Motor(joint=1, constant=2.0))


# These are roundings of a step that moves by one, and of a dense output, whose weights in dop853
# are some hundreds.
STEPS = dict.fromkeys(["dop853", "dop853-radau5"], of_new_state("dop853"))
WITHIN_STEPS = dict.fromkeys(STEPS, of_dense_output("dop853"))


def times(found: list[ev.Found]) -> list[float]:
    return [one.t for one in found]


def parabola(t_0: float, t_end: float, step: float, method: str, *wanted: ev.Event) -> Any:
    """Find events on q = t^2 - 1.5 t, which is least at t = 0.75."""
    q, rate = t_0 * t_0 - 1.5 * t_0, 2 * t_0 - 1.5
    sol = pc.simulate(
        TURNED, q0=q, qd0=rate, t_span=(t_0, t_end), method=method, step=step, events=wanted
    )
    assert sol.success
    return sol


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [2.0, 1.0, 0.5, 0.25, 0.3])
@pytest.mark.parametrize("backward", [False, True])
def test_roots_in_one_step_or_at_its_ends_are_found_once_each(
    method: str, step: float, backward: bool
) -> None:
    """The angle is -1/2 at 0.5 and 1: both in one step, each at the end of a step, or anywhere."""
    span = (2.0, 0.0) if backward else (0.0, 2.0)
    wanted = [ev.LinkAngle(1, -0.5), ev.JointAngle(1, -0.5), ev.RateZero(link=1)]
    wanted += [ev.Function(lambda t, q, qd: q[0] + 0.5, samples=16), ev.RateZero(joint=1)]
    sol = parabola(*span, step, method, *wanted)
    first, second, rate, own, joint = sol.events
    exact = [1.0, 0.5] if backward else [0.5, 1.0]
    fastest, there = 2.5, 0.5
    rounding = STEPS.get(method, 0.0) * 2.0 + WITHIN_STEPS.get(method, 0.0) * step
    last_bits = max(4e-15, rounding * fastest / there)
    for found in (first, second, own):
        assert times(found) == pytest.approx(exact, abs=last_bits)
        assert [one.direction for one in found] == [-1, 1]
        for one in found:
            assert one.q[0] == pytest.approx(-0.5, abs=2e-15)
            assert one.qd[0] == pytest.approx(2 * one.t - 1.5, abs=max(2e-15, 2 * rounding))
    assert times(rate) == times(joint) == pytest.approx([0.75], abs=max(1e-15, rounding))
    assert rate[0].direction == (-1 if backward else 1)


CLOCKS = {
    "t0": (0.0, []),
    "a step's end": (0.5, [0.5]),
    "t_end": (2.0, [2.0]),
    "within": (0.625, [0.625]),
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("zero", CLOCKS)
@pytest.mark.parametrize("direction", [-1, 0, 1])
@pytest.mark.parametrize("forward", [True, False])
def test_a_zero_that_lies_just_there(method: str, zero: str, direction: int, forward: bool) -> None:
    """A zero at t0 is no event; one at the end of a step or run is one event, at that time."""
    sense = 1 if forward else -1
    at, found = CLOCKS[zero]
    clock = ev.Function(lambda t, q, qd: t - sense * at, direction=direction)
    sol = parabola(0.0, sense * 2.0, 0.5, method, clock)
    expected = found if direction in (0, sense) else []
    assert times(sol.events[0]) == [sense * t for t in expected]
    if zero != "within":
        assert all(np.array_equal(one.y, sol(one.t)) for one in sol.events[0])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [0.25, 0.3])
def test_an_angle_that_starts_at_its_value_is_an_event_when_it_comes_back(
    method: str, step: float
) -> None:
    start = ev.LinkAngle(1, 0.0)
    sol = parabola(0.0, 2.0, step, method, start)
    assert times(sol.events[0]) == pytest.approx([1.5], abs=1e-14)
    stops = parabola(0.0, 2.0, step, method, start.replace(terminal=True))
    assert stops.status == "event"
    assert stops.t[-1] == sol.events[0][0].t


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("step", [2.0, 1.0])
def test_a_touch_that_the_interpolant_proves_is_told_as_one(method: str, step: float) -> None:
    touch, rising, clear = ev.LinkAngle(1, -0.5625), ev.LinkAngle(1, -0.5625, direction=1), None
    clear = ev.LinkAngle(1, -0.5625 - 1e-13)
    sol = parabola(0.0, 2.0, step, method, touch, rising, clear)
    assert times(sol.events[0]) == pytest.approx([0.75], abs=1e-7)
    assert [one.direction for one in sol.events[0]] == [0]
    assert sol.events[1:] == [[], []]


def test_a_rod_swings_with_the_period_of_elliptic_integrals() -> None:
    theta_0 = 2.5
    scene = pc.Scene(links=[pc.Link(mass=1.7, length=0.6)], gravity=9.81)
    wanted = [ev.LinkAngle(1, np.pi / 2), ev.RateZero(link=1), ev.TipLine((0.0, 0.0), (1.0, 0.0))]
    sol = pc.simulate(
        scene, q0=np.pi / 2 - theta_0, t_span=(0, 10), rtol=1e-13, atol=1e-15, events=wanted
    )
    modulus = mpmath.sin(mpmath.mpf(theta_0) / 2)
    period = float(4 * mpmath.ellipk(modulus**2) * mpmath.sqrt(mpmath.mpf(2 * 0.6) / (3 * 9.81)))
    through, turns, line = (np.array(times(found)) for found in sol.events)
    assert through == pytest.approx(period * (np.arange(len(through)) + 0.5) / 2, abs=2e-10)
    assert turns == pytest.approx(period * (np.arange(len(turns)) + 1) / 2, abs=2e-10)
    assert len(through) == len(line) == int(10 / period * 2 + 0.5)
    assert len(turns) == int(10 / period * 2)
    assert line == pytest.approx(through, abs=1e-14)
    assert {one.direction for one in sol.events[0][::2]} == {1}
    assert {one.direction for one in sol.events[0][1::2]} == {-1}


def test_a_mode_of_small_oscillations_passes_the_vertical_at_its_frequency() -> None:
    frequency = np.sqrt((3 - 6 / np.sqrt(7)) * 9.807)
    start = np.pi / 2 + 1e-6 * np.array([1.0, 3 / (3 - 6 / np.sqrt(7)) - 8 / 3])
    events = [ev.LinkAngle(i, np.pi / 2) for i in (1, 2)]
    sol = pc.simulate(BOOK, q0=start, t_span=(0, 20), rtol=1e-12, atol=1e-18, events=events)
    for found in sol.events:
        exact = (np.arange(len(found)) + 0.5) * np.pi / frequency
        assert len(found) == int(20 * frequency / np.pi + 0.5)
        assert times(found) == pytest.approx(exact, abs=1e-8)


@pytest.mark.parametrize("name", ["textbook", "textbook_long", "unequal", "three_links"])
def test_sections_are_where_the_multiple_precision_references_are(
    name: str, reference_case: Callable[[str], Any]
) -> None:
    """The run passes the angle that the reference has at a time, at that time."""
    case = reference_case(name)
    links = [pc.Link(mass=m, length=L) for m, L in zip(case.masses, case.lengths, strict=True)]
    scene = pc.Scene(links=links, gravity=case.gravity)
    rows = [k for k in range(1, len(case.t) - 1) if (np.abs(case.qd[k]) > 0.1).all()]
    wanted, expected = [], []
    for k in rows:
        for i, (q, qd) in enumerate(zip(case.q[k], case.qd[k], strict=True), start=1):
            wanted.append(ev.LinkAngle(i, q, direction=int(np.sign(qd))))
            expected.append((case.t[k], case.q[k], case.qd[k]))
    sol = pc.simulate(
        scene,
        q0=case.q0,
        qd0=case.qd0,
        t_span=(0, case.t[-1]),
        rtol=1e-14,
        atol=1e-15,
        events=wanted,
    )
    assert len(expected) > 20
    for found, (t, q, qd) in zip(sol.events, expected, strict=True):
        nearest = min(found, key=lambda one: abs(one.t - t))
        assert nearest.t == pytest.approx(t, abs=1e-9)
        assert nearest.q == pytest.approx(q, abs=1e-8)
        assert nearest.qd == pytest.approx(qd, abs=1e-7)


def test_every_turn_of_a_spinning_rod_is_found() -> None:
    """At 30 rad/s without gravity each multiple of 2 pi is found, also several in a step."""
    for step in (0.01, 0.1, 0.5, 1.0):
        sol = pc.simulate(
            rod(), q0=0.5, qd0=-30.0, t_span=(0, 10), step=step,
            events=[ev.LinkAngle(1, 1.0, every_turn=True), ev.JointAngle(1, 1.0)],
        )  # fmt: skip
        turns, once = sol.events
        exact = (0.5 - (1.0 - 2 * np.pi * np.arange(1, 48))) / 30
        # There are a thousand sums, each rounded to half a last bit of 300 rad.
        assert times(turns) == pytest.approx(exact, abs=1000 * np.spacing(300.0) / 2 / 30)
        assert {one.direction for one in turns} == {-1}
        assert once == []


def test_turns_are_found_backward_and_far_from_zero() -> None:
    turns = ev.LinkAngle(1, 1.0 - 2e6 * np.pi, every_turn=True)
    sol = pc.simulate(rod(), q0=1e6, qd0=20.0, t_span=(0, -10), step=0.5, events=[turns])
    first = np.ceil((1e6 - 200 - 1) / (2 * np.pi))
    exact = (1e6 - (1 + 2 * np.pi * np.arange(first, first + 32)[::-1])) / -20
    exact = exact[exact < 0]
    assert times(sol.events[0]) == pytest.approx(exact, abs=1e-9)
    assert {one.direction for one in sol.events[0]} == {-1}


def test_turns_without_end_end_the_run_before_the_step_that_has_them_and_say_so() -> None:
    """At 4e5 turns a step, the millionth turn comes in the third step."""
    turns = ev.LinkAngle(1, 0.0, every_turn=True, direction=-1)
    rate = 4e5 * 2 * np.pi
    sol = pc.simulate(
        rod(), q0=0.5, qd0=rate, t_span=(0, 4), step=1.0, events=[turns], on_failure="ignore"
    )
    assert (sol.status, sol.success) == ("max_turns", False)
    assert [*sol.t] == [0.0, 1.0, 2.0]
    assert sol.stats.accepted == 2
    assert sol.message.startswith("event 1 (link_angle): every_turn = true: ")
    assert "more than a million turns, not counting one a step (at t = 2.0 s)" in sol.message
    longer, whole = sol.resume(4.0), pc.simulate(rod(), q0=0.5, qd0=rate, t_span=(0, 4), step=1.0)
    assert longer.status == "finished"
    np.testing.assert_array_equal(longer.y, whole.y)
    assert longer.stats == whole.stats


def test_a_turn_a_step_is_never_too_many() -> None:
    turns = ev.LinkAngle(1, 1.0, every_turn=True, direction=-1)
    sol = pc.simulate(
        rod(), q0=0.5, qd0=6.0, t_span=(0, 1_100_000), step=1.0, store="end", events=[turns]
    )
    assert sol.status == "finished"


def test_a_step_of_more_turns_than_numbers_ends_the_run() -> None:
    turns = [ev.LinkAngle(1, 0.0, every_turn=True)]
    sol = pc.simulate(
        rod(), q0=0.5, qd0=1e300, t_span=(0, 1), step=1.0, events=turns, on_failure="ignore"
    )
    assert (sol.status, sol.t[-1], sol.events) == ("max_turns", 0.0, [[]])


def test_an_event_before_time_can_tell_ends_the_run_where_the_step_began() -> None:
    here = ev.LinkAngle(1, 1e-13, terminal=True)  # after 1e-18 s, and more than rounding away
    sol = pc.simulate(rod(), q0=0.0, qd0=1e5, t_span=(1, 1.001), step=1e-5, events=[here])
    assert (sol.status, [*sol.t], len(sol.events[0])) == ("event", [1.0], 1)
    np.testing.assert_array_equal(sol(sol.t).T, sol.y.T)
    assert sol.resume(1.001).status == "finished"


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("store", ["dense", "steps", "end"])
def test_a_run_may_end_in_its_first_step(method: str, store: str) -> None:
    here = ev.LinkAngle(1, 0.25, terminal=True)
    sol = pc.simulate(
        rod(), q0=0.0, qd0=0.5, t_span=(0, 10), method=method, step=1.0, store=store, events=[here]
    )
    assert (sol.status, sol.q[-1, 0]) == ("event", 0.25)
    assert sol.t[-1] == pytest.approx(0.5, rel=0, abs=WITHIN_STEPS.get(method, 0.0))
    assert sol.stats.accepted == 1
    assert len(sol.t) == (1 if store == "end" else 2)


@pytest.mark.parametrize("sense", [1, -1])
def test_events_a_hair_apart_come_in_their_order(sense: int) -> None:
    near = [ev.Function(lambda t, q, qd, at=at: t - sense * at) for at in (2e-8, 1e-8, 0.5 + 1e-8)]
    angle = ev.LinkAngle(1, sense * 0.5 * 1e-8)
    sol = pc.simulate(
        rod(), q0=0.0, qd0=0.5, t_span=(0, sense), step=1.0, events=[*near, angle, angle]
    )
    assert [times(found) for found in sol.events] == [
        pytest.approx([sense * t], abs=1e-16) for t in (2e-8, 1e-8, 0.5 + 1e-8, 1e-8, 1e-8)
    ]
    assert times(sol.events[3]) == times(sol.events[4])


def test_simultaneous_events_are_all_found_and_the_first_that_was_asked_for_ends_the_run() -> None:
    here = ev.LinkAngle(1, 0.25)
    wanted = [here, here.replace(terminal=True, name="b"), here.replace(terminal=True, name="c")]
    how = {"method": "dopri5", "step": 1.0}
    sol = pc.simulate(rod(), q0=0.0, qd0=0.5, t_span=(0, 1), **how, events=[*wanted, here])
    assert [times(found) for found in sol.events] == [[0.5]] * 4
    assert sol.message == ("stopped at a terminal event (at t = 0.5 s: event 2 (link_angle, 'b'))")


@pytest.mark.parametrize("count", [1, 2, 5])
@pytest.mark.parametrize("direction", [0, 1, -1])
def test_a_run_ends_at_as_many_occurrences_in_the_direction_that_counts(
    count: int, direction: int
) -> None:
    down = ev.LinkAngle(1, np.pi / 2, direction=direction)
    free = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 20), events=[down])
    sol = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 20), events=[down.replace(terminal=count)])
    assert sol.status == "event"
    assert sol.success
    assert times(sol.events[0]) == times(free.events[0])[:count]
    assert sol.t[-1] == sol.events[0][-1].t
    assert np.array_equal(sol.y[:, -1], sol.events[0][-1].y)
    assert {one.direction for one in sol.events[0]} <= ({direction} if direction else {1, -1})


def test_a_joint_that_comes_to_rest_by_friction_is_found_once() -> None:
    scene = rod(pc.effects.DryJointFriction(joint=1, coulomb=0.5))
    wanted = [ev.RateZero(joint=1), ev.RateZero(link=1, direction=1)]
    sol = pc.simulate(scene, q0=0.0, qd0=1.0, t_span=(0, 10), events=wanted)
    assert times(sol.events[0]) == pytest.approx([2.0], abs=1e-14)
    assert sol.events[0][0].qd[0] == 0.0
    assert sol.events[1] == []


def test_a_rod_at_rest_has_no_event() -> None:
    wanted = [
        ev.LinkAngle(1, 0.5), ev.RateZero(joint=1), ev.TipLine((np.cos(0.5), 0.0), (1.0, 0.0)),
        ev.Function(lambda t, q, qd: qd[0]),
    ]  # fmt: skip
    sol = pc.simulate(rod(links=2), q0=[0.5, 0.5], t_span=(0, 100), events=wanted)
    assert sol.success
    assert sol.events == [[]] * 4
