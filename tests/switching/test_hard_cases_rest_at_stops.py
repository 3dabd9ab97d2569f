"""Chains that start at rest on their stops, while nothing drives them yet: they get going."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from test_hard_cases_many_contacts import assert_within_its_stops, drawn


def resting(seed: int) -> tuple[pc.Scene, np.ndarray]:
    """Two to four rods without gravity, most at a stop, some rubbed; every motor starts from 0."""
    random = np.random.default_rng(seed)
    n = int(random.integers(2, 5))
    effects: list[pc.Effect] = []
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
@pytest.mark.parametrize("seeds", [range(100), range(100, 200), [392, 815, 1656, 2576]], ids=str)
def test_chains_that_rest_at_their_stops_get_going(seeds, method):
    for seed in seeds:
        scene, q0 = resting(seed)
        sol = pc.simulate(scene, q0=q0, qd0=0, t_span=(0, 1), method=method, max_steps=20_000)
        assert sol.success, (seed, sol.message)
        assert_within_its_stops(sol)


def test_a_dense_output_that_begins_with_its_own_error_is_not_taken_for_an_impact(method):
    """Both stops let go as t^3: the steps' interpolants begin as -t^2 times their error."""
    q0 = [0.7697859081537268, 1.301202961268858, 0.36560016303516885]
    hum = fx.Motor(joint=2, sinusoid=fx.Sinusoid(-1.7, angular_frequency=7.7))
    stops = [
        fx.JointStop(joint=1, range=(q0[0], 0.9)),
        fx.JointStop(joint=3, range=(q0[2] - q0[1], -0.5)),
    ]
    scene = pc.Scene(links=[pc.Link(mass=1, length=1)] * 3, gravity=0, effects=[*stops, hum])
    sol = pc.simulate(scene, q0=q0, qd0=0, t_span=(0, 0.1), method=method, rtol=1e-10)
    assert sol.success, sol.message
    # Without the stops the same motion: they only let go.
    free = pc.simulate(
        scene.replace(effects=[hum]), q0=q0, qd0=0, t_span=(0, 0.1), method=method, rtol=1e-10
    )
    np.testing.assert_allclose(sol(0.1), free(0.1), atol=1e-12)


@pytest.mark.parametrize("seed", [392, 1656, 6741])
def test_chains_of_many_contacts_that_went_back_and_forth_get_to_their_end(seed, method):
    scene, q0, qd0 = drawn(seed)
    sol = pc.simulate(scene, q0=q0, qd0=qd0, t_span=(0, 3), method=method, max_steps=50_000)
    assert sol.success, sol.message
    assert_within_its_stops(sol)
