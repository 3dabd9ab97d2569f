"""Chains with friction, stops and drives: mode by mode, and drawn ones that get to their end."""

from __future__ import annotations

import itertools
import warnings

import numpy as np
import pendcore as pc
import pytest
from dense_chain import joints
from driven_chains import FREE, DrivenChain, Motor, assert_follows_mode_by_mode, mode_by_mode
from pendcore import effects as fx

SLOW = {"h": 0.06, "t_end": 3.0}
RUNS = {
    "slow": DrivenChain(friction=(5.0, 1.5), motor=Motor(1, 10.0, 1.0), t_end=6.2),
    "fast": DrivenChain(friction=(6.0, 4.0), motor=Motor(1, 18.0, 3.0), t_end=3.0),
    "three rods": DrivenChain(friction=(9.0, 3.0, 1.0), motor=Motor(1, 22.0, 2.0), t_end=2.5),
    "stop": DrivenChain(
        stops=(FREE, (-0.1, 0.2)), friction=(0, 0), motor=Motor(1, 10.0, 2.0), t_end=4.0, h=0.06
    ),
    "two of three in contact": DrivenChain(
        stops=(FREE, (-0.2, 0.1), (-0.1, np.inf)), friction=(0, 0, 0), motor=Motor(1, 14, 2), **SLOW
    ),
    "one sticks while another is in contact": DrivenChain(
        stops=(FREE, (-0.1, 0.3), FREE), friction=(6, 0, 0), motor=Motor(1, 14.0, 2.0), **SLOW
    ),
    "a contact pushes on a joint that sticks": DrivenChain(
        stops=(FREE, (-0.1, 0.3)), friction=(6, 0), motor=Motor(2, 12.0, 2.0), **SLOW
    ),
    "friction at the stop": DrivenChain(
        stops=(FREE, (-0.1, 0.3)), friction=(5, 2), motor=Motor(1, 14.0, 2.0), t_end=4.0, h=0.06
    ),
}


@pytest.mark.few_cases
@pytest.mark.every_value("run")
@pytest.mark.parametrize("run", RUNS)
def test_sticking_sliding_and_lasting_contact_follow_the_solution_mode_by_mode(run, fine):
    """Hanging rods under a motor, plastic stops: every switch, and the states between."""
    chain = RUNS[run]
    sol = chain.simulate(**fine)
    assert_follows_mode_by_mode(sol, chain)
    phi = (joints(chain.n) @ sol.q.T).T
    least, most = chain.ranges.T
    assert (least - 1e-14 < phi).all()
    assert (most + 1e-14 > phi).all()
    switches = mode_by_mode(chain).exact.switches
    assert any(0 in mode for _, _, mode in switches)  # it is about joints that are held
    if chain.stops:
        assert any(leans_and_leaves(chain, *pair) for pair in itertools.pairwise(switches))


def leans_and_leaves(chain, switch, after):
    """Whether a joint that leans on its stop between these switches is let go by the second."""
    begin, y, mode = switch
    touches = mode_by_mode(chain).exact.gaps(y).min(axis=1) < 1e-9
    let_go = touches & (np.array(mode) == 0) & (np.array(after[2]) != 0)
    return let_go.any() and after[0] - begin > 0.1


