"""Links without an inertia of their own are taken where something else resists their rotation.

What locks, rotors, payloads and stops leave of a chain is compared with Newton and Euler in forty
digits, with the reference's own runs, and with the links that locks make one.
"""

from __future__ import annotations

import itertools
import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.arithmetic import multiple_precision
from reference.effects import Described, law
from reference.newton_euler import Body, uniform_rod
from reference.rig import Rig
from scipy.integrate import solve_ivp

FORTY = multiple_precision(40)
EMPTY, SHORT = Body(0.0, 1.2, 0.6, 0.0), Body(0.0, 0.5, 0.0, 0.0)
POINT = Body(1.5, 0.8, 0.8, 0.0)
ROD = uniform_rod(1.1, 0.9)
AT_THE_JOINT = Body(1.3, 0.7, 0.0, 0.0)
SPINNING = Body(0.0, 0.7, 0.0, 0.2)


def lock(joint: int) -> Described:
    return Described("lock", {"joint": joint})


def rotor(joint: int) -> Described:
    return Described("rotor_inertia", {"joint": joint, "armature": 0.3})


def motor(joint: int) -> Described:
    wave = {"amplitude": 2.0, "angular_frequency": 3.0, "phase": 0.4}
    return Described("motor", {"joint": joint, "sinusoid": wave})


def damper(joint: int) -> Described:
    return Described("viscous_joint", {"joint": joint, "damping": 0.2})


PAYLOAD = Described("payload", {"mass": 0.7, "inertia": 0.02})
POINT_PAYLOAD = Described("payload", {"mass": 0.7})

# Each was refused, though its mass matrix is regular wherever it can go.
SCENES: dict[str, tuple[list[Body], list[Described]]] = {
    "massless, then a point mass that is locked": ([EMPTY, POINT], [lock(2)]),
    "the same under a motor": ([EMPTY, POINT], [lock(2), motor(1), motor(2)]),
    "a rotor and a motor on a link of no inertia": ([AT_THE_JOINT], [rotor(1), motor(1)]),
    "the same on the second link": ([ROD, AT_THE_JOINT], [rotor(2), motor(2)]),
    "a rotor alone on a massless link": ([ROD, ROD, EMPTY], [rotor(3), motor(3)]),
    "massless and locked at the end": ([ROD, EMPTY], [lock(2), motor(2), damper(1)]),
    "massless and locked to the ground": ([EMPTY], [lock(1)]),
    "massless at the base and locked": ([SHORT, POINT], [lock(1), motor(2)]),
    "massless with a payload": ([EMPTY], [POINT_PAYLOAD]),
    "a payload on a massless last link": ([ROD, EMPTY], [POINT_PAYLOAD, motor(2)]),
    "a payload that has an inertia": ([ROD, SHORT, EMPTY], [PAYLOAD, lock(3)]),
    "massless with an inertia": ([ROD, SPINNING], [damper(2)]),
    "a rotor between a massless link and a point mass": ([EMPTY, POINT], [rotor(2), damper(1)]),
    "a rotor beyond a massless link": ([SHORT, POINT, ROD], [rotor(2), motor(3)]),
    "two massless, locked to a point mass": ([EMPTY, SHORT, POINT], [lock(2), lock(3)]),
    "massless in the middle, locked": ([ROD, EMPTY, POINT, ROD], [lock(3), motor(2)]),
    "two struts": ([ROD, EMPTY, POINT, SHORT, ROD], [lock(3), damper(4)]),
    "six links": (
        [EMPTY, ROD, EMPTY, SHORT, POINT, EMPTY],
        [lock(4), lock(5), lock(6), motor(3)],
    ),
}
Q = [0.3, 1.1, -0.4, 2.0, 0.9, -1.2]
RATES = [0.7, -1.3, 2.1, 0.4, -0.8, 1.7]


def case(name: str) -> tuple[pc.Scene, Rig, list[float], list[float]]:
    """Return a scene, the reference, and a start at which locked joints are at rest."""
    bodies, described = SCENES[name]
    locked = [one.parameters["joint"] - 1 for one in described if one.kind == "lock"]
    rates: list[float] = []
    for i in range(len(bodies)):
        before = rates[i - 1] if i else 0.0
        rates.append(before if i in locked else RATES[i])
    rig = Rig(
        bodies=bodies, gravity=9.81, effects=[law(one) for one in described], arithmetic=FORTY
    )
    return scene_of(bodies, 9.81, described), rig, Q[: len(bodies)], rates


