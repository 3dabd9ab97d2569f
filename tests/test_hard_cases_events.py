"""Events where event finders go wrong: two in a step, at the start, at the end, at a step's end."""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from unit_rods import rod

G = 9.81
METHODS = [method["name"] for method in _core.methods() if method["error_order"]]


def passages(amplitude: float, mark: float, swings: int) -> tuple[list[float], float]:
    """When a rod that swings from -amplitude passes the mark, and the end of the last swing."""
    with mpmath.mp.workdps(30):
        k = mpmath.sin(mpmath.mpf(amplitude) / 2)
        unit = mpmath.sqrt(2 / (3 * mpmath.mpf(G)))
        quarter = mpmath.ellipk(k**2) * unit
        past = mpmath.ellipf(mpmath.asin(mpmath.sin(mpmath.mpf(mark) / 2) / k), k**2) * unit
        first, second = quarter + past, 3 * quarter - past
        times = [float(t + 4 * quarter * n) for n in range(swings) for t in (first, second)]
        return times, float(4 * quarter * swings)


def times_of(sol: pc.Solution, number: int = 0) -> list[float]:
    return [event.t for event in sol.events[number]]


@pytest.mark.parametrize("sign", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("short", [1e-2, 1e-5, 1e-8])
def test_both_passages_of_a_mark_just_short_of_the_turn_are_found_in_every_swing(
    method: str, short: float, sign: int
) -> None:
    """At 1e-8 rad short of the turn they are 0.12 ms apart, in steps of tens."""
    amplitude = 1.0
    known, end = passages(amplitude, amplitude - short, 20)
    mark = pc.events.JointAngle(joint=1, value=np.pi / 2 - (amplitude - short))
    how = {"method": method, "rtol": 1e-12, "atol": 1e-14, "events": [mark]}
    sol = pc.simulate(rod(gravity=G), np.pi / 2 + amplitude, 0, (0, sign * end), **how)
    assert sol.success
    found = sign * np.array(times_of(sol))
    assert found.size == len(known)
    # an error of the angle of 1e-10 is one of the time of 1e-10/rate, sqrt(2 short) or so
    np.testing.assert_allclose(found, known, atol=1e-10 / np.sqrt(short))
    without = pc.simulate(
        rod(gravity=G), np.pi / 2 + amplitude, 0, (0, sign * end), **how | {"events": []}
    )
    np.testing.assert_array_equal(sol.y, without.y)


@pytest.mark.parametrize("sign", [1, -1], ids=["forward", "backward"])
def test_a_mark_at_the_start_is_no_event_and_one_at_the_end_is_one(sign: int) -> None:
    """A rod that turns at 1 rad/s; the mark at the end is where the run gets to, to the bit."""
    end = float(pc.simulate(rod(), 0, 1, (0, sign * 1.0)).q[-1, 0])
    marks = [pc.events.JointAngle(joint=1, value=value) for value in (0.0, end)]
    sol = pc.simulate(rod(), 0, 1, (0, sign * 1.0), events=marks)
    assert times_of(sol, 0) == []
    assert times_of(sol, 1) == [sign * 1.0]
    again = pc.simulate(rod(), 0, 1, (0, sign * 2.0), events=marks)
    assert times_of(again, 0) == []
    assert times_of(again, 1) == pytest.approx([sign * 1.0], abs=1e-14)
    went_on = sol.resume(sign * 2.0)
    assert times_of(went_on, 1) == pytest.approx([sign * 1.0], abs=1e-14)


@pytest.mark.parametrize("value", [0.25, 0.5, 0.75])
def test_a_mark_at_the_end_of_a_step_is_met_once(value: float) -> None:
    marks: list[Any] = [
        pc.events.JointAngle(joint=1, value=value),
        pc.events.LinkAngle(link=1, value=value),
        pc.events.Function(lambda t, q, qd: q[0] - value),
    ]
    sol = pc.simulate(rod(), 0, 1, (0, 1), step=0.25, events=marks)
    for number in range(3):
        assert times_of(sol, number) == pytest.approx([value], abs=1e-14)


def test_a_swing_that_only_touches_the_mark_does_not_pass_it_twice_the_wrong_way() -> None:
    """A mark a hair beyond the turn is never passed."""
    mark = pc.events.JointAngle(joint=1, value=np.pi / 2 - (1 + 1e-9))
    sol = pc.simulate(
        rod(gravity=G), np.pi / 2 + 1, 0, (0, 20), rtol=1e-12, atol=1e-14, events=[mark]
    )
    assert times_of(sol) == []


def test_each_bounce_is_an_event_with_the_states_on_both_sides() -> None:
    """Rate zero through a jump: from -w to e w without a value between."""
    stop = pc.effects.JointStop(joint=1, range=(0, np.inf), restitution=0.8, capture_speed=1e-3)
    scene = rod(pc.effects.Motor(joint=1, constant=-2.0), stop)
    bound = pc.events.JointAngle(joint=1, value=0.0)
    sol = pc.simulate(scene, 0.4, 0, (0, 3.0), rtol=1e-11, events=[bound])
    first = np.sqrt(2 * 2.0 * 0.4)
    assert len(sol.events[0]) > 0
    for k, event in enumerate(sol.events[0]):
        speed = first * 0.8**k
        np.testing.assert_allclose(event.y_before, [0, -speed], rtol=1e-9, atol=1e-13)
        np.testing.assert_allclose(event.y_after, [0, 0.8 * speed], rtol=1e-9, atol=1e-13)
