"""Several laws that change at one time, and steps too coarse to tell which comes first."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from unit_rods import rod, solve


@pytest.mark.parametrize("ways", [{"rtol": 1e-11}, {"step": 0.003}, {"step": 1 / 64}])
@pytest.mark.parametrize("order", [1, -1])
def test_friction_stops_a_rod_with_quadratic_damping(
    method: str, ways: dict[str, float], order: int
) -> None:
    """At sqrt(2) atan(sqrt(2)), from w' = -(1/2 + w^2): there both laws have two sides."""
    damping = fx.ViscousJoint(joint=1, damping=0.0, damping2=1.0)
    laws = fx.DryJointFriction(joint=1, coulomb=0.5), damping
    exact = np.sqrt(2) * np.arctan(np.sqrt(2))
    event = pc.events.RateZero(joint=1)
    sol = solve(rod(*laws[::order]), 0, 1, 3, method=method, events=[event], **ways)
    assert sol.status == "at_rest", sol.message
    [stop] = sol.events[0]
    assert stop.t == pytest.approx(exact, abs=1e-9 if "rtol" in ways else 1e-4)
    assert sol.y[1, -1] == 0.0


def test_a_joint_let_go_from_its_stop_by_a_slow_drive_sets_out_away_from_it(method: str) -> None:
    """The torque sin t - 1/2 lets it go at pi/6, with no acceleration yet to tell which way."""
    effects = (
        fx.JointStop(joint=1, range=(0.0, np.inf)),
        fx.ViscousJoint(joint=1, damping=0.0, damping2=0.1),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(1.0, angular_frequency=1.0)),
        fx.Motor(joint=1, constant=-0.5),
    )
    for order in (1, -1):
        sol = solve(rod(*effects[::order]), 0, 0, 1, method=method)
        assert sol.status == "finished", sol.message
        # Without the damping, which changes it by some b2 w^2 s^2/12: w = cos s0 - cos t - s/2
        released, s = np.pi / 6, 1 - np.pi / 6
        free = np.cos(released) - np.cos(1) - s / 2
        assert free - 0.1 * free**2 * s < sol.y[1, -1] < free


def drawn_chain(random: np.random.Generator) -> tuple[pc.Scene, np.ndarray, np.ndarray]:
    """Up to four links with laws of every kind that has sides, in any order."""
    n = int(random.integers(1, 5))
    phi = random.uniform(-1, 1, n)
    effects: list[Any] = []

    def add(chance: float, effect: Any) -> None:
        if random.random() < chance:
            effects.append(effect)

    for j in range(1, n + 1):
        low, high, limit, kp, kd, at, amplitude, omega = random.uniform(
            [0, 0.05, 0.2, 0, 0, -1, 0, 0.5], [1, 1, 5, 50, 5, 1, 4, 8]
        )
        coulomb, other = random.uniform(0, 2, 2)
        add(0.6, fx.DryJointFriction(joint=j, coulomb=coulomb, static=1.5 * coulomb,
                                     stribeck_velocity=0.1))  # fmt: skip
        add(0.3, fx.DryJointFriction(joint=j, coulomb=other))
        bounds = (phi[j - 1] - low * random.integers(2), phi[j - 1] + high)
        add(0.6, fx.JointStop(joint=j, range=bounds, restitution=random.choice([0, 0.3, 0.9])))
        add(0.3, fx.Motor(joint=j, sinusoid=fx.Sinusoid(amplitude, angular_frequency=omega)))
        add(0.3, fx.Motor(joint=j, pd=fx.PD(kp=kp, kd=kd, reference=at), limit=limit))
        add(0.3, fx.ViscousJoint(joint=j, damping=0.1, damping2=0.1))
    add(0.3, fx.DrivenPivot(x=fx.Sinusoid(0.1, angular_frequency=random.uniform(1, 9))))
    random.shuffle(effects)
    links = [pc.Link(mass=m, length=le) for m, le in random.uniform(0.3, 2, (n, 2))]
    rates = np.cumsum(random.integers(2) * random.uniform(-3, 3, n))
    return pc.Scene(links=links, effects=effects), np.cumsum(phi), rates


@pytest.mark.parametrize("step", [None, 0.003, 1 / 64])
@pytest.mark.parametrize("block", range(4))
def test_laws_that_meet_lead_on(method: str, step: float | None, block: int) -> None:
    """However coarse the step: what it says of its start, a shorter one has to bear out."""
    ways: dict[str, Any] = {"rtol": 1e-8} if step is None else {"step": step}
    for seed in range(10 * block, 10 * block + 10):
        scene, q0, qd0 = drawn_chain(np.random.default_rng(seed))
        sol = pc.simulate(scene, q0, qd0, (0, 3), method=method, max_steps=100_000, **ways)
        assert sol.success or sol.status == "not_converged", (seed, sol.message)
