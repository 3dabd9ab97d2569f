"""Watching changes no bit of a run; a run that an event ended goes on as if it never had."""

from __future__ import annotations

import pickle
from itertools import pairwise

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import effects as fx
from pendcore import events as ev

BOOK = pc.Scene.textbook()
ERROR_ORDERS = {method["name"]: method["error_order"] for method in _core.methods()}
DENSE_STAGES = {  # after the one at the end of the step
    method["name"]: len(table["a"]) - 1 - table["a"].index(table["b"]) if "b" in table else 0
    for method in _core.methods()
    for table in [_core.tableau(method["first"])]  # nothing is stiff here
}
CONTROLLED = fx.Motor(joint=2, pd=fx.PD(kp=3.0, kd=0.1, reference=0.3), limit=0.5)
SCENES = {
    "book": BOOK,
    "moved": BOOK.replace(effects=[fx.DryJointFriction(joint=1, coulomb=0.01), CONTROLLED]),
    "with impacts": pc.Scene(
        links=[pc.Link(mass=1.0, length=1.0)] * 2,
        effects=[fx.JointStop(2, (-0.4, 0.5), restitution=0.7), fx.DryJointFriction(1, 0.4)],
    ),
}
STORES = {
    "end": {"store": "end"},
    "times": {"t_eval": np.linspace(0, 10, 41)},
    "steps": {"store": "steps"},
    "dense": {},
    "dense with times": {"store": "dense", "t_eval": np.linspace(0, 10, 41)},
}


def sections(terminal=False):
    return [
        ev.LinkAngle(2, 1.2, direction=1, terminal=terminal),
        ev.JointAngle(2, 0.0, terminal=terminal and terminal + 1),
        ev.RateZero(joint=2),
        ev.TipLine((0.3, 0.0), (1.0, 0.2), terminal=terminal and terminal + 3),
        ev.LinkAngle(2, 1.2, direction=-1),
    ]


def in_numbers(sol):
    return [[(one.t, one.direction, one.y.tolist()) for one in found] for found in sol.events]


def run(scene=BOOK, t_end=10.0, **options):
    return pc.simulate(scene, (0, t_end), [-1.4, -1.1], 0.1, **options)


def resumed(sol, t_end=10.0):
    """The run, however often an event or a cap ends it."""
    while sol.status == "event" or sol._run.t_reached != t_end:
        sol = sol.resume(t_end)
    return sol


def assert_same(one, other):
    if one.store == "dense":
        assert np.array_equal(one(np.linspace(0, 10, 333)), other(np.linspace(0, 10, 333)))
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.y, other.y)
    # a dense output may ask for right-hand sides of its own
    assert one.stats._replace(nfev=0) == other.stats._replace(nfev=0)


def options_of(method, store):
    step = None if ERROR_ORDERS[method] else 0.01
    return {"method": method, "step": step, "rtol": 1e-6, "atol": 1e-9} | STORES[store]


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ERROR_ORDERS)
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("store", STORES)
def test_watching_changes_no_bit_whatever_is_stored(method, scene, store):
    how = options_of(method, store)
    watched = run(SCENES[scene], events=sections(), **how)
    unwatched = run(SCENES[scene], **how)
    assert_same(unwatched, watched)
    more = watched.stats.nfev - unwatched.stats.nfev
    if DENSE_STAGES[method] == 0 or scene != "book" or "dense" in store:  # asked for in any case
        assert more == 0
    elif store != "times":
        assert more == DENSE_STAGES[method] * watched.stats.accepted
    end = run(SCENES[scene], events=sections(), **options_of(method, "end"))
    assert in_numbers(watched) == in_numbers(end)
    assert sum(map(len, watched.events)) > 20


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ERROR_ORDERS)
@pytest.mark.parametrize("scene", ["book", "moved"])
@pytest.mark.parametrize("store", STORES)
def test_a_run_that_stops_at_events_goes_on_as_if_it_never_had(method, scene, store, tmp_path):
    how = options_of(method, store) | {"ledger": scene == "moved"}
    scene = SCENES[scene]
    whole = run(scene, events=sections(), **how)
    sol = run(scene, events=sections(terminal=1), **how)
    stops = 0
    while sol.status == "event":
        stops += 1
        found = in_numbers(sol)
        assert all(one.t <= sol._run.t_reached for each in sol.events for one in each)
        for each, all_of_them in zip(found, in_numbers(whole), strict=True):
            assert each == all_of_them[: len(each)]
        assert not len(sol.t) or sol.t[-1] <= sol._run.t_reached
        if stops % 3 == 1:
            sol = pickle.loads(pickle.dumps(sol))
        elif stops % 3 == 2:
            sol.save(tmp_path / "run.npz")
            sol = pc.load(tmp_path / "run.npz")
        assert in_numbers(sol) == found
        sol = sol.resume(10.0)
    counted = zip(whole.events[:2] + whole.events[3:4], (1, 2, 4), strict=True)
    ends = {found[k].t for found, n in counted for k in range(n - 1, len(found), n)}
    assert stops == len(ends) > 5
    assert_same(sol, whole)
    assert in_numbers(sol) == in_numbers(whole)
    if how["ledger"]:
        assert np.array_equal(sol.energy().ledger.dry, whole.energy().ledger.dry)


