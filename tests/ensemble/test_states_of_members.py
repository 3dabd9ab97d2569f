"""Energies and positions of all members: those of each member's run."""

from __future__ import annotations

import itertools

import numpy as np
import pendcore as pc
import pytest
from members_and_runs import BOOK, starts

SHAKEN = BOOK.replace(effects=[pc.effects.DrivenPivot(y=pc.effects.Sinusoid(0.1, 9.0))])
PASSES = pc.events.LinkAngle(1, np.pi / 2, every_turn=True, terminal=True)
TIMES = {"keep": "times", "t_eval": [0.5, 2.0]}
VARIED = {"vary": {"gravity": [9.8, 1.6, 0.0], "link[1].length": 1.2}}
ASKED = {
    "at the end": {},
    "at times": TIMES,
    "with parameters": VARIED,
    "with parameters, at times": VARIED | TIMES,
    "at an event, each at its own time": {"t_span": (0, 9), "events": [PASSES]},
    "one member": {"q0": [0.5, 1.0]},
}


@pytest.mark.parametrize("scene", [BOOK, SHAKEN], ids=["bare", "shaken"])
@pytest.mark.parametrize("asked", ASKED)
def test_they_are_those_of_single_runs(scene, asked):
    how = {"q0": starts(3, 2, 1, 2.0), "t_span": (0, 2)} | ASKED[asked]
    found = pc.ensemble(scene, **how)
    energy, positions = found.energy(), found.positions()
    assert energy.total.shape == found.q.shape[:-1]
    kept = slice(None) if "t_eval" in how else -1
    for place in np.ndindex(found.shape):
        alone = found.member(place)
        for name in ("kinetic", "potential", "total"):
            assert np.array_equal(getattr(energy, name)[place], getattr(alone.energy(), name)[kept])
        assert np.array_equal(positions[place], alone.positions()[kept])
    assert "event" not in asked or len(set(found.t)) == 3


@pytest.mark.parametrize("times", [{}, TIMES], ids=["end", "times"])
def test_those_of_a_refused_member_are_nan(times):
    vary = {"link[2].mass": [[1.0], [-1.0]]}
    how = {"t_span": (0, 2), "vary": vary, "on_failure": "ignore"} | times
    found = pc.ensemble(BOOK, q0=[[0.5, 1.0], [np.nan, 1.0]], **how)
    totals, positions = found.energy().total, found.positions()
    for place in itertools.product(range(2), range(2)):
        is_there = found.success[place]
        assert is_there == (place == (0, 0))
        assert np.isfinite(totals[place]).all() == is_there
        assert np.isfinite(positions[place]).all() == is_there


def test_no_members_have_none():
    none = pc.ensemble(BOOK, q0=np.zeros((0, 2)), t_span=(0, 2))
    assert (none.energy().total.shape, none.positions().shape) == ((0,), (0, 3, 2))
    assert repr(none.energy()) == "<Energy: kinetic, potential, total, each (0,)>"


def test_implausible_members_do_not_warn_again():
    found = pc.ensemble(BOOK, q0=[0.5, 1.0], t_span=(0, 0.1), vary={"link[1].inertia": [0.1, 1e9]})
    assert np.isfinite(found.energy().total).all()