@pytest.mark.parametrize("name", SCENES)
def test_accelerations_reactions_and_energy_are_those_of_newton_and_euler(name: str) -> None:
    scene, rig, q, qd = case(name)
    n = len(q)
    equations = rig.equations(rig.instant(0.3, q, qd))
    unknowns = np.array(equations.solve(FORTY), dtype=float)
    now = pc.simulate(scene, q, qd, (0.3, 0.3), store="steps")
    size = 1e-12 * np.abs(unknowns).max()
    np.testing.assert_allclose(scene.accelerations(0.3, q, qd), unknowns[:n], rtol=0, atol=size)
    np.testing.assert_allclose(now.accelerations()[0], unknowns[:n], rtol=0, atol=size)
    forces = np.ravel(now.reactions()[0])
    np.testing.assert_allclose(forces, unknowns[n : 3 * n], rtol=0, atol=size)
    exact, energy = rig.energy(0.3, q, qd), now.energy()
    assert energy.kinetic[0] == pytest.approx(float(exact.kinetic), rel=1e-14)
    assert energy.potential[0] == pytest.approx(float(exact.potential), rel=1e-13)


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "auto"])
@pytest.mark.parametrize("name", SCENES)
def test_every_method_follows_the_run_of_the_reference(name: str, method: str) -> None:
    scene, rig, q, qd = case(name)
    n = len(q)
    plain = Rig(bodies=rig.bodies, gravity=rig.gravity, effects=rig.effects)

    def rates(t: float, y: NDArray[np.float64]) -> list[float]:
        return [*y[n:], *map(float, plain.motion(t, list(y[:n]), list(y[n:])).accelerations)]

    known = solve_ivp(rates, (0, 0.4), [*q, *qd], method="DOP853", rtol=1e-10, atol=1e-11)
    sol = pc.simulate(scene, q, qd, (0, 0.4), method=method, rtol=1e-9, atol=1e-11, ledger=True)
    assert sol.success, sol.message
    np.testing.assert_allclose(np.r_[sol.q[-1], sol.qd[-1]], known.y[:, -1], rtol=0, atol=1e-7)
    energy = sol.energy()
    drift = energy.kinetic + energy.potential if energy.ledger is None else energy.ledger.residual
    assert np.abs(drift - drift[0]).max() < 1e-7


@pytest.mark.parametrize("name", SCENES)
def test_members_of_an_ensemble_have_the_bits_of_the_run_alone(name: str) -> None:
    scene, _, q, qd = case(name)
    for method in ("dop853", "taylor"):
        options: dict[str, Any] = {"method": method, "store": "end"}
        sweep = np.array(q) + 0.01 * np.arange(9)[:, None]
        many = pc.simulate_ensemble(scene, q0=sweep, qd0=qd, t_span=(0, 0.5), **options)
        for k in (0, 8):
            alone = pc.simulate(scene, sweep[k], qd, (0, 0.5), **options)
            np.testing.assert_array_equal(many.final_q[k], alone.q[-1])


@pytest.mark.parametrize("name", SCENES)
def test_explain_has_a_word_for_each(name: str) -> None:
    scene, _, q, _ = case(name)
    assert str(pc.explain(scene))


def merged(angle: float) -> pc.Link:
    """The link of 1.2 m without a mass, and the point mass that is locked to it at an angle."""
    x, y = 1.2 + 0.8 * np.cos(angle), 0.8 * np.sin(angle)
    return pc.Link.point_mass(mass=1.5, length=float(np.hypot(x, y)))


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.5])
@pytest.mark.parametrize(
    "effects",
    [
        [fx.DryJointFriction(joint=1, coulomb=4.0)],
        [fx.JointStop(joint=1, range=(0.2, 2.0), restitution=0.7)],
        [fx.JointStop(joint=1, range=(0.2, 2.0)), fx.DryJointFriction(joint=1, coulomb=2.0)],
    ],
    ids=["friction", "bounces", "both"],
)
def test_friction_and_stops_see_locked_links_as_one(angle: float, effects: list[Any]) -> None:
    """The locked pair swings, sticks and bounces like one link that is bent at the joint."""
    pair = [pc.Link(mass=0.0, length=1.2), pc.Link.point_mass(mass=1.5, length=0.8)]
    bent = float(np.arctan2(0.8 * np.sin(angle), 1.2 + 0.8 * np.cos(angle)))
    moved = [e.replace(range=tuple(np.add(e.range, bent))) if hasattr(e, "range") else e for e in
             effects]
    two = pc.Scene(links=pair, gravity=9.81, effects=[*effects, fx.Lock(joint=2, angle=angle)])
    one = pc.Scene(links=[merged(angle)], gravity=9.81, effects=moved)
    options: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-12, "ledger": True}
    times = np.linspace(0, 3, 31)
    a = pc.simulate(two, [0.5, 0.5 + angle], 0.0, (0, 3), t_eval=times, **options)
    b = pc.simulate(one, [0.5 + bent], 0.0, (0, 3), t_eval=times, **options)
    assert len(a.t) > 5
    m = min(len(a.t), len(b.t))
    np.testing.assert_allclose(a.q[:m, 0] + bent, b.q[:m, 0], rtol=0, atol=1e-7)
    lost, as_one = (sol.energy().ledger for sol in (a, b))
    for account in ("impact", "dry"):
        if hasattr(as_one, account) and getattr(as_one, account) is not None:
            ours = np.asarray(getattr(lost, account))[:m]
            np.testing.assert_allclose(ours, getattr(as_one, account)[:m], rtol=0, atol=1e-6)


