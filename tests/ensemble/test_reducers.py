"""Reducers: numbers of whole runs, as those runs alone have them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, starts

E, R = pc.effects, pc.reducers
SCENES = {
    "bare": BOOK,
    "damped": BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=0.1)]),
    "motor": BOOK.replace(effects=[E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0))]),
    "three links": BOOK.replace(links=[*BOOK.links, pc.Link(mass=0.5, length=0.6)]),
    "one link": pc.Scene(links=[pc.Link(mass=1.0, length=0.7)]),
    "stop": BOOK.replace(effects=[E.JointStop(joint=2, range=(-2.0, 2.0), restitution=0.5)]),
}
SMOOTH = [name for name in SCENES if name != "stop"]


def reduced(scene, q0, keep, **asked):
    """Return an ensemble with a reducer, which changes no bit of the motion."""
    found = pc.ensemble(scene, q0=q0, keep=keep, **asked)
    assert np.array_equal(found.q, pc.ensemble(scene, q0=q0, **asked).q)
    return found


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "auto"])
@pytest.mark.parametrize("name", SCENES)
def test_extremes_are_those_of_the_dense_output(name, method):
    scene = SCENES[name]
    if method == "taylor" and name == "stop":
        method = "dopri5-radau5"
    q0 = starts(4, len(scene.links), 4, 0.9)
    asked = {"t_span": (0, 3), "method": method, "rtol": 1e-5}
    found = reduced(scene, q0, R.Extremes(), **asked)
    for i, start in enumerate(q0):
        sol = pc.simulate(scene, q0=start, **asked)
        t = np.unique(np.concatenate([np.linspace(0, 3, 300_001), sol.t]))
        states = np.concatenate([sol(t).T, sol.y.T])  # both sides of every jump are kept
        least, greatest = found["extremes"][i]
        assert (least <= states.min(axis=0)).all()
        assert (greatest >= states.max(axis=0)).all()
        assert np.allclose(least, states.min(axis=0), rtol=0, atol=2e-6)
        assert np.allclose(greatest, states.max(axis=0), rtol=0, atol=2e-6)


def test_extremes_end_with_the_event_that_ends_the_run():
    top = pc.events.RateZero(link=1, terminal=True)
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 9), events=[top], keep=R.Extremes())
    assert found.status == "event"
    assert found["extremes"][1, 0] == pytest.approx(float(found.q[0]), abs=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_the_energy_drift_is_that_of_the_run(name):
    scene = SCENES[name]
    q0 = starts(4, len(scene.links), 4, 0.9)
    asked = {"t_span": (0, 3), "rtol": 1e-6}
    found = reduced(scene, q0, R.EnergyDrift(), **asked)
    for i, start in enumerate(q0):
        energy = pc.simulate(scene, q0=start, ledger=bool(scene.effects), **asked).energy()
        drift = energy.total - energy.total[0] if energy.ledger is None else energy.ledger.residual
        assert found["energy_drift"][i] == pytest.approx(np.abs(drift).max(), rel=1e-6, abs=1e-13)
        assert found["energy_drift"][i] > 0


@pytest.mark.parametrize("name", SMOOTH)
def test_the_largest_exponent_is_that_of_lyapunov(name):
    scene = SCENES[name]
    q0 = starts(3, len(scene.links), 4, 0.9)
    found = reduced(scene, q0, R.LargestExponent(), t_span=(0, 8))
    for i, start in enumerate(q0):
        alone = pc.lyapunov(scene, q0=start, t_span=(0, 8), count=1, t_eval=[8.0])
        assert found["largest_exponent"][i] == alone.largest


def test_equal_reducers_are_one_in_a_set():
    event = pc.events.RateZero(link=1)
    given = [R.FirstEvent(event), R.Extremes(), R.EnergyDrift(), R.LargestExponent()]
    given.append(R.Sensitivities(["q0[1]"]))
    assert {*given} == {*map(replace, given)}
    assert len({*given}) == len(R.REDUCERS)


def test_a_scene_without_exponents_is_refused():
    how = {"q0": [0.1, 0.1], "t_span": (0, 1), "keep": R.LargestExponent()}
    with pytest.raises(ValueError, match="remove dry friction and stops"):
        pc.ensemble(SCENES["stop"], **how)
    with pytest.raises(TypeError, match=r"rtol: must be one number with pc.reducers.LargestExp"):
        pc.ensemble(BOOK, **how, rtol=[1e-6] * 4)


@pytest.mark.parametrize("workers", [1, 3])
def test_several_reducers_at_once_have_the_numbers_of_each_alone(workers):
    keep = {
        "first": R.FirstEvent(pc.events.RateZero(link=1)),
        "span": R.Extremes(),
        "drift": R.EnergyDrift(),
        "again": R.EnergyDrift(),
        "exponent": R.LargestExponent(),
        "second": R.FirstEvent(pc.events.RateZero(link=2)),
    }
    q0 = starts(6, 2, 4, 0.9)
    q0[5, 0] = np.nan  # is not run, and has no numbers
    how = {"q0": q0, "t_span": (0, 3), "workers": workers, "on_failure": "ignore"}
    found = pc.ensemble(BOOK, keep=keep, **how)
    for name, one in keep.items():
        alone = pc.ensemble(BOOK, keep=one, **how)
        assert np.array_equal(found[name], alone[one.usual_name], equal_nan=True), name
        assert np.isfinite(found[name][0]).all()
        assert np.isnan(found[name][5]).all()
    assert "drift: in 5 of 6" in str(found)
    varied = pc.ensemble(BOOK, q0=0.5, t_span=(0, 1), vary={"gravity": [9.0, 9.8]})
    assert "\nvaried: gravity" in str(varied)


def numbers(whole, member, names):
    """Return all that an ensemble has of a member."""
    states = whole.codes[member], whole.t[member], whole.q[member], whole.qd[member]
    return np.concatenate([np.ravel(x) for x in (*states, *(whole[x][member] for x in names))])


@pytest.mark.few_cases
@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("beside", ["nothing", "an event"])
@pytest.mark.parametrize("name", SMOOTH)
def test_members_in_lanes_have_the_numbers_of_single_members(name, beside, backward):
    """An ensemble of one member has no lanes. One start is fast, one is not finite."""
    scene = SCENES[name]
    n = len(scene.links)
    q0, qd0 = starts(13, n, 4, 0.9), np.full((13, n), 0.2)
    qd0[3] = 1e160
    qd0[5] = 200.0
    t_span = (1.5, -1.0) if backward else (0, 2)
    asked = {"t_span": t_span, "rtol": 1e-5, "on_failure": "ignore", "max_steps": 2000}
    reducers = {"span": R.Extremes(), "drift": R.EnergyDrift()}
    wanted = [["span"], ["drift"], ["span", "drift"]]
    if beside == "an event":
        asked["events"] = [pc.events.RateZero(link=n, terminal=2)]
        reducers["first"] = R.FirstEvent(pc.events.RateZero(link=1))
        wanted.append(["span", "drift", "first"])
    mass = pc.sampling.uniform(0.5, 1.0, 13, seed=12)
    mass[8] = -1.0
    for method in (*pc._core.methods_with_lanes(scene._compiled), "auto"):
        for names in wanted:
            keep = {name: reducers[name] for name in names}
            how = asked | {"method": method, "keep": keep, "workers": 1}
            whole = pc.ensemble(scene, q0=q0, qd0=qd0, vary={"link[1].mass": mass}, **how)
            assert len(whole.counts()) > 1
            evaluations = 0
            for i in range(13):
                vary = {"link[1].mass": mass[i : i + 1]}
                one = pc.ensemble(scene, q0=q0[i], qd0=qd0[i], vary=vary, **how)
                evaluations += one.statistics["nfev"]
                of_whole, of_one = numbers(whole, i, names), numbers(one, 0, names)
                assert np.array_equal(of_whole, of_one, equal_nan=True), i
            assert whole.statistics["nfev"] == evaluations
