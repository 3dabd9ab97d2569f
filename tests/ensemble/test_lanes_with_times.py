"""States at given times, of members in lanes: the bits of `pc.simulate`."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from test_lanes import BOOK, LIGHT
from test_lanes_of_chains import chain

E = pc.effects
SCENES = {
    "bare": BOOK,
    "damped and driven": BOOK.replace(
        effects=[E.ViscousJoint(1, damping=0.2), E.Motor(2, sinusoid=E.Sinusoid(2.0, 7.0))]
    ),
    "light": LIGHT,
    "one link": chain(1),
    "one link, driven": chain(
        1, [E.Motor(1, sinusoid=E.Sinusoid(2.0, 7.0)), E.DrivenPivot(y=E.Sinusoid(0.05, 20.0))]
    ),
    "three links": chain(3),
    "two links, shaken": BOOK.replace(effects=[E.DrivenPivot(y=E.Sinusoid(0.05, 20.0))]),
    "two links, drag": BOOK.replace(
        effects=[E.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03)]
    ),
    "five links": chain(5),
    "four links, damped": chain(4, [E.ViscousJoint(2, damping=0.3)]),
}
TIMES = {
    "sparse": [0.9],
    "ends included": [0.0, 1.0, 2.0],
    "many in a step": np.linspace(0.0, 2.0, 501),
    "uneven": [0.1, 0.1 + 1e-12, 0.11, 1.3, 1.999],
}


def starts(count, n):
    return pc.sampling.uniform(-2.5, 2.5, (count, n), seed=5)


def methods(scene):
    """Return the methods by which some of the scene's members go in lanes, and the default."""
    return [*pc._core.methods_with_lanes(scene._compiled), "auto"]


def assert_same_at_times(scene, q0, t_span, times, **options):
    how = {"keep": "times", "t_eval": times, "on_failure": "ignore", "workers": 1}
    found = pc.ensemble(scene, q0=q0, qd0=0.3, t_span=t_span, **how, **options)
    evaluations = 0
    for i, start in enumerate(q0):
        alone = pc.simulate(
            scene, q0=start, qd0=0.3, t_span=t_span, t_eval=times, on_failure="ignore", **options
        )
        reached = len(alone.t)
        assert found.status[i] == alone.status
        assert np.array_equal(found.q[i, :reached], alone.q)
        assert np.array_equal(found.qd[i, :reached], alone.qd)
        assert np.isnan(found.q[i, reached:]).all()
        evaluations += alone.stats.nfev
    assert found.statistics["nfev"] == evaluations
    return found


@pytest.mark.parametrize("rtol", [1e-3, 1e-8, 1e-12])
@pytest.mark.parametrize("times", TIMES)
@pytest.mark.parametrize("name", SCENES)
def test_states_at_times_in_lanes_are_those_of_single_runs(name, times, rtol):
    scene = SCENES[name]
    q0 = starts(11, len(scene.links))
    for method in methods(scene):
        asked = {"method": method, "rtol": rtol, "atol": rtol / 10}
        assert_same_at_times(scene, q0, (0, 2), TIMES[times], **asked)


@pytest.mark.parametrize("name", SCENES)
def test_backward_and_cut_short(name):
    scene = SCENES[name]
    q0 = starts(9, len(scene.links))
    for method in methods(scene):
        times = [1.0, 0.7, 0.0, -0.5]
        assert_same_at_times(scene, q0, (1.0, -0.5), times, method=method)
        times = np.linspace(0, 2, 41)
        cut = assert_same_at_times(scene, q0, (0, 2), times, method=method, max_steps=9)
        assert (cut.status == "max_steps").any()
        assert_same_at_times(scene, q0, (0, 0.3), [0.05, 0.2], method=method, max_step=0.01)


@pytest.mark.parametrize("method", ["taylor", "dopri5", "dop853"])
@pytest.mark.parametrize("count", [1, 2, 3, 5])
def test_few_members_finish_alone(count, method):
    assert_same_at_times(BOOK, starts(count, 2), (0, 4), np.linspace(0, 4, 17), method=method)


@pytest.mark.parametrize("name", SCENES)
def test_times_and_an_event_that_ends_the_run(name):
    """Times after the event are not kept."""
    scene = SCENES[name]
    q0 = starts(17, len(scene.links))
    event = pc.events.RateZero(link=1, terminal=2)
    for method in methods(scene):
        found = assert_same_at_times(
            scene, q0, (0, 2), np.linspace(0, 2, 101), method=method, events=[event]
        )
        assert {"event", "finished"} >= set(found.counts()) >= {"event"}


@pytest.mark.parametrize("method", ["taylor", "dopri5", "dop853"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-9])
def test_members_that_lanes_leave_to_single_runs(rtol, method):
    """One start is not finite, one overflows, and one is so fast that its first step is odd."""
    q0 = starts(13, 2)
    qd0 = np.full((13, 2), 0.3)
    q0[4, 1] = np.nan
    qd0[7] = 1e160
    qd0[9] = [1e9, -1e9]
    times = np.linspace(0, 2, 9)
    asked = {
        "t_eval": times,
        "rtol": rtol,
        "max_steps": 300,
        "on_failure": "ignore",
        "method": method,
    }
    found = pc.ensemble(BOOK, q0=q0, qd0=qd0, t_span=(0, 2), keep="times", **asked)
    are_cut = method == "dopri5" and rtol == 1e-9  # four more runs, by max_steps
    assert found.counts()["finished"] == (6 if are_cut else 10)
    for i in range(13):
        if found.status[i] == "refused":
            continue
        alone = pc.simulate(BOOK, q0=q0[i], qd0=qd0[i], t_span=(0, 2), **asked)
        reached = len(alone.t)
        assert found.status[i] == alone.status
        assert np.array_equal(found.q[i, :reached], alone.q)
        assert np.array_equal(found.qd[i, :reached], alone.qd)
        assert np.isnan(found.q[i, reached:]).all()
