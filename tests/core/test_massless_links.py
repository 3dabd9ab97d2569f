"""Links without an inertia of their own are taken where something else resists their rotation.

What locks, rotors, payloads and stops leave of a chain is compared with Newton and Euler in forty
digits, with the reference's own runs, and with the links that locks make one.
"""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.arithmetic import multiple_precision
from reference.effects import Described, law
from reference.newton_euler import Body, uniform_rod
from reference.rig import Rig

FORTY = multiple_precision(40)
EMPTY, SHORT = Body(0.0, 1.2, 0.6, 0.0), Body(0.0, 0.5, 0.0, 0.0)
POINT = Body(1.5, 0.8, 0.8, 0.0)
ROD = uniform_rod(1.1, 0.9)
AT_THE_JOINT = Body(1.3, 0.7, 0.0, 0.0)
SPINNING = Body(0.0, 0.7, 0.0, 0.2)


def lock(joint: int) -> Described:
    return ("lock", {"joint": joint})


def rotor(joint: int) -> Described:
    return ("rotor_inertia", {"joint": joint, "armature": 0.3})


def motor(joint: int) -> Described:
    wave = {"amplitude": 2.0, "angular_frequency": 3.0, "phase": 0.4}
    return ("motor", {"joint": joint, "sinusoid": wave})


def damper(joint: int) -> Described:
    return ("viscous_joint", {"joint": joint, "damping": 0.2})


PAYLOAD = ("payload", {"mass": 0.7, "inertia": 0.02})
POINT_PAYLOAD = ("payload", {"mass": 0.7})

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
    locked = [told["joint"] - 1 for kind, told in described if kind == "lock"]
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
    now = pc.simulate(scene, q0=q, qd0=qd, t_span=(0.3, 0.3), store="steps")
    size = 1e-12 * np.abs(unknowns).max()
    np.testing.assert_allclose(scene.accelerations(0.3, q, qd), unknowns[:n], rtol=0, atol=size)
    np.testing.assert_allclose(now.accelerations()[0], unknowns[:n], rtol=0, atol=size)
    forces = np.ravel(now.reactions()[0])
    np.testing.assert_allclose(forces, unknowns[n : 3 * n], rtol=0, atol=size)
    exact, energy = rig.energy(0.3, q, qd), now.energy()
    assert energy.kinetic[0] == pytest.approx(float(exact.kinetic), rel=1e-14)
    assert energy.potential[0] == pytest.approx(float(exact.potential), rel=1e-13)


@functools.cache
def end_of_the_reference(name: str) -> NDArray[np.float64]:
    """Return the state after 0.2 s by the classical Runge-Kutta method and Newton and Euler."""
    _, rig, q, qd = case(name)
    n = len(q)
    plain = Rig(bodies=rig.bodies, gravity=rig.gravity, effects=rig.effects)

    def slope(t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.r_[y[n:], plain.motion(t, list(y[:n]), list(y[n:])).accelerations]

    y, h = np.r_[q, qd], 0.0005
    for t in h * np.arange(400):
        a = slope(t, y)
        b = slope(t + h / 2, y + h / 2 * a)
        c = slope(t + h / 2, y + h / 2 * b)
        y = y + h / 6 * (a + 2 * b + 2 * c + slope(t + h, y + h * c))
    return y


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "auto"])
@pytest.mark.parametrize("name", SCENES)
def test_every_method_follows_the_run_of_the_reference(name: str, method: str) -> None:
    scene, _, q, qd = case(name)
    y = end_of_the_reference(name)
    sol = pc.simulate(
        scene, q0=q, qd0=qd, t_span=(0, 0.2), method=method, rtol=1e-9, atol=1e-11, ledger=True
    )
    assert sol.success, sol.message
    np.testing.assert_allclose(np.r_[sol.q[-1], sol.qd[-1]], y, rtol=0, atol=1e-7)
    energy = sol.energy()
    drift = energy.kinetic + energy.potential if energy.ledger is None else energy.ledger.residual
    assert np.abs(drift - drift[0]).max() < 1e-7


@pytest.mark.parametrize("name", SCENES)
def test_members_of_an_ensemble_have_the_bits_of_the_run_alone(name: str) -> None:
    scene, _, q, qd = case(name)
    for method in ("dop853", "taylor"):
        options: dict[str, Any] = {"method": method, "store": "end"}
        sweep = np.array(q) + 0.01 * np.arange(9)[:, None]
        many = pc.ensemble(scene, q0=sweep, qd0=qd, t_span=(0, 0.5), method=method)
        for k in (0, 8):
            alone = pc.simulate(scene, q0=sweep[k], qd0=qd, t_span=(0, 0.5), **options)
            np.testing.assert_array_equal(many.q[k], alone.q[-1])


@pytest.mark.parametrize("name", SCENES)
def test_explain_has_a_word_for_each(name: str) -> None:
    scene, _, q, _ = case(name)
    assert str(scene.explain(0.0, q))


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
    moved = [
        e.replace(range=tuple(np.add(e.range, bent))) if hasattr(e, "range") else e for e in effects
    ]
    two = pc.Scene(links=pair, gravity=9.81, effects=[*effects, fx.Lock(joint=2, angle=angle)])
    one = pc.Scene(links=[merged(angle)], gravity=9.81, effects=moved)
    options: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-12, "ledger": True}
    times = np.linspace(0, 3, 31)
    a = pc.simulate(two, q0=[0.5, 0.5 + angle], t_span=(0, 3), t_eval=times, **options)
    b = pc.simulate(one, q0=[0.5 + bent], t_span=(0, 3), t_eval=times, **options)
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
    assert pc.simulate(scene, q0=[0.3, 0.9], t_span=(0, 1)).success
    with pytest.raises(ValueError, match="link 1: inertia about its joint"):
        pc.simulate(scene, q0=[0.3, 0.3 + np.pi], t_span=(0, 1))
    with pytest.raises(ValueError, match="link 1: inertia about its joint"):
        scene.replace(effects=[fx.Lock(joint=2, angle=-np.pi)])


def test_a_lock_that_makes_a_link_as_long_as_the_next_only_if_straight_is_taken_bent() -> None:
    """Straight, the pair is as long as the next link, which its rotor can fold back on it."""
    links = [pc.Link(mass=0.0, length=1.0)] * 2 + [pc.Link.point_mass(mass=1.0, length=2.0)]
    effects = [fx.Lock(joint=2), fx.RotorInertia(joint=3, armature=0.3)]
    scene = pc.Scene(links=links, effects=effects)
    bent, straight = [0.3, 1.3, 0.5], [0.3, 0.3, 0.5]
    assert pc.simulate(scene, q0=bent, t_span=(0, 1)).success
    message = "q0: with joints locked as it says: link 1: has neither mass nor inertia"
    with pytest.raises(ValueError, match=message):
        pc.simulate(scene, q0=straight, t_span=(0, 1))
    many = pc.ensemble(scene, q0=[bent, straight], t_span=(0, 1), on_failure="ignore")
    assert list(many.status) == ["finished", "refused"]
    assert many.message((1,)).startswith(message)
