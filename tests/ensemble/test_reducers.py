"""Reducers: numbers of whole runs, as those runs alone have them."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
E = pc.effects
SCENES = {
    "bare": BOOK,
    "damped": BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=0.1)]),
    "motor": BOOK.replace(effects=[E.Motor(joint=1, sinusoid=E.Sinusoid(3.0, 6.0))]),
    "stop": BOOK.replace(effects=[E.JointStop(joint=2, range=(-2.0, 2.0), restitution=0.5)]),
    "three links": BOOK.replace(links=[*BOOK.links, pc.Link(mass=0.5, length=0.6)]),
}


def starts(count, n):
    return pc.sampling.uniform(-0.9, 0.9, (count, n), seed=4)


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "auto"])
@pytest.mark.parametrize("name", SCENES)
def test_extremes_are_those_of_the_dense_output(name, method):
    scene = SCENES[name]
    if method == "taylor" and name == "stop":
        method = "dopri5-radau5"
    q0 = starts(4, len(scene.links))
    asked = {"t_span": (0, 3), "method": method, "rtol": 1e-5}
    found = pc.ensemble(scene, q0=q0, keep=pc.reducers.Extremes(), **asked)
    plain = pc.ensemble(scene, q0=q0, **asked)
    assert np.array_equal(found.q, plain.q)
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
    found = pc.ensemble(
        BOOK, q0=[0.5, 1.0], t_span=(0, 9), events=[top], keep=pc.reducers.Extremes()
    )
    assert found.status == "event"
    assert found["extremes"][1, 0] == pytest.approx(float(found.q[0]), abs=1e-12)


@pytest.mark.parametrize("name", SCENES)
def test_the_energy_drift_is_that_of_the_run(name):
    scene = SCENES[name]
    q0 = starts(4, len(scene.links))
    asked = {"t_span": (0, 3), "rtol": 1e-6}
    found = pc.ensemble(scene, q0=q0, keep=pc.reducers.EnergyDrift(), **asked)
    plain = pc.ensemble(scene, q0=q0, **asked)
    assert np.array_equal(found.q, plain.q)
    for i, start in enumerate(q0):
        sol = pc.simulate(scene, q0=start, ledger=bool(scene.effects), **asked)
        energy = sol.energy()
        drift = energy.total - energy.total[0] if energy.ledger is None else energy.ledger.residual
        assert found["energy_drift"][i] == pytest.approx(np.abs(drift).max(), rel=1e-6, abs=1e-13)
        assert found["energy_drift"][i] > 0


@pytest.mark.parametrize("name", ["bare", "damped", "motor", "three links"])
def test_the_largest_exponent_is_that_of_lyapunov(name):
    scene = SCENES[name]
    q0 = starts(3, len(scene.links))
    found = pc.ensemble(scene, q0=q0, t_span=(0, 8), keep=pc.reducers.LargestExponent())
    for i, start in enumerate(q0):
        alone = pc.lyapunov(scene, q0=start, t_span=(0, 8), count=1, t_eval=[8.0])
        assert found["largest_exponent"][i] == alone.largest
    assert np.array_equal(found.q, pc.ensemble(scene, q0=q0, t_span=(0, 8)).q)


def test_a_scene_without_exponents_is_refused():
    with pytest.raises(ValueError, match="remove dry friction and stops"):
        pc.ensemble(
            SCENES["stop"], q0=[0.1, 0.1], t_span=(0, 1), keep=pc.reducers.LargestExponent()
        )
    with pytest.raises(
        TypeError, match=r"rtol: must be one number with pc.reducers.LargestExponent"
    ):
        pc.ensemble(
            BOOK, q0=[0.1, 0.1], t_span=(0, 1), rtol=[1e-6] * 4, keep=pc.reducers.LargestExponent()
        )


@pytest.mark.parametrize("workers", [1, 3])
def test_several_reducers_at_once(workers):
    first = pc.reducers.FirstEvent(pc.events.RateZero(link=1))
    keep = {
        "first": first,
        "span": pc.reducers.Extremes(),
        "drift": pc.reducers.EnergyDrift(),
        "again": pc.reducers.EnergyDrift(),
        "second": pc.reducers.FirstEvent(pc.events.RateZero(link=2)),
    }
    q0 = starts(6, 2)
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 3), keep=keep, workers=workers)
    for name, one in keep.items():
        alone = pc.ensemble(BOOK, q0=q0, t_span=(0, 3), keep=one)
        assert np.array_equal(found[name], alone[one.usual_name], equal_nan=True), name
    assert "drift: in 6 of 6" in str(found)


def test_members_that_were_not_run_have_no_numbers():
    keep = {
        "a": pc.reducers.Extremes(),
        "b": pc.reducers.EnergyDrift(),
        "c": pc.reducers.LargestExponent(),
    }
    q0 = [[0.1, 0.2], [np.nan, 0.2]]
    found = pc.ensemble(BOOK, q0=q0, t_span=(0, 1), keep=keep, on_failure="ignore")
    for name in keep:
        assert np.isfinite(found[name][0]).all()
        assert np.isnan(found[name][1]).all()


def test_names_that_are_taken():
    with pytest.raises(ValueError, match=r"keep\[.q.\]: this name is taken"):
        pc.ensemble(BOOK, q0=[0.1, 0.2], t_span=(0, 1), keep={"q": pc.reducers.EnergyDrift()})


IN_LANES = {
    **{name: SCENES[name] for name in ("bare", "damped", "motor", "three links")},
    "one link": pc.Scene(links=[pc.Link(mass=1.0, length=0.7)]),
}


def numbers(whole, member):
    """Return all that an ensemble has of a member."""
    return [whole.codes[member], whole.t[member], *whole.q[member].flat, *whole.qd[member].flat]


@pytest.mark.parametrize("backward", [False, True])
@pytest.mark.parametrize("beside", ["nothing", "an event"])
@pytest.mark.parametrize("name", IN_LANES)
def test_members_in_lanes_have_the_numbers_of_single_members(name, beside, backward):
    """An ensemble of one member has no lanes. One start is fast, one is not finite."""
    scene = IN_LANES[name]
    n = len(scene.links)
    q0 = starts(13, n)
    qd0 = np.full((13, n), 0.2)
    qd0[3] = 1e160
    qd0[5] = 200.0
    t_span = (1.5, -1.0) if backward else (0, 2)
    asked = {
        "t_span": t_span,
        "rtol": 1e-5,
        "on_failure": "ignore",
        "max_steps": 2000,
        "workers": 1,
    }
    reducers = {"span": pc.reducers.Extremes(), "drift": pc.reducers.EnergyDrift()}
    wanted = [["span"], ["drift"], ["span", "drift"]]
    if beside == "an event":
        asked["events"] = [pc.events.RateZero(link=n, terminal=2)]
        reducers["first"] = pc.reducers.FirstEvent(pc.events.RateZero(link=1))
        wanted.append(["span", "drift", "first"])
    mass = pc.sampling.uniform(0.5, 1.0, 13, seed=12)
    mass[8] = -1.0
    for method in (*pc._core.methods_with_lanes(scene._compiled), "auto"):
        for names in wanted:
            keep = {name: reducers[name] for name in names}
            how = asked | {"method": method, "keep": keep}
            whole = pc.ensemble(scene, q0=q0, qd0=qd0, vary={"link[1].mass": mass}, **how)
            assert len(whole.counts()) > 1
            evaluations = 0
            for i in range(13):
                vary = {"link[1].mass": mass[i : i + 1]}
                one = pc.ensemble(scene, q0=q0[i], qd0=qd0[i], vary=vary, **how)
                evaluations += one.statistics["nfev"]
                assert np.array_equal(numbers(whole, i), numbers(one, 0), equal_nan=True)
                for name in names:
                    assert np.array_equal(whole[name][i], one[name][0], equal_nan=True), (i, name)
            assert whole.statistics["nfev"] == evaluations
