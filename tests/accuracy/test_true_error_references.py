"""References of `make campaign OF=errors` are right: exact answers, other forms, more digits."""

from __future__ import annotations

import warnings
from dataclasses import fields, replace
from inspect import signature
from time import monotonic
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from reference.effects import law
from reference.newton_euler import Body
from reference.rig import Rig
from reference.trajectories import Trajectory as Digits
from reference.trajectories import trajectory as of_digits

pytest.importorskip("heyoka", reason="the references of true errors need heyoka")

from true_error.arithmetic import LONG, QUAD
from true_error.curve import positions_apart
from true_error.drawn import Drawn
from true_error.families import FAMILIES
from true_error.own_laws import LAWS, OwnLaw
from true_error.rates import mass_matrix
from true_error.reference import Reference, trajectory
from true_error.switched import SwitchedTrajectory
from true_error.switches import Friction
from true_error.tables import bends
from true_error.trajectory import NoReferenceError

pytestmark = pytest.mark.unsanitized
E = pc.effects
J = 1.7 * 0.6**2 / 3


def drawn(
    effects: list[Any], q0: tuple[float, ...], qd0: tuple[float, ...], t_end: float,
    gravity: float = 0.0, links: list[pc.Link] | None = None,
) -> Drawn:  # fmt: skip
    """Return a scene of rods of inertia J about their joints, unless other links are given."""
    links = links or [pc.Link(mass=1.7, length=0.6)] * len(q0)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        scene = pc.Scene(links=links, effects=effects, gravity=gravity)
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
    case: Digits = of_digits(name)
    links = [pc.Link(mass=m, length=x) for m, x in zip(case.masses, case.lengths, strict=True)]
    damping = [E.ViscousJoint(j, b) for j, b in enumerate(case.damping, start=1) if b]
    start = tuple(map(float, case.q0)), tuple(map(float, case.qd0))
    of = drawn(damping, *start, float(case.t[-1]), case.gravity, links)
    truth = Reference(of, 20.0).angles(case.t)
    apart = positions_apart(of.scene, case.q, truth.angles)
    assert apart.max() < 1e-15 + 10 * truth.unsure.max()


def check_accelerations(of: Drawn) -> None:
    """Compare with the Newton-Euler equations of each link, with every law in its plainest form."""
    n = len(of.q0)
    bodies = [Body(x.mass, x.length, x.center, x.inertia) for x in of.scene.links]
    laws = [law(described(effect)) for effect in of.scene.effects]
    rig = Rig(bodies=bodies, gravity=of.scene.gravity, effects=laws)
    found = trajectory(of, LONG)
    integrator = found.prepared(of.t_start + 1e-9 * found.direction).integrator
    integrator.step(write_tc=True)
    qdd = np.cumsum(integrator.tc[n:, 1]).astype(float)
    expected = np.array(rig.motion(of.t_start, of.q0, of.qd0).accelerations, dtype=float)
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


def described(effect: Any) -> tuple[str, dict[str, Any]]:
    """Return an effect as the reference laws take it."""
    values = {field.name: getattr(effect, field.name) for field in fields(effect)}
    parts = (E.Sinusoid, E.Table, E.PD, E.Spline)
    return effect.kind, {
        name: {field.name: getattr(value, field.name) for field in fields(value)}
        if isinstance(value, parts) else value
        for name, value in values.items()
    }  # fmt: skip


@pytest.mark.parametrize("family", sorted(set(FAMILIES) - {"stiff"}))
def test_the_reference_knows_its_own_error(family: str) -> None:
    """More digits still confirm the error; the chains are short, since these digits take long."""
    few = [of for of in map(FAMILIES[family], range(30)) if len(of.q0) <= 2]
    for of in few[:2]:
        t = np.linspace(of.t_start, of.t_start + 0.3 * (of.t_end - of.t_start), 20)
        truth = Reference(of, 20.0).angles(t)
        finest = trajectory(of, QUAD)
        finest.extend(t[-1], monotonic() + 60)
        apart = positions_apart(of.scene, truth.angles, finest.angles(t))
        assert (apart <= truth.unsure + 1e-18).all()


# Friction and stops: what can be said exactly --------------------------------------------------


def test_a_rod_that_rubs_stops_where_its_momentum_ends() -> None:
    of = drawn([E.DryJointFriction(1, 0.3)], (0.2,), (3.0,), 5.0)
    ends = J * 3.0 / 0.3
    found = angle(of, ends / 2, ends, 5.0)
    assert found[0] == pytest.approx(0.2 + 3.0 * ends / 2 - 0.3 / J * ends**2 / 8, rel=1e-14)
    assert found[1:] == pytest.approx(0.2 + J * 9.0 / (2 * 0.3), rel=1e-14)


