"""The method of a run that names none: what the rule takes where, and that it is taken once."""

from __future__ import annotations

import inspect
import pickle

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
START = [0.8, 1.0]
ROD = pc.Link(mass=1.0, length=1.0)


def with_(*effects, links=2):
    return pc.Scene(links=[ROD] * links, effects=effects)


DRAG = with_(fx.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03))
SMOOTH = with_(
    fx.ViscousJoint(joint=1, damping=0.3, damping2=0.1),
    fx.TorsionalSpring(joint=2, stiffness=8.0),
    fx.Motor(joint=1, pd=fx.PD(kp=20.0, kd=3.0, reference=0.5), limit=4.0),
    fx.DryJointFriction(joint=2, coulomb=0.1),
    fx.DrivenPivot(y=fx.Sinusoid(0.02, 5.0)),
)
STIFF = with_(fx.ViscousJoint(joint=2, damping=1e6 / 3))
ONE = with_(links=1)


def default(scene, t_end=0.1, **how):
    return pc.simulate(scene, (0, t_end), np.linspace(*START, len(scene.links)), **how)


def assert_same(one, other):
    assert one.method == other.method
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.y, other.y)
    assert one.stats == other.stats


def test_to_name_no_method_is_to_name_the_rule():
    assert inspect.signature(pc.simulate).parameters["method"].default == "auto"
    assert_same(default(BOOK, method="auto"), default(BOOK))


@pytest.mark.parametrize(
    ("scene", "how", "method"),
    [
        (BOOK, {}, "taylor-radau5"),
        (BOOK, {"rtol": 1e-3, "atol": 1e-6}, "taylor-radau5"),
        (BOOK, {"ledger": True, "compensated": True}, "taylor-radau5"),
        (SMOOTH, {}, "taylor-radau5"),
        (with_(links=30), {}, "taylor-radau5"),
        (STIFF, {}, "taylor-radau5"),
        (ONE, {}, "dop853-radau5"),
        (DRAG, {}, "dop853-radau5"),
        (with_(fx.DryJointFriction(joint=1, coulomb=0.1, static=0.2)), {}, "dop853-radau5"),
        (with_(fx.User(lambda t, q, qd: -0.1 * qd)), {}, "dop853-radau5"),
        (BOOK, {"step": 1e-2}, "dopri5"),
        (BOOK, {"step": 1e-2, "rtol": 1e-3, "atol": 1e-3}, "dopri5"),
        (ONE, {"step": 1e-2, "rtol": 1e-3}, "dopri5"),
        (DRAG, {"step": 1e-2}, "dopri5"),
        (DRAG, {"rtol": 9e-7}, "dop853-radau5"),
        (DRAG, {"rtol": [1e-3, 1e-3, 1e-3, 1e-9]}, "dop853-radau5"),
        (DRAG, {"rtol": 1e-6}, "dopri5-radau5"),
        (DRAG, {"atol": 1e-4}, "dopri5-radau5"),
        (ONE, {"rtol": 1e-3}, "dopri5-radau5"),
    ],
)
def test_each_branch_of_the_rule(scene, how, method):
    sol = default(scene, **how)
    assert sol.success
    assert sol.method == method
    assert np.array_equal(sol.y, default(scene, **how | {"method": method}).y)


@pytest.mark.parametrize(
    ("q0", "span"), [(START, (0, 1e-3)), ([3.0, -3.0], (0, 0)), ([0.0, 0.0], (5, 4))]
)
def test_neither_start_nor_end_has_a_say(q0, span):
    run = pc.simulate(STIFF, span, q0, [1e3, 0], max_steps=100, on_failure="ignore")
    assert run.method == "taylor-radau5"


@pytest.mark.parametrize("scene", [BOOK, DRAG, STIFF], ids=["bare", "drag", "stiff"])
def test_what_ran_goes_on_and_runs_again_without_the_rule(scene):
    whole = default(scene, 1.0)
    case = whole.case()
    assert case.options["method"] == whole.method != "auto"
    assert_same(case.simulate(), whole)
    assert_same(pickle.loads(pickle.dumps(default(scene, 0.4))).resume(1.0), whole)


def test_tolerances_have_no_say_in_a_fixed_step():
    assert_same(*(default(DRAG, 1.0, step=1e-2, rtol=rtol) for rtol in (1e-3, 1e-12)))


def test_a_fixed_step_that_is_too_long_is_told_so():
    sol = default(STIFF, 5.0, step=1e-2, on_failure="ignore")
    assert sol.status == "non_finite"
    assert 'a shorter one helps, or method="radau5"' in sol.message


def test_in_fixed_steps_a_pair_changes_over_where_it_is_named_and_the_default_does_not():
    scene = with_(fx.ViscousJoint(joint=2, damping=1e3))
    named, unnamed = (
        default(scene, 0.5, step=2.5e-4, **how) for how in ({"method": "dopri5-radau5"}, {})
    )
    assert "went on with radau5" in named.message
    assert unnamed.method == "dopri5"
    assert unnamed.success
    assert "went on" not in unnamed.message


# A mode of 5e3 1/s that settles, beside a spring whose swing the steps have to follow.
SPRING = fx.TorsionalSpring(joint=4, stiffness=2000.0, rest_angle=0.3)
SETTLING = with_(SPRING, fx.ViscousJoint(joint=2, damping=280.0), links=4)


def settle(**how):
    return pc.simulate(SETTLING, (0, 5), [0.9, 1.0, 1.1, 1.2], **how)


def test_the_default_stays_with_its_first_method_where_radau5_does_not_pay():
    unnamed, by_name = settle(), settle(method="taylor")
    assert unnamed.stats.stiff
    assert by_name.stats.stiff
    assert unnamed.stats.accepted <= by_name.stats.accepted
    assert np.array_equal(unnamed.y, by_name.y)
    assert "but radau5 does not pay" in unnamed.message


def test_a_run_that_is_about_to_ask_goes_on_bit_by_bit():
    whole, found, asked = settle(), 1, []
    assert whole.stats.njev > 0
    while not settle(max_steps=found, on_failure="ignore").stats.stiff:
        found += 1
    for cap in range(found - 1, found + 3):
        begun = settle(max_steps=cap, on_failure="ignore")
        asked.append(begun.stats.stiff and begun.stats.njev == 0)
        resumed = pickle.loads(pickle.dumps(begun)).resume(5)
        assert_same(whole, resumed)
        assert whole.message == resumed.message
    assert asked == [False, True, False, False]  # one ends between last hit and trial


def test_a_method_that_is_none_is_refused_with_the_rule_among_those_there_are():
    with pytest.raises(ValueError, match="must be one of auto, dopri5, RK45"):
        default(BOOK, method="automatic")
    with pytest.raises(ValueError, match='"auto": must be one of dopri5, RK45'):
        pc._core.tableau("auto")


def test_a_run_of_before_the_rule_is_the_pair_that_it_was():
    kept = default(BOOK, method="dopri5-radau5")._run
    again = type(kept).__new__(type(kept))
    again.__setstate__(kept.__getstate__() | {"method": "auto"})
    assert again.method == "dopri5-radau5"
