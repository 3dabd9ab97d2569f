"""Compensated steps: the rounding of the state is carried on, and nothing else changes."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
FLOATING = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], gravity=0.0)
BUSY = [
    fx.ViscousJoint(1, 0.02),
    fx.Motor(2, sinusoid=fx.Sinusoid(amplitude=0.5, angular_frequency=3.0)),
    fx.DrivenPivot(y=fx.Sinusoid(amplitude=0.05, angular_frequency=11.0)),
]
METHODS = {method["name"]: method for method in _core.methods()}
EXPLICIT = [name for name, method in METHODS.items() if method["kind"] == "explicit"]
COMPENSATED = [name for name, method in METHODS.items() if method["compensates"]]


def low_part(sol):
    return sol._run.__getstate__()["position_stepper"]


def off(q0, qd0, t_end, compensated, **how):
    """How far a free rod is from its exact angle in the end, in last bits of that."""
    scene = how.pop("scene", FLOATING)
    how |= {"store": "end", "max_steps": 10**6, "compensated": compensated}
    sol = pc.simulate(scene, (0, t_end), q0, qd0, **how)
    exact = float(Fraction(qd0) * t_end + Fraction(q0))
    return abs(sol.q[-1, 0] - exact) / np.spacing(exact), sol


CORNERS = fx.Table(t=np.linspace(0, 10, 5001), torque=np.zeros(5001))
SUMS = {  # start, rate, end, options, last bits by which a carried and a rounded sum are off
    **{
        f"a hundred thousand increments, {method}": (
            (1.0, 0.3, 10_000), {"method": method, "step": 0.1}, 4, 20
        )
        for method in COMPENSATED
    },
    "radau5 at 0.1 rad/s": ((0.0, 0.1, 100), {"method": "radau5", "step": 1e-3}, 2, 10),
    # 1e-9 rad a step, where doubles are 1.5e-8 rad apart
    "increments below the last bit": ((1e8, 1e-6, 100), {"step": 1e-3}, 1, 6000),
    "five thousand corners of a table": (
        (1.0, 0.3, 10), {"scene": FLOATING.replace(effects=[fx.Motor(1, table=CORNERS)])}, 2, 10
    ),
}  # fmt: skip


@pytest.mark.parametrize("sums", SUMS)
def test_increments_add_up_to_the_last_bit(sums):
    """Without gravity the rate stays, and the angle is a sum; each increment is rounded alike."""
    (q0, qd0, t_end), how, carried, rounded = SUMS[sums]
    found, sol = off(q0, qd0, t_end, True, **how)
    assert found <= carried
    assert off(q0, qd0, t_end, False, **how)[0] > rounded
    if "scene" in how:
        assert sol.stats.limited_by_break > 4999


def increment_of_step(method, rate=0.75, h=2.0**-5):
    """Return a sum as a step forms it: in the order of weights, rounded after each but the last."""
    begins = METHODS[method]["first"]  # nothing is stiff here
    numbers = _core.tableau(begins)["b"] if begins in EXPLICIT else [(1, 1, 0)]
    *first, last = (Fraction(n / d) * Fraction(rate) for n, d, _ in numbers if n)
    sum_of_first = 0.0
    for part in first:
        sum_of_first = float(Fraction(sum_of_first) + part)
    return Fraction(h) * (Fraction(sum_of_first) + last)


@pytest.mark.parametrize("method", COMPENSATED)
def test_high_and_low_part_together_are_the_sum_to_thirty_digits(method):
    # a step, a rate and weights whose products are exact
    how = {"method": method, "step": 2.0**-5, "store": "end", "compensated": True}
    state = pc.simulate(FLOATING, (0, 2000), 1 / 3, 0.75, **how)._run.__getstate__()
    steps = round(state["position_t"] * 2**5)
    low = state["position_stepper"][0]
    increment = Fraction(state["position_y"][0]) + Fraction(low) - Fraction(1 / 3)
    # the rounding of h sum b k belongs to the increment
    assert abs(increment / (steps * increment_of_step(method)) - 1) < 2.0**-52
    assert steps > 60_000
    assert low != 0.0


@pytest.mark.parametrize("method", COMPENSATED)
@pytest.mark.parametrize("links", [1, 2, 3, 5])
def test_a_ledger_changes_no_bit_of_a_compensated_run(method, links):
    """The kernel in registers and the one in memory do the same."""
    effects = BUSY if links > 1 else BUSY[::2]
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)] * links, effects=effects)
    how = {"method": method, "step": 0.01, "store": "steps"}
    bare, booked, rounded = (
        pc.simulate(scene, (0, 5), 0.7, 1.0, **how, ledger=ledger, compensated=compensated)
        for ledger, compensated in ((False, True), (True, True), (False, False))
    )
    assert np.array_equal(bare.y, booked.y)
    assert not np.array_equal(bare.y, rounded.y)
    assert np.array_equal(low_part(bare)[: 2 * links], low_part(booked)[: 2 * links])
    if method in EXPLICIT:  # the other methods keep more than low parts
        assert len(low_part(rounded)) == 0
    assert np.count_nonzero(low_part(booked)) > links


def test_the_low_part_is_below_the_last_bit():
    how = {"method": "dop853", "max_step": 1e-3, "compensated": True}
    sol = pc.simulate(BOOK, (0, 20), [0.8, 1.0], **how)
    y = sol._run.__getstate__()["position_y"]
    assert (np.abs(low_part(sol)) <= 0.5 * np.spacing(np.abs(y))).all()


@pytest.mark.parametrize("ledger", [False, True])
def test_what_is_set_exactly_has_no_low_part(ledger):
    """A lock sets its joint's angle and rate at the end of every step."""
    scene = pc.Scene(links=BOOK.links, effects=[fx.Lock(1), fx.ViscousJoint(2, 0.1)])
    how = {"compensated": True, "ledger": ledger, "max_step": 0.01}
    sol = pc.simulate(scene, (0, 3), [0.8, 1.0], [0.0, 2.0], **how)
    assert (sol.q[:, 0] == 0.8).all()
    assert not sol.qd[:, 0].any()
    assert [bool(part) for part in low_part(sol)[:4]] == [False, True, False, True]


def test_a_low_part_of_another_state_is_refused():
    begun = pc.simulate(BOOK, (0, 1), [0.8, 1.0], method="dop853", compensated=True)
    run = _core.Run.__new__(_core.Run)
    run.__setstate__(begun._run.__getstate__() | {"position_stepper": [1e-20]})
    with pytest.raises(ValueError, match=r"the rounding errors kept"):
        run.resume(2.0, None, 1000, None, None)


@pytest.mark.parametrize("method", METHODS)
def test_methods_that_cannot_are_refused_by_name(method):
    step = None if METHODS[method]["error_order"] else 0.01
    how = {"method": method, "step": step, "compensated": True}
    if METHODS[method]["compensates"]:
        assert pc.simulate(BOOK, (0, 0.1), 0.8, **how)
    else:
        with pytest.raises(ValueError, match=rf'^compensated: method "{method}" cannot'):
            pc.simulate(BOOK, (0, 0.1), 0.8, **how)


@pytest.mark.parametrize("wrong", [1, "yes", None, np.array([True])])
def test_compensated_must_be_true_or_false(wrong):
    with pytest.raises(TypeError, match=r"^compensated = "):
        pc.simulate(BOOK, (0, 0.1), 0.8, compensated=wrong)
