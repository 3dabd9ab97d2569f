"""Impacts on chains, several at once and in turn, against the law in NumPy and in many digits.

The contacts that act are found by trying (dense_chain.py, struck_chain.py). In a corner, impacts
alternate ever faster between two stops; the gaps shrink faster than the rates, and are below the
last bits of the angles when much of the speed may be left. What becomes of it depends on the
further impacts, all at what is one time for a double (corner_impacts.py).
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from corner_impacts import corner_cases
from corner_impacts import drawn as drawn_corner
from dense_chain import DenseChain, joints, rates_after_impact
from pendcore import effects as fx
from struck_chain import TouchedStops
from unit_rods import links

inf = np.inf
FINE = {"rtol": 1e-13, "atol": 1e-15}
CASES = {f"scene {case.seed}": case for case in corner_cases()}


@pytest.fixture
def fine(fine):
    return fine | {"max_steps": 20_000}  # so that none goes on for ever


def drawn_chain(n, *seed):
    random = np.random.default_rng([n, *seed])
    masses, lengths = random.uniform(0.3, 3, n), random.uniform(0.3, 1.5, n)
    return DenseChain(masses=masses, lengths=lengths, gravity=9.81), random


def kinetic(m, qd):
    return float(qd @ m @ qd / 2)


@pytest.mark.few_cases
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_an_impact_turns_the_joint_and_jerks_the_others_as_the_law_says(n, e, fine):
    """v+ = v- + M^-1 J^T Lam, and (1 - e^2) (J v-)^2 / (2 J M^-1 J^T) is lost, for each on the way.

    A joint's rate is turned to -e of itself; the tips of all others are jerked along.
    """
    impacts = 0
    for seed in range(6):
        chain, random = drawn_chain(n, seed)
        joint = int(random.integers(n)) + 1
        stop = fx.JointStop(joint=joint, range=(-0.3, 0.4), restitution=e, capture_speed=1e-3)
        scene = pc.Scene(links=links(chain), gravity=chain.gravity, effects=[stop])
        phi, phid = random.uniform(-1, 1, n), random.uniform(-2, 2, n)
        phi[joint - 1], phid[joint - 1] = 0.1, 3.0
        sol = pc.simulate(scene, (0, 0.6), np.cumsum(phi), np.cumsum(phid), ledger=True, **fine)
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


# At once ----------------------------------------------------------------------------------------


def touched(n, seed, *, capturing):
    """Joints at their lower or upper stops or at none, and rates into and out of these."""
    chain, random = drawn_chain(n, seed, 15)
    e = np.clip(random.uniform(-0.3, 1.3, n), 0, 1)
    stops = TouchedStops(
        chain=chain,
        q=np.cumsum(random.uniform(-2, 2, n)),
        sides=np.append(random.choice([-1, 1]), random.choice([-1, -1, 1, 1, 0], n - 1)),
        restitution=e if capturing else random.choice([0.0, 0.4, 0.8, 1.0], n),
        capture_speed=10.0 ** random.uniform(-3, 1.5, n) if capturing else np.full(n, 1e-12),
    )
    return stops, np.cumsum(random.uniform(-4, 4, n))


def scene_of(stops):
    phi = stops.q - np.append(0.0, stops.q[:-1])  # as the core will see them, to the last bit
    found = [
        fx.JointStop(
            joint=j + 1, range=(-inf, phi[j]) if side > 0 else (phi[j], inf),
            restitution=float(stops.restitution[j]), capture_speed=float(stops.capture_speed[j]),
        )
        for j, side in enumerate(stops.sides) if side != 0
    ]  # fmt: skip
    return pc.Scene(links=links(stops.chain), gravity=stops.chain.gravity, effects=found)


def test_a_run_that_keeps_the_time_of_an_impact_has_the_state_after_it(fine):
    stop = fx.JointStop(joint=2, range=(-0.3, 0.4), restitution=0.5)
    case = {"scene": pc.Scene.textbook().replace(effects=[stop]), "q0": 0.1, "t_span": (0, 3)}
    whole = pc.simulate(**case, **fine)
    impacts = np.flatnonzero(np.diff(whole.t) == 0)
    assert len(impacts) > 3
    kept = pc.simulate(**case, **fine, t_eval=whole.t[impacts])
    np.testing.assert_array_equal(kept.qd, whole.qd[impacts + 1])


@pytest.mark.few_cases
@pytest.mark.every_value("struck")
@pytest.mark.parametrize("struck", [(n, capturing) for n in (1, 2, 3, 4) for capturing in (0, 1)])
def test_stops_hit_at_once_share_the_impulse_by_complementarity(struck, method):
    """Those that must, act; a captured joint is stopped after the others have bounced."""
    (n, capturing), captures, patterns = struck, 0, set()
    for seed in range(200):
        stops, qd = touched(n, seed, capturing=capturing)
        exact, captured = stops.after_impact(qd)
        how = {"method": method, "ledger": True, "max_steps": 20_000}
        sol = pc.simulate(scene_of(stops), (0, 1e-6), stops.q, qd, **how)
        assert sol.success, (seed, sol.message)
        after, size = sol(0.0)[n:], np.abs(qd).max()
        np.testing.assert_allclose(after, exact, atol=1e-10 * size, err_msg=f"seed {seed}")
        phid = joints(n) @ after
        assert (phid[sorted(captured)] == 0).all(), seed
        rounding = 1e-13 * size * (not capturing)
        assert (stops.sides * phid <= rounding).all(), seed
        m = stops.chain.mass_matrix(stops.q)
        before, lost = kinetic(m, qd), kinetic(m, qd) - kinetic(m, exact)
        assert lost >= -1e-13 * before
        impact = sol.energy().ledger.impact
        assert impact[0] == 0.0
        assert np.diff(impact).min() >= 0.0
        assert impact[-1] == pytest.approx(lost, abs=1e-11 * before)
        captures += len(captured) > 0
        patterns.add(tuple(stops.sides * phid < 0))
    assert captures > 10 or n == 1 or not capturing
    assert len(patterns) > n


TWO = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=0.0)


@pytest.mark.parametrize("apart", [0.0, 1e-9, -1e-9, 1e-13, -1e-13])
def test_two_stops_are_hit_in_their_order_however_near_or_at_the_same_time(apart, fine):
    """After 0.05 s, the second stop `apart` rad further. Gaps so small are linear in time.

    The result of each order differs from that of both at once.
    """
    free = pc.Scene(links=links(TWO), gravity=0.0)
    start = [0.3, 0.9], [1.0, 4.0]
    reached = pc.simulate(free, (0, 0.05), *start, **fine)
    q, rates = reached.q[-1], reached.qd[-1]
    phi = np.array([q[0], q[1] - q[0] + apart])
    stops = [fx.JointStop(joint=j + 1, range=(-inf, phi[j]), restitution=0.5) for j in range(2)]
    sol = pc.simulate(free.replace(effects=stops), (0, 0.05 + 1e-8), *start, **fine)
    assert sol.success
    assert (sol.relative_angles() <= phi + 1e-15).all()
    if abs(apart) != 1e-13:
        assert ("rounding has decided" in sol.message) == (apart == 0.0)
    rows = np.flatnonzero(np.diff(sol.t) == 0)
    m = TWO.mass_matrix(q)
    if apart == 0.0:
        exact, impulses = rates_after_impact(m, rates, -joints(2), [0.5, 0.5])
        assert (impulses > 0).all()
        assert sol.t[rows] == pytest.approx([0.05], abs=1e-15)
        np.testing.assert_allclose(sol.qd[rows[0] + 1], exact, atol=1e-10)
        return
    gaps, hits = np.array([0.0, apart]) - min(apart, 0.0), 0
    while ((closing := joints(2) @ rates) > 0).any():
        times = [gap / w if w > 0 else inf for gap, w in zip(gaps, closing, strict=True)]
        hit = int(np.argmin(times))
        gaps = gaps - times[hit] * closing
        gaps[hit] = 0.0
        rates, _ = rates_after_impact(m, rates, -joints(2)[[hit]], [0.5])
        hits += 1
    assert len(rows) == hits > 3
    np.testing.assert_allclose(sol.qd[-1], rates, atol=1e-7)  # some 1e-8 s later


def test_plastic_stops_that_are_struck_at_once_stop_both_joints_and_the_run_says_so(fine):
    """A little earlier at either stop, and a joint is thrown off after its impact."""
    free = pc.Scene(links=links(TWO), gravity=0.0)
    start = [0.3, 2.2], [1.0, -3.0]
    at_stops = pc.simulate(free, (0, 0.05), *start, **fine)
    q, by_impulse = at_stops.q[-1], np.linalg.inv(free.mass_matrix(at_stops.q[-1]))

    def after_stopping(*joints):
        qd = at_stops.qd[-1]
        for joint in joints:
            of_joint = np.array([[1, 0], [-1, 1]])[joint - 1]  # its rate, by those of the links
            change = by_impulse @ of_joint
            qd = qd - change * (of_joint @ qd) / (of_joint @ change)
        return qd

    ends = []
    for apart in (0.0, 1e-9, -1e-9):
        first = fx.JointStop(joint=1, range=(-inf, q[0]))
        second = fx.JointStop(joint=2, range=(q[1] - q[0] - apart, inf))
        sol = pc.simulate(free.replace(effects=[first, second]), (0, 0.05 + 1e-8), *start, **fine)
        ends.append(sol.qd[-1])
        assert ("rounding has decided" in sol.message) == (apart == 0.0)
    np.testing.assert_array_equal(ends[0], 0.0)
    in_turn = [after_stopping(1, 2), after_stopping(2, 1)]
    np.testing.assert_allclose(ends[1:], in_turn, atol=1e-6)
    assert (np.abs(in_turn).max(axis=1) > 0.3).all()


def test_impacts_at_the_very_start_are_one_problem_and_need_no_remark():
    stops = [fx.JointStop(joint=j, range=(-1.0, end)) for j, end in ((1, 0.3), (2, 0.5))]
    scene = pc.Scene(links=links(TWO), gravity=0.0, effects=stops)
    sol = pc.simulate(scene, (0, 0.1), [0.3, 0.8], [1.0, 4.0])
    assert sol.t[1] == 0.0
    assert "rounding" not in sol.message


# In corners -------------------------------------------------------------------------------------


@pytest.mark.few_cases
@pytest.mark.parametrize("start", [0.0, 1000.0])
@pytest.mark.parametrize("scene", CASES)
def test_a_run_through_a_corner_ends_where_its_impacts_lead(scene, start, method):
    """However late the run began: where time is coarser, more of the impacts are at one time."""
    case = CASES[scene]
    assert case.disagreement <= 1e-15  # of the record, in more digits
    sol = case.simulate(start, method=method, **FINE)
    assert sol.success, sol.message
    assert case.off(sol, start) < (1e-9 if start == 0.0 else 1e-7)
    if start == 0.0 and case.seed in {33, 121, 134}:  # two stops at most in any corner
        assert "rounding" not in sol.message


def test_a_run_through_a_corner_of_three_stops_says_that_rounding_has_decided():
    """Here even fifty digits more change what follows."""
    sol = drawn_corner(229).simulate(**FINE)
    assert sol.success
    assert "stops were struck within the last bits of one time" in sol.message
    at = float(sol.message.split("at t = ")[1].split()[0])
    assert np.abs(sol.t - at).min() < 1e-12
    assert sol.resume(2.5).message.count("within the last bits of one time") == 1


# Beside friction and a drive --------------------------------------------------------------------


def test_an_impact_sets_a_stuck_joint_free_and_friction_gives_no_impulse(fine):
    """Friction holds joint 1 until link 2 hits its stop; the impulse is as if joint 1 were free.

    From then on joint 1 slides against its friction.
    """
    chain = DenseChain(masses=np.array([2.0, 1.0]), lengths=np.array([1.0, 0.8]), gravity=0.0)
    stop = fx.JointStop(joint=2, range=(-inf, 0.5), restitution=0.3)
    effects = [fx.DryJointFriction(joint=1, coulomb=50.0), stop]
    scene = pc.Scene(links=links(chain), gravity=0.0, effects=effects)
    sol = pc.simulate(scene, (0, 1), [0.2, 0.3], [0.0, 2.0], **fine)
    row = int(np.flatnonzero(np.diff(sol.t) == 0)[0])
    assert sol.qd[row, 0] == 0.0
    assert sol.q[row, 0] == 0.2
    q, before, after = sol.q[row], sol.qd[row], sol.qd[row + 1]
    exact, _ = rates_after_impact(chain.mass_matrix(q), before, -joints(2)[1:], [0.3])
    np.testing.assert_allclose(after, exact, atol=1e-12)
    assert after[0] > 0.1
    assert sol.qd[-1, 0] == 0.0  # stopped again


def test_the_drive_pays_its_share_of_an_impact_on_a_moving_pivot(fine):
    """The ledger closes over bounces under a driven pivot."""
    effects = [
        fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.3, angular_frequency=5.0)),
        fx.JointStop(joint=1, range=(1.2, 1.9), restitution=0.7),
        fx.JointStop(joint=2, range=(-0.5, 0.4), restitution=0.4),
    ]
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 2, gravity=9.81, effects=effects)
    sol = pc.simulate(scene, q0=[1.5, 1.6], qd0=0, t_span=(0, 3), ledger=True, **fine)
    assert sol.success
    ledger = sol.energy().ledger
    assert ledger.impact[-1] > 0.1
    assert (np.diff(ledger.impact) >= -1e-12).all()
    assert np.abs(ledger.residual).max() < 1e-7
