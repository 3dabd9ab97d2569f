"""Compensated steps: the rounding of the state is carried on, and nothing else changes."""

from __future__ import annotations

import pickle
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
EXPLICIT = [m["name"] for m in _core.methods() if m["kind"] == "explicit"]
COMPENSATED = [name for name, method in METHODS.items() if method["compensates"]]


def low_part(sol: pc.Solution) -> np.ndarray:
    return sol._run.__getstate__()["position_stepper"]


@pytest.mark.parametrize("method", COMPENSATED)
def test_a_hundred_thousand_increments_add_up_to_the_last_bit(method: str) -> None:
    """Without gravity the rate stays, and the angle is a sum of equal increments."""
    how = {"method": method, "step": 0.1, "store": "end"}
    exact = float(Fraction(0.3) * 10_000 + 1)
    rounded, carried = (
        abs(
            pc.simulate(FLOATING, q0=1.0, qd0=0.3, t_span=(0, 10_000), **how, compensated=c).q[
                -1, 0
            ]
            - exact
        )
        for c in (False, True)
    )
    ulp = np.spacing(exact)
    assert carried <= 4 * ulp  # the increment's own rounding, the same each time
    assert rounded > 20 * ulp


def increment_of_step(method: str, rate: float = 0.75, h: float = 2.0**-5) -> Fraction:
    """Return a sum as a step forms it: in the order of weights, rounded after each but the last."""
    begins = METHODS[method]["first"]  # nothing is stiff here
    numbers = _core.tableau(begins)["b"] if begins in EXPLICIT else [(1, 1, 0)]
    *first, last = (Fraction(n / d) * Fraction(rate) for n, d, _ in numbers if n)
    sum_of_first = 0.0
    for part in first:
        sum_of_first = float(Fraction(sum_of_first) + part)
    return Fraction(h) * (Fraction(sum_of_first) + last)


@pytest.mark.parametrize("method", COMPENSATED)
def test_high_and_low_part_together_are_the_sum_to_thirty_digits(method: str) -> None:
    # a step, a rate and weights whose products are exact
    sol = pc.simulate(
        FLOATING,
        q0=1 / 3,
        qd0=0.75,
        t_span=(0, 2000),
        method=method,
        step=2.0**-5,
        store="end",
        compensated=True,
    )
    state = sol._run.__getstate__()
    steps = round(state["position_t"] * 2**5)
    found = Fraction(state["position_y"][0]) + Fraction(state["position_stepper"][0])
    increment = found - Fraction(1 / 3)
    # the rounding of h sum b k belongs to the increment
    assert abs(increment / (steps * increment_of_step(method)) - 1) < 2.0**-52
    assert steps > 60_000
    assert state["position_stepper"][0] != 0.0


@pytest.mark.parametrize("method", COMPENSATED)
@pytest.mark.parametrize("links", [1, 2, 3, 5])
def test_a_ledger_changes_no_bit_of_a_compensated_run(method: str, links: int) -> None:
    """The kernel in registers and the one in memory do the same."""
    effects = BUSY if links > 1 else BUSY[:1] + BUSY[2:]
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)] * links, effects=effects)
    how = {"method": method, "compensated": True, "step": 0.01, "store": "steps"}
    bare = pc.simulate(scene, q0=0.7, qd0=1.0, t_span=(0, 5), **how)
    booked = pc.simulate(scene, q0=0.7, qd0=1.0, t_span=(0, 5), **how, ledger=True)
    rounded = pc.simulate(scene, q0=0.7, qd0=1.0, t_span=(0, 5), **(how | {"compensated": False}))
    assert np.array_equal(bare.y, booked.y)
    assert not np.array_equal(bare.y, rounded.y)
    assert np.array_equal(low_part(bare)[: 2 * links], low_part(booked)[: 2 * links])
    if method in EXPLICIT:  # the other methods keep more than low parts
        assert len(low_part(rounded)) == 0
    assert np.count_nonzero(low_part(booked)) > links


def test_the_low_part_is_below_the_last_bit() -> None:
    how = {"method": "dop853", "max_step": 1e-3, "compensated": True}
    sol = pc.simulate(BOOK, q0=[0.8, 1.0], qd0=0, t_span=(0, 20), **how)
    y = sol._run.__getstate__()["position_y"]
    assert (np.abs(low_part(sol)) <= 0.5 * np.spacing(np.abs(y))).all()


def test_increments_below_the_last_bit_of_a_large_angle_are_not_lost() -> None:
    how = {"step": 1e-3, "store": "end", "max_steps": 10**6}
    rounded, carried = (
        pc.simulate(FLOATING, q0=1e8, qd0=1e-6, t_span=(0, 100), **how, compensated=c).q[-1, 0]
        - 1e8
        for c in (False, True)
    )
    assert rounded == 0.0  # 1e-9 rad a step, where doubles are 1.5e-8 rad apart
    assert carried == pytest.approx(1e-4, abs=np.spacing(1e8))


