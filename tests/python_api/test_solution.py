"""A solution has what interface and docstrings promise: shapes, units, and itself on disk."""

from __future__ import annotations

import copy
import pickle
import re
import sys
from math import pi

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli.summary import facts
from pendcore.cli.summary import text as summary_text

G = 9.807
SCENE = pc.Scene(
    links=[pc.Link(mass=1, length=0.8), pc.Link(mass=2, length=0.5, center=0.3, inertia=0.02)]
)


@pytest.fixture(scope="module")
def sol():
    return pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 3))


def same(a, b):
    """Whether two runs are the same to the last bit, also between the steps, and in words."""
    between = np.linspace(a.t[0], a.t[-1], 7)
    return (
        a.scene == b.scene
        and np.array_equal(a.t, b.t)
        and np.array_equal(a.y, b.y)
        and (a.store != "dense" or np.array_equal(a(between), b(between)))
        and (a.status, a.message, a.stats, a.case()) == (b.status, b.message, b.stats, b.case())
    )


def test_arrays_have_the_documented_shapes(sol):
    n_t = len(sol.t)
    assert sol.q.shape == sol.qd.shape == (n_t, 2)
    assert sol.y.shape == (4, n_t)
    assert sol.relative_angles().shape == sol.accelerations().shape == (n_t, 2)
    assert sol.positions().shape == (n_t, 3, 2)
    assert sol.mass_centers().shape == sol.reactions().shape == (n_t, 2, 2)
    energy = sol.energy()
    assert energy.kinetic.shape == energy.potential.shape == energy.total.shape == (n_t,)


def test_y_is_angles_over_rates(sol):
    assert np.array_equal(sol.y, np.vstack([sol.q.T, sol.qd.T]))
    assert sol.y[:, 0].tolist() == [0.3, -0.4, 1.0, -2.0]
    assert (sol.t[0], sol.t[-1]) == (1.0, 3.0)


@pytest.mark.parametrize("name", ["t", "q", "qd", "y"])
def test_what_was_found_cannot_be_overwritten(sol, name):
    with pytest.raises(ValueError, match="read-only"):
        getattr(sol, name)[..., 0] = 0.0


def test_arrays_outlive_their_solution():
    y = pc.simulate(SCENE, q0=0.3, t_span=(0, 1)).y
    assert np.array_equal(y, pc.simulate(SCENE, q0=0.3, t_span=(0, 1)).y)


def test_a_call_gives_the_state_at_one_time_or_many(sol):
    assert sol(2).shape == (4,)
    assert sol([1.5, 2, 2.5]).shape == (4, 3)
    assert np.array_equal(sol([2.5, 1.5]), np.column_stack([sol(2.5), sol(1.5)]))
    assert sol([]).shape == (4, 0)


def test_a_call_at_a_step_gives_the_step(sol):
    assert np.array_equal(sol(sol.t), sol.y)


def test_a_call_outside_the_run_is_refused(sol):
    for t in (0.999, 3.001, [2, 5]):
        with pytest.raises(ValueError, match=r"^t = .* must be within the run, 1\.0 to 3\.0 s"):
            sol(t)


def test_a_call_without_dense_output_is_refused_with_the_remedy():
    for store in ("steps", "end"):
        with pytest.raises(ValueError, match='store="dense"'):
            pc.simulate(SCENE, q0=0.3, t_span=(0, 1), store=store)(0.5)


def test_relative_angles_are_those_of_the_joints(sol):
    phi = sol.relative_angles()
    assert np.array_equal(phi[:, 0], sol.q[:, 0])
    assert np.array_equal(phi[:, 1], sol.q[:, 1] - sol.q[:, 0])


def test_positions_are_lengths_along_the_angles_with_y_down(sol):
    place = sol.positions()
    assert np.array_equal(place[:, 0], np.zeros((len(sol.t), 2)))
    along = np.stack([np.cos(sol.q), np.sin(sol.q)], axis=-1)
    steps = np.diff(place, axis=1)
    np.testing.assert_allclose(steps, along * [[0.8], [0.5]], atol=1e-15)
    np.testing.assert_allclose(
        sol.mass_centers() - place[:, :-1], along * [[0.4], [0.3]], atol=1e-15
    )


def test_accelerations_are_the_scenes(sol):
    assert np.array_equal(sol.accelerations(), SCENE.accelerations(sol.t, sol.q, sol.qd))


def test_reactions_carry_the_weight_at_rest():
    hanging = pc.simulate(SCENE, q0=pi / 2, t_span=(0, 0))
    force = hanging.reactions()[0]
    np.testing.assert_allclose(force, [[0, -3 * G], [0, -2 * G]], atol=1e-14)


