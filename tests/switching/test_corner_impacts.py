"""Impacts that alternate ever faster between two stops, past the last of infinitely many.

The core is compared with the solution event by event in many digits (corner_impacts.py). In such a
corner the gaps shrink faster than the rates. When the gaps are below the last bits of the angles,
much of the speed may be left. What becomes of it depends on the further impacts, all at what is one
time for a double.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from corner_impacts import TIMES, CornerCase, corner_cases, drawn
from dense_chain import DenseChain
from pendcore import effects as fx
from reference.many_digit_contacts import Stop
from reference.stopped_rods import StoppedRods
from reference.taylor_series import RodChain, motion
from unit_rods import links

CASES = corner_cases()
FINE = {"rtol": 1e-13, "atol": 1e-15}


def named(case: CornerCase) -> str:
    return f"scene {case.seed}"


# The reference ----------------------------------------------------------------------------------


@pytest.mark.parametrize("case", CASES, ids=named)
def test_the_record_does_not_depend_on_its_digits(case: CornerCase) -> None:
    assert case.disagreement <= 1e-15
    again = case.computed([45])
    np.testing.assert_allclose(again.q, case.q, rtol=0, atol=1e-15)


def test_without_stops_in_reach_the_reference_is_the_motion_in_many_digits() -> None:
    chain = RodChain([1.0, 0.7], [0.9, 0.6], 9.807)
    far = [Stop(joint, side * 100.0, side, 0.5, 1e-9) for joint in (0, 1) for side in (-1, 1)]
    rods = StoppedRods(chain=chain, stops=far, digits=40)
    exact = motion(chain, [0.3, 1.1], [0.5, -2.0], list(TIMES))
    found = rods.run([0.3, 1.1], [0.5, -2.0], TIMES)
    np.testing.assert_array_equal(found, [[float(x) for x in row] for row in exact])
    assert rods.events == []


def test_bounces_of_one_rod_in_the_reference_are_over_when_their_series_says() -> None:
    """Small bounces, pressed on by gravity: t_1 + (2 w_1/a) e/(1 - e), a = 3 g/(2 L)."""
    height, e = 1e-8, 0.6
    rod = RodChain([2.0], [1.5], 9.807)
    rods = StoppedRods(chain=rod, stops=[Stop(0, 0.0, 1, e, 1e-15)], digits=40)
    rods.run([-height], [0.0], [0.01])
    pressed = 3 * 9.807 / (2 * 1.5)
    first = np.sqrt(2 * height / pressed)
    assert rods.events[0].t == pytest.approx(first, rel=1e-7)
    assert rods.events[-1].t == pytest.approx(first * (1 + 2 * e / (1 - e)), rel=1e-7)
    assert len(rods.events) > 40


# The core ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("start", [0.0, 1000.0])
@pytest.mark.parametrize("case", CASES, ids=named)
def test_a_run_through_a_corner_ends_where_its_impacts_lead(
    case: CornerCase, start: float, method: str
) -> None:
    """However late the run began: where time is coarser, more of the impacts are at one time."""
    sol = case.simulate(start, method=method, **FINE)
    assert sol.success, sol.message
    assert case.off(sol, start) < (1e-9 if start == 0.0 else 1e-7)
    if start == 0.0 and case.seed in {33, 121, 134}:  # two stops at most in any corner
        assert "rounding" not in sol.message


def test_a_run_through_a_corner_of_three_stops_says_that_rounding_has_decided() -> None:
    """Here even fifty digits more change what follows."""
    case = drawn(229)
    sol = case.simulate(**FINE)
    assert sol.success
    assert "stops were struck within the last bits of one time" in sol.message
    at = float(sol.message.split("at t = ")[1].split()[0])
    assert np.abs(sol.t - at).min() < 1e-12
    assert sol.resume(2.5).message.count("within the last bits of one time") == 1


TWO = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=0.0)


@pytest.mark.parametrize(("apart", "is_told"), [(0.0, True), (1e-9, False)])
def test_two_stops_reached_at_one_time_are_told_as_for_rounding_to_say(
    apart: float, is_told: bool
) -> None:
    """Both joints turn towards stops that they reach at 0.05 s, or one of them a little later."""
    free = pc.Scene(links=links(TWO), gravity=0.0)
    reached = pc.simulate(free, q0=[0.3, 0.9], qd0=[1.0, 4.0], t_span=(0, 0.05), **FINE).q[-1]
    ends = reached[0], reached[1] - reached[0] + apart
    stops = [
        fx.JointStop(joint=j + 1, range=(-np.inf, end), restitution=0.5)
        for j, end in enumerate(ends)
    ]
    sol = pc.simulate(
        free.replace(effects=stops), q0=[0.3, 0.9], qd0=[1.0, 4.0], t_span=(0, 0.06), **FINE
    )
    assert ("rounding has decided" in sol.message) == is_told


def test_impacts_at_the_very_start_are_one_problem_and_need_no_remark() -> None:
    stops = [fx.JointStop(joint=j, range=(-1.0, end)) for j, end in ((1, 0.3), (2, 0.5))]
    scene = pc.Scene(links=links(TWO), gravity=0.0, effects=stops)
    sol = pc.simulate(scene, q0=[0.3, 0.8], qd0=[1.0, 4.0], t_span=(0, 0.1))
    assert sol.t[1] == 0.0
    assert "rounding" not in sol.message
