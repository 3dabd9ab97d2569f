"""Thousands of bounces and of crossings, counted against closed forms: none is missed or doubled.

A rod of moment of inertia 1 that swings as x'' = -sin x about the vertical, from rest at x = 1:
with k = sin(1/2), sin(x/2) = k cd(t, k), so that it is at x after K - F(asin(sin(x/2) / k), k).
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from mpmath import asin, ellipf, ellipk, mpf, sin  # type: ignore[import-untyped]
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod

pytestmark = pytest.mark.unsanitized

GRAVITY = 2 / 3
BOTTOM = np.pi / 2


@functools.cache
def time_to(x: str) -> float:
    k = sin(mpf(1) / 2)
    return float(ellipk(k**2) - ellipf(asin(sin(mpf(x) / 2) / k), k**2))


def swing(*effects: Any, t_end: float, rtol: float, **how: Any) -> pc.Solution:
    scene = rod(*effects, gravity=GRAVITY)
    return pc.simulate(
        scene, q0=BOTTOM - 1, qd0=0, t_span=(0, t_end), rtol=rtol, atol=rtol / 100, **how
    )


def beyond(sol: pc.Solution, joint: int, bound: float) -> float:
    """The largest way beyond the bound, in and between the steps."""
    shares = np.array([0.0, 0.02, 0.1, 0.5, 0.9, 0.98])
    times = np.unique(sol.t[:-1, None] + np.diff(sol.t)[:, None] * shares)
    q = sol(times)[:joint]
    return float((q[-1] - (q[-2] if joint > 1 else 0) - bound).max())


def test_over_ten_thousand_seconds_no_bounce_is_missed_and_nothing_gets_through(
    method: str,
) -> None:
    t_end, bound = 1e4, BOTTOM - 0.3
    stop = fx.JointStop(joint=1, range=(-9.0, bound), restitution=1.0)
    sol = swing(stop, t_end=t_end, method=method, rtol=1e-10)
    assert sol.status == "finished"
    first = time_to("0.3")
    expected = np.arange(first, t_end, 2 * first)
    struck = sol.t[:-1][np.diff(sol.t) == 0]
    assert len(struck) == len(expected) > 3600
    assert np.abs(struck - expected).max() < 1e-3  # the drift of the energy
    assert beyond(sol, 1, bound) <= 1e-15


def test_bounces_of_a_driven_chain_stay_within_the_range_for_a_thousand_seconds(
    method: str,
) -> None:
    scene = rod(
        fx.JointStop(joint=2, range=(-9.0, 0.25), restitution=0.8),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=12.0, angular_frequency=3.0)),
        fx.ViscousJoint(joint=1, damping=0.5),
        gravity=9.81,
        links=2,
    )
    sol = pc.simulate(scene, q0=BOTTOM, qd0=0, t_span=(0, 1000), method=method, rtol=1e-6)
    assert sol.status == "finished"
    assert np.count_nonzero(np.diff(sol.t) == 0) > 1000
    assert beyond(sol, 2, 0.25) <= 1e-13


@pytest.mark.parametrize("store", ["end", "dense"])
def test_over_five_thousand_seconds_every_crossing_is_found_once(store: str, method: str) -> None:
    t_end = 5000.0
    marks = {"0": 0.0, "0.5": 0.5, "0.99999": 0.99999}
    watched = [ev.JointAngle(1, BOTTOM - x) for x in marks.values()]
    sol = swing(
        t_end=t_end, method=method, rtol=1e-11, events=[*watched, ev.RateZero(joint=1)], store=store
    )
    period = 4 * time_to("0")
    passages = {
        x: np.sort([n * period + way for n in range(1000) for way in (time_to(x), -time_to(x))])
        for x in marks
    }
    turns = np.arange(1, 2000) * period / 2
    for found, expected in zip(sol.events, [*passages.values(), turns], strict=True):
        due = expected[(expected > 0) & (expected < t_end)]
        assert abs(due - t_end / 2).max() < t_end / 2 - 1e-3  # none at the very end
        assert len(found) == len(due) > 1400
        assert np.abs(np.array([one.t for one in found]) - due).max() < 1e-3
        directions = np.array([one.direction for one in found])
        np.testing.assert_array_equal(directions[1:], -directions[:-1])
