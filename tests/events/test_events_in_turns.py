"""Every turn of an angle, and every crossing of the tip's line, however many lie in a step."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from turning_rod import directions, times, turning
from unit_rods import rod


@pytest.mark.parametrize("step", [0.01, 0.1, 0.5, 1.0])
def test_every_turn_of_a_spinning_rod_is_found(step):
    """At 30 rad/s each multiple of 2 pi is found, also several in a step."""
    wanted = [ev.LinkAngle(1, 1.0, every_turn=True), ev.JointAngle(1, 1.0)]
    turns, once = turning(-30.0, (0, 10), wanted, q0=0.5, step=step).events
    exact = (0.5 - (1.0 - 2 * np.pi * np.arange(1, 48))) / 30
    # There are a thousand sums, each rounded to half a last bit of 300 rad.
    assert times(turns) == pytest.approx(exact, abs=1000 * np.spacing(300.0) / 2 / 30)
    assert set(directions(turns)) == {-1}
    assert once == []


def test_turns_are_found_backward_and_far_from_zero():
    turns = ev.LinkAngle(1, 1.0 - 2e6 * np.pi, every_turn=True)
    (found,) = turning(20.0, (0, -10), [turns], q0=1e6, step=0.5).events
    first = np.ceil((1e6 - 200 - 1) / (2 * np.pi))
    exact = (1e6 - (1 + 2 * np.pi * np.arange(first, first + 32)[::-1])) / -20
    assert times(found) == pytest.approx(exact[exact < 0], abs=1e-9)
    assert set(directions(found)) == {-1}


def test_turns_without_end_end_the_run_before_the_step_that_has_them_and_say_so():
    """At 4e5 turns a step, the millionth turn comes in the third step."""
    turns = ev.LinkAngle(1, 0.0, every_turn=True, direction=-1)
    rate, span = 4e5 * 2 * np.pi, (0, 4)
    sol = turning(rate, span, [turns], q0=0.5, step=1.0, on_failure="ignore")
    assert (sol.status, sol.success) == ("max_turns", False)
    assert [*sol.t] == [0.0, 1.0, 2.0]
    assert sol.stats.accepted == 2
    assert sol.message.startswith("event 1 (link_angle): every_turn = true: ")
    longer, whole = sol.resume(4.0), turning(rate, span, [], q0=0.5, step=1.0)
    assert longer.status == "finished"
    np.testing.assert_array_equal(longer.y, whole.y)
    assert longer.stats == whole.stats


def test_a_turn_a_step_is_never_too_many():
    turns = ev.LinkAngle(1, 1.0, every_turn=True, direction=-1)
    sol = turning(6.0, (0, 1_100_000), [turns], q0=0.5, step=1.0, store="end")
    assert sol.status == "finished"


def test_a_step_of_more_turns_than_numbers_ends_the_run():
    turns = ev.LinkAngle(1, 0.0, every_turn=True)
    sol = turning(1e300, (0, 1), [turns], q0=0.5, step=1.0, on_failure="ignore")
    assert (sol.status, sol.t[-1], sol.events) == ("max_turns", 0.0, [[]])


SWAY = fx.DrivenPivot(
    x=fx.Sinusoid(amplitude=0.3, angular_frequency=5.0),
    y=fx.Sinusoid(amplitude=0.1, angular_frequency=11.0, phase=1.0),
)
ALONG = fx.DrivenPivot(
    spline=fx.Spline(
        t=[-4, -2, 0, 1, 4], x=[0.1, -0.3, 0.0, 0.5, 0.0], y=[0.2, 0.0, 0.1, 0.2, -0.3]
    )
)
PIVOTS = {"fixed": [], "sway": [SWAY], "along": [ALONG]}


@pytest.mark.parametrize("step", [1.0, 0.25, 0.1])
@pytest.mark.parametrize("sense", [1, -1])
def test_a_spinning_tip_crosses_a_line_twice_a_turn(step, sense, method):
    """As q = 7 t exactly, x = 0.3 where cos(7 t) = 0.3, several times in a step."""
    line = ev.TipLine((0.3, 5.0), (2.0, 0.0))
    (found,) = turning(7.0, (0, 10 * sense), [line], method=method, step=step).events
    turns = 2 * np.pi * np.arange(14)
    exact = np.sort(np.concatenate([turns + np.arccos(0.3), turns - np.arccos(0.3)]))
    exact = exact[(exact > 0) & (exact <= 70)] / 7
    assert times(found) == pytest.approx(sense * exact, abs=1e-13)
    assert directions(found) == [-1, 1] * (len(found) // 2) + [-1] * (len(found) % 2)


@pytest.mark.few_cases
@pytest.mark.parametrize("pivot", PIVOTS)
@pytest.mark.parametrize("sense", [1, -1])
@pytest.mark.parametrize("start", [[-1.4, -1.1, 0.3], [0.8, 1.0, 1.2], [0.1, -2.0, 3.0]])
def test_no_crossing_that_samples_see_is_missed(pivot, start, sense, method):
    links = [pc.Link(mass=1, length=length) for length in (0.7, 0.5, 0.3)]
    scene = pc.Scene(links=links, effects=PIVOTS[pivot])
    lines = [
        ev.TipLine((0.1, 0.2), (1.0, 0.0)), ev.TipLine((0.0, 0.9), (0.3, 1.0)),
        ev.TipLine((-0.4, 0.3), (1.0, -2.0)), ev.TipLine((5.0, 5.0), (1.0, 0.0)),
    ]  # fmt: skip
    sol = pc.simulate(scene, (0, 4 * sense), start, method=method, rtol=1e-6, events=lines)

    def distance(line, t):
        """Return normal . (tip - point), from the states between the steps."""
        tips = scene._compiled.positions(t, np.ascontiguousarray(sol(t)[:3].T))[:, -1]
        return (tips - np.array(line.point)) @ np.array(line.normal)

    t = np.linspace(0, 4, 100_001)
    for line, found in zip(lines, sol.events, strict=True):
        at = np.array(times(found))
        assert np.all(np.diff(sense * at) >= 0)
        signs = np.sign(distance(line, sense * t))
        seen = np.flatnonzero(np.diff(signs))
        between = np.histogram(sense * at, t)[0]
        assert np.all(between[seen] % 2 == 1)
        assert np.all(np.delete(between, seen) % 2 == 0)
        assert np.abs(distance(line, at)).max(initial=0.0) < 1e-13
        rising = directions(found)
        assert rising == [1 if k % 2 == (signs[0] > 0) else -1 for k in range(len(found))]
    assert sum(map(len, sol.events)) > 4
    assert sol.events[3] == []


def test_a_pivot_alone_takes_a_tip_across(method):
    """The rod is locked where it hangs, and the pivot sways: x = 0.3 sin 5 t crosses 0.2."""
    scene, how = rod(SWAY, fx.Lock(joint=1)), {"method": method, "step": 1.0}
    line = ev.TipLine((0.2, 0.0), (1.0, 0.0))
    (found,) = pc.simulate(scene, (0, 2), np.pi / 2, events=[line], **how).events
    phase = np.arcsin(0.2 / 0.3)
    exact = np.array([phase, np.pi - phase, 2 * np.pi + phase, 3 * np.pi - phase]) / 5
    assert times(found) == pytest.approx(exact, abs=1e-15)
