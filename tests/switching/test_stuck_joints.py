"""Several joints with dry friction: which of them stick, and what the others do meanwhile.

The answer of dense_chain.py tries every pattern of stick and slip: the one without contradiction is
the law (the convex problem of Coulomb friction has one solution). Testing each joint with all
others locked is wrong in one random case of six.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pendcore as pc
import pytest
from dense_chain import Array, DenseChain, held_accelerations, joints
from pendcore import effects as fx
from unit_rods import links, time_of_rest


@dataclass(frozen=True, kw_only=True)
class Rubbed:
    """A chain with friction and a motor in every joint, and its state."""

    chain: DenseChain
    q: Array
    phid: Array
    motors: Array
    static: Array
    coulomb: Array

    @property
    def scene(self):
        effects = []
        for j, torque in enumerate(self.motors, start=1):
            how = {"coulomb": float(self.coulomb[j - 1]), "static": float(self.static[j - 1])}
            effects.append(fx.Motor(joint=j, constant=float(torque)))
            effects.append(fx.DryJointFriction(joint=j, stribeck_velocity=0.01, **how))
        return pc.Scene(links=links(self.chain), gravity=self.chain.gravity, effects=effects)

    def answer(self):
        """The accelerations, and the joints that stick."""
        phid, qd = self.phid, np.cumsum(self.phid)
        at_rest = {j: float(self.static[j]) for j in np.flatnonzero(phid == 0)}
        peak = (self.static - self.coulomb) * np.exp(-((phid / 0.01) ** 2))
        sliding = -np.sign(phid) * (self.coulomb + peak)
        forces = self.chain.forces(self.q, qd, self.motors + sliding)
        return held_accelerations(self.chain.mass_matrix(self.q), forces, at_rest)


def drawn(n, seed, *, at_rest):
    """All joints at rest, or some of them sliding."""
    random = np.random.default_rng([n, seed])
    masses, lengths = random.uniform(0.2, 3, n), random.uniform(0.2, 2, n)
    chain = DenseChain(masses=masses, lengths=lengths, gravity=9.81)
    size = chain.moments * chain.gravity
    phid = np.zeros(n) if at_rest else random.choice([0.0, 0.0, 1.0, -2.0], n)
    static = np.cumsum(size[::-1])[::-1] * random.uniform(0, 0.8, n)
    q, motors = random.uniform(-4, 4, n), size * random.uniform(-0.5, 0.5, n)
    coulomb = static * random.uniform(0.3, 1, n)
    return Rubbed(chain=chain, q=q, phid=phid, motors=motors, static=static, coulomb=coulomb)


@pytest.mark.few_cases
@pytest.mark.parametrize("at_rest", [True, False], ids=["at rest", "some slide"])
@pytest.mark.parametrize(("n", "cases"), [(2, 2000), (3, 1000)])
def test_what_sticks_is_what_is_free_of_contradiction(n, cases, at_rest):
    """Accelerations of random cases; those of joints that stick vanish exactly."""
    patterns = set()
    for seed in range(cases):
        case = drawn(n, seed, at_rest=at_rest)
        exact, stuck = case.answer()
        found = case.scene.accelerations(0.0, case.q, np.cumsum(case.phid))
        scale = max(np.abs(exact).max(), 1.0)
        np.testing.assert_allclose(found, exact, atol=1e-9 * scale, err_msg=f"seed {seed}")
        before = np.append(0.0, found[:-1])
        assert all(found[j] == before[j] for j in stuck), f"seed {seed}: {stuck} {found}"
        patterns.add(stuck)
    assert len(patterns) == 2**n  # each subset of the joints stuck is among them


@pytest.mark.parametrize("n", [5, 10, 20, 40, 80])
def test_any_number_of_joints_hold_as_much_as_they_can_and_no_more(n):
    """At rest: a joint that does not turn holds within its static range, one that does at its end.

    The torques of friction follow from the accelerations; more patterns than can be tried out.
    """
    patterns = set()
    for seed in range(40):
        case, still = drawn(n, 20_000 + seed, at_rest=True), np.zeros(n)
        qdd = case.scene.accelerations(0.0, case.q, still)
        free = case.chain.forces(case.q, still, case.motors)
        m = case.chain.mass_matrix(case.q)
        held = np.linalg.solve(joints(n).T, m @ qdd - free)
        turns, most = joints(n) @ qdd, case.static
        scale = np.abs(free).sum() + (np.abs(m) @ np.abs(qdd)).sum()  # of the rounded terms
        stuck = qdd == np.append(0.0, qdd[:-1])  # not small: the same as the link before
        assert (np.abs(held) <= most + 1e-12 * scale).all(), f"seed {seed}"
        slides = -np.sign(turns[~stuck]) * most[~stuck]
        np.testing.assert_allclose(held[~stuck], slides, atol=1e-12 * scale)
        patterns.add(tuple(stuck))
    assert len(patterns) > 10
    assert max(map(sum, patterns)) > n / 3


@pytest.mark.few_cases
@pytest.mark.parametrize("n", [2, 3, 4])
def test_a_run_from_rest_begins_as_the_law_says(n, method):
    """A microsecond on: joints that stick have not moved, the others as their accelerations say."""
    rested = 0
    for seed in range(60):
        case = drawn(n, 10_000 + seed, at_rest=True)
        exact, stuck = case.answer()
        how = {"method": method, "rtol": 1e-10, "atol": 1e-16}
        sol = pc.simulate(case.scene, (0, 1e-6), case.q, **how)
        if len(stuck) == n:
            assert (sol.status, time_of_rest(sol)) == ("at_rest", 0.0), f"seed {seed}"
            rested += 1
            continue
        assert sol.status == "finished", f"seed {seed}: {sol.message}"
        before = np.append(0.0, sol.qd[-1, :-1])
        assert {j for j in range(n) if sol.qd[-1, j] == before[j]} == stuck, f"seed {seed}"
        slid, moved = joints(n) @ exact, joints(n) @ (sol.q[-1] - case.q)
        loose = [j for j in range(n) if j not in stuck and abs(slid[j]) > 0.1]
        # friction falls as they speed up, with a peak of 0.01 rad/s: the signs must agree
        assert (np.sign(moved[loose]) == np.sign(slid[loose])).all(), f"seed {seed}"
    assert rested or n > 2


def test_a_joint_that_is_stuck_may_let_go_because_another_moves(fine):
    """Link 2 swings freely about a held link 1: joint 1 lets go when the reaction's couple is ts.

    Until then link 2 is a single pendulum, which presses on joint 1 with the couple of its forces.
    """
    chain, limit = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=9.81), 5.0
    friction = fx.DryJointFriction(joint=1, coulomb=limit)
    scene = pc.Scene(links=links(chain), gravity=9.81, effects=[friction])
    sol = pc.simulate(scene, (0, 2.0), [np.pi / 2, 0.3], **fine)
    assert sol.success
    first_free = int(np.argmax(sol.qd[:, 0] != 0))
    assert first_free > 1
    assert (sol.q[:first_free, 0] == np.pi / 2).all()
    couples = []  # that hold link 1, from its line of M qdd = forces with qdd_1 = 0
    for q, qd in zip(sol.q[:first_free], sol.qd[:first_free], strict=True):
        m, f = chain.mass_matrix(q), chain.forces(q, qd, np.zeros(2))
        couples.append(abs(m[0, 1] * f[1] / m[1, 1] - f[0]))
    assert max(couples) <= limit * (1 + 1e-9)
    assert couples[-1] == pytest.approx(limit, rel=1e-9)
