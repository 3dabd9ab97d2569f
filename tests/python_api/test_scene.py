"""A scene holds what it was given, counts its freedom, and gives accelerations of any shape."""

from __future__ import annotations

import copy
from dataclasses import FrozenInstanceError, replace
from math import pi

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pendcore import Link, Scene

G = 9.807
BOOK = Scene.textbook()
ROD = Link(mass=1.0, length=1.0)


def test_a_link_is_a_uniform_rod_unless_said_otherwise():
    link = Link(mass=3, length=2)
    assert (link.center, link.inertia) == (1.0, 1.0)
    link = Link(mass=3, length=2, center=0.5, inertia=0)
    assert (link.center, link.inertia) == (0.5, 0.0)
    assert Link.point_mass(mass=3, length=2) == Link(mass=3, length=2, center=2, inertia=0)
    rod = Link(mass=1.0, length=1.0, center=0.5, inertia=1 / 12)
    assert Scene(links=[rod, rod], gravity=9.807) == BOOK
    shown = "Link(mass=3.0, length=2.0, center=0.5, inertia=0.0)"
    assert repr(Scene(links=[link], gravity=0)) == f"Scene(links=({shown},), gravity=0.0)"
    assert repr(rod.replace(center=None)) == "Link(mass=1.0, length=1.0)"


ODD = Link(mass=1, length=1, center=0.4, inertia=0.01)


class Rods(Scene):
    """Scenes that are made of a number of rods."""

    def __init__(self, number):
        super().__init__(links=[ROD] * number)


REPLACED = [
    (ROD.replace(mass=2), Link(mass=2, length=1)),
    (ROD.replace(length=3), Link(mass=1, length=3)),
    (ODD.replace(mass=2), Link(mass=2, length=1, center=0.4, inertia=0.01)),
    (ODD.replace(center=None, inertia=None), ROD),
    (BOOK.replace(links=[ODD]), Scene(links=[ODD])),
    (BOOK.replace(gravity=0).replace(links=[ODD]), Scene(links=[ODD], gravity=0)),
    (copy.deepcopy(BOOK), BOOK),
    (copy.copy(BOOK), BOOK),
    (copy.deepcopy(Rods(3)), Rods(3)),
]


@pytest.mark.parametrize("row", REPLACED)
def test_what_is_replaced_is_as_if_made_so_and_the_rest_stays(row):
    one, other = row
    assert one == other
    assert hash(one) == hash(other)


def test_what_cannot_be_replaced_or_changed_is_refused():
    with pytest.raises(TypeError, match="massa"):
        ROD.replace(massa=2)
    # A rod's inertia is not kept for another mass in silence.
    with pytest.raises((TypeError, ValueError)):
        replace(ROD, mass=2)
    for one, name in ((BOOK, "links"), (BOOK, "gravity"), (BOOK.links[0], "mass")):
        with pytest.raises(FrozenInstanceError):
            setattr(one, name, 2.0)


def test_accelerations_broadcast_time_angles_and_rates():
    for t, q, qd, shape in (
        (np.zeros(5), [1, 2], [0, 0], (5, 2)),
        (0, np.ones((5, 2)), [0, 0], (5, 2)),
        (np.zeros((3, 1)), np.ones((5, 2)), [0, 0], (3, 5, 2)),
        (np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2)), (0, 2)),
    ):
        assert BOOK.accelerations(t, q, qd).shape == shape
        assert {x.shape for x in BOOK.jacobian(t, q, qd)} == {(*shape, 2)}
        assert BOOK.mass_centers(t, q).shape == (*shape, 2)
    assert BOOK.mass_matrix(np.zeros((3, 4, 2))).shape == (3, 4, 2, 2)


@pytest.mark.parametrize("rubbed", [False, True])
@pytest.mark.parametrize("n", [1, 2, 5])
def test_one_state_has_the_accelerations_of_a_row_of_many_and_makes_no_arrays_of_rows(
    n, rubbed, monkeypatch
):
    rub = [pc.effects.DryJointFriction(joint=1, coulomb=0.1), pc.effects.ViscousJoint(n, 0.2)]
    scene = Scene(links=[Link(mass=1.0, length=0.5)] * n, effects=rub if rubbed else [])
    q, qd = np.linspace(0.3, 1.0, n), np.linspace(-1.0, 2.0, n)
    row = scene.accelerations([2.0], [q], [qd])
    assert row.shape == scene.accelerations([2.0], q, qd).shape == (1, n)
    backward = np.stack([q, qd])[:, ::-1][:, ::-1]  # neither is contiguous to look at
    assert np.array_equal(scene.accelerations(2.0, *backward), row[0])

    def no_conversion(*_):
        raise AssertionError("one state went through the checks of many")

    monkeypatch.setattr("pendcore._scene.scene.finite_array", no_conversion)
    for t in (2.0, 2, np.float64(2.0)):
        for form in (np.array, list, tuple):
            one = scene.accelerations(t, form(q), form(qd))
            assert one.shape == (n,)
            assert np.array_equal(one, row[0])


@pytest.mark.parametrize("n", [1, 2])
def test_mobility_is_three_n_minus_two_c5_minus_c4(n):
    found = Scene(links=[ROD] * n).mobility()
    assert found == pc.Mobility(links=n, c5=n, c4=0, degrees_of_freedom=n)
    assert found.degrees_of_freedom == 3 * found.links - 2 * found.c5 - found.c4


ANGLES = {
    # hanging, to the right, upright
    "hanging": ([0.0, pi / 2, pi], [pi / 2, 0, -pi / 2]),
    # upright, to the left, to the right, hanging: counter-clockwise as seen
    "upright": ([0.0, pi / 2, -pi / 2, -pi], [-pi / 2, -pi, 0, pi / 2]),
}


@pytest.mark.parametrize("zero", ANGLES)
def test_angles_from_a_vertical_are_those_of_the_scene_and_come_back(zero):
    theta, expected = ANGLES[zero]
    q = pc.angles_from_vertical(theta, zero=zero)
    np.testing.assert_allclose(q, expected, atol=1e-16)
    np.testing.assert_array_equal(pc.angles_to_vertical(q, zero=zero), theta)
    assert zero == "upright" or np.array_equal(pc.angles_from_vertical(theta), q)
    assert pc.angles_to_vertical(pi / 2) == 0.0
    assert pc.angles_from_vertical(np.float16([0.25])).dtype == np.float64


@given(x=st.floats(-100, 100))
@pytest.mark.parametrize("zero", ANGLES)
def test_an_angle_from_a_vertical_comes_back_from_it(zero, x):
    there = pc.angles_from_vertical(x, zero=zero)
    assert abs(pc.angles_to_vertical(there, zero=zero) - x) <= np.spacing(102.0)


def test_a_lock_is_not_in_the_mass_matrix():
    free = Scene(links=[ROD, ROD], effects=[pc.effects.Payload(0.5)])
    locked = free.replace(effects=[*free.effects, pc.effects.Lock(2)])
    q = [0.3, 1.1]
    assert np.array_equal(locked.mass_matrix(q), free.mass_matrix(q))
    assert not np.array_equal(free.mass_matrix(q), free.replace(effects=[]).mass_matrix(q))
    qdd = locked.accelerations(0.0, q, [2.0, 2.0])
    assert qdd[0] == qdd[1]


def test_numbers_that_are_not_finite_have_the_same_sign_on_every_processor():
    """Processors give the NaN of inf - inf different signs."""
    found = BOOK.accelerations(0.0, [0.0, 0.0], [1e200, 1e200])
    assert np.isnan(found).all()
    assert not np.signbit(found).any()
