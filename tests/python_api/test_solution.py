"""A solution has what interface and docstrings promise: shapes, units, and itself on disk."""

from __future__ import annotations

import copy
import pickle
import re
import sys

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.cli.summary import facts
from pendcore.cli.summary import text as summary_text

G = 9.807
BOOK = pc.Scene.textbook()
SCENE = pc.Scene(
    links=[pc.Link(mass=1, length=0.8), pc.Link(mass=2, length=0.5, center=0.3, inertia=0.02)]
)
START = {"q0": (0.3, -0.4), "qd0": (1.0, -2.0), "t_span": (1.0, 3.0)}


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(SCENE, **START)


def same(a, b):
    """Whether two runs are the same to the last bit, also between the steps, and in words."""
    between = np.linspace(a.t[0], a.t[-1], 7)
    return (
        a.scene == b.scene
        and np.array_equal(a.t, b.t)
        and np.array_equal(a.y, b.y)
        and (a.store != "dense" or np.array_equal(a(between), b(between)))
        and all(np.array_equal(a._run.ledger[x], b._run.ledger[x]) for x in a._run.ledger)
        and (a.status, a.message, a.stats, a.case()) == (b.status, b.message, b.stats, b.case())
    )


def test_arrays_have_the_documented_shapes_and_are_computed_from_y(sol):
    n_t, energy = len(sol.t), sol.energy()
    for shape, arrays in {
        (n_t,): (energy.kinetic, energy.potential, energy.total),
        (n_t, 2): (sol.q, sol.qd, sol.relative_angles(), sol.accelerations()),
        (4, n_t): (sol.y,),
        (n_t, 3, 2): (sol.positions(),),
        (n_t, 2, 2): (sol.mass_centers(), sol.reactions()),
    }.items():
        assert [array.shape for array in arrays] == [shape] * len(arrays)
    assert np.array_equal(sol.y, np.vstack([sol.q.T, sol.qd.T]))
    assert sol.y[:, 0].tolist() == [0.3, -0.4, 1.0, -2.0]
    assert (sol.t[0], sol.t[-1]) == (1.0, 3.0)
    phi = np.column_stack([sol.q[:, 0], sol.q[:, 1] - sol.q[:, 0]])
    assert np.array_equal(sol.relative_angles(), phi)
    assert np.array_equal(sol.accelerations(), SCENE.accelerations(sol.t, sol.q, sol.qd))


@pytest.mark.parametrize("name", ["t", "q", "qd", "y"])
def test_what_was_found_cannot_be_overwritten_and_outlives_its_solution(sol, name):
    with pytest.raises(ValueError, match="read-only"):
        getattr(sol, name)[..., 0] = 0.0
    alone = getattr(pc.simulate(SCENE, **START), name)
    assert np.array_equal(alone, getattr(sol, name))


def test_a_call_gives_the_state_at_one_time_or_many(sol):
    assert sol(2).shape == (4,)
    assert sol([1.5, 2, 2.5]).shape == (4, 3)
    assert np.array_equal(sol([2.5, 1.5]), np.column_stack([sol(2.5), sol(1.5)]))
    assert sol([]).shape == (4, 0)
    assert np.array_equal(sol(sol.t), sol.y)
    for store in ("steps", "end"):
        with pytest.raises(ValueError, match='store="dense"'):
            pc.simulate(SCENE, **START, store=store)(1.5)


def test_positions_are_lengths_along_the_angles_with_y_down(sol):
    place = sol.positions()
    assert np.array_equal(place[:, 0], np.zeros((len(sol.t), 2)))
    along = np.stack([np.cos(sol.q), np.sin(sol.q)], axis=-1)
    to_the_centers = sol.mass_centers() - place[:, :-1]
    np.testing.assert_allclose(np.diff(place, axis=1), along * [[0.8], [0.5]], atol=1e-15)
    np.testing.assert_allclose(to_the_centers, along * [[0.4], [0.3]], atol=1e-15)


def test_energy_is_kept_and_made_of_its_parts(sol):
    energy = sol.energy()
    assert np.array_equal(energy.total, energy.kinetic + energy.potential)
    assert np.abs(energy.total - energy.total[0]).max() < 1e-7
    a = np.array([1 * 0.4 + 0.8 * 2, 2 * 0.3])
    np.testing.assert_allclose(energy.potential, -G * np.sin(sol.q) @ a, rtol=1e-13)
    shown = r"<Energy: kinetic, potential, total, each \(\d+,\); the total is \S+ to \S+ J>"
    assert re.fullmatch(shown, repr(energy))


