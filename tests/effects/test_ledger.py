"""The ledger: work and loss of every effect, and a balance that closes."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from numpy.typing import NDArray
from pendcore import _core
from pendcore import effects as fx
from reference.effects import Described, law
from reference.newton_euler import Body, uniform_rod
from reference.random_rigs import address_of, polynomial
from reference.rig import LOSSES, Rig

Array = NDArray[np.float64]

BODIES = [Body(1.0, 0.5, 0.2, 0.02), Body(0.7, 0.6, 0.35, 0.015), uniform_rod(0.4, 0.4)]
Q, QD = [0.3, 1.1, -0.4], [1.0, -2.0, 3.0]
G = 9.81

# One or two of each: on the first joint or link, and on the last.
SMOOTH: dict[str, list[Described]] = {
    "viscous": [
        ("viscous_joint", {"joint": 1, "damping": 0.05, "damping2": 0.02, "damping3": 0.003}),
        ("viscous_joint", {"joint": 3, "damping": 0.02}),
    ],
    "drag": [
        ("rod_drag", {"link": 1, "drag_coefficient": 1.2, "diameter": 0.05}),
        (
            "rod_drag",
            {"link": 3, "drag_coefficient": 1.0, "diameter": 0.04, "wind": (4.0, -1.5)},
        ),
    ],
    "spring": [("torsional_spring", {"joint": 2, "stiffness": 1.5, "rest_angle": 0.4})],
    "motor": [
        (
            "motor",
            {"joint": 1, "sinusoid": {"amplitude": 2.0, "angular_frequency": 4.0, "phase": 0.3}},
        ),
        ("motor", {"joint": 2, "pd": {"kp": 2.0, "kd": 0.1, "reference": 0.5}, "limit": 1.2}),
        (
            "motor",
            {"joint": 3, "table": {"t": [0.0, 1.3, 2.2, 5.0], "torque": [0.2, -0.5, 0.4, 0.1]}},
        ),
    ],
    "rotor": [("rotor_inertia", {"joint": 2, "armature": 0.05})],
    "payload": [("payload", {"mass": 0.3, "inertia": 0.002})],
    "drive": [
        (
            "driven_pivot",
            {
                "x": {"amplitude": 0.1, "angular_frequency": 5.0},
                "y": {"amplitude": 0.05, "angular_frequency": 9.0, "phase": 1.0},
            },
        )
    ],
    "user": [
        ("user", {"function": polynomial(0.2, 0.1, 0.03)}),
        ("compiled_user", {"address": address_of(-0.1, 0.2, 0.01)}),
    ],
    "dry": [
        (
            "dry_joint_friction",
            {"joint": 2, "coulomb": 0.05, "static": 0.08, "stribeck_velocity": 0.5},
        )
    ],
}
ALL = [one for kind, some in SMOOTH.items() if kind != "dry" for one in some]
# Too little friction to stick: the joints reverse through it.
SLIDING: list[Described] = [
    (
        "dry_joint_friction",
        {"joint": 2, "coulomb": 0.005, "static": 0.008, "stribeck_velocity": 0.5},
    ),
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


def test_the_balance_closes_with_all_smooth_effects_on() -> None:
    sol = simulate(ALL)
    assert exchanged(sol.energy().ledger) > 10
    assert_closes(sol)


@pytest.mark.parametrize("locked", [False, True])
def test_the_balance_closes_with_every_effect_on(locked: bool) -> None:
    lock: list[Described] = [("lock", {"joint": 3})] if locked else []
    every = [*ALL, *SLIDING, *STRIKING, *lock]
    assert {kind for kind, _ in every} == set(pc.effects.kinds()) - (set() if locked else {"lock"})
    sol = simulate(every, qd=[1.0, -2.0, -2.0] if locked else QD)
    assert sol.t[-1] == 5.0
    assert sol.stats.limited_by_break > 20
    ledger = sol.energy().ledger
    assert sorted(entries(ledger)) == sorted(EVERY_ENTRY)
    assert exchanged(ledger) > 10
    assert_closes(sol)


@pytest.mark.parametrize("kind", SMOOTH)
def test_the_balance_closes_with_an_effect_alone(kind: str) -> None:
    # Dry friction slides all the time here; at_rest has the scenes that rest.
    sol = simulate(SMOOTH[kind], t_end=0.3 if kind == "dry" else 5.0)
    found = entries(sol.energy().ledger)
    assert sorted(found) == sorted(ENTRIES.get(kind, []))
    for entry in found.values():
        assert entry.shape == sol.t.shape
        assert entry[0] == 0.0
        assert np.abs(entry).max() > 1e-3
    if found:
        assert_closes(sol)
    else:
        np.testing.assert_allclose(sol.energy().ledger.residual, 0, atol=1e-8)


@pytest.mark.parametrize("kind", ["viscous", "drag", "dry"])
def test_what_is_lost_is_lost_for_good(kind: str) -> None:
    sol = simulate(SMOOTH[kind], t_end=0.3 if kind == "dry" else 5.0)
    assert np.all(np.diff(getattr(sol.energy().ledger, kind)) >= 0)


def test_every_entry_is_the_integral_of_its_power() -> None:
    """Integrate the reference's powers along the motion that was found, by Gauss and Legendre."""
    sol = simulate(ALL, t_end=2.0)
    rig = Rig(bodies=BODIES, gravity=G, effects=[law(one) for one in ALL])
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


