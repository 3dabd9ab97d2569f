"""References of `make campaign OF=errors` are right: exact answers, other forms, more digits."""

from __future__ import annotations

from dataclasses import replace
from inspect import signature
from time import monotonic
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from described_scenes import rig_of
from reference.trajectories import trajectory as of_digits

pytest.importorskip("heyoka", reason="the references of true errors need heyoka")

from true_error.arithmetic import LONG, QUAD
from true_error.asked import Drawn, mass_matrix
from true_error.drawing import scene_of
from true_error.families import FAMILIES
from true_error.own_laws import LAWS, OwnLaw
from true_error.reference import Reference, positions_apart, trajectory
from true_error.switched import SwitchedTrajectory
from true_error.switches import Friction
from true_error.trajectory import NoReferenceError

pytestmark = pytest.mark.unsanitized
E = pc.effects
J = 1.7 * 0.6**2 / 3


def drawn(
    effects: list[Any], q0: tuple[float, ...], qd0: tuple[float, ...], t_end: float,
    gravity: float = 0.0,
) -> Drawn:  # fmt: skip
    """Return a scene of rods of inertia J about their joints."""
    scene = scene_of([pc.Link(mass=1.7, length=0.6)] * len(q0), effects, gravity)
    return Drawn(
        family="exact", seed=0, scene=scene, q0=q0, qd0=qd0, t_start=0.0, t_end=t_end,
        error=1e-9, rtol=1e-9, limit=0.1,
    )  # fmt: skip


def angle(of: Drawn, *times: float) -> Any:
    """Return the angles of the first link, and check that they are known."""
    truth = Reference(of, 20.0).angles(np.array(times))
    assert truth.unsure.max() < 1e-16
    return truth.angles[:, 0]


# Smooth scenes -------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "name", ["textbook", "unequal", "light_tip", "no_gravity", "single_rod", "three_links"]
)
def test_trajectories_of_forty_digits(name: str) -> None:
    """The trajectories were integrated from other equations, in another arithmetic."""
    case = of_digits(name)
    start = tuple(map(float, case.q0)), tuple(map(float, case.qd0))
    of = replace(drawn([], *start, float(case.t[-1])), scene=case.scene)
    truth = Reference(of, 20.0).angles(case.t)
    apart = positions_apart(of.scene, case.q, truth.angles)
    assert apart.max() < 1e-15 + 10 * truth.unsure.max()


