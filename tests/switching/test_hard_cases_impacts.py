"""Impacts on chains against the law in NumPy, several at once by trying out: see dense_chain.py."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain, joints, rates_after_impact
from pendcore import effects as fx
from unit_rods import links

inf = np.inf


@pytest.fixture
def fine(fine: Any) -> Any:
    return fine | {"max_steps": 20_000}  # so that none goes on for ever


def drawn_chain(n: int, seed: int) -> tuple[DenseChain, np.random.Generator]:
    random = np.random.default_rng([n, seed])
    masses, lengths = random.uniform(0.3, 3, n), random.uniform(0.3, 1.5, n)
    return DenseChain(masses=masses, lengths=lengths, gravity=9.81), random


def kinetic(m: Any, qd: Any) -> float:
    return float(qd @ m @ qd / 2)


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_an_impact_turns_the_joint_and_jerks_the_others_as_the_law_says(
    n: int, e: float, fine: Any
) -> None:
    """v+ = v- + M^-1 J^T Lam, and (1 - e^2) (J v-)^2 / (2 J M^-1 J^T) is lost, for each on the way.

    A joint's rate is turned to -e of itself; the tips of all others are jerked along.
    """
    impacts = 0
    for seed in range(6):
        chain, random = drawn_chain(n, seed)
        joint = int(random.integers(n)) + 1
        stop = fx.JointStop(joint=joint, range=(-0.3, 0.4), restitution=e, capture_speed=1e-3)
        scene = pc.Scene(links=links(chain), gravity=chain.gravity, effects=[stop])
        phi = random.uniform(-1, 1, n)
        phi[joint - 1] = 0.1
        phid = random.uniform(-2, 2, n)
        phid[joint - 1] = 3.0
        sol = pc.simulate(
            scene, q0=np.cumsum(phi), qd0=np.cumsum(phid), t_span=(0, 0.6), ledger=True, **fine
        )
        assert sol.success, sol.message
        row_j = joints(n)[joint - 1]
        angle = sol.relative_angles()[:, joint - 1]
        assert angle.min() >= -0.3 - 1e-12
        assert angle.max() <= 0.4 + 1e-12
        impact = sol.energy().ledger.impact
        for row in np.flatnonzero(np.diff(sol.t) == 0):
            q, before, after = sol.q[row], sol.qd[row], sol.qd[row + 1]
            np.testing.assert_array_equal(sol.q[row + 1], q)
            assert min(abs(angle[row] + 0.3), abs(angle[row] - 0.4)) < 1e-13
            m = chain.mass_matrix(q)
            closing = row_j @ before
            restitution = e if abs(closing) >= 1e-3 else 0.0
            exact, _ = rates_after_impact(m, before, -np.sign(closing) * row_j[None], [restitution])
            np.testing.assert_allclose(after, exact, atol=1e-11 * np.abs(before).max())
            lost = kinetic(m, before) - kinetic(m, after)
            assert impact[row + 1] - impact[row] == pytest.approx(lost, abs=1e-11)
            formula = (1 - restitution**2) * closing**2 / (2 * row_j @ np.linalg.solve(m, row_j))
            assert lost == pytest.approx(formula, abs=1e-11)
            impacts += 1
        assert np.abs(sol.energy().ledger.residual).max() < 1e-8
    assert impacts >= 4


@pytest.mark.parametrize("n", [2, 3, 4])
def test_stops_hit_at_once_share_the_impulse_by_complementarity(n: int, fine: Any) -> None:
    """Every joint starts at one of its bounds and moves either way; those that must, act."""
    acted = set()
    for seed in range(80):
        chain, random = drawn_chain(n, 1000 + seed)
        phi, phid = random.uniform(-2, 2, n), random.uniform(-3, 3, n)
        restitution = random.choice([0.0, 0.4, 0.8, 1.0], n)
        side = random.choice([-1.0, 1.0], n)  # 1: at its upper bound
        q, qd = np.cumsum(phi), np.cumsum(phid)
        relative = q - np.append(0.0, q[:-1])  # as the core will see them, to the last bit
        stops = [
            fx.JointStop(
                joint=j + 1,
                range=(-inf, relative[j]) if side[j] > 0 else (relative[j], inf),
                restitution=float(restitution[j]),
                capture_speed=1e-12,
            )
            for j in range(n)
        ]
        scene = pc.Scene(links=links(chain), gravity=chain.gravity, effects=stops)
        normals = -side[:, None] * joints(n)
        m = chain.mass_matrix(q)
        exact, impulses = rates_after_impact(m, qd, normals, restitution)
        sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0, 1e-5), ledger=True, **fine)
        assert sol.success, f"seed {seed}: {sol.message}"
        lost = kinetic(m, qd) - kinetic(m, exact)
        assert lost >= -1e-12 * kinetic(m, qd)
        assert sol.energy().ledger.impact[0] == 0.0
        assert sol.energy().ledger.impact[1] == pytest.approx(lost, abs=1e-10 * kinetic(m, qd))
        size = np.abs(qd).max()
        np.testing.assert_allclose(sol(0.0)[n:], exact, atol=1e-10 * size, err_msg=f"seed {seed}")
        acted.add(tuple(impulses > 1e-9))
    assert len(acted) > n + 1


TWO = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=0.0)


def two_stops(apart: float, fine: Any) -> tuple[pc.Solution, Any, Any]:
    """Two rods that reach their stops after 0.05 s; the second stop is `apart` rad further.

    Returns the run that hits them, with the mass matrix and the rates there.
    """
    free = pc.Scene(links=links(TWO), gravity=0.0)
    start, rates = [0.3, 0.9], [1.0, 4.0]
    reached = pc.simulate(free, q0=start, qd0=rates, t_span=(0, 0.05), **fine)
    q, qd = reached.q[-1], reached.qd[-1]
    phi = np.array([q[0], q[1] - q[0] + apart])
    assert (joints(2) @ qd > 0).all()
    stops = [fx.JointStop(joint=j + 1, range=(-inf, phi[j]), restitution=0.5) for j in range(2)]
    sol = pc.simulate(
        free.replace(effects=stops), q0=start, qd0=rates, t_span=(0, 0.05 + 1e-8), **fine
    )
    assert sol.success
    assert (sol.relative_angles() <= phi + 1e-15).all()
    return sol, TWO.mass_matrix(q), qd


def test_two_stops_that_are_reached_at_the_same_time_are_hit_at_the_same_time(fine: Any) -> None:
    sol, m, qd = two_stops(0.0, fine)
    exact, impulses = rates_after_impact(m, qd, -joints(2), [0.5, 0.5])
    assert (impulses > 0).all()
    (row,) = np.flatnonzero(np.diff(sol.t) == 0)
    assert sol.t[row] == pytest.approx(0.05, abs=1e-15)
    np.testing.assert_allclose(sol.qd[row + 1], exact, atol=1e-10)


@pytest.mark.parametrize("apart", [1e-9, -1e-9, 1e-13, -1e-13])
def test_two_stops_that_are_reached_a_hair_apart_are_hit_in_their_order(
    apart: float, fine: Any
) -> None:
    """The result differs from both at once. So near to the stops, the gaps are linear in time."""
    sol, m, rates = two_stops(apart, fine)
    gaps = np.array([0.0, apart]) - min(apart, 0.0)
    hits = 0
    while ((closing := joints(2) @ rates) > 0).any():
        times = [
            gap / speed if speed > 0 else inf for gap, speed in zip(gaps, closing, strict=True)
        ]
        hit = int(np.argmin(times))
        gaps = gaps - times[hit] * closing
        gaps[hit] = 0.0
        rates, _ = rates_after_impact(m, rates, -joints(2)[[hit]], [0.5])
        hits += 1
    assert len(np.flatnonzero(np.diff(sol.t) == 0)) == hits > 3
    np.testing.assert_allclose(sol.qd[-1], rates, atol=1e-7)  # some 1e-8 s later


def test_an_impact_sets_a_stuck_joint_free_and_friction_gives_no_impulse(fine: Any) -> None:
    """Friction holds joint 1 until link 2 hits its stop; the impulse is as if joint 1 were free.

    From then on joint 1 slides against its friction.
    """
    chain = DenseChain(masses=np.array([2.0, 1.0]), lengths=np.array([1.0, 0.8]), gravity=0.0)
    effects = [
        fx.DryJointFriction(joint=1, coulomb=50.0),
        fx.JointStop(joint=2, range=(-inf, 0.5), restitution=0.3),
    ]
    scene = pc.Scene(links=links(chain), gravity=0.0, effects=effects)
    sol = pc.simulate(scene, q0=[0.2, 0.3], qd0=[0.0, 2.0], t_span=(0, 1), **fine)
    row = int(np.flatnonzero(np.diff(sol.t) == 0)[0])
    assert sol.qd[row, 0] == 0.0
    assert sol.q[row, 0] == 0.2
    q, before, after = sol.q[row], sol.qd[row], sol.qd[row + 1]
    exact, _ = rates_after_impact(chain.mass_matrix(q), before, -joints(2)[1:], [0.3])
    np.testing.assert_allclose(after, exact, atol=1e-12)
    assert after[0] > 0.1
    assert sol.qd[-1, 0] == 0.0  # stopped again


def test_the_drive_pays_its_share_of_an_impact_on_a_moving_pivot(fine: Any) -> None:
    """The ledger closes over bounces under a driven pivot."""
    rod = pc.Link(mass=1, length=1)
    effects = [
        fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.3, angular_frequency=5.0)),
        fx.JointStop(joint=1, range=(1.2, 1.9), restitution=0.7),
        fx.JointStop(joint=2, range=(-0.5, 0.4), restitution=0.4),
    ]
    scene = pc.Scene(links=[rod, rod], gravity=9.81, effects=effects)
    sol = pc.simulate(scene, q0=[1.5, 1.6], qd0=0, t_span=(0, 3), ledger=True, **fine)
    assert sol.success
    ledger = sol.energy().ledger
    assert ledger.impact[-1] > 0.1
    assert (np.diff(ledger.impact) >= -1e-12).all()
    assert np.abs(ledger.residual).max() < 1e-7
