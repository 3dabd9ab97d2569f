"""Chains that come to their stops, lean on them and are let go, beside joints that stick."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from dense_chain import joints
from driven_chains import (
    FREE,
    DrivenChain,
    Motor,
    assert_follows_mode_by_mode,
    mode_by_mode,
)

W = 2.0  # rad/s, of every motor

RUNS = {
    "two rods": DrivenChain(
        stops=(FREE, (-0.1, 0.2)),
        friction=(0.0, 0.0),
        motor=Motor(1, 10.0, W),
        t_end=4.0,
        h=0.06,
    ),
    "three rods, two of them in contact": DrivenChain(
        stops=(FREE, (-0.2, 0.1), (-0.1, np.inf)),
        friction=(0.0, 0.0, 0.0),
        motor=Motor(1, 14.0, W),
        t_end=3.0,
        h=0.06,
    ),
    "one sticks while another is in contact": DrivenChain(
        stops=(FREE, (-0.1, 0.3), FREE),
        friction=(6.0, 0.0, 0.0),
        motor=Motor(1, 14.0, W),
        t_end=3.0,
        h=0.06,
    ),
    "a contact pushes on a joint that sticks": DrivenChain(
        stops=(FREE, (-0.1, 0.3)),
        friction=(6.0, 0.0),
        motor=Motor(2, 12.0, W),
        t_end=3.0,
        h=0.06,
    ),
    "friction at the stop": DrivenChain(
        stops=(FREE, (-0.1, 0.3)),
        friction=(5.0, 2.0),
        motor=Motor(1, 14.0, W),
        t_end=4.0,
        h=0.06,
    ),
}


@pytest.mark.parametrize("run", RUNS)
def test_lasting_contact_begins_and_ends_as_in_the_solution_mode_by_mode(
    run: str, fine: Any
) -> None:
    """Hanging rods under a motor, plastic stops: every switch, and the states between."""
    sol = RUNS[run].simulate(**fine)
    assert_follows_mode_by_mode(sol, RUNS[run])
    phi = joints(RUNS[run].n) @ sol.q.T
    least, most = RUNS[run].ranges.T
    assert (least - 1e-14 < phi.T).all()
    assert (most + 1e-14 > phi.T).all()


def test_these_runs_reach_their_stops_lean_on_them_and_leave_them() -> None:
    lean = dict.fromkeys(RUNS, 0)
    together = dict.fromkeys(RUNS, 0)
    for run in RUNS:
        exact, _, _ = mode_by_mode(RUNS[run])
        for (begin, y, mode), (end, _, after) in itertools.pairwise(exact.switches):
            touches = exact.gaps(y).min(axis=1) < 1e-9
            held = np.array(mode) == 0
            let_go = touches & held & (np.array(after) != 0)
            lean[run] += int((let_go & (end - begin > 0.1)).any())
            together[run] += int((touches & held).any() and (~touches & held).any())
    assert min(lean.values()) >= 1
    assert together["one sticks while another is in contact"] >= 1
    assert together["a contact pushes on a joint that sticks"] >= 1