@pytest.mark.parametrize("n", [1, 2, 3, 5])
@pytest.mark.parametrize("bare", [True, False])
def test_keeping_a_ledger_changes_no_bit_of_the_motion(n: int, bare: bool) -> None:
    bodies = [uniform_rod(1.0 + 0.1 * i, 0.5) for i in range(n)]
    described = [
        (kind, told)
        for kind, told in ALL
        if max(told.get("joint", 1), told.get("link", 1)) <= n and not bare
    ]
    scene = scene_of(bodies, G, described)
    start = np.linspace(0.2, 1.5, n), np.linspace(-1, 2, n)
    runs = [pc.simulate(scene, (0.0, 3.0), *start, ledger=ledger) for ledger in (True, False)]
    np.testing.assert_array_equal(runs[0].t, runs[1].t)
    np.testing.assert_array_equal(runs[0].y, runs[1].y)
    assert runs[0].stats.rejected == runs[1].stats.rejected
    times = np.linspace(0, 3, 50)
    np.testing.assert_array_equal(runs[0](times), runs[1](times))


def test_a_run_that_kept_no_ledger_has_none() -> None:
    assert simulate(ALL, t_end=0.1, ledger=False).energy().ledger is None


def test_a_bare_scene_has_a_residual_alone() -> None:
    ledger = simulate([]).energy().ledger
    assert entries(ledger) == {}
    assert np.abs(ledger.residual).max() < 1e-8


# Exact answers: one rod without gravity ---------------------------------------------------------

ROD = uniform_rod(1.7, 0.6)
J = 1.7 * 0.6**2 / 3


def turning(kind: str, w0: float = 3.0, t_end: float = 2.0, **told: Any) -> pc.Solution:
    scene = scene_of([ROD], 0.0, [(kind, told)])
    return pc.simulate(
        scene, q0=0.2, qd0=w0, t_span=(0.0, t_end), rtol=1e-12, atol=1e-14, ledger=True
    )


def test_damping_takes_the_kinetic_energy() -> None:
    sol = turning("viscous_joint", joint=1, damping=0.3)
    lost = J * 3.0**2 / 2 * -np.expm1(-2 * 0.3 * sol.t / J)
    np.testing.assert_allclose(sol.energy().ledger.viscous, lost, atol=1e-11)


def test_friction_takes_its_torque_times_the_angle() -> None:
    sol = turning("dry_joint_friction", joint=1, coulomb=0.4, t_end=5.0)
    ledger = sol.energy().ledger
    np.testing.assert_allclose(ledger.dry, 0.4 * (sol.q[:, 0] - 0.2), atol=1e-12)
    assert sol.status == "at_rest"
    assert ledger.dry[-1] == pytest.approx(J * 3.0**2 / 2, rel=1e-12)