@pytest.mark.parametrize("stop", [0.0, 1e-4, 3.21])
@pytest.mark.parametrize("ledger", [False, True])
def test_a_compensated_run_goes_on_as_if_it_had_never_stopped(stop: float, ledger: bool) -> None:
    scene = pc.Scene(links=BOOK.links, effects=BUSY)
    how = {"compensated": True, "ledger": ledger, "max_step": 0.01}
    whole = pc.simulate(scene, q0=[0.8, 1.0], qd0=0, t_span=(0, 6), **how)
    begun = pc.simulate(scene, q0=[0.8, 1.0], qd0=0, t_span=(0, stop), **how)
    resumed = pickle.loads(pickle.dumps(begun)).resume(6)
    assert np.array_equal(resumed.t, whole.t)
    assert np.array_equal(resumed.y, whole.y)
    assert np.array_equal(low_part(resumed), low_part(whole))
    assert resumed.case() == whole.case()


def test_a_low_part_of_another_state_is_refused() -> None:
    begun = pc.simulate(
        BOOK, q0=[0.8, 1.0], qd0=0, t_span=(0, 1), method="dop853", compensated=True
    )
    state = begun._run.__getstate__() | {"position_stepper": [1e-20]}
    run = _core.Run.__new__(_core.Run)
    run.__setstate__(state)
    with pytest.raises(ValueError, match=r"the rounding errors kept"):
        run.resume(2.0, None, 1000, None, None)


def test_what_is_set_exactly_has_no_low_part() -> None:
    """A lock sets its joint's angle and rate at the end of every step."""
    scene = pc.Scene(links=BOOK.links, effects=[fx.Lock(1), fx.ViscousJoint(2, 0.1)])
    for ledger in (False, True):
        how = {"compensated": True, "ledger": ledger, "max_step": 0.01}
        sol = pc.simulate(scene, q0=[0.8, 1.0], qd0=[0.0, 2.0], t_span=(0, 3), **how)
        low = low_part(sol)
        assert (sol.q[:, 0] == 0.8).all()
        assert not sol.qd[:, 0].any()
        assert (low[0], low[2]) == (0.0, 0.0)
        assert low[1] != 0.0
        assert low[3] != 0.0


def test_what_a_change_of_law_leaves_alone_keeps_its_low_part() -> None:
    """Five thousand corners of a table add no rounding of their own."""
    table = fx.Table(t=np.linspace(0, 10, 5001), torque=np.zeros(5001))
    scene = pc.Scene(links=FLOATING.links, gravity=0.0, effects=[fx.Motor(1, table=table)])
    exact = float(1 + Fraction(0.3) * 10)
    rounded, carried = (
        pc.simulate(scene, q0=1.0, qd0=0.3, t_span=(0, 10), compensated=c, store="end")
        for c in (False, True)
    )
    assert carried.stats.limited_by_break > 4999
    assert abs(carried.q[-1, 0] - exact) <= 2 * np.spacing(exact)
    assert abs(rounded.q[-1, 0] - exact) > 10 * np.spacing(exact)


def test_methods_that_cannot_are_refused_by_name() -> None:
    for name, method in METHODS.items():
        step = None if method["error_order"] else 0.01
        if method["compensates"]:
            assert pc.simulate(
                BOOK, q0=0.8, qd0=0, t_span=(0, 0.1), method=name, step=step, compensated=True
            )
        else:
            with pytest.raises(ValueError, match=rf'^compensated: method "{name}" cannot'):
                pc.simulate(
                    BOOK, q0=0.8, qd0=0, t_span=(0, 0.1), method=name, step=step, compensated=True
                )


@pytest.mark.parametrize("wrong", [1, "yes", None, np.array([True])])
def test_compensated_must_be_true_or_false(wrong: object) -> None:
    with pytest.raises(TypeError, match=r"^compensated = "):
        pc.simulate(BOOK, q0=0.8, qd0=0, t_span=(0, 0.1), compensated=wrong)


def test_a_case_keeps_compensated(tmp_path) -> None:
    case = pc.Case(scene=BOOK, q0=0.8, t_span=(0, 1), options={"compensated": True})
    assert "compensated = true\n" in case.to_toml()
    sol = case.simulate()
    assert sol.case().options == case.options | {"method": "taylor-radau5"}
    sol.save(tmp_path / "run.npz")
    assert pc.load(tmp_path / "run.npz").case() == sol.case()
