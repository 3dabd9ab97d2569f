"""Events agree with a scan that shares no code: NumPy's roots of the run's polynomials."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.polynomial import polynomial
from pendcore import _core
from pendcore import events as ev
from sweeps import random_examples

METHODS = [m["name"] for m in _core.methods() if m["error_order"] and m["kind"] != "pair"]
"""These methods have an interpolant of their own."""

CLEAR = 1e-6
"""Roots nearer to each other, in shares of a step, may be found by only one of scan and event."""

LAST_BITS = 8
"""By how many last bits of the sum of their sizes a sum of terms may be off."""

angles = st.floats(-3.1, 3.1)
rates = st.floats(-8, 8)


def pieces(sol):
    """Yield start, size and coefficients (degree + 1, dimension) of each step's polynomial."""
    state = sol._run.__getstate__()
    steps = len(state["dense_h"])
    rows = state["dense_coefficients"].reshape(steps, state["dense_degree"] + 1, -1)
    yield from zip(state["dense_start"], state["dense_h"], rows, strict=True)


def crossings(sol, weights, value):
    """Return the zeros of ``weights . y - value`` between the steps.

    Each comes with the slope there, and with the size of the polynomial's terms, whose last bit is
    what the value there is rounded to.
    """
    found = []
    for start, h, rows in pieces(sol):
        p = rows @ weights
        p[0] -= value
        zeros = polynomial.polyroots(polynomial.polytrim(p, 1e-60 * np.abs(p).max()))
        near = zeros[(np.abs(zeros.imag) < CLEAR) & (np.abs(zeros.real - 0.5) < 0.5 + CLEAR)]
        # Roots at an end, or where the curve nearly touches, are left to other tests.
        assume(np.all(np.abs(np.abs(near.real - 0.5) - 0.5) > CLEAR))
        assume(np.all(np.diff(np.sort(near.real)) > CLEAR))
        slopes = polynomial.polyval(near.real, polynomial.polyder(p)) / abs(h)
        size = (np.abs(rows) @ np.abs(weights)).sum()
        of_step = zip(start + near.real * h, slopes, [size] * len(slopes), strict=True)
        found += sorted(of_step, key=lambda one: one[0] * np.sign(h))
    return found


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=random_examples(60))
@given(
    n=st.integers(1, 3), data=st.data(), t_end=st.sampled_from([3.0, -3.0]),
    step=st.sampled_from([None, 0.1, 0.03]), friction=st.booleans(),
)  # fmt: skip
def test_angles_and_rates_are_found_where_a_scan_finds_them(method, n, data, t_end, step, friction):
    effects = [pc.effects.ViscousJoint(joint=1, damping=0.05)] if friction else []
    links = [pc.Link(mass=1 + 0.3 * i, length=1 - 0.2 * i) for i in range(n)]
    q0, qd0 = (data.draw(st.lists(what, min_size=n, max_size=n)) for what in (angles, rates))
    number, value = data.draw(st.integers(1, n)), data.draw(angles)
    link, joint = np.eye(n)[number - 1], np.eye(n)[number - 1] - np.eye(n, k=1)[:, number - 1]
    none = np.zeros(n)
    watched = [
        (ev.LinkAngle(number, value), np.concatenate([link, none]), value),
        (ev.JointAngle(number, value), np.concatenate([joint, none]), value),
        (ev.RateZero(link=number), np.concatenate([none, link]), 0.0),
        (ev.RateZero(joint=number), np.concatenate([none, joint]), 0.0),
    ]
    how = {"step": step} if step else {"rtol": 1e-5, "atol": 1e-8}
    how |= {"method": method, "events": [event for event, _, _ in watched]}
    scene = pc.Scene(links=links, effects=effects)
    sol = pc.simulate(scene, (0, t_end), q0, qd0, on_failure="ignore", **how)
    assume(sol.success and np.abs(sol.qd).max() < 50)
    for found, (_, weights, level) in zip(sol.events, watched, strict=True):
        # A start that is on the level but for rounding has no event; the scan would see a crossing.
        assume(abs(weights @ np.concatenate([q0, qd0]) - level) > 1e-12)
        expected = crossings(sol, weights, level)
        assert [one.direction for one in found] == [np.sign(slope) for _, slope, _ in expected]
        assert np.allclose([one.t for one in found], [t for t, *_ in expected], rtol=0, atol=1e-9)
        for one, (t, slope, size) in zip(found, expected, strict=True):
            within_two_last_bits_of_time = 2 * abs(slope) * np.spacing(abs(t))
            rounding = LAST_BITS * np.spacing(size + abs(level))
            assert abs(weights @ one.y - level) <= rounding + within_two_last_bits_of_time


@pytest.mark.parametrize("method", METHODS)
@settings(max_examples=random_examples(40))
@given(
    q0=st.lists(angles, min_size=2, max_size=2), qd0=st.lists(rates, min_size=2, max_size=2),
    point=st.tuples(st.floats(-2, 2), st.floats(-2, 2)), angle=angles,
    step=st.sampled_from([0.1, 0.03]), sense=st.sampled_from([1, -1]),
)  # fmt: skip
def test_the_tip_crosses_where_a_dense_scan_of_it_changes_sign(
    method: str, q0: list[float], qd0: list[float], point: tuple[float, float], angle: float,
    step: float, sense: int,
) -> None:  # fmt: skip
    normal = (np.cos(angle), np.sin(angle))
    line = ev.TipLine(point, normal)
    book = pc.Scene.textbook()
    how = {"method": method, "step": step, "events": [line], "on_failure": "ignore"}
    sol = pc.simulate(book, q0=q0, qd0=qd0, t_span=(0, 2 * sense), **how)
    assume(sol.success and np.abs(sol.qd).max() < 50)  # at such rates steps follow it
    times = np.array([one.t for one in sol.events[0]])
    theta = np.linspace(0, 1, 2001)
    for start, h, rows in pieces(sol):
        q = polynomial.polyval(theta, rows)[:2]
        tip = np.cos(q).sum(axis=0), np.sin(q).sum(axis=0)
        g = normal[0] * (tip[0] - point[0]) + normal[1] * (tip[1] - point[1])
        assume(np.abs(g).min() > 1e-13)
        here = (times - start) / h
        between = np.histogram(here[(here >= 0) & (here <= 1)], theta)[0]
        changes = np.diff(np.sign(g)) != 0
        assert np.all(between[changes] % 2 == 1)
        assert np.all(between[~changes] % 2 == 0)
