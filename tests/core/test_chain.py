"""Chains of n links follow reference motions, keep what they must, and equal their equivalents."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from numpy.typing import ArrayLike, NDArray
from reference.arithmetic import multiple_precision
from reference.newton_euler import uniform_rod
from reference.rig import Rig
from reference.trajectories import Trajectory

Array = NDArray[np.float64]
DOWN = np.pi / 2


def rods(n: int, length: float = 1.0, mass: float = 1.0, **options: Any) -> pc.Scene:
    """Return equal rods that have this length and mass in all."""
    return pc.Scene(links=[pc.Link(mass=mass / n, length=length / n)] * n, **options)


def solve(scene: pc.Scene, q: ArrayLike, qd: ArrayLike, t_end: float, **options: Any) -> Any:
    told = {"rtol": 1e-12, "atol": 1e-13, **options}
    sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0.0, t_end), **told)
    assert sol.success
    return sol


@pytest.mark.parametrize("name", ["three_links", "ten_links", "damped_textbook"])
def test_angles_follow_the_multiple_precision_ones(
    name: str, reference_case: Callable[[str], Trajectory]
) -> None:
    case = reference_case(name)
    damping = [
        pc.effects.ViscousJoint(joint=joint, damping=b)
        for joint, b in enumerate(case.damping, start=1)
        if b
    ]
    links = zip(case.masses, case.lengths, strict=True)
    scene = pc.Scene(
        links=[pc.Link(mass=m, length=length) for m, length in links],
        gravity=case.gravity,
        effects=damping,
    )
    sol = solve(scene, case.q0, case.qd0, float(case.t[-1]), atol=1e-12)
    n = len(case.q0)
    assert np.abs(sol(case.t)[:n].T - case.q).max() < 1e-9


# What a chain conserves -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("n", "t_end"),
    [(3, 5.0), (10, 2.0), (100, 0.5), pytest.param(1000, 0.05, marks=pytest.mark.unsanitized)],
)
def test_a_free_chain_keeps_its_energy(n: int, t_end: float) -> None:
    start = 0.5 * np.sin(np.linspace(0, 3, n))
    sol = solve(rods(n), start, np.linspace(-1, 1, n), t_end, store="steps")
    energy = sol.energy()
    assert np.ptp(energy.kinetic) > 0.01  # the chain does move
    assert np.ptp(energy.total) < 1e-10 * np.ptp(energy.kinetic)


@pytest.mark.parametrize("n", [3, 30])
def test_a_floating_chain_keeps_its_angular_momentum(n: int) -> None:
    scene = rods(n, gravity=0.0)
    sol = solve(scene, np.linspace(0, 3, n), np.linspace(-5, 5, n), 1.0, store="steps")
    momentum = np.einsum("tij,tj->t", scene.mass_matrix(sol.q), sol.qd)
    sizes = np.einsum("tij,tj->t", np.abs(scene.mass_matrix(sol.q)), np.abs(sol.qd))
    assert np.ptp(momentum) < 1e-10 * sizes.max()


@pytest.mark.parametrize("n", [1, 2, 3, 4, 10, 20])
def test_the_mass_matrix_is_that_of_the_kinetic_energy(n: int) -> None:
    random = np.random.default_rng(n)
    bodies = [uniform_rod(*random.uniform(0.1, 2.0, 2)) for _ in range(n)]
    links = [pc.Link(mass=body.mass, length=body.length) for body in bodies]
    q = random.uniform(-4, 4, n)
    exact = Rig(bodies=bodies, gravity=0.0, arithmetic=multiple_precision(30)).mass_matrix(
        q.tolist()
    )
    exact = np.array(exact, dtype=float)
    size = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
    error = np.abs(pc.Scene(links=links).mass_matrix(q) - exact)
    assert np.all(error < 1e-14 * size)


@pytest.mark.parametrize("n", [10, 100, 1000])
def test_the_accelerations_are_those_of_a_dense_solution(n: int) -> None:
    """M qdd equals what gravity and centripetal forces leave, written out as a matrix equation."""
    random = np.random.default_rng(n)
    scene, q, qd = rods(n, length=n, mass=n), *random.uniform(-3, 3, (2, n))
    a = np.arange(n, 0, -1) - 0.5  # for rods of 1 kg and 1 m
    coupling = np.minimum.outer(a, a) + np.diag(np.full(n, -1 / 6))
    difference = q[:, np.newaxis] - q
    mass = coupling * np.cos(difference)
    terms = a * scene.gravity * np.cos(q) - coupling * np.sin(difference) @ qd**2
    found = scene.accelerations(0.0, q, qd)
    assert np.abs(mass @ found - terms).max() < 1e-13 * n * np.abs(terms).max()
    np.testing.assert_allclose(found, np.linalg.solve(mass, terms), atol=1e-13 * n**2)


# Small oscillations -----------------------------------------------------------------------------


@pytest.mark.parametrize("n", [10, 30, 100])
def test_a_hanging_chain_swings_as_bessels_function_says(n: int) -> None:
    """The slowest frequency is 1.2024128 sqrt(g/length), with a relative error of 0.0307/n^2."""
    scene, hanging, small = rods(n), np.full(n, DOWN), 1e-6
    mass = scene.mass_matrix(hanging)
    stiffness = np.diag((np.arange(n, 0, -1) - 0.5) / n**2 * scene.gravity)
    # The slowest mode has the largest 1/w^2; inverting a diagonal matrix does not blur it.
    squares, modes = np.linalg.eig(np.linalg.solve(stiffness, mass))
    slowest = np.argmax(squares.real)
    w, shape = 1 / np.sqrt(squares.real[slowest]), modes.real[:, slowest]
    limit = 1.2024127788478852 * np.sqrt(scene.gravity)
    assert (w / limit - 1) * n**2 == pytest.approx(0.0307, rel=0.02)

    shape /= np.abs(shape).max()
    found = scene.accelerations(0.0, hanging + small * shape, np.zeros(n)) / small
    np.testing.assert_allclose(found, -(w**2) * shape, atol=1e-6 * n**2)
    period = 2 * np.pi / w
    sol = solve(scene, hanging + 1e-3 * shape, 0.0, period, rtol=1e-10, atol=1e-13)
    quarters = (sol(period * np.array([0, 0.25, 0.5, 0.75, 1]))[:n] - DOWN) / 1e-3
    expected = np.outer(shape, [1, 0, -1, 0, 1])
    np.testing.assert_allclose(quarters, expected, atol=2e-5)


# Chains that are each other's equal -------------------------------------------------------------


def same_motion(one: Array, other: Array) -> None:
    np.testing.assert_allclose(one, other, rtol=0, atol=2e-9)


T = np.linspace(0, 3, 61)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_the_mirror_image_of_a_motion_is_a_motion(n: int) -> None:
    q, qd = np.linspace(0.2, 1.0, n), np.linspace(-1, 2, n)
    scene = rods(n, length=0.5 * n, mass=n)
    motion, image = solve(scene, q, qd, 3.0), solve(scene, np.pi - q, -qd, 3.0)
    same_motion(np.pi - image(T)[:n], motion(T)[:n])


@pytest.mark.parametrize(("locked", "free"), [(2, 2), (3, 1)])
def test_rods_locked_in_line_are_one_longer_rod(locked: int, free: int) -> None:
    """Joint ``locked`` is locked; the rods before and after it make one rod of twice the length."""
    links = [pc.Link(mass=1.0, length=0.5)] * 3
    scene = pc.Scene(links=links, effects=[pc.effects.Lock(joint=locked)])
    merged = [pc.Link(mass=1.0, length=0.5)] * 2
    merged[locked - 2] = pc.Link(mass=2.0, length=1.0)
    q, qd = np.array([0.4, 1.3]), np.array([1.0, -2.0])
    doubled = [0, 0, 1] if locked == 2 else [0, 1, 1]
    three = solve(scene, q[doubled], qd[doubled], 3.0)
    two = solve(pc.Scene(links=merged), q, qd, 3.0)
    same_motion(three(T), two(T)[[*doubled, *(np.array(doubled) + 2)]])
    joint, other = (three.reactions()[:, free], two.reactions()[:, 1])
    assert np.isfinite(joint).all()
    assert np.isfinite(other).all()


@pytest.mark.parametrize("angle", [0.9, -2.0])
def test_a_bent_pair_is_a_link_with_its_mass_centre_off_the_line(angle: float) -> None:
    """Links 2 and 3, locked at an angle, are one body whose line goes through its mass centre."""
    m, length = 1.0, 0.5
    arm = np.array([length, 0]) + length / 2 * np.array([np.cos(angle), np.sin(angle)])
    center = (m * np.array([length / 2, 0]) + m * arm) / (2 * m)
    inertia = m * length**2 / 6 + 2 * m * (arm - center) @ (arm - center)
    reach, offset = float(np.hypot(*center)), float(np.arctan2(center[1], center[0]))
    bent = pc.Scene(
        links=[pc.Link(mass=m, length=length)] * 3,
        effects=[pc.effects.Lock(joint=3, angle=angle)],
    )
    body = pc.Link(mass=2 * m, length=2 * length, center=reach, inertia=inertia)
    pair = pc.Scene(links=[pc.Link(mass=m, length=length), body])
    q, qd = [0.4, 1.3], [1.0, -2.0]
    three = solve(bent, [*q, q[1] + angle], [*qd, qd[1]], 3.0)
    two = solve(pair, [q[0], q[1] + offset], qd, 3.0)
    same_motion(three(T)[0], two(T)[0])
    same_motion(three(T)[1] + offset, two(T)[1])
    np.testing.assert_allclose(np.diff(three.q[:, 1:]), angle, atol=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_a_payload_is_a_heavier_last_link(n: int) -> None:
    links = [pc.Link(mass=1.0, length=0.5)] * n
    center = (0.25 + 3.0 * 0.5) / 4.0
    inertia = 1 / 48 + (center - 0.25) ** 2 + 0.02 + 3.0 * (0.5 - center) ** 2
    heavy = pc.Link(mass=4.0, length=0.5, center=center, inertia=inertia)
    loaded = pc.Scene(links=links, effects=[pc.effects.Payload(mass=3.0, inertia=0.02)])
    q, qd = np.linspace(0.4, 1.3, n), np.linspace(1.0, -2.0, n)
    one = solve(loaded, q, qd, 3.0, t_eval=T)
    other = solve(pc.Scene(links=[*links[:-1], heavy]), q, qd, 3.0, t_eval=T)
    same_motion(one.y, other.y)
    np.testing.assert_allclose(one.reactions(), other.reactions(), atol=1e-6)
    np.testing.assert_allclose(one.energy().total, other.energy().total, atol=1e-11)


def test_a_motor_in_every_joint_and_its_opposite_leave_the_chain_alone() -> None:
    links = [pc.Link(mass=1.0, length=0.5)] * 4
    torques = [
        pc.effects.Motor(joint=j, constant=sign * 0.7) for j in range(1, 5) for sign in (1, -1)
    ]
    q, qd = np.linspace(0.4, 1.3, 4), np.linspace(1.0, -2.0, 4)
    bare = pc.Scene(links=links).accelerations(0.0, q, qd)
    np.testing.assert_allclose(
        pc.Scene(links=links, effects=torques).accelerations(0.0, q, qd), bare, rtol=1e-12
    )