def test_reactions_are_what_newton_asks_of_the_mass_centers():
    """Accelerations by differences of the path (fourth order) against forces over mass."""
    t = np.linspace(0, 1, 2001)
    run = pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(0, 1), t_eval=t, rtol=1e-13)
    windows = np.lib.stride_tricks.sliding_window_view(run.mass_centers(), 5, axis=0)
    acceleration = windows @ [-1, 16, -30, 16, -1] / (12 * t[1] ** 2)
    force = run.reactions()[2:-2]
    resultant = force - np.concatenate([force[:, 1:], np.zeros_like(force[:, :1])], axis=1)
    expected = resultant / [[1.0], [2.0]] + [0.0, G]
    assert np.abs(acceleration - expected).max() < 1e-6 * np.abs(expected).max()


def test_energy_is_kept_and_made_of_its_parts(sol):
    energy = sol.energy()
    assert np.array_equal(energy.total, energy.kinetic + energy.potential)
    assert np.abs(energy.total - energy.total[0]).max() < 1e-7
    a = np.array([1 * 0.4 + 0.8 * 2, 2 * 0.3])
    np.testing.assert_allclose(energy.potential, -G * np.sin(sol.q) @ a, rtol=1e-13)


def test_statistics_add_up():
    sol = pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 3), method="dopri5")
    stats = sol.stats
    assert stats.accepted == len(sol.t) - 1
    limited = stats.limited_by_tolerance + stats.limited_by_max_step + stats.limited_by_break
    assert limited == stats.accepted
    assert 0 < stats.min_step <= stats.max_step
    assert stats.nfev >= 6 * (stats.accepted + stats.rejected)
    assert not stats.stiff


def test_a_capped_run_can_be_resumed(sol):
    capped = pc.simulate(
        SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 3), max_steps=9, on_failure="ignore"
    )
    assert capped.status == "max_steps"
    assert np.array_equal(capped.resume(3).y, sol.y)


def test_resume_samples_where_it_is_asked_to(sol):
    part = pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 2), t_eval=[1.5, 2.0])
    whole = part.resume(3, t_eval=[2.5, 3.0])
    assert whole.t.tolist() == [1.5, 2.0, 2.5, 3.0]
    assert np.array_equal(whole.y, sol([1.5, 2.0, 2.5, 3.0]))


def test_resume_does_not_go_back(sol):
    with pytest.raises(
        ValueError, match=r"^t_end = 2\.0: must be .* at or beyond the end reached, 3\.0 s"
    ):
        sol.resume(2)


def test_resume_has_limits_and_progress_of_its_own(sol):
    part = pc.simulate(SCENE, q0=[0.3, -0.4], qd0=[1.0, -2.0], t_span=(1, 1.1), max_steps=1000)
    capped = part.resume(3, max_steps=5, on_failure="ignore")
    assert capped.status == "max_steps"
    assert part.t[-1] <= capped.t[-1] < 3

    def break_off(fraction):
        raise LookupError

    with pytest.raises(LookupError) as stop:
        part.resume(1e9, time_limit=10, progress=break_off)
    assert stop.value.solution.t[-1] > 1.1
    assert part.t[-1] == 1.1


def test_a_name_stays_with_the_solution_of_a_case(tmp_path):
    sol = pc.Case.textbook().simulate()
    sol.save(tmp_path / "run.npz")
    for again in (sol, pc.load(tmp_path / "run.npz"), pickle.loads(pickle.dumps(sol))):
        for run in (again, again.resume(6.0)):
            assert run.name == run.case().name == "double pendulum, section 2.1"
    assert pc.simulate(SCENE, q0=0.3, t_span=(0, 1)).name == ""


def test_a_name_stays_with_a_run_that_was_broken_off():
    def break_off(fraction):
        raise LookupError

    endless = {"store": "end", "time_limit": 10.0, "progress": break_off}
    case = pc.Case(scene=SCENE, q0=1, t_span=(0, 1e9), name="long", options=endless)
    with pytest.raises(LookupError) as stop:
        case.simulate()
    assert stop.value.solution.name == "long"
    with pytest.raises(LookupError) as stop:
        pc.Case.textbook().simulate().resume(1e9, time_limit=10, progress=break_off)
    assert stop.value.solution.name == "double pendulum, section 2.1"


