"""A run tells its energies, where they went if it kept a ledger, and whether it can be trusted."""

from __future__ import annotations

import copy
import pickle
from math import pi

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore._views.energy_drift import energy_drift

ROD = pc.Link(mass=1.0, length=1.0)
DAMPED = pc.Scene(
    links=[ROD, ROD],
    effects=[
        fx.ViscousJoint(1, 0.3),
        fx.ViscousJoint(2, 0.1),
        fx.Motor(2, sinusoid=fx.Sinusoid(2.0, 6.0)),
        fx.TorsionalSpring(2, 3.0),
    ],
)
START = {"q0": [0.5, 1.0], "qd0": [1.0, -1.0], "t_span": (0, 3)}


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(DAMPED, **START, ledger=True)


def test_a_ledger_has_an_entry_for_each_account_of_the_scene_and_what_is_left_over(sol):
    energy = sol.energy()
    ledger = energy.ledger
    assert [*ledger] == ["viscous", "motor", "residual"]
    assert len(ledger) == 3
    assert ledger.viscous.shape == ledger["motor"].shape == (len(sol.t),)
    assert ledger.viscous[0] == ledger.motor[0] == ledger.residual[0] == 0.0
    assert (np.diff(ledger.viscous) >= 0).all()
    gain = energy.total - energy.total[0]
    assert np.array_equal(ledger.residual, gain - (ledger.motor - ledger.viscous))
    assert np.abs(ledger.residual).max() < 1e-7
    assert set(dict(ledger)) <= set(dir(ledger))


def test_an_entry_that_is_not_there_is_told_with_those_that_are(sol):
    with pytest.raises(AttributeError, match=r"no entry 'drag': it has viscous, motor, residual"):
        _ = sol.energy().ledger.drag
    with pytest.raises(KeyError):
        sol.energy().ledger["drag"]


def test_a_ledger_cannot_be_changed_and_comes_back_from_pickle(sol):
    ledger = sol.energy().ledger
    with pytest.raises(AttributeError):
        ledger.viscous = 0
    for name in ledger:
        with pytest.raises(ValueError, match="read-only"):
            ledger[name][0] = 1.0
    for again in (pickle.loads(pickle.dumps(ledger)), copy.deepcopy(ledger)):
        assert [*again] == [*ledger]
        assert all(np.array_equal(again[name], ledger[name]) for name in ledger)


def test_repr_has_the_ends(sol):
    ledger = sol.energy().ledger
    assert repr(ledger).startswith(f"<Ledger, J, at the last of {len(sol.t)} times: viscous ")
    assert f"motor {ledger.motor[-1]:.6g}" in repr(ledger)


def test_without_a_ledger_there_is_none():
    assert pc.simulate(DAMPED, **START).energy().ledger is None


def test_a_ledger_changes_no_bit_of_the_motion_and_no_shape(sol):
    bare = pc.simulate(DAMPED, **START)
    for name in ("t", "q", "qd", "y"):
        assert np.array_equal(getattr(sol, name), getattr(bare, name))
    assert sol.y.shape == (4, len(sol.t))
    between = np.linspace(0, 3, 17)
    assert np.array_equal(sol(between), bare(between))
    assert sol(0.5).shape == (4,)
    for name in ("accelerations", "positions", "reactions", "relative_angles"):
        assert np.array_equal(getattr(sol, name)(), getattr(bare, name)())
    frame = pytest.importorskip("pandas") and sol.to_pandas()
    assert [*frame.columns] == ["q_1", "q_2", "qd_1", "qd_2"]


@pytest.mark.parametrize("tolerance", ["rtol", "atol"])
def test_tolerances_are_those_of_angles_and_rates_alone(tolerance):
    assert pc.simulate(DAMPED, **START, ledger=True, **{tolerance: [1e-8] * 4}).success
    with pytest.raises(ValueError, match=rf"^{tolerance}.*\b4\b"):
        pc.simulate(DAMPED, **START, ledger=True, **{tolerance: [1e-8] * 6})


