"""Watching changes no bit of a run; a run that an event ended goes on as if it never had."""

from __future__ import annotations

import pickle
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import _core
from pendcore import events as ev

BOOK = pc.Scene.textbook()
ERROR_ORDERS = {method["name"]: method["error_order"] for method in _core.methods()}
METHODS = list(ERROR_ORDERS)
DENSE_STAGES = {
    method["name"]: len(table.get("c", ())) - len(table.get("b", table.get("c", ())))
    for method in _core.methods()
    for table in [_core.tableau(method["first"])]  # nothing is stiff here
}
MOVED = pc.Scene(
    links=BOOK.links,
    effects=[
        pc.effects.DryJointFriction(joint=1, coulomb=0.01),
        pc.effects.Motor(
            joint=2, pd=pc.effects.PD(kp=3.0, kd=0.1, reference=0.3), limit=0.5
        ),
    ],
)  # fmt: skip
FAST = {"rtol": 1e-6, "atol": 1e-9}


def sections(terminal: bool | int = False) -> list[ev.Event]:
    return [
        ev.LinkAngle(2, 1.2, direction=1, terminal=terminal),
        ev.JointAngle(2, 0.0, terminal=terminal and terminal + 1),
        ev.RateZero(joint=2),
        ev.TipLine((0.3, 0.0), (1.0, 0.2), terminal=terminal and terminal + 3),
        ev.LinkAngle(2, 1.2, direction=-1),
    ]


def in_numbers(sol: pc.Solution) -> list[list[tuple[float, int, list[float]]]]:
    return [[(one.t, one.direction, one.y.tolist()) for one in found] for found in sol.events]


def run(scene: pc.Scene = BOOK, t_end: float = 10.0, **options: Any) -> pc.Solution:
    return pc.simulate(scene, q0=[-1.4, -1.1], qd0=0.1, t_span=(0, t_end), **options)


def but_for_dense_stages(stats: pc.Statistics) -> pc.Statistics:
    """Return the statistics without right-hand sides; a dense output may ask for its own."""
    return stats._replace(nfev=0)


def same(one: pc.Solution, other: pc.Solution) -> bool:
    dense = one.store != "dense" or np.array_equal(
        one(np.linspace(0, 10, 333)), other(np.linspace(0, 10, 333))
    )
    return (
        dense
        and np.array_equal(one.t, other.t)
        and np.array_equal(one.y, other.y)
        and but_for_dense_stages(one.stats) == but_for_dense_stages(other.stats)
    )


STORES: dict[str, dict[str, Any]] = {
    "end": {"store": "end"},
    "times": {"t_eval": np.linspace(0, 10, 41)},
    "steps": {"store": "steps"},
    "dense": {},
    "dense with times": {"store": "dense", "t_eval": np.linspace(0, 10, 41)},
}


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", [BOOK, MOVED], ids=["book", "moved"])
@pytest.mark.parametrize("store", STORES)
def test_watching_changes_no_bit_whatever_is_stored(
    method: str, scene: pc.Scene, store: str
) -> None:
    how = {"method": method, "step": None if ERROR_ORDERS[method] else 0.01, **FAST}
    watched = run(scene, events=sections(), **how | STORES[store])
    unwatched = run(scene, **how | STORES[store])
    assert same(unwatched, watched)
    more = watched.stats.nfev - unwatched.stats.nfev
    if DENSE_STAGES[method] == 0 or scene is MOVED or "dense" in store:  # asked for in any case
        assert more == 0
    elif store != "times":
        assert more == DENSE_STAGES[method] * watched.stats.accepted
    assert in_numbers(watched) == in_numbers(run(scene, events=sections(), store="end", **how))
    assert sum(map(len, watched.events)) > 20


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("scene", [BOOK, MOVED], ids=["book", "moved"])
@pytest.mark.parametrize("store", STORES)
def test_a_run_that_stops_at_events_goes_on_as_if_it_never_had(
    method: str, scene: pc.Scene, store: str, tmp_path: Path
) -> None:
    how = {"method": method, "step": None if ERROR_ORDERS[method] else 0.01, **FAST}
    how |= STORES[store]
    whole = run(scene, events=sections(), **how)
    sol = run(scene, events=sections(terminal=1), **how)
    stops = 0
    while sol.status == "event":
        stops += 1
        t, found = sol.t[-1] if len(sol.t) else 0.0, in_numbers(sol)
        assert all(one.t <= sol._run.t_reached for each in sol.events for one in each)
        for each, all_of_them in zip(found, in_numbers(whole), strict=True):
            assert each == all_of_them[: len(each)]
        assert t <= sol._run.t_reached
        if stops % 3 == 1:
            sol = pickle.loads(pickle.dumps(sol))
        elif stops % 3 == 2:
            sol.save(tmp_path / "run.npz")
            sol = pc.load(tmp_path / "run.npz")
        assert in_numbers(sol) == found
        sol = sol.resume(10.0)
    ends = {
        found[k].t
        for found, every in zip(whole.events[:2] + whole.events[3:4], (1, 2, 4), strict=True)
        for k in range(every - 1, len(found), every)
    }
    assert stops == len(ends) > 5
    assert same(sol, whole)
    assert in_numbers(sol) == in_numbers(whole)


