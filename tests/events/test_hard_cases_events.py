"""Event finders often fail at these: two in a step, at the start, at the end, at a step's end."""

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
    """Return when a rod swinging from -amplitude passes the mark, and when its last swing ends."""
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
    """At 1e-8 rad short of the turn the passages are 0.12 ms apart, in steps of tens of ms."""
    amplitude = 1.0
    known, end = passages(amplitude, amplitude - short, 20)
    mark = pc.events.JointAngle(joint=1, value=np.pi / 2 - (amplitude - short))
    how = {"method": method, "rtol": 1e-12, "atol": 1e-14, "events": [mark]}
    sol = pc.simulate(
        rod(gravity=G), q0=np.pi / 2 + amplitude, qd0=0, t_span=(0, sign * end), **how
    )
    assert sol.success
    found = sign * np.array(times_of(sol))
    assert found.size == len(known)
    # an angle's error of 1e-10 is a time's of 1e-10/rate, and the rate is sqrt(2 short) or so
    np.testing.assert_allclose(found, known, atol=1e-10 / np.sqrt(short))
    without = pc.simulate(
        rod(gravity=G),
        q0=np.pi / 2 + amplitude,
        qd0=0,
        t_span=(0, sign * end),
        **how | {"events": []},
    )
    np.testing.assert_array_equal(sol.y, without.y)


def marks_at(sol: pc.Solution, row: int) -> list[pc.events.Event]:
    """Return angles, and a line for the tip, where a rod is at a point of a run."""
    angle, (x, y) = float(sol.q[row, 0]), sol.positions()[row, -1]
    line = pc.events.TipLine((float(x), float(y)), (-0.18, 1.0))
    return [pc.events.JointAngle(1, angle), pc.events.LinkAngle(1, angle), line]


@pytest.mark.parametrize("sign", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize("method", METHODS)
def test_a_mark_at_the_start_is_no_event_and_one_at_the_end_is_one(method: str, sign: int) -> None:
    """A rod turns at 1 rad/s; the marks at the end are where the run gets to, to the bit."""
    free = pc.simulate(rod(), q0=0.2, qd0=1, t_span=(0, sign * 1.0), method=method)
    marks = marks_at(free, 0) + marks_at(free, -1)
    how = {"method": method, "events": marks}
    sol = pc.simulate(rod(), q0=0.2, qd0=1, t_span=(0, sign * 1.0), **how)
    assert [times_of(sol, k) for k in range(6)] == [[]] * 3 + [[sign * 1.0]] * 3
    assert {event.direction for found in sol.events for event in found} == {sign}
    once = [[]] * 3 + [pytest.approx([sign * 1.0], abs=1e-14)] * 3
    again = pc.simulate(rod(), q0=0.2, qd0=1, t_span=(0, sign * 1.5), **how)
    assert [times_of(again, k) for k in range(6)] == once
    went_on = sol.resume(sign * 1.5)
    assert [times_of(went_on, k) for k in range(6)] == once


ZEROS = [pc.events.RateZero(joint=1), pc.events.RateZero(link=1)]
TURNED_BACK = rod(pc.effects.Motor(joint=1, constant=-2.0))


@pytest.mark.parametrize("sign", [1, -1], ids=["forward", "backward"])
def test_a_rate_that_is_zero_at_the_start_is_no_event(sign: int, fine: Any) -> None:
    """A rod is let go at rest, and its next rest is the other turn."""
    quarter = passages(1.0, 0.0, 1)[0][0]
    sol = pc.simulate(
        rod(gravity=G),
        q0=np.pi / 2 + 1,
        qd0=0,
        t_span=(0, sign * 5 * quarter),
        **fine,
        events=ZEROS,
    )
    for found in sol.events:
        assert [event.t for event in found] == pytest.approx(
            [2 * sign * quarter, 4 * sign * quarter]
        )


def test_a_rate_that_is_zero_at_the_end_is_an_event(fine: Any) -> None:
    """Friction stops the rod, to the bit, after 2 s; a step that ends there may be the last."""
    scene = rod(pc.effects.DryJointFriction(joint=1, coulomb=0.5))
    whole = pc.simulate(scene, q0=0, qd0=1, t_span=(0, 3), **fine)
    stopped = float(whole.t[np.flatnonzero(whole.qd[:, 0] == 0)[0]])
    assert stopped == pytest.approx(2.0, abs=1e-12)
    # two bits later, as a step cut where the rod is found to stop may end a bit of the rate before
    stopped += 2 * np.spacing(stopped)
    sol = pc.simulate(scene, q0=0, qd0=1, t_span=(0, stopped), **fine, events=ZEROS)
    assert [times_of(sol, k) for k in range(2)] == [[stopped]] * 2
    assert sol.events[0][0].y.tolist() == sol.y[:, -1].tolist()
    assert sol.qd[-1, 0] == 0.0


@pytest.mark.parametrize("sign", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize("value", [0.25, 0.5, 0.75])
@pytest.mark.parametrize("method", METHODS)
def test_a_mark_at_the_end_of_a_step_is_met_once(method: str, value: float, sign: int) -> None:
    """At 1 rad/s the rod is there; under a couple it rests there, to a last bit before or after."""
    point = (float(np.cos(value)), float(np.sin(value)))
    marks: list[Any] = [
        pc.events.JointAngle(joint=1, value=value),
        pc.events.LinkAngle(link=1, value=value),
        pc.events.TipLine(point, (-0.18, 1.0)),
        pc.events.TipLine(point, (0.3, -0.2)),
        pc.events.Function(lambda t, q, qd: q[0] - value),
    ]
    how = {"t_span": (0, sign), "method": method, "step": 0.25}
    runs = [
        (pc.simulate(rod(), q0=0, qd0=sign, events=marks, **how), [1, 1, 1, -1, 1]),
        (pc.simulate(TURNED_BACK, q0=0, qd0=sign * 2 * value, events=ZEROS, **how), [-sign] * 2),
    ]
    for sol, directions in runs:
        for found, direction in zip(sol.events, directions, strict=True):
            assert [one.t for one in found] == pytest.approx([sign * value], abs=1e-14)
            assert found[0].direction == direction


def test_a_swing_that_only_touches_the_mark_does_not_pass_it_twice_the_wrong_way(fine: Any) -> None:
    """A mark a hair beyond the turn is never passed."""
    mark = pc.events.JointAngle(joint=1, value=np.pi / 2 - (1 + 1e-9))
    sol = pc.simulate(
        rod(gravity=G), q0=np.pi / 2 + 1, qd0=0, t_span=(0, 20), **fine, events=[mark]
    )
    assert times_of(sol) == []


def test_each_bounce_is_an_event_with_the_states_on_both_sides(fine: Any) -> None:
    """The rate passes zero by a jump, from -w to e w without a value between."""
    stop = pc.effects.JointStop(joint=1, range=(0, np.inf), restitution=0.8, capture_speed=1e-3)
    scene = rod(pc.effects.Motor(joint=1, constant=-2.0), stop)
    bound = pc.events.JointAngle(joint=1, value=0.0)
    sol = pc.simulate(scene, q0=0.4, qd0=0, t_span=(0, 3.0), **fine, events=[bound])
    first = np.sqrt(2 * 2.0 * 0.4)
    assert len(sol.events[0]) > 0
    for k, event in enumerate(sol.events[0]):
        speed = first * 0.8**k
        np.testing.assert_allclose(event.y_before, [0, -speed], rtol=1e-9, atol=1e-13)
        np.testing.assert_allclose(event.y_after, [0, 0.8 * speed], rtol=1e-9, atol=1e-13)
