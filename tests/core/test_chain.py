"""Chains of n links keep what they must, swing as theory says, and equal their equivalents."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain
from numpy.typing import ArrayLike
from pendcore import effects as fx

DOWN = np.pi / 2
LINK = pc.Link(mass=1.0, length=0.5)
T = np.linspace(0, 3, 61)


def rods(n: int, length: float = 1.0, mass: float = 1.0, **options: Any) -> pc.Scene:
    """Return equal rods that have this length and mass in all."""
    return pc.Scene(links=[pc.Link(mass=mass / n, length=length / n)] * n, **options)


def solve(scene: pc.Scene, q: ArrayLike, qd: ArrayLike, t_end: float, **options: Any) -> Any:
    told = {"rtol": 1e-12, "atol": 1e-13, **options}
    sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0.0, t_end), **told)
    assert sol.success
    return sol


@pytest.mark.parametrize(
    ("n", "t_end"),
    [(3, 5.0), (10, 2.0), (100, 0.5), pytest.param(1000, 0.05, marks=pytest.mark.unsanitized)],
)
def test_a_free_chain_keeps_its_energy(n: int, t_end: float) -> None:
    start = 0.5 * np.sin(np.linspace(0, 3, n))
    energy = solve(rods(n), start, np.linspace(-1, 1, n), t_end, store="steps").energy()
    assert np.ptp(energy.kinetic) > 0.01  # the chain does move
    assert np.ptp(energy.total) < 1e-10 * np.ptp(energy.kinetic)


@pytest.mark.parametrize("n", [3, 30])
def test_a_floating_chain_keeps_its_angular_momentum(n: int) -> None:
    scene = rods(n, gravity=0.0)
    sol = solve(scene, np.linspace(0, 3, n), np.linspace(-5, 5, n), 1.0, store="steps")
    parts = scene.mass_matrix(sol.q) * sol.qd[:, np.newaxis]
    assert np.ptp(parts.sum(axis=(1, 2))) < 1e-10 * np.abs(parts).sum(axis=(1, 2)).max()


@pytest.mark.parametrize("n", [10, 100, 1000])
def test_the_accelerations_are_those_of_a_dense_solution(n: int) -> None:
    """M qdd equals what gravity and centripetal forces leave, written out as a matrix equation."""
    random = np.random.default_rng(n)
    scene, q, qd = rods(n, length=n, mass=n), *random.uniform(-3, 3, (2, n))
    dense = DenseChain(masses=np.ones(n), lengths=np.ones(n), gravity=scene.gravity)
    mass, terms = dense.mass_matrix(q), dense.forces(q, qd, np.zeros(n))
    found = scene.accelerations(0.0, q, qd)
    assert np.abs(mass @ found - terms).max() < 1e-13 * n * np.abs(terms).max()
    np.testing.assert_allclose(found, np.linalg.solve(mass, terms), atol=1e-13 * n**2)


@pytest.mark.parametrize("n", [10, 30, 100])
def test_a_hanging_chain_swings_as_bessels_function_says(n: int) -> None:
    """The slowest frequency is 1.2024128 sqrt(g/length), with a relative error of 0.0307/n^2."""
    scene, hanging, small = rods(n), np.full(n, DOWN), 1e-6
    stiffness = np.diag((np.arange(n, 0, -1) - 0.5) / n**2 * scene.gravity)
    # The slowest mode has the largest 1/w^2; inverting a diagonal matrix does not blur it.
    squares, modes = np.linalg.eig(np.linalg.solve(stiffness, scene.mass_matrix(hanging)))
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
    np.testing.assert_allclose(quarters, np.outer(shape, [1, 0, -1, 0, 1]), atol=2e-5)


def check_same_motion(
    scene: pc.Scene,
    other: pc.Scene,
    q: ArrayLike,
    qd: ArrayLike,
    same: list[int],
    turned: Any = 0.0,
) -> tuple[pc.Solution, pc.Solution]:
    """Run both; link i of ``scene`` moves as link same[i] of ``other``, turned by an angle."""
    q, qd = np.asarray(q), np.asarray(qd)
    one = solve(scene, q[same] + turned, qd[same], 3.0, t_eval=T)
    two = solve(other, q, qd, 3.0, t_eval=T)
    np.testing.assert_allclose(one.q, two.q[:, same] + turned, rtol=0, atol=2e-9)
    np.testing.assert_allclose(one.qd, two.qd[:, same], rtol=0, atol=2e-9)
    return one, two


@pytest.mark.parametrize(("locked", "same"), [(2, [0, 0, 1]), (3, [0, 1, 1])])
def test_rods_locked_in_line_are_one_longer_rod(locked: int, same: list[int]) -> None:
    scene = pc.Scene(links=[LINK] * 3, effects=[fx.Lock(joint=locked)])
    merged = [LINK, LINK]
    merged[locked - 2] = pc.Link(mass=2.0, length=1.0)
    three, two = check_same_motion(scene, pc.Scene(links=merged), [0.4, 1.3], [1.0, -2.0], same)
    free = [0, same.index(1)]
    np.testing.assert_allclose(three.reactions()[:, free], two.reactions(), atol=1e-6)


@pytest.mark.parametrize("angle", [0.9, -2.0])
def test_a_bent_pair_is_a_link_with_its_mass_centre_off_the_line(angle: float) -> None:
    """Links 2 and 3, locked at an angle, are one body whose line goes through its mass centre."""
    m, length = LINK.mass, LINK.length
    arm = np.array([length, 0]) + length / 2 * np.array([np.cos(angle), np.sin(angle)])
    center = (m * np.array([length / 2, 0]) + m * arm) / (2 * m)
    inertia = m * length**2 / 6 + 2 * m * (arm - center) @ (arm - center)
    reach, offset = float(np.hypot(*center)), float(np.arctan2(center[1], center[0]))
    bent = pc.Scene(links=[LINK] * 3, effects=[fx.Lock(joint=3, angle=angle)])
    body = pc.Link(mass=2 * m, length=2 * length, center=reach, inertia=inertia)
    pair = pc.Scene(links=[LINK, body])
    turned = [0.0, -offset, angle - offset]
    three, _ = check_same_motion(bent, pair, [0.4, 1.3 + offset], [1.0, -2.0], [0, 1, 1], turned)
    np.testing.assert_allclose(np.diff(three.q[:, 1:]), angle, atol=1e-14)


@pytest.mark.parametrize("n", [1, 2, 3, 5])
def test_a_payload_is_a_heavier_last_link(n: int) -> None:
    center = (0.25 + 3.0 * 0.5) / 4.0
    inertia = 1 / 48 + (center - 0.25) ** 2 + 0.02 + 3.0 * (0.5 - center) ** 2
    heavy = pc.Link(mass=4.0, length=0.5, center=center, inertia=inertia)
    loaded = pc.Scene(links=[LINK] * n, effects=[fx.Payload(mass=3.0, inertia=0.02)])
    merged = pc.Scene(links=[*[LINK] * (n - 1), heavy])
    q, qd = np.linspace(0.4, 1.3, n), np.linspace(1.0, -2.0, n)
    one, other = check_same_motion(loaded, merged, q, qd, [*range(n)])
    np.testing.assert_allclose(one.reactions(), other.reactions(), atol=1e-6)
    np.testing.assert_allclose(one.energy().total, other.energy().total, atol=1e-11)


def test_a_motor_in_every_joint_and_its_opposite_leave_the_chain_alone() -> None:
    motors = [fx.Motor(joint=j, constant=torque) for j in range(1, 5) for torque in (0.7, -0.7)]
    state = 0.0, np.linspace(0.4, 1.3, 4), np.linspace(1.0, -2.0, 4)
    driven, bare = (pc.Scene(links=[LINK] * 4, effects=some) for some in (motors, []))
    np.testing.assert_allclose(driven.accelerations(*state), bare.accelerations(*state), rtol=1e-12)
