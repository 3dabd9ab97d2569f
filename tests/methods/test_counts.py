"""Thousands of bounces and of crossings, counted against closed forms: none is missed or doubled.

A rod of moment of inertia 1 that swings as x'' = -sin x about the vertical, from rest at x = 1:
with k = sin(1/2), sin(x/2) = k cd(t, k), so that it is at x after K - F(asin(sin(x/2) / k), k).
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from swings import time_to
from unit_rods import rod

pytestmark = pytest.mark.unsanitized

BOTTOM, G = np.pi / 2, 2 / 3


def first_at(mark):
    return float(time_to(mark, 1, G))


def swing(*effects, t_end, rtol, **how):
    scene = rod(*effects, gravity=G)
    return pc.simulate(scene, (0, t_end), BOTTOM - 1, rtol=rtol, atol=rtol / 100, **how)


def beyond(sol, joint, bound):
    """The largest way beyond the bound, in and between the steps."""
    shares = np.array([0.0, 0.02, 0.1, 0.5, 0.9, 0.98])
    times = np.unique(sol.t[:-1, None] + np.diff(sol.t)[:, None] * shares)
    q = sol(times)[:joint]
    return float((q[-1] - (q[-2] if joint > 1 else 0) - bound).max())


@pytest.mark.few_cases
def test_over_ten_thousand_seconds_no_bounce_is_missed_and_nothing_gets_through(method):
    t_end, bound, first = 1e4, BOTTOM - 0.3, first_at("0.3")
    stop = fx.JointStop(joint=1, range=(-9.0, bound), restitution=1.0)
    sol = swing(stop, t_end=t_end, method=method, rtol=1e-10)
    assert sol.status == "finished"
    expected = np.arange(first, t_end, 2 * first)
    struck = sol.t[:-1][np.diff(sol.t) == 0]
    assert len(struck) == len(expected) > 3600
    assert np.abs(struck - expected).max() < 1e-3  # the drift of the energy
    assert beyond(sol, 1, bound) <= 1e-15


def test_bounces_of_a_driven_chain_stay_within_the_range_for_a_thousand_seconds(method):
    effects = [
        fx.JointStop(joint=2, range=(-9.0, 0.25), restitution=0.8),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=12.0, angular_frequency=3.0)),
        fx.ViscousJoint(joint=1, damping=0.5),
    ]
    scene = rod(*effects, gravity=9.81, links=2)
    sol = pc.simulate(scene, (0, 1000), BOTTOM, method=method, rtol=1e-6)
    assert sol.status == "finished"
    assert np.count_nonzero(np.diff(sol.t) == 0) > 1000
    assert beyond(sol, 2, 0.25) <= 1e-13


@pytest.mark.few_cases
@pytest.mark.parametrize("store", ["end", "dense"])
def test_over_five_thousand_seconds_every_crossing_is_found_once(store, method):
    t_end, marks = 5000.0, ["0", "0.5", "0.99999"]
    watched = [ev.JointAngle(1, BOTTOM - float(x)) for x in marks] + [ev.RateZero(joint=1)]
    sol = swing(t_end=t_end, method=method, rtol=1e-11, events=watched, store=store)
    period, n = 4 * first_at(0), np.arange(1000)
    passages = [np.sort([*(n * period + first_at(x)), *(n * period - first_at(x))]) for x in marks]
    turns = np.arange(1, 2000) * period / 2
    for found, expected in zip(sol.events, [*passages, turns], strict=True):
        due = expected[(expected > 0) & (expected < t_end)]
        assert abs(due - t_end / 2).max() < t_end / 2 - 1e-3  # none at the very end
        assert len(found) == len(due) > 1400
        assert np.abs(np.array([one.t for one in found]) - due).max() < 1e-3
        directions = np.array([one.direction for one in found])
        np.testing.assert_array_equal(directions[1:], -directions[:-1])
