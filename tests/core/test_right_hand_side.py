"""Accelerations, joint forces, energies, mass centres at one instant agree with the reference.

Errors are measured against the size of what they are made of: L qdd against the accelerations at
hand (gravity and the centripetal ones), a force against that times the mass it moves. A component
that happens to vanish by cancellation asks for no more digits than the terms that cancel have.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from reference.arithmetic import DOUBLE, Arithmetic, multiple_precision
from reference.newton_euler import Body, uniform_rod
from reference.random_rigs import links
from reference.rig import Rig
from sweeps import random_examples

TOLERANCE = 1e-12
SIXTY = multiple_precision(60)

angles = st.floats(-10, 10)
rates = st.floats(-20, 20).map(lambda w: round(w, 6))
gravities = st.just(0.0) | st.floats(0.1, 30)
State = tuple[list[float], list[float]]


def uneven_links(n: int) -> st.SearchStrategy[list[Body]]:
    return st.lists(links(mass_decades=2, length_decades=1), min_size=n, max_size=n)


def states(n: int) -> st.SearchStrategy[State]:
    return st.tuples(*(st.lists(some, min_size=n, max_size=n) for some in (angles, rates)))


def assert_close(computed: ArrayLike, exact: object, scale: ArrayLike) -> None:
    error = np.abs(np.asarray(computed) - np.array(exact, dtype=float))
    assert np.all(error <= TOLERANCE * np.asarray(scale))


def check_instant(
    bodies: Sequence[Body], gravity: float, state: State, arithmetic: Arithmetic = DOUBLE
) -> None:
    q, qd = state
    scene = scene_of(bodies, gravity)
    now = pc.simulate(scene, q0=q, qd0=qd, t_span=(0.0, 0.0), store="steps")
    rig = Rig(bodies=bodies, gravity=gravity, arithmetic=arithmetic)
    exact = rig.motion(0, q, qd)

    masses, lengths, *_ = np.array(bodies).T
    w = np.array(qd)
    size = gravity + np.sum(lengths * w**2)
    carried = np.cumsum(masses[::-1])[::-1]
    assert_close(scene.accelerations(0.0, q, qd), exact.accelerations, size / lengths)
    assert_close(now.accelerations()[0], exact.accelerations, size / lengths)
    assert_close(now.reactions()[0], exact.reactions, (carried * size)[:, np.newaxis])

    exact_matrix = rig.mass_matrix(q)
    squares = np.diag(np.array(exact_matrix, dtype=float))
    assert_close(scene.mass_matrix(q), exact_matrix, np.sqrt(np.outer(squares, squares)))

    centers = [center[:2] for center in rig.instant(0.0, q, qd).mass_centers()]
    reach = np.cumsum(lengths)
    assert_close(now.mass_centers()[0], centers, reach[:, np.newaxis])
    speed = np.cumsum(lengths * np.abs(w))
    kinetic, potential = rig.energy(0.0, q, qd)
    assert_close(now.energy().kinetic[0], kinetic, np.sum(masses * speed**2))
    assert_close(now.energy().potential[0], potential, gravity * np.sum(masses * reach))


@pytest.mark.parametrize("n", [1, 2])
@given(data=st.data())
def test_one_link_and_two(n: int, data: st.DataObject) -> None:
    check_instant(data.draw(uneven_links(n)), data.draw(gravities), data.draw(states(n)))


@settings(max_examples=random_examples(50), deadline=None)
@given(*[st.floats(-12, 12)] * 2, gravities, states(2))
def test_mass_and_length_ratios_up_to_1e12(mass, length, gravity, state) -> None:
    rods = [uniform_rod(1.0, 1.0), uniform_rod(10**mass, 10**length)]
    check_instant(rods, gravity, state, SIXTY)


@pytest.mark.parametrize("mass", [1e-12, 1e12])
@pytest.mark.parametrize("length", [1e-12, 1e12])
@pytest.mark.parametrize("q", [(0.7, 0.7), (0.7, 0.7 + np.pi), (0.7, -1.3)], ids=str)
def test_the_corners_of_the_ratios_also_straight_and_folded(mass, length, q) -> None:
    rods = [uniform_rod(1.0, 1.0), uniform_rod(mass, length)]
    check_instant(rods, 9.81, (list(q), [2.0, -3.0]), SIXTY)


@pytest.mark.few_cases
@pytest.mark.parametrize("n", [1, 2, 3, 4, 10, 20])
def test_the_mass_matrix_is_that_of_the_kinetic_energy(n: int) -> None:
    @settings(max_examples=random_examples(20 if n <= 10 else 3), deadline=None)
    @given(uneven_links(n), states(n))
    def check(bodies, state) -> None:
        rig = Rig(bodies=bodies, gravity=0.0, arithmetic=SIXTY)
        exact = np.array(rig.mass_matrix(state[0]), dtype=float)
        size = np.sqrt(np.outer(np.diag(exact), np.diag(exact)))
        found = scene_of(bodies, 9.81).mass_matrix(state[0])
        assert np.all(np.abs(found - exact) < 1e-14 * size)

    check()


def test_many_states_at_once() -> None:
    rods = [uniform_rod(1.3, 0.8), uniform_rod(0.4, 1.1)]
    q, qd = np.random.default_rng(1).uniform(-4, 4, (2, 50, 2))
    rig = Rig(bodies=rods, gravity=9.81)
    exact = [rig.motion(0, *state).accelerations for state in zip(q, qd, strict=True)]
    size = 9.81 + (qd**2) @ [0.8, 1.1]
    computed = scene_of(rods, 9.81).accelerations(0.0, q, qd)
    assert_close(computed, exact, size[:, np.newaxis] / [0.8, 1.1])