@pytest.mark.parametrize("exponent", [1.0, 2.0])
@pytest.mark.parametrize("velocity", [0.003, 0.5])
def test_a_rod_with_a_static_peak_comes_as_far_as_an_integral_says(
    exponent: float, velocity: float
) -> None:
    """The peak is narrow, and a step that begins far from it does not see it."""
    peak = E.DryJointFriction(1, 0.3, static=0.9, stribeck_velocity=velocity, exponent=exponent)
    found = angle(drawn([peak], (0.0,), (3.0,), 5.0), 5.0)[0]

    def slowed(w: Any) -> Any:
        return w * J / (0.3 + 0.6 * mpmath.exp(-((w / velocity) ** exponent)))

    turned = mpmath.quad(slowed, [0, velocity, 3 * velocity, 10 * velocity, 3])
    assert float(found) == pytest.approx(float(turned), rel=1e-12)


def test_a_rod_on_a_spring_turns_back_where_friction_says() -> None:
    k, tc, start = 20.0, 0.5, 0.4
    rubs = [E.TorsionalSpring(1, k), E.DryJointFriction(1, tc)]
    of = drawn(rubs, (start,), (0.0,), 5.0)
    turns = np.pi * np.sqrt(J / k) * np.arange(1, 5)
    swings = [start]
    while k * abs(swings[-1]) > tc:
        swings.append(-(swings[-1] - np.sign(swings[-1]) * 2 * tc / k))
    found = np.asarray(angle(of, *turns, 5.0), float)
    np.testing.assert_allclose(found, [*swings[1:5], swings[-1]], rtol=1e-13, atol=1e-15)


@pytest.mark.parametrize("restitution", [0.0, 0.5, 1.0])
def test_a_rod_that_is_pushed_against_a_stop_bounces_as_it_must(restitution: float) -> None:
    push, capture = 2.0, 0.05
    stop = E.JointStop(1, (-np.inf, 1.0), restitution=restitution, capture_speed=capture)
    of = drawn([E.Motor(1, constant=push), stop], (0.0,), (0.0,), 4.0)
    a = push / J
    first, speed = np.sqrt(2 / a), np.sqrt(2 * a)
    tops, t = [], first
    while speed * restitution and speed > capture and t < 4.0:
        speed *= restitution
        tops.append((t + speed / a, 1.0 - speed**2 / (2 * a)))
        t += 2 * speed / a
    times, highest = zip(*[top for top in tops if top[0] < 4.0], strict=True) if tops else ((), ())
    found = np.asarray(angle(of, *times, 4.0), float)
    np.testing.assert_allclose(found[:-1], highest, rtol=1e-13, atol=1e-15)
    if restitution < 1:
        assert found[-1] == 1.0


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


# Tables, splines, laws of one's own ------------------------------------------------------------


def test_a_table_of_torque_turns_a_rod_as_its_integral_does() -> None:
    t, torque = [0.0, 1.0, 1.5, 4.0], [0.0, 2.0, -3.0, 1.0]
    of = drawn([E.Motor(1, table=E.Table(t, torque))], (0.1,), (0.2,), 3.0)
    turned = mpmath.quad(lambda s: (3 - s) * np.interp(float(s), t, torque) / J, [0, 1, 1.5, 3])
    assert float(angle(of, 3.0)[0]) == pytest.approx(0.1 + 0.6 + float(turned), rel=1e-12)


def test_a_natural_spline_has_no_kinks() -> None:
    t, x = (0.0, 0.7, 1.0, 2.5), (0.3, -1.0, 2.0, 0.4)
    m = [float(value) for value in bends(t, x)]
    assert m[0] == m[-1] == 0.0
    h = np.diff(t)
    rise, bend = np.diff(x) / h, np.array(m)
    after = rise - h * (2 * bend[:-1] + bend[1:]) / 6
    before = rise + h * (bend[:-1] + 2 * bend[1:]) / 6
    assert before[:-1] == pytest.approx(after[1:], rel=1e-13)


def test_a_short_pulse_far_ahead_is_not_stepped_over() -> None:
    pulse = OwnLaw("pulse", 1, (2.0, 3.0, 0.01))
    of = drawn([E.User(pulse)], (0.0,), (0.0,), 5.0)
    turned = 2.0 * 0.01 * np.sqrt(np.pi) / J * 2.0
    assert float(angle(of, 5.0)[0]) == pytest.approx(turned, rel=1e-12)


def test_quadratic_damping_slows_a_rod_like_one_over_time() -> None:
    for damping in (
        E.ViscousJoint(1, 0.0, damping2=0.4),
        E.User(OwnLaw("quadratic damper", 1, (0.4,))),
    ):
        found = angle(drawn([damping], (0.0,), (-3.0,), 5.0), 5.0)[0]
        assert float(found) == pytest.approx(-J / 0.4 * np.log1p(0.4 * 3.0 * 5.0 / J), rel=1e-13)


def test_laws_that_change_side_at_one_time_all_do() -> None:
    """Two dampers in one joint act as one whose coefficient is their sum."""
    both = [E.ViscousJoint(1, 0.0, damping2=0.1), E.User(OwnLaw("quadratic damper", 1, (0.25,)))]
    found, alone = (
        float(angle(drawn([E.TorsionalSpring(1, 20.0), *law], (1.0,), (0.0,), 5.0), 5.0)[0])
        for law in (both, [E.ViscousJoint(1, 0.0, damping2=0.35)])
    )
    assert found == pytest.approx(alone, rel=1e-13)
