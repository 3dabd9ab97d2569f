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
from described_scenes import rig_of, scene_of
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.arithmetic import multiple_precision
from reference.dormand_prince import integrate
from reference.effects import Described
from reference.newton_euler import Body, uniform_rod
from reference.rig import Rig

FORTY = multiple_precision(40)
EMPTY, SHORT = Body(0.0, 1.2, 0.6, 0.0), Body(0.0, 0.5, 0.0, 0.0)
POINT = Body(1.5, 0.8, 0.8, 0.0)
ROD = uniform_rod(1.1, 0.9)
AT_THE_JOINT = Body(1.3, 0.7, 0.0, 0.0)
SPINNING = Body(0.0, 0.7, 0.0, 0.2)


def on(kind: str, joint: int, **told: Any) -> Described:
    return kind, {"joint": joint, **told}


LOCK_1, LOCK_2, LOCK_3, LOCK_4, LOCK_5, LOCK_6 = (on("lock", joint) for joint in range(1, 7))
ROTOR_1, ROTOR_2, ROTOR_3 = (on("rotor_inertia", joint, armature=0.3) for joint in (1, 2, 3))
WAVE = {"amplitude": 2.0, "angular_frequency": 3.0, "phase": 0.4}
MOTOR_1, MOTOR_2, MOTOR_3 = (on("motor", joint, sinusoid=WAVE) for joint in (1, 2, 3))
DAMPER_1, DAMPER_2, DAMPER_4 = (on("viscous_joint", joint, damping=0.2) for joint in (1, 2, 4))
PAYLOAD = ("payload", {"mass": 0.7, "inertia": 0.02})
POINT_PAYLOAD = ("payload", {"mass": 0.7})