def test_a_run_backward_stops_and_goes_on_likewise():
    whole, sol = (run(t_end=-10, events=sections(terminal)) for terminal in (False, 2))
    assert sol.status == "event"
    sol = resumed(sol, -10)
    assert np.array_equal(sol.y, whole.y)
    assert in_numbers(sol) == in_numbers(whole)
    for found in whole.events:
        assert all(a.t > b.t for a, b in pairwise(found))


def test_what_a_stopped_run_leaves_ends_at_the_event():
    sol, free = run(events=sections(terminal=2)), run()
    end = max((found[-1] for found in sol.events if found), key=lambda one: one.t)
    assert sol.t[-1] == end.t
    assert np.array_equal(sol.y[:, -1], end.y)
    assert np.array_equal(sol(end.t), end.y)
    assert np.all(np.diff(sol.t) > 0)
    with pytest.raises(ValueError, match="within the run"):
        sol(np.nextafter(end.t, 10))
    within = np.linspace(0, end.t, 50)[:-1]
    assert np.array_equal(sol(within), free(within))
    assert sol.stats.accepted == len(sol.t) - 1
    kept = run(events=sections(terminal=2), ledger=True, rtol=1e-8)
    assert kept.status == "event"
    assert abs(kept.energy().ledger.residual[-1]) < 1e-6


def test_an_end_just_behind_an_event_cuts_its_step_and_is_a_view():
    whole, stopping = run(events=sections()), [ev.LinkAngle(2, 1.2, direction=1, terminal=True)]
    for found in whole.events[0][:4]:
        for gap in (0.0, 1e-12, 1e-9, 1e-4):
            for events, kept in ((sections(), 5), (stopping, 1)):
                longer = resumed(run(t_end=found.t + gap, events=events))
                assert in_numbers(longer) == in_numbers(whole)[:kept]
                assert np.array_equal(longer.y, whole.y)


@pytest.mark.parametrize("store", STORES)
def test_an_event_within_the_last_bit_of_the_start(store):
    """At t = 1e9 s a double resolves 1e-7 s, and the event comes before the next double."""
    rod, how = pc.Scene(links=BOOK.links[:1], gravity=0.0), dict(STORES[store])
    if "t_eval" in how:
        how["t_eval"] = 1e9 + how["t_eval"]
    here = ev.LinkAngle(1, 1.0 + 1e-9, terminal=True)
    sol, free = (
        pc.simulate(rod, (1e9, 1e9 + 10), 1.0, 1.0, events=events, **how)
        for events in ([here], [])
    )  # fmt: skip
    assert sol.status == "event"
    assert sol.events[0][0].t == sol._run.t_reached == 1e9
    assert sol.events[0][0].q[0] == pytest.approx(1.0 + 1e-9, abs=1e-15)
    longer = pickle.loads(pickle.dumps(sol)).resume(1e9 + 10)
    assert np.array_equal(longer.t, free.t)
    assert np.array_equal(longer.y, free.y)


@pytest.mark.parametrize("cap", [1, 7, 40, 200])
def test_a_capped_run_keeps_what_it_found_and_finds_the_rest(cap):
    sol = run(events=sections(), max_steps=cap, on_failure="ignore")
    while not sol.success:
        sol = sol.resume(10.0, max_steps=cap, on_failure="ignore")
    assert in_numbers(sol) == in_numbers(run(events=sections()))


def test_chaotic_sections_are_counted_alike_whatever_is_kept():
    """Some thousand crossings over 500 s agree, in one go, in pieces, with and without stops."""
    section = ev.JointAngle(2, 0.0, every_turn=True, direction=1)
    start = [-1.4, -1.1]
    whole = pc.simulate(BOOK, (0, 500), start, store="end", events=[section])
    pieces = pc.simulate(BOOK, (0, 100), start, store="steps", events=[section])
    for t_end in (200, 300.5, 500):
        pieces = pieces.resume(t_end)
    stopping = [section.replace(terminal=100)]
    stops = pc.simulate(BOOK, (0, 500), start, store="end", events=stopping)
    while stops.status == "event":
        assert len(stops.events[0]) % 100 == 0
        stops = stops.resume(500)
    assert len(whole.events[0]) > 300
    assert in_numbers(whole) == in_numbers(pieces) == in_numbers(stops)
    turns = [(one.q[1] - one.q[0]) / (2 * np.pi) for one in whole.events[0]]
    assert turns == pytest.approx(np.round(turns), abs=1e-13)
    assert all(one.qd[1] > one.qd[0] for one in whole.events[0])
