"""An event that ended a run is not found again where a new run starts, and no other is lost.

The state that a run stored at an event lies on it to rounding only.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod

METHODS = ["dopri5", "dop853", "taylor", "radau5", "rk4"]
DOWN = np.pi / 2
KINDS = {
    "joint angle": lambda j, x, _: ev.JointAngle(j, x, every_turn=True, terminal=True),
    "joint angle 0": lambda j, x, _: ev.JointAngle(j, 0.0, terminal=True),
    "link angle": lambda j, x, _: ev.LinkAngle(j, x, terminal=True),
    "link angle 0": lambda j, x, _: ev.LinkAngle(j, 0.0, every_turn=True, terminal=True),
    "rate of a joint": lambda j, x, _: ev.RateZero(joint=j, terminal=True),
    "rate of a link": lambda j, x, _: ev.RateZero(link=j, terminal=True),
    "tip": lambda j, x, normal: ev.TipLine(normal / 4, normal[::-1], terminal=True),
    "function": lambda j, x, _: ev.Function(
        lambda t, q, qd: float(np.sin(q[0]) * qd[-1] - 0.3 * np.sin(t)), terminal=True
    ),
}


def restarts(kind, method, sense, seeds):
    """Yield runs that start on an event, each with the run that went on instead of ending.

    A chain swings or turns; which event of the kind ends its runs is drawn.
    """
    options = {"method": method, "step": 0.002 if method == "rk4" else None}
    for seed in range(seeds):
        dice = np.random.default_rng(seed)
        n = int(dice.integers(1, 4))
        links = [pc.Link(mass=m, length=x) for m, x in dice.uniform(0.3, 1.5, size=(n, 2))]
        scene = pc.Scene(links=links, effects=[fx.ViscousJoint(1, 0.05)])
        drawn = int(dice.integers(1, n + 1)), float(dice.uniform(-1, 3)), dice.normal(size=2)
        options["events"] = [KINDS[kind](*drawn)]
        t, start = float(dice.choice([0.0, 7.3])), dice.uniform(-3, 3, size=(2, n))
        for _ in range(4):
            sol = pc.simulate(scene, (t, t + sense * 4.0), *start, **options)
            if sol.status != "event":
                break
            t, start = float(sol.t[-1]), np.split(sol.y[:, -1], 2)
            span = t, t + sense * 0.5
            yield pc.simulate(scene, span, *start, **options), sol.resume(span[1])


@pytest.mark.few_cases
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("kind", KINDS)
def test_a_run_from_an_event_finds_next_what_the_run_that_goes_on_finds(kind, method, sense):
    count = 0
    for again, goes_on in restarts(kind, method, sense, seeds=18):
        (found,), (all_found,) = again.events, goes_on.events
        start = again.t[0]
        expected = [one.t for one in all_found if (one.t - start) * sense > 0]
        assert [one.t for one in found] == pytest.approx(expected, abs=2e-4)
        assert all(abs(one.t - start) > 1e-9 for one in found)
        count += 1
    assert count >= 10


@pytest.mark.parametrize("kind", KINDS)
def test_members_find_the_events_of_the_run_alone_from_an_event(kind):
    for again, _ in restarts(kind, "dopri5", 1, seeds=4):
        n, t = len(again.scene.links), float(again.t[0])
        (event,) = again.case().options["events"]
        starts = np.array([again.y[:, 0]] * 4)
        starts[1:, 0] += 1e-3
        many = pc.ensemble(
            again.scene, q0=starts[:, :n], qd0=starts[:, n:], t_span=(t, t + 0.5), method="dopri5",
            keep=pc.reducers.FirstEvent(event), workers=1,
        )  # fmt: skip
        (found,) = again.events
        first = found[0].t if found else np.nan
        assert np.array_equal(many["first_event"][0], first, equal_nan=True)


def pushed(u):
    return rod(fx.Motor(1, constant=u))


def on_a_spring(u):
    return rod(fx.TorsionalSpring(1, stiffness=9.0), fx.Motor(1, constant=0.1 * u))


# Phi'' = -sign(phi) from rest at 0.4: a quarter of a period is sqrt(0.8).
ANGLES = pushed, DOWN + 0.4, -1, np.sqrt(0.8) * np.arange(1, 34, 2), 1e-7
# Phi'' = -9 phi + 0.1 sign(phi'): the rate is zero every half period, pi/3.
RATES = on_a_spring, 0.4, 0, np.pi / 3 * np.arange(1, 29), 1e-6
LOOPS = {  # the event, the scene, its start, the first torque's sign, times of the switches
    "joint angle": (ev.JointAngle(1, DOWN, terminal=True), *ANGLES),
    "link angle": (ev.LinkAngle(1, DOWN, terminal=True), *ANGLES),
    "tip": (ev.TipLine((0.0, 0.3), (1.0, 0.0), terminal=True), *ANGLES),
    "function": (ev.Function(lambda t, q, qd: np.cos(q[0]), max_step=0.1, terminal=True), *ANGLES),
    "rate of a joint": (ev.RateZero(joint=1, terminal=True), *RATES),
    "rate of a link": (ev.RateZero(link=1, terminal=True), *RATES),
}


@pytest.mark.few_cases
@pytest.mark.every_value("loop")
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("loop", LOOPS)
def test_a_bang_bang_loop_switches_as_often_as_its_exact_answer(loop, method, sense):
    event, scene_of, q, sign, exact, within = LOOPS[loop]
    t, rate, times, sign = 0.0, 0.0, [], sign or -sense
    how = {"method": method, "events": [event], "step": 0.01 if method == "rk4" else None}
    while len(times) < 100:
        span = t, 30.0 * sense
        sol = pc.simulate(scene_of(sign), span, q, rate, rtol=1e-10, atol=1e-12, **how)
        if sol.status != "event":
            break
        t, (q, rate), sign = float(sol.t[-1]), sol.y[:, -1], -sign
        times.append(t)
    assert times == pytest.approx(sense * exact, abs=within)


CLOSE = [1e-3, 1e-6, 1e-9, 1e-12]


def found_by_each(scene, start, t_end, events, method, step=0.01):
    """The one event that each of them finds."""
    how = {"method": method, "step": step if method == "rk4" else None, "events": events}
    return [one for (one,) in pc.simulate(scene, (0, t_end), *start, **how).events]


def at_angle(value):
    line = ev.TipLine((np.cos(value), np.sin(value)), (-np.sin(value), np.cos(value)))
    return [ev.JointAngle(1, value), line, ev.Function(lambda t, q, qd: q[0] - value)]


@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("distance", CLOSE)
@pytest.mark.parametrize("method", METHODS)
def test_events_that_come_close_after_the_start_are_found(method, distance, sense):
    """A free rod at the rate 2, and Phi'' = -1 from the rate `distance`."""
    value = 0.7 + sense * distance
    watched = [*at_angle(value), ev.LinkAngle(1, value + 4 * np.pi, every_turn=True)]
    for one in found_by_each(rod(), (0.7, 2.0), sense * 0.5, watched, method):
        assert one.t == pytest.approx(sense * distance / 2, abs=3e-15)
    watched = [ev.RateZero(joint=1), ev.RateZero(link=1)]
    for one in found_by_each(pushed(-1.0), (0, sense * distance), sense * 0.5, watched, method):
        assert one.t == pytest.approx(sense * distance, rel=1e-9, abs=3e-15)


@pytest.mark.parametrize("rate", [1.0, 1e-3, 1e-5])
@pytest.mark.parametrize("method", METHODS)
def test_a_run_that_starts_on_an_event_finds_the_way_back(method, rate):
    """Phi = w t - t^2/2 from an angle that rounding leaves beside the event: back after 2 w."""
    off = 0.7 + 1e-15  # on the side from which rounding would make the start a crossing
    back = rate + np.sqrt(rate**2 - 2 * (off - 0.7))
    start, watched = (0.7, rate), at_angle(off)
    for one in found_by_each(pushed(-1.0), start, 3 * rate, watched, method, step=rate / 50):
        assert one.t == pytest.approx(back, rel=1e-9, abs=2e-15 / rate)
        assert one.direction == -1