def test_a_run_backward_stops_and_goes_on_likewise() -> None:
    whole = pc.simulate(BOOK, q0=[-1.4, -1.1], qd0=0.1, t_span=(0, -10), events=sections())
    sol = pc.simulate(BOOK, q0=[-1.4, -1.1], qd0=0.1, t_span=(0, -10), events=sections(terminal=2))
    while sol.status == "event":
        sol = sol.resume(-10)
    assert np.array_equal(sol.y, whole.y)
    assert in_numbers(sol) == in_numbers(whole)
    for found in whole.events:
        assert all(a.t > b.t for a, b in pairwise(found))


def test_what_a_stopped_run_leaves_ends_at_the_event() -> None:
    sol = run(events=sections(terminal=2))
    end = sol.events[1][-1] if sol.message.endswith("event 2 (joint_angle))") else sol.events[0][-1]
    assert sol.t[-1] == end.t
    assert np.array_equal(sol.y[:, -1], end.y)
    assert np.array_equal(sol(end.t), end.y)
    assert np.all(np.diff(sol.t) > 0)
    with pytest.raises(ValueError, match="within the run"):
        sol(np.nextafter(end.t, 10))
    free = run()
    within = np.linspace(0, end.t, 50)[:-1]
    assert np.array_equal(sol(within), free(within))
    assert sol.stats.accepted == len(sol.t) - 1


def test_times_asked_for_stop_at_the_event_and_go_on_behind_it() -> None:
    grid = np.linspace(0, 10, 101)
    whole = run(t_eval=grid)
    sol = run(t_eval=grid, events=[ev.LinkAngle(2, 1.2, terminal=3)])
    end = sol.events[0][-1].t
    assert np.array_equal(sol.t, grid[grid <= end])
    assert np.array_equal(sol.y, whole.y[:, grid <= end])
    assert np.array_equal(sol.resume(10.0).t[: len(sol.t) + 1], grid[: len(sol.t) + 1])


def test_a_time_asked_for_that_is_the_time_of_the_event() -> None:
    clock = ev.Function(lambda t, q, qd: t - 3.21, samples=1, terminal=True)
    sol = run(t_eval=[1.0, 3.21, 4.0], events=[clock])
    (found,) = sol.events[0]
    assert found.t == pytest.approx(3.21, abs=1e-15)
    early = run(t_eval=[1.0, found.t, 4.0], events=[clock])
    assert early.t.tolist() == [1.0, found.t]
    assert np.array_equal(early.y[:, 1], found.y)