# The mass matrix of each is regular wherever it can go.
SCENES: dict[str, tuple[list[Body], list[Described]]] = {
    "massless, then a point mass that is locked": ([EMPTY, POINT], [LOCK_2]),
    "the same under a motor": ([EMPTY, POINT], [LOCK_2, MOTOR_1, MOTOR_2]),
    "a rotor and a motor on a link of no inertia": ([AT_THE_JOINT], [ROTOR_1, MOTOR_1]),
    "the same on the second link": ([ROD, AT_THE_JOINT], [ROTOR_2, MOTOR_2]),
    "a rotor alone on a massless link": ([ROD, ROD, EMPTY], [ROTOR_3, MOTOR_3]),
    "massless and locked at the end": ([ROD, EMPTY], [LOCK_2, MOTOR_2, DAMPER_1]),
    "massless and locked to the ground": ([EMPTY], [LOCK_1]),
    "massless at the base and locked": ([SHORT, POINT], [LOCK_1, MOTOR_2]),
    "massless with a payload": ([EMPTY], [POINT_PAYLOAD]),
    "a payload on a massless last link": ([ROD, EMPTY], [POINT_PAYLOAD, MOTOR_2]),
    "a payload that has an inertia": ([ROD, SHORT, EMPTY], [PAYLOAD, LOCK_3]),
    "massless with an inertia": ([ROD, SPINNING], [DAMPER_2]),
    "a rotor between a massless link and a point mass": ([EMPTY, POINT], [ROTOR_2, DAMPER_1]),
    "a rotor beyond a massless link": ([SHORT, POINT, ROD], [ROTOR_2, MOTOR_3]),
    "two massless, locked to a point mass": ([EMPTY, SHORT, POINT], [LOCK_2, LOCK_3]),
    "massless in the middle, locked": ([ROD, EMPTY, POINT, ROD], [LOCK_3, MOTOR_2]),
    "two struts": ([ROD, EMPTY, POINT, SHORT, ROD], [LOCK_3, DAMPER_4]),
    "six links": ([EMPTY, ROD, EMPTY, SHORT, POINT, EMPTY], [LOCK_4, LOCK_5, LOCK_6, MOTOR_3]),
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
    scene = scene_of(bodies, 9.81, described)
    return scene, rig_of(scene, FORTY), Q[: len(bodies)], rates


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
    np.testing.assert_allclose(np.ravel(now.reactions()[0]), unknowns[n : 3 * n], rtol=0, atol=size)
    exact, energy = rig.energy(0.3, q, qd), now.energy()
    assert energy.kinetic[0] == pytest.approx(float(exact.kinetic), rel=1e-14)
    assert energy.potential[0] == pytest.approx(float(exact.potential), rel=1e-13)
    assert str(scene.explain(0.0, q))


@functools.cache
def end_of_the_reference(name: str) -> NDArray[np.float64]:
    """Return the state after 0.2 s by the reference's dopri5 and Newton and Euler."""
    scene, _, q, qd = case(name)
    plain = rig_of(scene)

    def rates(t: float, y: NDArray[np.float64]) -> NDArray[np.float64]:
        q, qd = np.split(y, 2)
        return np.r_[qd, plain.motion(t, q.tolist(), qd.tolist()).accelerations]

    return integrate(rates, np.r_[q, qd], (0.0, 0.2), rtol=1e-11, atol=1e-12).y[-1]


@pytest.mark.few_cases
@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor", "radau5", "auto"])
@pytest.mark.parametrize("name", SCENES)
def test_every_method_follows_the_run_of_the_reference(name: str, method: str) -> None:
    scene, _, q, qd = case(name)
    how: dict[str, Any] = {"method": method, "rtol": 1e-9, "atol": 1e-11, "ledger": True}
    sol = pc.simulate(scene, (0, 0.2), q, qd, **how)
    assert sol.success, sol.message
    np.testing.assert_allclose(sol.y[:, -1], end_of_the_reference(name), rtol=0, atol=1e-7)
    assert np.abs(sol.energy().ledger.residual).max() < 1e-7


@pytest.mark.parametrize("name", SCENES)
def test_members_of_an_ensemble_have_the_bits_of_the_run_alone(name: str) -> None:
    scene, _, q, qd = case(name)
    sweep = np.array(q) + 0.01 * np.arange(9)[:, None]
    for method in ("dop853", "taylor"):
        run: dict[str, Any] = {"qd0": qd, "t_span": (0, 0.5), "method": method}
        many = pc.ensemble(scene, q0=sweep, **run)
        for k in (0, 8):
            alone = pc.simulate(scene, q0=sweep[k], store="end", **run)
            np.testing.assert_array_equal(many.q[k], alone.q[-1])


@pytest.mark.parametrize("angle", [0.0, 1.0, -2.5])
@pytest.mark.parametrize(
    ("friction", "restitution"),
    [(4.0, None), (0.0, 0.7), (2.0, 0.0)],
    ids=["friction", "bounces", "both"],
)
def test_friction_and_stops_see_locked_links_as_one(angle, friction, restitution) -> None:
    """The locked pair swings, sticks and bounces like one link that is bent at the joint."""

    def effects(bent: float) -> list[Any]:
        rubs = [fx.DryJointFriction(joint=1, coulomb=friction)] if friction else []
        if restitution is None:
            return rubs
        return [fx.JointStop(joint=1, range=(0.2 + bent, 2 + bent), restitution=restitution), *rubs]

    x, y = 1.2 + 0.8 * np.cos(angle), 0.8 * np.sin(angle)
    bent = float(np.arctan2(y, x))
    pair = [pc.Link(mass=0.0, length=1.2), pc.Link.point_mass(mass=1.5, length=0.8)]
    merged = pc.Link.point_mass(mass=1.5, length=float(np.hypot(x, y)))
    two = pc.Scene(links=pair, gravity=9.81, effects=[*effects(0.0), fx.Lock(2, angle)])
    one = pc.Scene(links=[merged], gravity=9.81, effects=effects(bent))
    how: dict[str, Any] = {"rtol": 1e-11, "atol": 1e-12, "ledger": True}
    how["t_eval"] = np.linspace(0, 3, 31)
    a = pc.simulate(two, (0, 3), [0.5, 0.5 + angle], **how)
    b = pc.simulate(one, (0, 3), [0.5 + bent], **how)
    m = min(len(a.t), len(b.t))
    assert m > 5
    np.testing.assert_allclose(a.q[:m, 0] + bent, b.q[:m, 0], rtol=0, atol=1e-7)
    lost, as_one = (sol.energy().ledger for sol in (a, b))
    assert set(lost) == set(as_one)
    for account in {"impact", "dry"} & set(as_one):
        np.testing.assert_allclose(lost[account][:m], as_one[account][:m], rtol=0, atol=1e-6)


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
