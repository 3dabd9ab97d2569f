"""The ledger: work and loss of every effect, and a balance that closes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import rig_of, scene_of
from numpy.typing import NDArray
from pendcore import _core
from pendcore import effects as fx
from reference.effects import Described
from reference.newton_euler import Body, uniform_rod
from reference.random_rigs import address_of, polynomial
from reference.rig import LOSSES

Array = NDArray[np.float64]

BODIES = [Body(1.0, 0.5, 0.2, 0.02), Body(0.7, 0.6, 0.35, 0.015), uniform_rod(0.4, 0.4)]
Q, QD = [0.3, 1.1, -0.4], [1.0, -2.0, 3.0]
G = 9.81

STRIBECK = {"stribeck_velocity": 0.5}


def wave(amplitude: float, angular_frequency: float, phase: float = 0.0) -> dict[str, float]:
    return {"amplitude": amplitude, "angular_frequency": angular_frequency, "phase": phase}


# One or two of each: on the first joint or link, and on the last.
SMOOTH: dict[str, list[Described]] = {
    "viscous": [
        ("viscous_joint", {"joint": 1, "damping": 0.05, "damping2": 0.02, "damping3": 0.003}),
        ("viscous_joint", {"joint": 3, "damping": 0.02}),
    ],
    "drag": [
        ("rod_drag", {"link": 1, "drag_coefficient": 1.2, "diameter": 0.05}),
        ("rod_drag", {"link": 3, "drag_coefficient": 1, "diameter": 0.04, "wind": (4.0, -1.5)}),
    ],
    "spring": [("torsional_spring", {"joint": 2, "stiffness": 1.5, "rest_angle": 0.4})],
    "motor": [
        ("motor", {"joint": 1, "sinusoid": wave(2.0, 4.0, 0.3)}),
        ("motor", {"joint": 2, "pd": {"kp": 2.0, "kd": 0.1, "reference": 0.5}, "limit": 1.2}),
        ("motor", {"joint": 3, "table": {"t": [0, 1.3, 2.2, 5], "torque": [0.2, -0.5, 0.4, 0.1]}}),
    ],
    "rotor": [("rotor_inertia", {"joint": 2, "armature": 0.05})],
    "payload": [("payload", {"mass": 0.3, "inertia": 0.002})],
    "drive": [("driven_pivot", {"x": wave(0.1, 5.0), "y": wave(0.05, 9.0, 1.0)})],
    "user": [
        ("user", {"function": polynomial(0.2, 0.1, 0.03)}),
        ("compiled_user", {"address": address_of(-0.1, 0.2, 0.01)}),
    ],
    "dry": [("dry_joint_friction", {"joint": 2, "coulomb": 0.05, "static": 0.08, **STRIBECK})],
}
ALL = [one for kind, some in SMOOTH.items() if kind != "dry" for one in some]
# Too little friction to stick: the joints reverse through it.
SLIDING: list[Described] = [
    ("dry_joint_friction", {"joint": 2, "coulomb": 0.005, "static": 0.008, **STRIBECK}),
    ("dry_joint_friction", {"joint": 1, "coulomb": 0.003}),
]
STRIKING: list[Described] = [("joint_stop", {"joint": 2, "range": (-1.5, 1.2), "restitution": 0.7})]
EVERY_ENTRY = set(_core.accounts())
ENTRIES = {kind: [kind] for kind in SMOOTH if kind in EVERY_ENTRY} | {"drag": ["drag", "wind"]}


def simulate(
    described: Sequence[Described], t_end: float = 5.0, qd: Sequence[float] = QD, **options: Any
) -> pc.Solution:
    scene = scene_of(BODIES, G, described)
    told = {"rtol": 1e-11, "atol": 1e-13, "ledger": True, **options}
    sol = pc.simulate(scene, q0=Q, qd0=qd, t_span=(0.0, t_end), **told)
    assert sol.success
    return sol


def entries(ledger: Any) -> dict[str, Array]:
    return {name: getattr(ledger, name) for name in EVERY_ENTRY if hasattr(ledger, name)}


def exchanged(ledger: Any) -> float:
    """Return all the energy that went in or out, each time it did."""
    return sum(float(np.abs(np.diff(entry)).sum()) for entry in entries(ledger).values())


def assert_closes(sol: pc.Solution, tolerance: float = 1e-9) -> None:
    energy = sol.energy()
    ledger = energy.ledger
    booked = sum(-x if name in LOSSES else x for name, x in entries(ledger).items())
    change = energy.total - energy.total[0]
    np.testing.assert_allclose(ledger.residual, change - booked, atol=1e-13 * exchanged(ledger))
    assert np.abs(ledger.residual).max() < tolerance * exchanged(ledger)


LOCKED: list[Described] = [*ALL, *SLIDING, *STRIKING, ("lock", {"joint": 3})]


@pytest.mark.parametrize("every", [ALL, LOCKED[:-1], LOCKED], ids=["smooth", "all", "with a lock"])
def test_the_balance_closes_with_many_effects_on(every: list[Described]) -> None:
    sol = simulate(every, qd=[1.0, -2.0, -2.0] if every is LOCKED else QD)
    ledger = sol.energy().ledger
    assert sol.t[-1] == 5.0
    assert exchanged(ledger) > 10
    assert_closes(sol)
    if every is not ALL:
        assert sol.stats.limited_by_break > 20
        assert {*entries(ledger)} == EVERY_ENTRY


def test_every_effect_is_among_them() -> None:
    assert {kind for kind, _ in LOCKED} == {*pc.effects.kinds()}


@pytest.mark.parametrize("kind", [*SMOOTH, "bare"])
def test_the_balance_closes_with_an_effect_alone(kind: str) -> None:
    # Dry friction slides all the time in this.
    sol = simulate(SMOOTH.get(kind, []), t_end=0.3 if kind == "dry" else 5.0)
    found = entries(sol.energy().ledger)
    assert sorted(found) == sorted(ENTRIES.get(kind, []))
    for name, entry in found.items():
        assert entry.shape == sol.t.shape
        assert entry[0] == 0.0
        assert np.abs(entry).max() > 1e-3
        assert name not in LOSSES or np.all(np.diff(entry) >= 0)  # it is lost for good
    if found:
        assert_closes(sol)
    else:
        np.testing.assert_allclose(sol.energy().ledger.residual, 0, atol=1e-8)


def test_every_entry_is_the_integral_of_its_power() -> None:
    """Integrate the reference's powers along the motion that was found, by Gauss and Legendre."""
    sol = simulate(ALL, t_end=2.0)
    rig = rig_of(sol.scene)
    # Breaks of a power, in its derivative at least: the table's, and where the servo meets its
    # limit; the steps end there, so panels made of steps are smooth inside.
    places, weights = np.polynomial.legendre.leggauss(4)
    total: dict[str, float] = {}
    for a, b in pairwise(sol.t):
        for place, weight in zip(places, weights, strict=True):
            t = (a + b) / 2 + place * (b - a) / 2
            state = sol(t)
            for name, power in rig.shares(t, state[:3].tolist(), state[3:].tolist()).items():
                total[name] = total.get(name, 0.0) + weight * (b - a) / 2 * power
    ledger = sol.energy().ledger
    assert sorted(total) == sorted(entries(ledger))
    for name, energy in total.items():
        assert getattr(ledger, name)[-1] == pytest.approx(energy, rel=1e-8, abs=1e-9)


