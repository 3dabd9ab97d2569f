"""Figures and films show the dense output of a run, whether it kept that, few times or its end."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main
from pendcore.plotting.stage import Stage
from runs_that_kept_little import (
    BOUNCING,
    RESTING,
    RUNS,
    STOP,
    axes,
    chain_of,
    few,
    joints_of,
    places,
    simulate,
    stage,
    trace_of,
)


@pytest.fixture(params=RUNS)
def pair(request, tmp_path):
    """Return a run that kept little, and the same run with its dense output."""
    kept, dense = RUNS[request.param]
    return kept(tmp_path), dense()


def test_each_frame_of_a_film_is_the_dense_output(pair):
    kept, dense = pair
    if kept.accuracy is None:  # the runs that an error asks for depend on what is kept
        assert kept._run.t_reached == dense._run.t_reached
    else:
        dense = pc.simulate(
            kept.scene, q0=[1.8, 2.5], t_span=(0, 10), method=kept.method,
            **{name: kept._run.arguments[name] for name in ("rtol", "atol", "compensated")},
        )  # fmt: skip
    film = stage(kept, reactions=True, trace=np.inf)
    low, high = sorted([dense._run.arguments["t_start"], dense._run.t_reached])
    at = np.clip(film.times, low, high)
    true, forces = places(dense, at), reactions(dense, at)
    n = len(dense.scene.links)
    for k in range(0, len(at), 7):
        arrows, *sizes = film.show(k)[2 + n : 3 + 2 * n]
        assert np.abs(chain_of(film, k) - true[k]).max() < 1e-12
        assert np.abs(arrows.get_offsets() - true[k, :-1]).max() < 1e-12
        for *drawn, force, size in zip(arrows.U, arrows.V, forces[k], sizes, strict=True):
            newtons = np.hypot(*force)
            if newtons > 1e-5 * np.abs(forces).max():
                assert drawn / np.hypot(*drawn) == pytest.approx(force / newtons, abs=1e-9)
                assert size.get_text() == f"{newtons:.3g} N"
        assert np.abs(trace_of(film, k)[-1] - true[k, -1]).max() < 1e-12


def test_no_frame_and_no_curve_shows_a_rod_beyond_its_stop():
    for kept in (few(BOUNCING), simulate(RESTING)):
        film = stage(kept)
        shown = np.array([chain_of(film, k)[1] for k in range(len(film.times))])
        angle = np.arctan2(shown[:, 1], shown[:, 0])
        assert angle.max() <= STOP + 1e-9
        assert (angle > STOP - 0.1).any()
    assert angle[-1] == angle[-40]  # it rests to the end
    curve = few(BOUNCING).plot(ax=axes(2))[0].get_ydata()
    assert np.rad2deg(STOP) + 1e-7 >= curve.max() > np.rad2deg(1.8)


def angles_and_rates(run, t):
    return (np.ascontiguousarray(half.T) for half in np.split(run(t), 2))


def reactions(run, t):
    return run.scene._compiled.reactions(t, *angles_and_rates(run, t))


def values(what, run, t):
    """Return what the curves of a figure have to be, from dense output and the scene alone."""
    q, qd = angles_and_rates(run, t)
    if what == "angles":
        return [*np.rad2deg(q.T)]
    if what == "rates":
        return [*qd.T]
    if what == "energy":
        kinetic, potential = run.scene._compiled.energy(t, q, qd)
        return [kinetic, potential, kinetic + potential]
    forces = np.moveaxis(reactions(run, t), 1, 0)
    return [x for one in forces for x in (one[:, 0], one[:, 1], np.hypot(*one.T))]


@pytest.mark.few_cases
@pytest.mark.parametrize("what", ["angles", "rates", "reactions", "energy"])
@pytest.mark.parametrize("kept", ["times", "stop", "loaded", "resumed past events", "broken off"])
def test_each_curve_over_time_is_the_dense_output(kept, what, tmp_path):
    run, dense = RUNS[kept][0](tmp_path), RUNS[kept][1]()
    lines = run.plot(what, axes(1 if what == "energy" else 2))
    true = values(what, dense, lines[0].get_xdata())
    assert len(lines) == len(true)
    for line, curve in zip(lines, true, strict=True):
        assert len(line.get_xdata()) > 1000
        assert np.abs(line.get_ydata() - curve).max() <= 1e-12 * np.abs(curve).max()


@pytest.mark.parametrize("kept", ["times", "end", "stop", "member"])
def test_paths_phases_and_poses_are_the_dense_output(kept, tmp_path):
    run, dense = RUNS[kept][0](tmp_path), RUNS[kept][1]()
    t = run.plot(ax=axes(2))[0].get_xdata()
    (path,) = run.plot("path", axes())
    assert np.abs(np.array(path.get_data()).T - places(dense, t)[:, -1]).max() < 1e-12
    for i, line in enumerate(run.plot("phase", axes())):
        assert np.array_equal(line.get_xdata(), dense(t)[i])
        assert np.array_equal(line.get_ydata(), dense(t)[2 + i])
    at = np.array([0.35, 3.7, 9.9])
    strip = run.plot("strip", axes(), t=at)
    for k, pose in enumerate(places(dense, at)):
        first, second = (np.array(line.get_data()).T for line in strip[3 * k : 3 * k + 2])
        drawn = np.array([*first, second[1]])
        assert np.abs(drawn - drawn[0] - (pose - pose[0])).max() < 1e-12
    bodies = [run.plot("free_bodies", axes(), t=0.35)[0].axes for run in (run, dense)]
    told = [[text.get_text() for text in one.texts] for one in bodies]
    assert told[0] == told[1]


def test_the_ledger_is_drawn_between_the_times_that_were_kept():
    kept, at_steps = few(BOUNCING, ledger=True), simulate(BOUNCING, ledger=True)
    lines = {line.get_label().lstrip("_"): line for line in kept.plot("energy", axes(3))}
    ledger = at_steps.energy().ledger
    assert ledger is not None
    is_last = np.diff(at_steps.t, append=np.inf) > 0  # of those at one time
    t, entry, drawn = at_steps.t[is_last], ledger["impact"][is_last], lines["impact (lost)"]
    shared = np.isin(t, drawn.get_xdata())
    assert shared.sum() > 50
    at = np.searchsorted(drawn.get_xdata(), t[shared])
    assert np.abs(drawn.get_ydata()[at] - entry[shared]).max() < 1e-12
    assert np.abs(lines["residual"].get_ydata()).max() < 1e-7


def test_a_case_that_keeps_few_times_is_shown_as_it_moves(tmp_path, monkeypatch):
    case = few(BOUNCING).case()
    (tmp_path / "case.toml").write_text(case.to_toml())
    shown = []
    draw = Stage.show

    def show(self, k):
        found = draw(self, k)
        shown.append((self.times[k], joints_of(found)))
        return found

    monkeypatch.setattr(Stage, "show", show)
    monkeypatch.chdir(tmp_path)
    assert main(["show", "case.toml", "-o", "case.gif", "--fps", "1", "--speed", "3"]) == 0
    times, chains = zip(*shown, strict=True)
    assert np.abs(np.array(chains) - places(simulate(BOUNCING), np.array(times))).max() < 1e-12
