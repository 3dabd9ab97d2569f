"""First events, and states at given times, of members in lanes: those of `pc.simulate`."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, assert_runs, chain, starts
from test_lanes import LIGHT

TURNS = pc.events.LinkAngle(2, -np.pi / 2, every_turn=True)
TIP = pc.events.TipLine(point=(0.3, 0.5), normal=(1.0, 0.2))
EVENTS = {
    "turns": TURNS,
    "joint": pc.events.JointAngle(2, 0.0, direction=-1),
    "rate": pc.events.RateZero(link=1),
    "joint rate": pc.events.RateZero(joint=2, direction=1),
    "level": pc.events.LinkAngle(1, 0.4),
    "tip": TIP,
}


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "auto"])
@pytest.mark.parametrize("rtol", [1e-3, 1e-10])
@pytest.mark.parametrize("terminal", [False, True, 3])
@pytest.mark.parametrize("name", EVENTS)
def test_first_events_are_those_of_simulate(name, terminal, rtol, method):
    first = {"it": EVENTS[name].replace(terminal=terminal)}
    q0 = starts(23, 2, 8, 3.0)
    q0[3, 0] = 0.4  # begins at a level
    for t_span in ((0, 4), (1e5, 1e5 - 3)):
        how = {"method": method, "rtol": rtol, "atol": rtol}
        assert_runs(BOOK, q0, 0.25, t_span, firsts=first, **how)


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
@pytest.mark.parametrize("terminal", [False, True])
@pytest.mark.parametrize(("n", "effects"), [(3, "bare"), (3, "drag"), (1, "bare"), (5, "bare")])
def test_first_events_of_other_chains(n, effects, terminal, method):
    turns = TURNS.replace(link=n, terminal=terminal)
    how = {"method": "dopri5" if effects == "drag" and method == "taylor" else method}
    q0 = starts(23, n, 8, 3.0)
    found = assert_runs(chain(n, effects), q0, 4.0, firsts={"turns": turns}, **how)
    assert np.isfinite(found["turns"]).any()


def test_several_events_of_which_one_ends_the_run():
    events = [EVENTS["rate"], EVENTS["joint"].replace(terminal=True)]
    firsts = {"turns": EVENTS["turns"], "rate": EVENTS["rate"]}
    assert_runs(BOOK, starts(23, 2, 9, 3.0), 0.0, (0, 6), events=events, firsts=firsts)


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
def test_events_of_members_with_lengths_of_their_own(method):
    """Where the tip is depends on the lengths."""
    length = {"link[2].length": pc.sampling.uniform(0.5, 1.5, 19, seed=11)}
    assert_runs(BOOK, starts(19, 2, 10, 3.0), vary=length, firsts={"tip": TIP}, method=method)


SCENES = {
    "light": LIGHT,
    **{
        f"{n}, {effects}": chain(n, effects)
        for n, effects in [
            (1, "bare"), (2, "bare"), (3, "bare"), (5, "bare"), (1, "waves and damping"),
            (2, "waves and damping"), (4, "damping"), (1, "shaken along y"), (2, "shaken along y"),
            (2, "drag"),
        ]
    },
}  # fmt: skip
TIMES = {
    "sparse": [0.9],
    "ends included": [0.0, 1.0, 2.0],
    "many in a step": np.linspace(0.0, 2.0, 501),
    "uneven": [0.1, 0.1 + 1e-12, 0.11, 1.3, 1.999],
}


def with_methods(name, count):
    """Yield starts, and each of the methods by which some members go in lanes, and the default."""
    scene = SCENES[name]
    for method in (*pc._core.methods_with_lanes(scene._compiled), "auto"):
        yield scene, starts(count, len(scene.links), 5, 2.5), {"method": method}


@pytest.mark.few_cases
@pytest.mark.every_value("name")
@pytest.mark.parametrize("rtol", [1e-3, 1e-8, 1e-12])
@pytest.mark.parametrize("times", TIMES)
@pytest.mark.parametrize("name", SCENES)
def test_states_at_times_in_lanes_are_those_of_single_runs(name, times, rtol):
    for scene, q0, how in with_methods(name, 11):
        how |= {"rtol": rtol, "atol": rtol / 10}
        assert_runs(scene, q0, 0.3, (0, 2), times=TIMES[times], **how)


@pytest.mark.few_cases
@pytest.mark.parametrize("name", SCENES)
def test_times_of_runs_backward_cut_short_and_ended_by_an_event(name):
    """Times after the event are not kept."""
    event = pc.events.RateZero(link=1, terminal=2)
    for scene, q0, how in with_methods(name, 17):
        times = np.linspace(0, 2, 41)
        assert_runs(scene, q0, 0.3, (1.0, -0.5), times=[1.0, 0.7, 0.0, -0.5], **how)
        cut = assert_runs(scene, q0, 0.3, (0, 2), times=times, max_steps=9, **how)
        assert (cut.status == "max_steps").any()
        assert_runs(scene, q0, 0.3, (0, 0.3), times=[0.05, 0.2], max_step=0.01, **how)
        ended = assert_runs(scene, q0, 0.3, (0, 2), times=times, events=[event], **how)
        assert {"event", "finished"} >= set(ended.counts()) >= {"event"}