def test_an_end_just_behind_an_event_cuts_its_step_and_is_a_view() -> None:
    whole = run(events=sections())
    for found in whole.events[0][:4]:
        for gap in (0.0, 1e-12, 1e-9, 1e-4):
            cut = run(t_end=found.t + gap, events=sections())
            longer = cut.resume(10.0)
            assert in_numbers(longer) == in_numbers(whole)
            assert np.array_equal(longer.y, whole.y)
            stopping = [ev.LinkAngle(2, 1.2, direction=1, terminal=True)]
            ended = run(t_end=found.t + gap, events=stopping)
            while ended.status == "event" or ended.t[-1] < 10:
                ended = ended.resume(10.0)
            assert in_numbers(ended) == in_numbers(whole)[:1]
            assert np.array_equal(ended.y, whole.y)


def test_the_ledger_is_kept_to_the_event() -> None:
    how = {"ledger": True, "rtol": 1e-8}
    whole = run(MOVED, **how)
    sol = run(MOVED, events=sections(terminal=2), **how)
    assert sol.status == "event"
    assert abs(sol.energy().ledger.residual[-1]) < 1e-6
    while sol.status == "event":
        sol = sol.resume(10.0)
    assert np.array_equal(sol.energy().ledger.dry, whole.energy().ledger.dry)
    assert np.array_equal(sol.y, whole.y)


@pytest.mark.parametrize("store", STORES)
def test_an_event_within_the_last_bit_of_the_start(store: str) -> None:
    """At t = 1e9 s a double resolves 1e-7 s, and the event comes before the next double."""
    rod = pc.Scene(links=BOOK.links[:1], gravity=0.0)
    how = {**STORES[store], "events": [ev.LinkAngle(1, 1.0 + 1e-9, terminal=True)]}
    if "t_eval" in how:
        how["t_eval"] = 1e9 + how["t_eval"]
    sol = pc.simulate(rod, q0=1.0, qd0=1.0, t_span=(1e9, 1e9 + 10), **how)
    assert sol.status == "event"
    assert sol.events[0][0].t == sol._run.t_reached == 1e9
    assert sol.events[0][0].q[0] == pytest.approx(1.0 + 1e-9, abs=1e-15)
    longer = pickle.loads(pickle.dumps(sol)).resume(1e9 + 10)
    free = pc.simulate(rod, q0=1.0, qd0=1.0, t_span=(1e9, 1e9 + 10), **how | {"events": []})
    assert np.array_equal(longer.t, free.t)
    assert np.array_equal(longer.y, free.y)


@pytest.mark.parametrize("cap", [1, 7, 40, 200])
def test_a_capped_run_keeps_what_it_found_and_finds_the_rest(cap: int) -> None:
    whole = run(events=sections())
    sol = run(events=sections(), max_steps=cap, on_failure="ignore")
    while not sol.success:
        sol = sol.resume(10.0, max_steps=cap, on_failure="ignore")
    assert in_numbers(sol) == in_numbers(whole)


def test_chaotic_sections_are_counted_alike_whatever_is_kept() -> None:
    """Some thousand crossings over 500 s agree, in one go, in pieces, with and without stops."""
    section = ev.JointAngle(2, 0.0, every_turn=True, direction=1)
    span, start = (0, 500), [-1.4, -1.1]
    whole = pc.simulate(BOOK, q0=start, t_span=span, store="end", events=[section])
    pieces = pc.simulate(BOOK, q0=start, t_span=(0, 100), store="steps", events=[section])
    for t_end in (200, 300.5, 500):
        pieces = pieces.resume(t_end)
    stopping = [section.replace(terminal=100)]
    stops = pc.simulate(BOOK, q0=start, t_span=span, store="end", events=stopping)
    while stops.status == "event":
        assert len(stops.events[0]) % 100 == 0
        stops = stops.resume(500)
    assert len(whole.events[0]) > 300
    assert in_numbers(whole) == in_numbers(pieces) == in_numbers(stops)
    turns = [(one.q[1] - one.q[0]) / (2 * np.pi) for one in whole.events[0]]
    assert turns == pytest.approx(np.round(turns), abs=1e-13)
    assert all(one.qd[1] > one.qd[0] for one in whole.events[0])