@pytest.mark.parametrize("store", ["dense", "steps", "times", "end"])
@pytest.mark.parametrize("way", ["pickle", "npz", "case"])
def test_a_run_with_a_ledger_comes_back_whole(store, way, tmp_path):
    t_eval = [1.0, 2.5] if store == "times" else None
    first = pc.simulate(DAMPED, **START, ledger=True, store=store, t_eval=t_eval)
    if way == "npz":
        first.save(tmp_path / "run.npz")
        again = pc.load(tmp_path / "run.npz")
    else:
        again = first.case().simulate() if way == "case" else pickle.loads(pickle.dumps(first))
    assert again.case() == first.case()
    for a, b in ((first, again), (first.resume(4.0), again.resume(4.0))):
        assert a.scene == b.scene == DAMPED
        assert np.array_equal(a.y, b.y)
        mine, theirs = a.energy().ledger, b.energy().ledger
        assert all(np.array_equal(mine[name], theirs[name]) for name in mine)


def test_a_ledger_counts_from_the_start_whatever_is_kept(sol):
    late = pc.simulate(DAMPED, **START, ledger=True, t_eval=[2.0, 3.0]).energy().ledger
    assert late.viscous[0] > 0.01
    assert late.viscous[-1] == sol.energy().ledger.viscous[-1]
    assert np.abs(late.residual).max() < 1e-7


def test_a_ledger_goes_on_where_it_stopped(sol):
    part = pc.simulate(DAMPED, **{**START, "t_span": (0, 1)}, ledger=True)
    mine, whole = part.resume(3.0).energy().ledger, sol.energy().ledger
    assert all(np.array_equal(mine[name], whole[name]) for name in whole)


def test_a_scene_that_does_no_work_has_nothing_but_the_residual():
    ledger = pc.simulate(pc.Scene.textbook(), **START, ledger=True).energy().ledger
    assert [*ledger] == ["residual"]
    assert 0 < np.abs(ledger.residual).max() < 1e-7


@pytest.mark.parametrize("value", [1, None, "yes", [True]], ids=repr)
def test_a_ledger_is_asked_for_by_true_or_false(value):
    with pytest.raises(TypeError, match=r"^ledger = .*: must be True or False"):
        pc.simulate(DAMPED, **START, ledger=value)
    assert pc.simulate(DAMPED, **START, ledger=np.True_).energy().ledger is not None


def test_what_effects_change_is_no_drift_and_what_a_ledger_leaves_over_is(sol):
    told = energy_drift(sol)
    assert told.changed_by == ["viscous_joint", "motor"]
    assert told.largest_drift == np.abs(sol.energy().ledger.residual).max()
    assert not told.too_large
    untold = energy_drift(pc.simulate(DAMPED, **START))
    assert untold.largest_drift is untold.relative_drift is None
    assert not untold.too_large


def test_a_ledger_calls_out_a_coarse_run():
    coarse = pc.simulate(DAMPED, **START, ledger=True, rtol=0.1, atol=0.1)
    assert energy_drift(coarse).too_large
    assert "too large to trust this run" in repr(coarse)


def test_repr_says_what_changes_the_energy(sol):
    assert "  energy   drift " in repr(sol)
    bare = repr(pc.simulate(DAMPED, **START))
    assert "drift not known (changed by viscous_joint and motor): run with ledger=True" in bare
    assert "too large" not in bare
    assert "  effects  viscous_joint (2), motor, torsional_spring" in bare


def test_springs_are_part_of_what_the_energy_allows():
    sprung = pc.Scene(links=[ROD, ROD], effects=[fx.TorsionalSpring(2, 50.0, rest_angle=1.0)])
    start = {**START, "t_span": (0, 20)}
    every = energy_drift(pc.simulate(sprung, **start))
    bound = energy_drift(pc.simulate(sprung, **start, store="end"))
    assert every.changed_by == []
    assert not every.too_large
    assert every.largest_kinetic <= bound.largest_kinetic * (1 + 1e-6)


def test_a_spring_that_pushes_has_no_bound():
    pushed = pc.Scene(links=[ROD], effects=[fx.TorsionalSpring(1, -0.5)])
    run = pc.simulate(pushed, q0=0.5, t_span=(0, 1), store="end")
    assert not energy_drift(run).too_large


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