def test_statistics_add_up():
    sol = pc.simulate(SCENE, **START, method="dopri5")
    stats = sol.stats
    assert stats.accepted == len(sol.t) - 1
    limited = stats.limited_by_tolerance + stats.limited_by_max_step + stats.limited_by_break
    assert limited == stats.accepted
    assert 0 < stats.min_step <= stats.max_step
    assert stats.nfev >= 6 * (stats.accepted + stats.rejected)
    assert not stats.stiff


def test_found_events_are_a_list_that_has_arrays():
    event = pc.events.RateZero(link=1)
    found = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 5), events=[event]).events[0]
    assert len(found) > 2
    assert found.t.tolist() == [one.t for one in found]
    assert found.q.shape == found.qd.shape == (len(found), 2)
    assert np.array_equal(found.y, [one.y for one in found])
    assert found.direction.tolist() == [one.direction for one in found]
    assert np.array_equal(found[1:].q, found.q[1:])
    assert found[::-1][0] is found[-1]
    assert np.array_equal(pickle.loads(pickle.dumps(found))[:1].y, found.y[:1])
    none = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 1e-3), events=[event]).events[0]
    assert none.q.shape == (0, 2)


WITH_LEDGER = [fx.ViscousJoint(1, 0.3), fx.Motor(2, sinusoid=fx.Sinusoid(2.0, 6.0))]


def break_off(fraction):
    raise LookupError


def test_a_name_stays_with_the_solution_of_a_case(tmp_path):
    case = pc.Case.textbook()
    sol = case.simulate()
    sol.save(tmp_path / "run.npz")
    for again in (sol, pc.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol))):
        for run in (again, again.resume(6.0)):
            assert run.name == run.case().name == case.name == "double pendulum, section 2.1"
    assert pc.simulate(SCENE, **START).name == ""
    endless = {"store": "end", "time_limit": 10.0, "progress": break_off}
    broken = pc.Case(scene=BOOK, q0=1, t_span=(0, 1e9), name=case.name, options=endless)
    for call in (broken.simulate, lambda: sol.resume(1e9, time_limit=10, progress=break_off)):
        with pytest.raises(LookupError) as stop:
            call()
        assert stop.value.solution.name == case.name


def test_the_case_of_a_solution_gives_the_same_solution(sol):
    assert sol.case() == pc.Case(scene=SCENE, **START, options={"method": sol.method})
    assert same(sol.case().simulate(), sol)


@pytest.mark.parametrize("store", ["dense", "steps", "times", "end"])
@pytest.mark.parametrize("way", ["pickle", "deepcopy", "npz", "case"])
@pytest.mark.parametrize("effects", [[], WITH_LEDGER], ids=["bare", "with a ledger"])
@pytest.mark.parametrize("compensated", [False, True])
def test_a_solution_comes_back_whole(store, way, effects, compensated, tmp_path):
    how = {"store": store, "rtol": [1e-8] * 4, "ledger": bool(effects), "compensated": compensated}
    how["t_eval"] = [0.25, 0.5, 1.0] if store == "times" else None
    first = pc.simulate(SCENE.replace(effects=effects), q0=0.3, t_span=(0, 1), **how)
    if way == "case":
        again = first.case().simulate()
    elif way == "npz":
        first.save(tmp_path / "run.npz")
        again = pc.load(tmp_path / "run.npz")
    else:
        again = copy.deepcopy(first) if way == "deepcopy" else pickle.loads(pickle.dumps(first))
    assert same(first, again)
    assert same(first.resume(2.0), again.resume(2.0))


def test_what_a_solution_and_a_scene_tell_comes_back_from_pickle():
    event = pc.events.LinkAngle(1, 0.5)
    sol = pc.simulate(SCENE, q0=0.3, t_span=(0, 1), ledger=True, events=[event])
    energy = sol.energy()
    told = [energy, energy.ledger, sol.stats, *sol.events, SCENE.explain(q=0.3), SCENE.mobility()]
    for one in told:
        again = pickle.loads(pickle.dumps(one))
        assert type(again) is type(one)
        assert repr(again) == repr(one)
    names = ["Energy", "Ledger", "Statistics", "FoundEvents", "Explanation", "Mobility"]
    assert [type(one).__name__ for one in told] == names
    again = pickle.loads(pickle.dumps(energy))
    assert np.array_equal(again.total, energy.total)
    assert {**again.ledger}.keys() == {**energy.ledger}.keys()