def check_accelerations(of: Drawn) -> None:
    """Compare with the Newton-Euler equations of each link, with every law in its plainest form."""
    n = len(of.q0)
    found = trajectory(of, LONG)
    integrator = found.prepared(of.t_start + 1e-9 * found.direction).integrator
    integrator.step(write_tc=True)
    qdd = np.cumsum(integrator.tc[n:, 1]).astype(float)
    expected = np.array(rig_of(of.scene).motion(of.t_start, of.q0, of.qd0).accelerations)
    np.testing.assert_allclose(qdd, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("family", FAMILIES)
@pytest.mark.parametrize("seed", range(12))
def test_accelerations_are_those_of_another_derivation(family: str, seed: int) -> None:
    of = FAMILIES[family](seed)
    rates = np.random.default_rng(seed).uniform(-2, 2, len(of.q0))
    check_accelerations(replace(of, qd0=tuple(map(float, rates))))


PIECES = {
    **{name: E.User(OwnLaw(name, 2, (1.3, 0.4, 0.7)[: len(signature(of).parameters) - 3]))
       for name, of in LAWS.items()},
    "clipped controller": E.Motor(2, pd=E.PD(3.0, 0.5, 0.2), limit=1.1),
    "damping2": E.ViscousJoint(2, 0.1, damping2=0.6),
    "friction": E.DryJointFriction(2, 0.4, static=0.9, stribeck_velocity=0.7, exponent=1.0),
}  # fmt: skip


@pytest.mark.parametrize("kind", PIECES)
def test_each_piece_of_a_law_is_that_of_another_derivation(kind: str) -> None:
    for phi in (-2.0, -0.1, 0.3, 2.0):
        for w in (-1.5, 1.5):
            check_accelerations(drawn([PIECES[kind]], (0.5, 0.5 + phi), (0.3, 0.3 + w), 1.0, 9.8))


@pytest.mark.few_cases
@pytest.mark.parametrize("family", sorted(set(FAMILIES) - {"stiff"}))
def test_the_reference_knows_its_own_error(family: str) -> None:
    """More digits still confirm the error; the chains are short, since these digits take long."""
    few = [of for of in map(FAMILIES[family], range(30)) if len(of.q0) <= 2]
    for of in few[:2]:
        t = np.linspace(of.t_start, of.t_start + 0.2 * (of.t_end - of.t_start), 20)
        truth = Reference(of, 20.0).angles(t)
        finest = trajectory(of, QUAD)
        finest.extend(t[-1], monotonic() + 60)
        apart = positions_apart(of.scene, truth.angles, finest.angles(t))
        assert (apart <= truth.unsure + 1e-18).all()


# Rods whose motion can be said exactly ---------------------------------------------------------

Exact = tuple[Drawn, dict[float, float]]
"""A rod, and its angle at some times."""


def stopped_by_friction(rate: float = 3.0, torque: float = 0.3) -> Exact:
    end = J * rate / torque
    far, half = J * rate**2 / (2 * torque), rate * end / 2 - torque / J * end**2 / 8
    of = drawn([E.DryJointFriction(1, torque)], (0.2,), (rate,), 5.0)
    return of, {end / 2: 0.2 + half, end: 0.2 + far, 5.0: 0.2 + far}


def stopped_by_a_peak(velocity: float, exponent: float) -> Exact:
    """The peak is narrow, and a step that begins far from it does not see it."""

    def slowed(w: Any) -> Any:
        return w * J / (0.3 + 0.6 * mpmath.exp(-((w / velocity) ** exponent)))

    turned = mpmath.quad(slowed, [0, *np.geomspace(velocity, 3, 8)])
    peak = E.DryJointFriction(1, 0.3, static=0.9, stribeck_velocity=velocity, exponent=exponent)
    return drawn([peak], (0.0,), (3.0,), 5.0), {5.0: float(turned)}


def turning_back(k: float = 20.0, torque: float = 0.5) -> Exact:
    """A spring drives it back until friction holds it."""
    swings = [0.4]
    while k * abs(swings[-1]) > torque:
        swings.append(-(swings[-1] - np.sign(swings[-1]) * 2 * torque / k))
    rubs = [E.TorsionalSpring(1, k), E.DryJointFriction(1, torque)]
    turns = np.pi * np.sqrt(J / k) * np.arange(1, 5)
    known = dict(zip(turns, swings[1:5], strict=True)) | {5.0: swings[-1]}
    return drawn(rubs, (0.4,), (0.0,), 5.0), known


def bouncing(restitution: float, push: float = 2.0, capture: float = 0.05) -> Exact:
    """A motor pushes it against a stop, where it rests in the end unless the stop is elastic."""
    stop = E.JointStop(1, (-np.inf, 1.0), restitution=restitution, capture_speed=capture)
    a = push / J
    t, speed, tops = np.sqrt(2 / a), np.sqrt(2 * a), {}
    while speed * restitution and speed > capture and t + restitution * speed / a < 4.0:
        speed *= restitution
        tops[t + speed / a] = 1.0 - speed**2 / (2 * a)
        t += 2 * speed / a
    at_rest = {4.0: 1.0} if restitution < 1 else {}
    return drawn([E.Motor(1, constant=push), stop], (0.0,), (0.0,), 4.0), tops | at_rest


def following_a_table() -> Exact:
    t, torque = [0.0, 1.0, 1.5, 4.0], [0.0, 2.0, -3.0, 1.0]
    turned = mpmath.quad(lambda s: (3 - s) * np.interp(float(s), t, torque) / J, [0, 1, 1.5, 3])
    table = E.Motor(1, table=E.Table(t, torque))
    return drawn([table], (0.1,), (0.2,), 3.0), {3.0: 0.1 + 0.6 + float(turned)}


def slowed_by_a_square(damper: Any) -> Exact:
    turned = -J / 0.4 * np.log1p(0.4 * 3.0 * 5.0 / J)
    return drawn([damper], (0.0,), (-3.0,), 5.0), {5.0: turned}


def pushed_by_a_pulse() -> Exact:
    """It is short and far ahead, and no step may go past it."""
    turned = 2.0 * 0.01 * np.sqrt(np.pi) / J * 2.0
    pulse = E.User(OwnLaw("pulse", 1, (2.0, 3.0, 0.01)))
    return drawn([pulse], (0.0,), (0.0,), 5.0), {5.0: turned}


EXACT = {
    "friction": stopped_by_friction(),
    **{f"peak at {v}, {p}": stopped_by_a_peak(v, p) for v in (0.003, 0.5) for p in (1.0, 2.0)},
    "spring and friction": turning_back(),
    **{f"restitution {e}": bouncing(e) for e in (0.0, 0.5, 1.0)},
    "table": following_a_table(),
    "pulse": pushed_by_a_pulse(),
    "quadratic": slowed_by_a_square(E.ViscousJoint(1, 0.0, damping2=0.4)),
    "own quadratic": slowed_by_a_square(E.User(OwnLaw("quadratic damper", 1, (0.4,)))),
}


@pytest.mark.parametrize("name", EXACT)
def test_a_rod_moves_as_a_closed_form_or_an_integral_says(name: str) -> None:
    of, known = EXACT[name]
    found = np.asarray(angle(of, *known), float)
    np.testing.assert_allclose(found, [*known.values()], rtol=1e-14, atol=1e-15)


# Chains, and joints that hold ------------------------------------------------------------------


def test_an_impact_of_a_chain_keeps_what_it_must() -> None:
    """It keeps the momentum of every other joint and, where the stop is elastic, the energy."""
    stop = E.JointStop(2, (-2.0, 0.5), restitution=1.0, capture_speed=1e-3)
    of = drawn([stop], (0.3, 0.4, 0.0), (0.0, 3.0, 1.0), 1.0)
    found = SwitchedTrajectory(of, LONG)
    system = found.prepared(1.0)
    found.phi[1] = 0.5
    R = mass_matrix(of.scene, tuple(np.cumsum(found.phi).astype(float)))
    before = found.w.astype(float)
    found._happen(system, 0)
    after = found.w.astype(float)
    assert after[1] == -before[1] < 0
    momentum = R @ (after - before)
    np.testing.assert_allclose(momentum[[0, 2]], 0.0, atol=1e-12)
    assert after @ R @ after == pytest.approx(before @ R @ before, rel=1e-13)


def test_joints_that_could_as_well_hold_as_slide_are_refused() -> None:
    """A rod rests, and its weight is exactly the most that friction can hold."""
    weight = 1.7 * 0.3 * 8.0
    of = drawn([E.DryJointFriction(1, weight)], (0.0,), (0.0,), 1.0, gravity=8.0)
    with pytest.raises(NoReferenceError, match="not clear"):
        Reference(of, 5.0).angles(np.array([1.0]))


def test_a_joint_holds_to_the_last_bit_and_gives_way() -> None:
    """A slow motor drives the joint, which holds until the torque is what friction can bear."""
    drive = E.Motor(1, sinusoid=E.Sinusoid(1.0, 0.5))
    of = drawn([E.DryJointFriction(1, 0.25, static=0.6), drive], (0.3,), (0.0,), 4.0)
    gives_way = np.arcsin(0.6) / 0.5
    found = angle(of, 0.999 * gives_way, 1.2 * gives_way)
    assert found[0] == 0.3
    assert found[1] > 0.3
    held = trajectory(of, LONG)
    assert isinstance(held, SwitchedTrajectory)
    held.extend(gives_way + 1e-6, monotonic() + 5)
    assert isinstance(held.switches[0], Friction)
    assert held.switches[0].sign == 1


def test_laws_that_change_side_at_one_time_all_do() -> None:
    """Two dampers in one joint act as one whose coefficient is their sum."""
    both = [E.ViscousJoint(1, 0.0, damping2=0.1), E.User(OwnLaw("quadratic damper", 1, (0.25,)))]
    found, alone = (
        float(angle(drawn([E.TorsionalSpring(1, 20.0), *law], (1.0,), (0.0,), 5.0), 5.0)[0])
        for law in (both, [E.ViscousJoint(1, 0.0, damping2=0.35)])
    )
    assert found == pytest.approx(alone, rel=1e-13)
