"""Chains that come to their stops, lean on them and are let go, beside joints that stick."""

from __future__ import annotations

import functools
import itertools
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain, joints
from hybrid_chain import HybridChain
from pendcore import effects as fx
from unit_rods import links

FREE = (-np.inf, np.inf)
RUNS: dict[str, tuple[list[Any], list[float], tuple[int, float], float]] = {
    "two rods": ([FREE, (-0.1, 0.2)], [0, 0], (1, 10.0), 4.0),
    "three rods, two of them in contact": (
        [FREE, (-0.2, 0.1), (-0.1, np.inf)], [0, 0, 0], (1, 14.0), 3.0,
    ),
    "one sticks while another is in contact": (
        [FREE, (-0.1, 0.3), FREE], [6, 0, 0], (1, 14.0), 3.0,
    ),
    "a contact pushes on a joint that sticks": ([FREE, (-0.1, 0.3)], [6, 0], (2, 12.0), 3.0),
    "friction at the stop": ([FREE, (-0.1, 0.3)], [5, 2], (1, 14.0), 4.0),
}  # fmt: skip
"""Of each joint its stops and its friction; where the motor is, and how strong; until when."""


@functools.cache
def mode_by_mode(run: str) -> tuple[HybridChain, Any, Any]:
    stops, friction, (joint, amplitude), t_end = RUNS[run]
    n = len(stops)
    chain = DenseChain(masses=np.ones(n), lengths=np.ones(n), gravity=9.807)
    motor = np.eye(n)[joint - 1] * amplitude
    exact = HybridChain(
        chain=chain,
        friction=np.array(friction, float),
        torques=lambda t: motor * np.sin(2 * t),
        stops=np.array(stops),
    )
    times = np.linspace(0, t_end, 12)[1:]
    return exact, times, exact.run(np.full(n, np.pi / 2), times, h=0.06)


@pytest.mark.parametrize("run", RUNS)
def test_lasting_contact_begins_and_ends_as_in_the_solution_mode_by_mode(
    run: str, fine: Any
) -> None:
    """Hanging rods under a motor, plastic stops: every switch, and the states between."""
    stops, friction, (joint, amplitude), t_end = RUNS[run]
    n = len(stops)
    exact, times, states = mode_by_mode(run)
    hum = fx.Sinusoid(amplitude=amplitude, angular_frequency=2.0)
    effects: list[Any] = [fx.Motor(joint=joint, sinusoid=hum)]
    for j in range(n):
        if friction[j]:
            effects.append(fx.DryJointFriction(joint=j + 1, coulomb=float(friction[j])))
        if stops[j] != FREE:
            effects.append(fx.JointStop(joint=j + 1, range=stops[j]))
    scene = pc.Scene(links=links(exact.chain), gravity=exact.chain.gravity, effects=effects)
    sol = pc.simulate(scene, np.pi / 2, t_span=(0, t_end), **fine)
    assert sol.status == "finished"
    np.testing.assert_allclose(sol(times).T, states, rtol=0, atol=1e-9)
    for time, _, _ in exact.switches:
        assert np.abs(sol.t - time).min() < 1e-9
    for (begin, _, mode), (end, _, _) in itertools.pairwise(exact.switches):
        phid = joints(n) @ sol((begin + end) / 2)[n:]
        np.testing.assert_array_equal(phid == 0, np.array(mode) == 0)  # not small: nothing
    phi = joints(n) @ sol.q.T
    least, most = np.array(stops).T
    assert (least - 1e-14 < phi.T).all()
    assert (most + 1e-14 > phi.T).all()


def test_these_runs_reach_their_stops_lean_on_them_and_leave_them() -> None:
    lean = dict.fromkeys(RUNS, 0)
    together = dict.fromkeys(RUNS, 0)
    for run in RUNS:
        exact, _, _ = mode_by_mode(run)
        for (begin, y, mode), (end, _, after) in itertools.pairwise(exact.switches):
            touches = exact.gaps(y).min(axis=1) < 1e-9
            held = np.array(mode) == 0
            let_go = touches & held & (np.array(after) != 0)
            lean[run] += int((let_go & (end - begin > 0.1)).any())
            together[run] += int((touches & held).any() and (~touches & held).any())
    assert min(lean.values()) >= 1
    assert together["one sticks while another is in contact"] >= 1
    assert together["a contact pushes on a joint that sticks"] >= 1