def drawn(seed):
    """One to four rods, on which impacts accumulate in several joints at once."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 5))
    phi = random.uniform(-1, 1, n)
    found = []
    for j in range(1, n + 1):
        if random.random() < 0.6:
            coulomb = random.uniform(0, 2)
            static = coulomb * random.uniform(1, 2) if random.random() < 0.5 else None
            found.append(fx.DryJointFriction(joint=j, coulomb=coulomb, static=static))
        if random.random() < 0.6:
            below = random.uniform(0, 1) * (random.random() < 0.8)  # or it starts at the stop
            ends = (phi[j - 1] - below, phi[j - 1] + random.uniform(0.05, 1))
            e = random.choice([0, 0.3, 0.6, 0.9])
            found.append(fx.JointStop(joint=j, range=ends, restitution=e))
        if random.random() < 0.3:
            hum = fx.Sinusoid(random.uniform(0, 4), angular_frequency=random.uniform(0.5, 8))
            found.append(fx.Motor(joint=j, sinusoid=hum))
        if random.random() < 0.2:
            found.append(fx.ViscousJoint(joint=j, damping=0.1, damping2=0.1))
    if random.random() < 0.3:
        shake = fx.Sinusoid(0.1, angular_frequency=random.uniform(1, 9))
        found.append(fx.DrivenPivot(x=shake))
    rods = [pc.Link(mass=random.uniform(0.3, 3), length=random.uniform(0.3, 1.5)) for _ in range(n)]
    rates = random.choice([0, 1]) * random.uniform(-3, 3, n)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        scene = pc.Scene(links=rods, effects=found, gravity=random.choice([0, 9.81]))
    return scene, np.cumsum(phi), np.cumsum(rates)


def assert_within_its_stops(sol, seed):
    assert sol.success, (seed, sol.message)
    phi = sol.relative_angles()
    for effect in sol.scene.effects:
        if effect.kind == "joint_stop":
            low, high = effect.range
            assert phi[:, effect.joint - 1].min() >= low - 1e-12
            assert phi[:, effect.joint - 1].max() <= high + 1e-12


def assert_its_ledger_closes(sol, rtol):
    ledger = sol.energy().ledger
    size = sol.energy().kinetic.max()
    size += sum(np.abs(np.diff(entry)).sum() for entry in ledger.values())
    assert np.abs(ledger.residual).max() <= 30 * rtol * size + 1e-12
    for name in {"dry", "viscous", "impact"} & {*ledger}:  # none of these gives energy back
        assert np.diff(ledger[name]).min(initial=0.0) >= -1e-9


LATER = [pytest.param(range(k, k + 60), marks=pytest.mark.unsanitized) for k in (60, 120, 180)]


@pytest.mark.few_cases
@pytest.mark.parametrize("seeds", [range(60), *LATER], ids=str)
def test_chains_of_many_contacts_get_to_their_end_within_their_stops(seeds, method):
    how = {"method": method, "rtol": 1e-9, "atol": 1e-11, "max_steps": 50_000, "ledger": True}
    for seed in seeds:
        scene, q0, qd0 = drawn(seed)
        runs = [pc.simulate(scene, (0, 3), q0, qd0, **how)]
        # Nothing but max_step limits the error of the work where a shaken chain is held.
        drives = [effect.x for effect in scene.effects if effect.kind == "driven_pivot"]
        for drive in drives:
            fine = 2 * np.pi / drive.angular_frequency / 50
            runs.append(pc.simulate(scene, (0, 3), q0, qd0, max_step=fine, **how))
        for sol in runs:
            assert_within_its_stops(sol, seed)
            assert sol.t[-1] == 3.0
        assert_its_ledger_closes(runs[-1], how["rtol"])


@pytest.mark.few_cases
@pytest.mark.parametrize("step", [None, 0.003, 1 / 64])
@pytest.mark.parametrize("block", range(4))
def test_laws_that_meet_lead_on(method, step, block):
    """Laws of every kind that has sides, in any order.

    Whatever a coarse step says of its start, a shorter one has to confirm it.
    """
    ways = {"rtol": 1e-8} if step is None else {"step": step}
    how = {"method": method, "max_steps": 100_000, "on_failure": "ignore", **ways}
    for seed in range(10 * block, 10 * block + 10):
        scene, q0, qd0 = drawn(seed)
        random, effects = np.random.default_rng(seed), list(scene.effects)
        for j in range(1, len(scene.links) + 1):
            kp, kd, at, limit = random.uniform([0, 0, -1, 0.2], [50, 5, 1, 5])
            servo = fx.Motor(joint=j, pd=fx.PD(kp=kp, kd=kd, reference=at), limit=limit)
            second = fx.DryJointFriction(joint=j, coulomb=random.uniform(0, 2))
            effects += [law for law in (servo, second) if random.random() < 0.3]
        random.shuffle(effects)
        sol = pc.simulate(scene.replace(effects=effects), (0, 3), q0, qd0, **how)
        may_fail = method == "radau5" and step is not None  # in so long a step
        assert sol.success or (may_fail and sol.status == "not_converged"), (seed, sol.message)


@pytest.mark.few_cases
@pytest.mark.parametrize("seed", [392, 1656, 6741])
def test_chains_of_many_contacts_that_went_back_and_forth_get_to_their_end(seed, method):
    scene, q0, qd0 = drawn(seed)
    sol = pc.simulate(scene, (0, 3), q0, qd0, method=method, max_steps=50_000)
    assert_within_its_stops(sol, seed)


def resting(seed):
    """Two to four rods without gravity, most at a stop, some rubbed; every motor starts from 0."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 5))
    effects = []
    phi = random.uniform(-1, 1, n)
    for j, start in enumerate(phi, start=1):
        free = random.uniform(0.05, 1)
        ends = (start, start + free) if random.integers(2) else (start - free, start)
        if random.random() < 0.8:
            e = float(random.choice([0, 0.3, 0.9]))
            effects.append(fx.JointStop(joint=j, range=ends, restitution=e))
        if random.random() < 0.5:
            effects.append(fx.DryJointFriction(joint=j, coulomb=random.uniform(0.1, 2)))
        hum = fx.Sinusoid(random.uniform(-2, 2), angular_frequency=random.uniform(0.5, 8))
        effects.append(fx.Motor(joint=j, sinusoid=hum))
    rods = [pc.Link(mass=random.uniform(0.3, 3), length=random.uniform(0.3, 1.5)) for _ in phi]
    return pc.Scene(links=rods, effects=effects, gravity=0), np.cumsum(phi)


# 4, 815 and 2576: an impact at 1e-29 rad/s set joints in motion that friction held.
@pytest.mark.few_cases
@pytest.mark.parametrize("seeds", [range(100), range(100, 200), [392, 815, 1656, 2576]], ids=str)
def test_chains_that_rest_at_their_stops_get_going(seeds, method):
    for seed in seeds:
        scene, q0 = resting(seed)
        sol = pc.simulate(scene, (0, 1), q0, method=method, max_steps=20_000)
        assert_within_its_stops(sol, seed)


def test_a_dense_output_that_begins_with_its_own_error_is_not_taken_for_an_impact(method):
    """Both stops let go as t^3: the steps' interpolants begin as -t^2 times their error."""
    q0 = [0.7697859081537268, 1.301202961268858, 0.36560016303516885]
    hum = fx.Motor(joint=2, sinusoid=fx.Sinusoid(-1.7, angular_frequency=7.7))
    stops = [
        fx.JointStop(joint=1, range=(q0[0], 0.9)),
        fx.JointStop(joint=3, range=(q0[2] - q0[1], -0.5)),
    ]
    ends = []
    for effects in ([*stops, hum], [hum]):  # without the stops the same motion: they only let go
        scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 3, gravity=0, effects=effects)
        sol = pc.simulate(scene, (0, 0.1), q0, method=method, rtol=1e-10)
        assert sol.success, sol.message
        ends.append(sol(0.1))
    np.testing.assert_allclose(*ends, atol=1e-12)