def test_a_lock_where_the_run_starts_is_looked_at_there() -> None:
    """Folded back on a link as long, a point mass is in the pivot: nothing resists the rotation."""
    links = [pc.Link(mass=0.0, length=0.8), pc.Link.point_mass(mass=1.5, length=0.8)]
    scene = pc.Scene(links=links, gravity=9.81, effects=[fx.Lock(joint=2)])
    assert pc.simulate(scene, [0.3, 0.9], 0.0, (0, 1)).success
    with pytest.raises(ValueError, match="link 1: inertia about its joint"):
        pc.simulate(scene, [0.3, 0.3 + np.pi], 0.0, (0, 1))
    with pytest.raises(ValueError, match="link 1: inertia about its joint"):
        scene.replace(effects=[fx.Lock(joint=2, angle=-np.pi)])


# What is refused is singular, and what is taken is not ---------------------------------------


def mass_matrix(links: list[Body], effects: list[Any], q: NDArray[np.float64]) -> Any:
    """Sum the Jacobians of all that has a mass or an inertia, for the bodies that locks leave."""
    n = len(links)
    across = np.stack([-np.sin(q), np.cos(q)])
    m = np.zeros((n, n))
    arm = np.zeros((2, n))

    def add(mass: float, at: NDArray[np.float64]) -> None:
        nonlocal m
        m = m + mass * at.T @ at

    for i, link in enumerate(links):
        center = arm.copy()
        center[:, i] += link.center * across[:, i]
        add(link.mass, center)
        m[i, i] += link.inertia
        arm[:, i] += link.length * across[:, i]
    body = np.cumsum([not any(isinstance(e, fx.Lock) and e.joint == i + 1 for e in effects)
                      for i in range(n)]) - 1
    for e in effects:
        if isinstance(e, fx.Payload):
            add(e.mass, arm)
            m[-1, -1] += e.inertia
        if isinstance(e, fx.RotorInertia):
            row = np.eye(n)[e.joint - 1] - (np.eye(n)[e.joint - 2] if e.joint > 1 else 0.0)
            m = m + e.armature * np.outer(row, row)
    count = body[-1] + 1
    together = (body[:, None] == np.arange(count)).astype(float)
    return together.T @ m @ together


def least(links: list[Body], effects: list[Any]) -> float:
    """The least eigenvalue of the mass matrix wherever joints can go, by trying out and descending.
    """
    from scipy.optimize import minimize

    n = len(links)
    locked = {e.joint: e.angle for e in effects if isinstance(e, fx.Lock)}
    ranges = {e.joint: e.range for e in effects if isinstance(e, fx.JointStop)}
    free = [j for j in range(2, n + 1) if j not in locked]

    def value(angles: Any) -> float:
        phi = np.zeros(n)
        for j, x in zip(free, angles, strict=True):
            phi[j - 1] = np.clip(x, *ranges.get(j, (-np.inf, np.inf)))
        for j, x in locked.items():
            phi[j - 1] = x
        m = mass_matrix(links, effects, np.cumsum(phi))
        return float(np.linalg.eigvalsh(m)[0]) if m.size else 1.0

    lined_up = [[0.0, np.pi, 1.3, -2.0] for _ in free]
    starts = sorted(itertools.product(*lined_up), key=value)[:6]
    best = min(map(value, starts))
    for start in starts if free else []:
        found = minimize(lambda x: np.log(max(value(x), 1e-40)), start, method="Nelder-Mead",
                         options={"maxiter": 300})
        best = min(best, value(found.x))
    return best


bodies = st.sampled_from([EMPTY, SHORT, POINT, ROD, AT_THE_JOINT, Body(0.9, 1.0, 0.4, 0.0)])


@st.composite
def drawn(draw: st.DrawFn) -> tuple[list[Body], list[Any]]:
    links = draw(st.lists(bodies, min_size=1, max_size=4))
    effects: list[Any] = []
    for joint in range(1, len(links) + 1):
        kind = draw(st.sampled_from(["", "", "lock", "rotor", "stop"]))
        if kind == "lock":
            effects.append(fx.Lock(joint=joint, angle=draw(st.sampled_from([0.0, 0.7, np.pi]))))
        if kind == "rotor":
            effects.append(fx.RotorInertia(joint=joint, armature=0.4))
        if kind == "stop" and joint > 1:
            effects.append(fx.JointStop(joint=joint, range=draw(
                st.sampled_from([(0.4, 2.5), (-0.5, 1.0), (2.0, 4.0)]))))
    if draw(st.booleans()):
        effects.append(fx.Payload(mass=0.6))
    return links, effects


@settings(max_examples=150, deadline=None)
@given(drawn())
def test_a_scene_is_refused_where_and_only_where_its_mass_matrix_is_singular(
    given_: tuple[list[Body], list[Any]],
) -> None:
    links, effects = given_
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        try:
            pc.Scene(links=[pc.Link(**one._asdict()) for one in links], effects=effects)
            is_taken = True
        except ValueError as refused:
            assert str(refused).startswith("link ")
            is_taken = False
    smallest = least(links, effects)
    assert smallest > 1e-6 if is_taken else smallest < 1e-9, (is_taken, smallest)