def test_the_case_of_a_solution_gives_the_same_solution(sol):
    start = {"q0": (0.3, -0.4), "qd0": (1.0, -2.0), "t_span": (1.0, 3.0)}
    assert sol.case() == pc.Case(scene=SCENE, **start, options={"method": sol.method})
    assert same(sol.case().simulate(), sol)


@pytest.mark.parametrize("store", ["dense", "steps", "times", "end"])
@pytest.mark.parametrize("way", ["pickle", "deepcopy", "npz"])
def test_a_solution_comes_back_whole(store, way, tmp_path):
    t_eval = [0.25, 0.5, 1.0] if store == "times" else None
    first = pc.simulate(SCENE, q0=0.3, t_span=(0, 1), store=store, t_eval=t_eval, rtol=[1e-8] * 4)
    if way == "npz":
        first.save(tmp_path / "run.npz")
        again = pc.load(tmp_path / "run.npz")
    else:
        again = copy.deepcopy(first) if way == "deepcopy" else pickle.loads(pickle.dumps(first))
    assert same(first, again)
    assert same(first.resume(2.0), again.resume(2.0))


def test_what_a_solution_and_a_scene_tell_comes_back_from_pickle():
    sol = pc.simulate(
        SCENE, q0=0.3, t_span=(0, 1), ledger=True, events=[pc.events.LinkAngle(1, 0.5)]
    )
    energy = sol.energy()
    told = [energy, energy.ledger, sol.stats, *sol.events, SCENE.explain(q=0.3), SCENE.mobility()]
    for one in told:
        again = pickle.loads(pickle.dumps(one))
        assert type(again) is type(one)
        assert repr(again) == repr(one)
    assert [type(one).__name__ for one in told] == [
        "Energy", "Ledger", "Statistics", "FoundEvents", "Explanation", "Mobility"
    ]  # fmt: skip
    again = pickle.loads(pickle.dumps(energy))
    assert np.array_equal(again.total, energy.total)
    assert {**again.ledger}.keys() == {**energy.ledger}.keys()
    for name, entry in energy.ledger.items():
        assert np.array_equal(again.ledger[name], entry), name


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


def test_repr_is_a_short_table():
    run = pc.simulate(pc.Scene.textbook(), q0=[1, 2], t_span=(0, 1), method="dopri5", step=0.25)
    lines = repr(run).splitlines()
    assert lines[0] == "Solution"
    assert lines[1] == "  status   finished: reached the end of the interval"
    assert lines[2] == "  scene    2 links, gravity 9.807 m/s^2"
    assert lines[3] == f"  method   dopri5, 4 steps, {run.stats.nfev} right-hand sides"
    assert lines[4] == "  t        0 ... 1 s, 5 kept"
    assert lines[5].startswith("  last q   ")
    assert lines[6].endswith(" rad/s")
    assert lines[7].startswith("  energy   drift ")
    assert max(map(len, lines)) <= 80
    table = run._repr_html_()
    assert "<table>" in table
    assert all(line.split("  ")[1] in table for line in lines[1:])


def test_it_says_that_it_is_series_that_were_counted():
    book = pc.Scene.textbook()
    stiff = book.replace(effects=[pc.effects.ViscousJoint(joint=2, damping=1e6 / 3)])
    for scene, method, counted in (
        (book, "auto", "series, each as long as many right-hand sides"),
        (book, "taylor", "series, each as long as many right-hand sides"),
        (book, "dop853-radau5", "right-hand sides"),
        (stiff, "auto", "series and right-hand sides"),
        (stiff, "radau5", "right-hand sides"),
    ):
        run = pc.simulate(scene, q0=[0.8, 1.0], t_span=(0, 1), method=method)
        assert f" steps, {run.stats.nfev} {counted}\n" in str(run)
        summary = " ".join(summary_text(facts(run)).split())
        assert f" work {run.stats.nfev} {counted} energy" in summary


def test_it_has_a_line_of_the_accuracy_that_was_asked_for():
    book = pc.Scene.textbook()
    run = pc.simulate(book, q0=[0.8, 1.0], t_span=(0, 1), error=1e-6)
    (line,) = [line for line in str(run).splitlines() if line.startswith("  accuracy ")]
    assert re.search(
        r"asked 1.0e-06, achieved \S+ of the total length over the whole curve: verified by ", line
    )
    assert "paid" not in line
    assert "accuracy" not in str(pc.simulate(book, q0=[0.8, 1.0], t_span=(0, 1)))


def test_energy_is_shown_in_a_line(sol):
    assert re.fullmatch(
        r"<Energy: kinetic, potential, total, each \(\d+,\); the total is \S+ to \S+ J>",
        repr(sol.energy()),
    )
