"""A run tells its energies, where they went if it kept a ledger, and whether it can be trusted."""

from __future__ import annotations

import copy
import pickle
from functools import partial
from math import pi

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

ROD = pc.Link(mass=1.0, length=1.0)
DAMPED = pc.Scene(links=[ROD, ROD], effects=[
    fx.ViscousJoint(1, 0.3), fx.ViscousJoint(2, 0.1), fx.Motor(2, sinusoid=fx.Sinusoid(2.0, 6.0)),
    fx.TorsionalSpring(2, 3.0)])  # fmt: skip
START = {"q0": [0.5, 1.0], "qd0": [1.0, -1.0]}
simulate = partial(pc.simulate, DAMPED, (0, 3), **START)


@pytest.fixture(scope="module")
def sol():
    return simulate(ledger=True)


@pytest.fixture(scope="module")
def ledger(sol):
    return sol.energy().ledger


def are_same(ledger, other):
    return [*ledger] == [*other] and all(np.array_equal(ledger[x], other[x]) for x in ledger)


def test_a_ledger_has_an_entry_for_each_account_of_the_scene_and_what_is_left_over(sol, ledger):
    assert [*ledger] == ["viscous", "motor", "residual"]
    assert len(ledger) == 3
    assert {*dict(ledger)} <= {*dir(ledger)}
    assert ledger.viscous.shape == ledger["motor"].shape == (len(sol.t),)
    assert ledger.viscous[0] == ledger.motor[0] == ledger.residual[0] == 0.0
    assert (np.diff(ledger.viscous) >= 0).all()
    energy = sol.energy()
    gain = energy.total - energy.total[0]
    assert np.array_equal(ledger.residual, gain - (ledger.motor - ledger.viscous))
    assert np.abs(ledger.residual).max() < 1e-7
    assert repr(ledger).startswith(f"<Ledger, J, at the last of {len(sol.t)} times: viscous ")
    assert f"motor {ledger.motor[-1]:.6g}" in repr(ledger)


def test_a_ledger_cannot_be_changed_names_what_it_has_and_comes_back_from_pickle(ledger):
    with pytest.raises(AttributeError, match=r"no entry 'drag': it has viscous, motor, residual"):
        _ = ledger.drag
    with pytest.raises(KeyError):
        ledger["drag"]
    with pytest.raises(AttributeError):
        ledger.viscous = 0
    with pytest.raises(TypeError):
        ledger["viscous"] = 0
    for name in ledger:
        with pytest.raises(ValueError, match="read-only"):
            ledger[name][0] = 1.0
    assert are_same(ledger, pickle.loads(pickle.dumps(ledger)))
    assert are_same(ledger, copy.deepcopy(ledger))
    assert ledger == ledger != copy.deepcopy(ledger)
    assert len({ledger}) == 1


def test_a_ledger_changes_no_bit_of_the_motion_and_no_shape(sol):
    bare = simulate()
    assert bare.energy().ledger is None
    between = np.linspace(0, 3, 17)
    assert np.array_equal(sol(between), bare(between))
    for name in ("t", "q", "qd", "y"):
        assert np.array_equal(getattr(sol, name), getattr(bare, name))
    for name in ("accelerations", "positions", "reactions", "relative_angles"):
        assert np.array_equal(getattr(sol, name)(), getattr(bare, name)())
    assert sol.y.shape == (4, len(sol.t))
    assert sol(0.5).shape == (4,)
    pytest.importorskip("pandas")
    assert [*sol.to_pandas().columns] == ["q_1", "q_2", "qd_1", "qd_2"]


@pytest.mark.parametrize("tolerance", ["rtol", "atol"])
def test_tolerances_are_those_of_angles_and_rates_alone(tolerance):
    assert simulate(ledger=True, **{tolerance: [1e-8] * 4}).success
    with pytest.raises(ValueError, match=rf"^{tolerance}.*\b4\b"):
        simulate(ledger=True, **{tolerance: [1e-8] * 6})


def test_a_ledger_counts_from_the_start_whatever_is_kept_and_goes_on_where_it_stopped(ledger):
    late = simulate(ledger=True, t_eval=[2.0, 3.0]).energy().ledger
    assert late.viscous[0] > 0.01
    assert late.viscous[-1] == ledger.viscous[-1]
    assert np.abs(late.residual).max() < 1e-7
    bare = pc.simulate(pc.Scene.textbook(), (0, 3), **START, ledger=True).energy().ledger
    assert [*bare] == ["residual"]  # nothing does work
    assert 0 < np.abs(bare.residual).max() < 1e-7
    part = pc.simulate(DAMPED, (0, 1), **START, ledger=True)
    assert are_same(part.resume(3.0).energy().ledger, ledger)


@pytest.mark.parametrize("value", [1, None, "yes", [True]], ids=repr)
def test_a_ledger_is_asked_for_by_true_or_false(value):
    with pytest.raises(TypeError, match=r"^ledger = .*: must be True or False"):
        simulate(ledger=value)
    assert simulate(ledger=np.True_).energy().ledger is not None


def test_what_effects_change_is_no_drift_and_what_a_ledger_leaves_over_is(sol, ledger):
    told, untold = sol.energy_drift(), simulate().energy_drift()
    assert told.changed_by == ["viscous_joint", "motor"]
    assert told.largest_drift == np.abs(ledger.residual).max()
    assert untold.largest_drift is untold.relative_drift is None
    assert not told.too_large
    assert not untold.too_large
    assert "  energy   drift " in repr(sol)
    bare = repr(simulate())
    assert "drift not known (changed by viscous_joint and motor): run with ledger=True" in bare
    assert "too large" not in bare
    coarse = simulate(ledger=True, rtol=0.1, atol=0.1)
    assert coarse.energy_drift().too_large
    assert "too large to trust this run" in repr(coarse)
    assert ", viscous_joint (2), motor, torsional_spring\n" in bare


def test_springs_are_part_of_what_the_energy_allows_and_one_that_pushes_has_no_bound():
    sprung = pc.Scene(links=[ROD, ROD], effects=[fx.TorsionalSpring(2, 50.0, rest_angle=1.0)])
    every, bound = (
        pc.simulate(sprung, (0, 20), **START, store=store).energy_drift()
        for store in ("dense", "end")
    )
    assert every.changed_by == []
    assert not every.too_large
    assert every.largest_kinetic <= bound.largest_kinetic * (1 + 1e-6)
    pushed = pc.Scene(links=[ROD], effects=[fx.TorsionalSpring(1, -0.5)])
    assert not pc.simulate(pushed, (0, 1), 0.5, store="end").energy_drift().too_large


def test_energies_of_a_moving_pivot_are_those_of_its_motion():
    """A lock holds the rod still against a moving pivot, so the rod moves as the pivot does."""
    moving = fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.5, angular_frequency=2.0))
    scene = pc.Scene(links=[ROD], effects=[moving, fx.Lock(1)])
    # Nothing turns, so nothing but max_step keeps the steps short enough for the ledger.
    run = pc.simulate(scene, q0=pi / 2, t_span=(0, 2), ledger=True, max_step=0.02)
    speed = 0.5 * 2.0 * np.cos(2.0 * run.t)
    np.testing.assert_allclose(run.energy().kinetic, speed**2 / 2, atol=1e-12)
    np.testing.assert_allclose(run.positions()[:, 0, 0], 0.5 * np.sin(2.0 * run.t), atol=1e-15)
    assert np.abs(run.energy().ledger.residual).max() < 1e-8