def test_the_ledger_at_given_times_is_that_of_the_steps_there_and_closes() -> None:
    """Between steps it closes as well as the dense output allows."""
    steps = simulate(ALL, t_end=3.0, rtol=1e-9, store="steps")
    chosen = steps.t[5::7]
    given = simulate(ALL, t_end=3.0, rtol=1e-9, t_eval=chosen)
    found, expected = given.energy().ledger, steps.energy().ledger
    for name, entry in entries(expected).items():
        np.testing.assert_allclose(getattr(found, name), entry[5::7], rtol=1e-12, atol=1e-13)
    assert_closes(simulate(ALL, t_end=3.0, t_eval=np.linspace(0, 3, 400)), 1e-7)


def test_a_backward_run_gives_back_what_the_forward_one_took() -> None:
    scene = scene_of(BODIES, G, [one for one in ALL if one[0] != "compiled_user"])
    told = {"rtol": 1e-11, "atol": 1e-13, "ledger": True, "store": "steps"}
    there = pc.simulate(scene, q0=Q, qd0=QD, t_span=(0.0, 0.5), **told)
    back = pc.simulate(scene, q0=there.q[-1], qd0=there.qd[-1], t_span=(0.5, 0.0), **told)
    forth, again = there.energy().ledger, back.energy().ledger
    for name, entry in entries(forth).items():
        assert getattr(again, name)[-1] == pytest.approx(-entry[-1], rel=1e-7, abs=1e-9)


def test_a_ledger_that_overflows_ends_the_run_and_is_named() -> None:
    """It overflows in a step (once without a word), at an impact, and at an impact at the start."""
    shaken = fx.DrivenPivot(y=fx.Sinusoid(amplitude=1e-48, angular_frequency=1e150))
    heavy, stop = pc.Link(mass=1e300, length=1.0), fx.JointStop(joint=1, range=(-1.0, 1.0))
    for link, effect, q0, qd0, account in (
        (pc.Link(mass=1.0, length=1.0), shaken, 0.0, 0.0, "drive"),
        (heavy, stop, 0.0, 1e10, "impact"),
        (heavy, stop, 1.0, 1e10, "impact"),
    ):
        scene = pc.Scene(links=[link], gravity=0.0, effects=[effect])
        sol = pc.simulate(
            scene, q0=q0, qd0=qd0, t_span=(0, 0.5), max_steps=300, ledger=True, on_failure="ignore"
        )
        assert sol.status == "non_finite"
        assert f"the ledger's {account} stopped being finite" in sol.message
        assert np.isfinite(getattr(sol.energy().ledger, account)).all()
        assert (np.diff(sol.t) > 0.0).all()
