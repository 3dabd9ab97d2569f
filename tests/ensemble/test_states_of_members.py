"""Energies and positions of all members: those of each member's run."""

from __future__ import annotations

import itertools

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
SHAKEN = BOOK.replace(effects=[pc.effects.DrivenPivot(y=pc.effects.Sinusoid(0.1, 9.0))])
STARTS = pc.sampling.uniform(-2, 2, (3, 2), seed=1)
VARIED = {
    "nothing": {},
    "parameters": {"gravity": [9.8, 1.6, 0.0], "link[1].length": 1.2},
}


def assert_those_of_single_runs(found):
    energy, positions = found.energy(), found.positions()
    assert energy.total.shape == found.q.shape[:-1]
    for place in np.ndindex(found.shape):
        alone = found.member(place)
        kept = slice(None) if found.request.t_eval is not None else -1
        for name in ("kinetic", "potential", "total"):
            assert np.array_equal(getattr(energy, name)[place], getattr(alone.energy(), name)[kept])
        assert np.array_equal(positions[place], alone.positions()[kept])


@pytest.mark.parametrize("scene", [BOOK, SHAKEN], ids=["bare", "shaken"])
@pytest.mark.parametrize("vary", VARIED)
@pytest.mark.parametrize("t_eval", [None, [0.5, 2.0]], ids=["end", "times"])
def test_they_are_those_of_single_runs(scene, vary, t_eval):
    keep = "end" if t_eval is None else "times"
    how = {"t_span": (0, 2), "keep": keep, "t_eval": t_eval, "vary": VARIED[vary]}
    assert_those_of_single_runs(pc.ensemble(scene, q0=STARTS, **how))


def test_an_event_ends_each_member_at_its_own_time():
    passes = pc.events.LinkAngle(1, np.pi / 2, every_turn=True, terminal=True)
    found = pc.ensemble(SHAKEN, q0=STARTS, t_span=(0, 9), events=[passes])
    assert len(set(found.t)) == 3
    assert_those_of_single_runs(found)


@pytest.mark.parametrize("t_eval", [None, [0.5, 2.0]], ids=["end", "times"])
def test_those_of_a_refused_member_are_nan(t_eval):
    found = pc.ensemble(
        BOOK, q0=[[0.5, 1.0], [np.nan, 1.0]], t_span=(0, 2), vary={"link[2].mass": [[1.0], [-1.0]]},
        keep="end" if t_eval is None else "times", t_eval=t_eval, on_failure="ignore",
    )  # fmt: skip
    totals, positions = found.energy().total, found.positions()
    for place in itertools.product(range(2), range(2)):
        is_there = found.success[place]
        assert is_there == (place == (0, 0))
        assert np.isfinite(totals[place]).all() == is_there
        assert np.isfinite(positions[place]).all() == is_there


def test_one_member_and_none():
    assert_those_of_single_runs(pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 2)))
    none = pc.ensemble(BOOK, q0=np.zeros((0, 2)), t_span=(0, 2))
    assert (none.energy().total.shape, none.positions().shape) == ((0,), (0, 3, 2))
    assert repr(none.energy()) == "<Energy: kinetic, potential, total, each (0,)>"


def test_implausible_members_do_not_warn_again():
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 0.1), vary={"link[1].inertia": [0.1, 1e9]})
    assert np.isfinite(found.energy().total).all()
