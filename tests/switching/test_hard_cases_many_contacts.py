"""Chains with friction, stops and drives in any joint: runs get to their end, within the stops."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx


def drawn(seed: int) -> tuple[pc.Scene, Any, Any]:
    """One to four rods, on which impacts accumulate in several joints at once."""
    random = np.random.default_rng(seed)
    n = int(random.integers(1, 5))
    phi = random.uniform(-1, 1, n)
    found: list[Any] = []
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


def assert_within_its_stops(sol: pc.Solution) -> None:
    phi = sol.relative_angles()
    for effect in sol.scene.effects:
        if effect.kind == "joint_stop":
            low, high = effect.range
            assert phi[:, effect.joint - 1].min() >= low - 1e-12
            assert phi[:, effect.joint - 1].max() <= high + 1e-12


def assert_its_ledger_closes(sol: pc.Solution, rtol: float) -> None:
    ledger = sol.energy().ledger
    size = sol.energy().kinetic.max()
    size += sum(np.abs(np.diff(entry)).sum() for entry in ledger.values())
    assert np.abs(ledger.residual).max() <= 30 * rtol * size + 1e-12
    for name in {"dry", "viscous", "impact"} & {*ledger}:  # none of these gives energy back
        assert np.diff(ledger[name]).min(initial=0.0) >= -1e-9


@pytest.mark.parametrize(
    "block", [0, *(pytest.param(more, marks=pytest.mark.unsanitized) for more in (1, 2, 3))]
)
def test_chains_of_many_contacts_get_to_their_end_within_their_stops(
    block: int, method: str
) -> None:
    how: dict[str, Any] = {"method": method, "rtol": 1e-9, "atol": 1e-11, "max_steps": 50_000}
    for seed in range(60 * block, 60 * block + 60):
        scene, q0, qd0 = drawn(seed)
        runs = [pc.simulate(scene, q0=q0, qd0=qd0, t_span=(0, 3), ledger=True, **how)]
        # Nothing but max_step limits the error of the work where a shaken chain is held.
        drives = [effect.x for effect in scene.effects if effect.kind == "driven_pivot"]
        for drive in drives:
            fine = 2 * np.pi / drive.angular_frequency / 50
            runs.append(
                pc.simulate(scene, q0=q0, qd0=qd0, t_span=(0, 3), ledger=True, max_step=fine, **how)
            )
        for sol in runs:
            assert sol.status in {"finished", "at_rest"}, (seed, sol.message)
            assert sol.t[-1] == 3.0
            assert_within_its_stops(sol)
        assert_its_ledger_closes(runs[-1], how["rtol"])
