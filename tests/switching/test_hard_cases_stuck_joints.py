"""Several joints with dry friction: which of them stick, and what the others do meanwhile.

The answer of dense_chain.py tries every pattern of stick and slip: the one without contradiction is
the law (the convex problem of Coulomb friction has one solution). Testing each joint with all
others locked is wrong in one random case of six.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain, held_accelerations, joints
from driven_chains import DrivenChain, Motor, assert_follows_mode_by_mode, mode_by_mode
from pendcore import effects as fx
from unit_rods import links, time_of_rest

CASES = 2000


def drawn(n: int, seed: int, *, at_rest: bool) -> dict[str, Any]:
    """A chain with friction and a motor in every joint, at rest or with some joints sliding."""
    random = np.random.default_rng([n, seed])
    chain = DenseChain(
        masses=random.uniform(0.2, 3, n), lengths=random.uniform(0.2, 2, n), gravity=9.81
    )
    size = chain.moments * chain.gravity
    phid = np.zeros(n) if at_rest else random.choice([0.0, 0.0, 1.0, -2.0], n)
    static = np.cumsum(size[::-1])[::-1] * random.uniform(0, 0.8, n)
    return {
        "chain": chain,
        "q": random.uniform(-4, 4, n),
        "qd": np.cumsum(phid),
        "phid": phid,
        "motors": size * random.uniform(-0.5, 0.5, n),
        "static": static,
        "coulomb": static * random.uniform(0.3, 1, n),
    }


def scene_of(case: dict[str, Any]) -> pc.Scene:
    chain: DenseChain = case["chain"]
    effects: list[Any] = []
    for j in range(chain.n):
        effects.append(fx.Motor(joint=j + 1, constant=float(case["motors"][j])))
        friction = {name: float(case[name][j]) for name in ("coulomb", "static")}
        effects.append(fx.DryJointFriction(joint=j + 1, stribeck_velocity=0.01, **friction))
    return pc.Scene(links=links(chain), gravity=chain.gravity, effects=effects)


def answer(case: dict[str, Any]) -> tuple[Any, frozenset[int]]:
    chain: DenseChain = case["chain"]
    phid = case["phid"]
    at_rest = {j: float(case["static"][j]) for j in range(chain.n) if phid[j] == 0}
    peak = (case["static"] - case["coulomb"]) * np.exp(-((phid / 0.01) ** 2))
    sliding = -np.sign(phid) * (case["coulomb"] + peak)
    forces = chain.forces(case["q"], case["qd"], case["motors"] + sliding)
    return held_accelerations(chain.mass_matrix(case["q"]), forces, at_rest)


@pytest.mark.parametrize("at_rest", [True, False], ids=["at rest", "some slide"])
@pytest.mark.parametrize("n", [2, 3])
def test_what_sticks_is_what_is_free_of_contradiction(n: int, at_rest: bool) -> None:
    """Accelerations of 2000 random cases; those of joints that stick vanish exactly."""
    patterns = set()
    for seed in range(CASES if n == 2 else CASES // 2):
        case = drawn(n, seed, at_rest=at_rest)
        exact, stuck = answer(case)
        found = scene_of(case).accelerations(0.0, case["q"], case["qd"])
        scale = max(np.abs(exact).max(), 1.0)
        np.testing.assert_allclose(found, exact, atol=1e-9 * scale, err_msg=f"seed {seed}")
        before = np.append(0.0, found[:-1])
        assert all(found[j] == before[j] for j in stuck), f"seed {seed}: {stuck} {found}"
        patterns.add(stuck)
    assert len(patterns) == 2**n  # each subset of the joints stuck is among them


@pytest.mark.parametrize("n", [5, 10, 20, 40, 80])
def test_any_number_of_joints_hold_as_much_as_they_can_and_no_more(n: int) -> None:
    """At rest: a joint that does not turn holds within its static range, one that does at its end.

    The torques of friction follow from the accelerations; more patterns than can be tried out.
    """
    patterns = set()
    for seed in range(40):
        case = drawn(n, 20_000 + seed, at_rest=True)
        chain: DenseChain = case["chain"]
        qdd = scene_of(case).accelerations(0.0, case["q"], case["qd"])
        free = chain.forces(case["q"], case["qd"], case["motors"])
        m = chain.mass_matrix(case["q"])
        held = np.linalg.solve(joints(n).T, m @ qdd - free)
        turns, most = joints(n) @ qdd, case["static"]
        scale = np.abs(free).sum() + (np.abs(m) @ np.abs(qdd)).sum()  # of the rounded terms
        stuck = qdd == np.append(0.0, qdd[:-1])  # not small: the same as the link before
        assert (np.abs(held) <= most + 1e-12 * scale).all(), f"seed {seed}"
        np.testing.assert_allclose(
            held[~stuck], -np.sign(turns[~stuck]) * most[~stuck], atol=1e-12 * scale
        )
        patterns.add(tuple(stuck))
    assert len(patterns) > 10
    assert max(map(sum, patterns)) > n / 3


@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_run_from_rest_begins_as_the_law_says(n: int, method: str) -> None:
    """A microsecond on: joints that stick have not moved, the others as their accelerations say."""
    rested = 0
    for seed in range(60):
        case = drawn(n, 10_000 + seed, at_rest=True)
        exact, stuck = answer(case)
        sol = pc.simulate(
            scene_of(case),
            q0=case["q"],
            qd0=0,
            t_span=(0, 1e-6),
            method=method,
            rtol=1e-10,
            atol=1e-16,
        )
        if len(stuck) == n:
            assert (sol.status, time_of_rest(sol)) == ("at_rest", 0.0), f"seed {seed}"
            rested += 1
            continue
        assert sol.status == "finished", f"seed {seed}: {sol.message}"
        before = np.append(0.0, sol.qd[-1, :-1])
        held = frozenset(j for j in range(n) if sol.qd[-1, j] == before[j])
        assert held == stuck, f"seed {seed}"
        slid = joints(n) @ exact
        moved = joints(n) @ (sol.q[-1] - case["q"])
        loose = [j for j in range(n) if j not in stuck and abs(slid[j]) > 0.1]
        # friction falls as they speed up, with a peak of 0.01 rad/s: the signs must agree
        assert (np.sign(moved[loose]) == np.sign(slid[loose])).all(), f"seed {seed}"
    assert rested or n > 2


def test_a_joint_that_is_stuck_may_let_go_because_another_moves(fine: Any) -> None:
    """Link 2 swings freely about a held link 1: joint 1 lets go when the reaction's couple is ts.

    Until then link 2 is a single pendulum, which presses on joint 1 with the couple of its forces.
    """
    chain = DenseChain(masses=np.array([1.0, 1.0]), lengths=np.array([1.0, 1.0]), gravity=9.81)
    limit = 5.0
    scene = pc.Scene(
        links=links(chain), gravity=9.81, effects=[fx.DryJointFriction(joint=1, coulomb=limit)]
    )
    start = np.array([np.pi / 2, 0.3])
    sol = pc.simulate(scene, q0=start, qd0=0, t_span=(0, 2.0), **fine)
    assert sol.success
    first_free = int(np.argmax(sol.qd[:, 0] != 0))
    assert first_free > 1
    np.testing.assert_array_equal(sol.q[:first_free, 0], start[0])

    def couple(q: Any, qd: Any) -> float:
        """The couple that must hold link 1, from its line of M qdd = forces with qdd_1 = 0."""
        m, f = chain.mass_matrix(q), chain.forces(q, qd, np.zeros(2))
        return float(m[0, 1] * f[1] / m[1, 1] - f[0])

    for row in range(first_free):
        assert abs(couple(sol.q[row], sol.qd[row])) <= limit * (1 + 1e-9)
    let_go = abs(couple(sol.q[first_free - 1], sol.qd[first_free - 1]))
    assert let_go == pytest.approx(limit, rel=1e-9)


RUNS = {
    "slow": DrivenChain(friction=(5.0, 1.5), motor=Motor(1, 10.0, 1.0), t_end=6.2),
    "fast": DrivenChain(friction=(6.0, 4.0), motor=Motor(1, 18.0, 3.0), t_end=3.0),
    "three rods": DrivenChain(friction=(9.0, 3.0, 1.0), motor=Motor(1, 22.0, 2.0), t_end=2.5),
}


@pytest.mark.parametrize("run", RUNS)
def test_joints_that_stick_and_slide_in_turn_follow_the_solution_mode_by_mode(
    run: str, fine: Any
) -> None:
    """Hanging rods under a motor in joint 1: every switch, and the states between."""
    assert any(0 in mode for _, _, mode in mode_by_mode(RUNS[run]).exact.switches)
    assert_follows_mode_by_mode(RUNS[run].simulate(**fine), RUNS[run])