def test_drag_takes_the_kinetic_energy() -> None:
    sol = turning("rod_drag", link=1, drag_coefficient=1.2, diameter=0.5, w0=20.0)
    decay = 1.225 * 1.2 * 0.5 / 2 * 0.6**4 / (4 * J)
    lost = J / 2 * (20.0**2 - (20.0 / (1 + decay * 20.0 * sol.t)) ** 2)
    np.testing.assert_allclose(sol.energy().ledger.drag, lost, rtol=1e-9, atol=1e-10)


def test_a_motor_gives_its_torque_times_the_angle() -> None:
    sol = turning("motor", joint=1, constant=0.8, w0=-1.0)
    np.testing.assert_allclose(sol.energy().ledger.motor, 0.8 * (sol.q[:, 0] - 0.2), atol=1e-12)


@pytest.mark.parametrize("kind", ["user", "compiled_user"])
def test_a_users_force_gives_its_torque_times_the_angle(kind: str) -> None:
    spring = {"function": polynomial(0, 0, 0.5)}
    told = spring if kind == "user" else {"address": address_of(0, 0, 0.5)}
    sol = turning(kind, **told)  # a damping: -0.5 qd
    given = -J * 3.0**2 / 2 * -np.expm1(-2 * 0.5 * sol.t / J)
    np.testing.assert_allclose(sol.energy().ledger.user, given, atol=1e-11)


def test_a_drive_along_the_rod_gives_the_rod_its_speed() -> None:
    drive = {"amplitude": 0.2, "angular_frequency": 7.0, "phase": 0.3}
    scene = scene_of([ROD], 0.0, [("driven_pivot", {"x": drive})])
    # The rod does not turn, so that nothing but max_step keeps the steps short.
    told = {"rtol": 1e-12, "atol": 1e-14, "max_step": 0.005, "ledger": True}
    sol = pc.simulate(scene, q0=0.0, t_span=(0.0, 3.0), **told)
    kinetic = 1.7 / 2 * (1.4 * np.cos(7 * sol.t + 0.3)) ** 2
    np.testing.assert_allclose(sol.energy().ledger.drive, kinetic - kinetic[0], atol=1e-10)


def test_wind_blows_a_rod_up_to_speed() -> None:
    """The ledger keeps wind and drag apart: the drag's loss is never negative."""
    sol = turning("rod_drag", link=1, drag_coefficient=1.2, diameter=0.5, wind=(0.0, 9.0), w0=0.0)
    ledger = sol.energy().ledger
    assert ledger.wind[-1] > ledger.drag[-1] > 0
    np.testing.assert_allclose(
        ledger.wind - ledger.drag, sol.energy().kinetic, atol=1e-10 * ledger.wind[-1]
    )


# With the rest of a run -------------------------------------------------------------------------


def assert_same_ledger(one: pc.Solution, other: pc.Solution) -> None:
    first, second = one.energy().ledger, other.energy().ledger
    for name in [*entries(first), "residual"]:
        np.testing.assert_array_equal(getattr(first, name), getattr(second, name))


@pytest.mark.parametrize("store", ["dense", "steps", "end"])
def test_a_resumed_run_books_on_as_if_it_had_never_stopped(store: str) -> None:
    whole = simulate(ALL, t_end=3.0, rtol=1e-9, store=store)
    halves = simulate(ALL, t_end=1.0, rtol=1e-9, store=store).resume(3.0)
    np.testing.assert_array_equal(whole.y, halves.y)
    assert_same_ledger(whole, halves)


def test_the_ledger_at_given_times_is_that_of_the_steps_there() -> None:
    steps = simulate(ALL, t_end=3.0, rtol=1e-9, store="steps")
    chosen = steps.t[5::7]
    given = simulate(ALL, t_end=3.0, rtol=1e-9, t_eval=chosen)
    found, expected = given.energy().ledger, steps.energy().ledger
    for name, entry in entries(expected).items():
        np.testing.assert_allclose(getattr(found, name), entry[5::7], rtol=1e-12, atol=1e-13)


def test_the_ledger_between_the_steps_closes_as_the_dense_output_allows() -> None:
    sol = simulate(ALL, t_end=3.0, t_eval=np.linspace(0, 3, 400))
    assert_closes(sol, 1e-7)


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