def test_pandas_gets_a_row_per_time_with_units(sol):
    pytest.importorskip("pandas")
    frame = sol.to_pandas()
    assert list(frame.columns) == ["q_1", "q_2", "qd_1", "qd_2"]
    assert frame.index.name == "time"
    assert np.array_equal(frame.index, sol.t)
    assert np.array_equal(frame.to_numpy(), sol.y.T)
    assert frame.attrs["units"]["qd_2"] == "rad/s"
    assert pc.read_case(frame.attrs["case"]) == sol.case()
    frame.loc[:, "q_1"] = 0.0  # it is the user's


def test_xarray_gets_time_and_link_with_units(sol):
    pytest.importorskip("xarray")
    data = sol.to_xarray()
    assert data.q.dims == data.qd.dims == ("time", "link")
    assert data.link.values.tolist() == [1, 2]
    assert np.array_equal(data.q.sel(link=2), sol.q[:, 1])
    assert (data.q.units, data.qd.units, data.time.units) == ("rad", "rad/s", "s")
    assert pc.read_case(data.attrs["case"]) == sol.case()


@pytest.mark.parametrize("library", ["pandas", "xarray"])
def test_a_missing_library_is_named_with_what_installs_it(sol, library, monkeypatch):
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(ImportError, match=f"{library}: pip install {library}$"):
        getattr(sol, f"to_{library}")()


def test_a_repr_says_how_it_ended_what_was_run_and_what_it_took():
    run = pc.simulate(BOOK, q0=[1, 2], t_span=(0, 1), method="dopri5", step=0.25)
    for words in (
        "status   finished: reached the end of the interval",
        "scene    2 links, gravity 9.807 m/s^2",
        f"method   dopri5, 4 steps, {run.stats.nfev} right-hand sides",
        "t        0 ... 1 s, 5 kept",
        "last q   ",
        "right    not estimated yet: sol.valid_until() does, by a second run",
        "energy   drift ",
    ):
        assert f"\n  {words}" in repr(run)
        assert words.split("  ")[-1].strip() in run._repr_html_()


COUNTED = [
    (False, "auto", "Taylor expansions"),
    (False, "taylor", "Taylor expansions"),
    (False, "dop853-radau5", "right-hand sides"),
    (True, "auto", "Taylor expansions and right-hand sides"),
    (True, "radau5", "right-hand sides"),
]


@pytest.mark.parametrize(("stiff", "method", "counted"), COUNTED)
def test_it_says_whether_it_is_series_that_were_counted(stiff, method, counted):
    scene = BOOK.replace(effects=[fx.ViscousJoint(joint=2, damping=1e6 / 3)] * stiff)
    run = pc.simulate(scene, q0=[0.8, 1.0], t_span=(0, 1), method=method)
    assert str(run).endswith(f" steps, {run.stats.nfev:,} {counted}")
    summary = " ".join(summary_text(facts(run)).split())
    assert f" work {run.stats.nfev:,} {counted} energy" in summary


def test_it_says_until_when_it_is_right_once_that_is_known():
    chaotic = pc.simulate(BOOK, q0=0.0, t_span=(0, 30))
    until = chaotic.valid_until()
    assert f"\n  right    to 0.1 rad until {until:.4g} s\n" in str(chaotic)
    short = pc.simulate(BOOK, q0=[1, 1], t_span=(0, 1))
    short.valid_until()
    assert "\n  right    to 0.1 rad to the end\n" in str(short)
    end = pc.simulate(BOOK, q0=0.0, t_span=(0, 30), store="end")
    assert end.valid_until() == 0.0
    assert "\n  right    not to 0.1 rad at 30 s, and no earlier time is kept\n" in str(end)


def test_it_has_a_line_of_the_accuracy_that_was_asked_for():
    run = pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 1), error=1e-6)
    words = r"asked 1.0e-06, achieved \S+ of the total length over the whole curve: verified by "
    assert re.search(rf"\n  accuracy +{words}", str(run))
    assert "accuracy" not in str(pc.simulate(BOOK, q0=[0.8, 1.0], t_span=(0, 1)))


def test_the_summary_of_a_run_tells_effects_ledger_and_what_is_not_simulated():
    scene = BOOK.replace(effects=[fx.ViscousJoint(1, 0.1)])
    found = facts(pc.simulate(scene, q0=1.0, t_span=(0, 1), ledger=True))
    assert found["not_simulated"] == scene.explain().to_dict()["not_simulated"]
    assert (found["effects"][0]["kind"], found["effects"][0]["damping"]) == ("viscous_joint", 0.1)
    assert set(found["ledger"]) == {"viscous", "residual"}
    said = summary_text(found)
    assert "ViscousJoint(joint=1, damping=0.1)" in said
    assert "  ledger            viscous " in said
    assert "viscous joint" not in said.partition("not simulated")[2].partition("What came")[0]
