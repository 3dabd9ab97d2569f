"""Spans of a few units in the last place, tiny time scales, and times asked for beside events."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod

ORDERS = {method["name"]: method["order"] for method in _core.methods()}

BOOK = pc.Scene.textbook()


def at_time(time: float, **how: Any) -> ev.Function:
    return ev.Function(lambda t, q, qd: t - time, **how)


# Spans of a few units in the last place ---------------------------------------------------------


@pytest.mark.parametrize("count", [1, 2, 3, 7, 100, 1000])
@pytest.mark.parametrize("t0", [1.0, -1e6])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_span_of_a_few_units_in_the_last_place_ends_where_it_should(
    sign: int, t0: float, count: int, method: str
) -> None:
    """What happens in it has its time to the last bit; rates are a unit of angle in one of time."""
    unit = sign * np.spacing(abs(t0))
    rate = np.spacing(0.3) / abs(unit)
    ticks = sorted({1, (count + 1) // 2, count})
    sol = pc.simulate(
        rod(links=2), q0=0.3, qd0=[rate, -rate], t_span=(t0, t0 + count * unit), method=method,
        events=[at_time(t0 + k * unit) for k in ticks],
    )  # fmt: skip
    assert sol.status == "finished", sol.message
    assert sol.t.tolist() == [t0, t0 + count * unit]
    assert [[(one.t - t0) / unit for one in found] for found in sol.events] == [[k] for k in ticks]
    moved = (sol.q[-1] - 0.3) / np.spacing(0.3)
    np.testing.assert_allclose(moved, [sign * count, -sign * count], atol=1)


@pytest.mark.parametrize("way", ["step", "max_step", "first_step"])
def test_steps_of_a_few_units_in_the_last_place_are_refused_with_the_reason(
    way: str, method: str
) -> None:
    unit = np.spacing(1.0)
    span = (1.0, 1 + 100 * unit)
    short = pc.simulate(
        BOOK, q0=0.3, qd0=1, t_span=span, method=method, on_failure="ignore", **{way: 4.7 * unit}
    )
    assert short.status == "step_too_small"
    assert "t + h = t" in short.message
    assert "t = 1.0 s" in short.message
    assert short.t.tolist() == [1.0]


def test_an_event_ends_a_span_of_a_few_units_in_the_last_place(method: str) -> None:
    unit = np.spacing(1.0)
    end = 1 + 100 * unit
    events = [at_time(1 + 30 * unit, terminal=True)]
    sol = pc.simulate(BOOK, q0=0.3, qd0=1, t_span=(1.0, end), method=method, events=events)
    assert sol.status == "event"
    assert sol.t.tolist() == [1.0, 1 + 30 * unit]
    longer = sol.resume(end)
    assert longer.status == "finished"
    assert longer.t.tolist() == [1.0, end]


@pytest.mark.parametrize("t0", [1e16, -1e16, 1e18])
@pytest.mark.parametrize("count", [1, 2, 5])
def test_where_time_is_coarser_than_the_motion_no_step_is_taken(
    count: int, t0: float, method: str
) -> None:
    span = (t0, t0 + count * np.spacing(abs(t0)))  # units of 2 s, and of 128 s
    fast = pc.simulate(BOOK, q0=[-1.2, -0.6], t_span=span, method=method, on_failure="ignore")
    assert fast.status == "step_too_small"
    assert fast.t.tolist() == [t0]
    assert fast.stats.nfev < 1000
    if count > 2:
        return  # more than the first step of any motion can be: it is not known to be slow
    slow_book = pc.Scene(links=BOOK.links, gravity=1e-12)  # turns in some weeks
    slow = pc.simulate(slow_book, q0=[-1.2, -0.6], t_span=span, method=method)
    assert slow.status == "finished"
    alike = pc.simulate(slow_book, q0=[-1.2, -0.6], t_span=(0, span[1] - t0), method=method)
    np.testing.assert_allclose(slow.y[:, -1], alike.y[:, -1], rtol=1e-8)


def test_a_span_that_no_double_holds_is_refused() -> None:
    with pytest.raises(ValueError, match=r"^end of the run = .*: must be less than 1.8e308 s from"):
        pc.simulate(BOOK, q0=0.3, t_span=(-1.7e308, 1.7e308))


# Tiny and huge time scales ----------------------------------------------------------------------


@pytest.mark.parametrize("w", [1e20, 1e-20, 1e100, 1e-100])
def test_an_oscillation_of_any_frequency_is_followed_over_ten_radians(
    w: float, method: str
) -> None:
    """A spring of stiffness w^2 on a moment of inertia of 1: cos(w t) / 2, from 0 to 10 / w."""
    scene = rod(fx.TorsionalSpring(joint=1, stiffness=w**2))
    how = {"method": method, "rtol": 1e-10, "atol": [1e-12, 1e-12 * w]}
    turns = ev.RateZero(joint=1)
    sol = pc.simulate(scene, q0=0.5, t_span=(0, 10 / w), events=[turns], **how)
    assert sol.status == "finished"
    assert 1e-10 ** (-1 / ORDERS[method]) < sol.stats.accepted < 1000
    wt = np.linspace(0, 10, 50)
    q, qd = sol(wt / w)
    np.testing.assert_allclose(q, np.cos(wt) / 2, atol=1e-9)
    np.testing.assert_allclose(qd / w, -np.sin(wt) / 2, atol=1e-9)
    assert [one.t * w for one in sol.events[0]] == pytest.approx(np.pi * np.arange(1, 4), rel=1e-9)


# Times asked for --------------------------------------------------------------------------------


def asked(times: list[float], span: tuple[float, float], end: float, **how: Any) -> pc.Solution:
    """A run that an event at time `end` stops."""
    events = [at_time(end, samples=1, terminal=True)]
    return pc.simulate(BOOK, q0=0.3, qd0=1, t_span=span, t_eval=times, events=events, **how)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("store", ["times", "dense"])
def test_an_event_before_the_first_time_that_was_asked_for_leaves_none(
    store: str, sign: int, method: str
) -> None:
    times, span = [sign * 0.5, sign * 0.75, sign * 1.0], (0.0, sign * 1.0)
    how = {"method": method, "store": store}
    sol = asked(times, span, sign * 0.25, **how)
    assert sol.status == "event"
    assert sol.t.shape == (0,)
    assert sol.y.shape == (4, 0)
    assert sol.q.shape == (0, 2)
    (found,) = sol.events[0]
    assert found.t == sign * 0.25
    whole = pc.simulate(BOOK, q0=0.3, qd0=1, t_span=span, t_eval=times, **how)
    longer = sol.resume(span[1])
    assert longer.status == "finished"
    np.testing.assert_array_equal(longer.t, times)
    np.testing.assert_array_equal(longer.y, whole.y)


@pytest.mark.parametrize("sign", [1, -1])
def test_times_asked_for_up_to_the_event_are_there_and_no_later_one(sign: int, method: str) -> None:
    times, span = [0.0, sign * 0.25, np.nextafter(sign * 0.25, sign), sign * 1.0], (0.0, sign * 1.0)
    sol = asked(times, span, sign * 0.25, method=method)
    assert sol.t.tolist() == times[:2]
    np.testing.assert_array_equal(sol.y[:, 1], sol.events[0][0].y)
    np.testing.assert_array_equal(sol.y[:, 0], [0.3, 0.3, 1, 1])
    longer = sol.resume(span[1])
    whole = pc.simulate(BOOK, q0=0.3, qd0=1, t_span=span, t_eval=times, method=method)
    np.testing.assert_array_equal(longer.t, times)
    np.testing.assert_array_equal(longer.y, whole.y)


def test_one_time_asked_for_is_one_state_wherever_it_lies(method: str) -> None:
    whole = pc.simulate(BOOK, q0=0.3, qd0=1, t_span=(0, 1), method=method, store="dense")
    for time in (0.0, 5e-324, 1e-9, whole.t[1], np.nextafter(1.0, 0), 1.0):
        sol = pc.simulate(BOOK, q0=0.3, qd0=1, t_span=(0, 1), method=method, t_eval=[time])
        assert sol.t.tolist() == [time]
        np.testing.assert_array_equal(sol.y[:, 0], whole(time))
