"""A scene holds what it was given, counts its freedom, and gives accelerations of any shape."""

from __future__ import annotations

import copy
import pickle
import re
import warnings
from dataclasses import FrozenInstanceError, replace
from math import pi

import numpy as np
import pendcore as pc
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pendcore import Link, Scene

G = 9.807
sizes = st.floats(min_value=1e-6, max_value=1e6)


@st.composite
def links(draw):
    """Links that a workshop could make: mass centre on the link, no more inertia than fits."""
    mass, length = draw(sizes), draw(sizes)
    if draw(st.booleans()):
        return Link(mass=mass, length=length)
    center = draw(st.floats(0.1, 0.9)) * length
    most = mass * center * (length - center)
    return Link(mass=mass, length=length, center=center, inertia=draw(st.floats(0, 0.9)) * most)


scenes = st.builds(
    Scene, links=st.lists(links(), min_size=1, max_size=2), gravity=st.floats(-1e3, 1e3)
)


def test_a_link_is_a_uniform_rod_unless_said_otherwise():
    link = Link(mass=3, length=2)
    assert (link.center, link.inertia) == (1.0, 1.0)
    link = Link(mass=3, length=2, center=0.5, inertia=0)
    assert (link.center, link.inertia) == (0.5, 0.0)


def test_a_point_mass_sits_at_the_tip():
    assert Link.point_mass(mass=3, length=2) == Link(mass=3, length=2, center=2, inertia=0)


def test_the_textbook_scene_is_that_of_section_2_1():
    rod = Link(mass=1.0, length=1.0, center=0.5, inertia=1 / 12)
    assert Scene.textbook() == Scene(links=[rod, rod], gravity=9.807)


@given(scenes)
def test_a_scene_comes_back_from_its_repr(scene):
    assert eval(repr(scene), {"Scene": Scene, "Link": Link}) == scene


@given(scenes)
def test_a_scene_comes_back_from_pickle_and_moves_the_same(scene):
    again = pickle.loads(pickle.dumps(scene))
    assert again == scene
    assert hash(again) == hash(scene)
    q = np.linspace(-1, 2, len(scene.links))
    assert np.array_equal(again.accelerations(0, q, q), scene.accelerations(0, q, q))


def test_repr_shows_what_is_not_as_in_a_rod_and_nothing_else():
    scene = Scene(links=[Link(mass=1, length=2), Link(mass=1, length=2, center=0.5)], gravity=0)
    assert repr(scene) == (
        "Scene(links=(Link(mass=1.0, length=2.0), Link(mass=1.0, length=2.0, center=0.5)),"
        " gravity=0.0)"
    )


def test_copies_are_equal_and_scenes_can_be_varied():
    scene = Scene.textbook()
    assert copy.deepcopy(scene) == copy.copy(scene) == scene
    moon = scene.replace(gravity=1.62)
    assert (moon.gravity, moon.links) == (1.62, scene.links)
    hanging = [pi / 2 - 0.1, pi / 2 - 0.1]
    ratio = moon.accelerations(0, hanging, [0, 0]) / scene.accelerations(0, hanging, [0, 0])
    np.testing.assert_allclose(ratio, 1.62 / G, rtol=1e-14)


def test_a_replaced_link_keeps_what_was_left_to_the_default_a_default():
    rod = Link(mass=1, length=1)
    assert rod.replace(mass=2) == Link(mass=2, length=1)
    assert rod.replace(length=3) == Link(mass=1, length=3)
    odd = Link(mass=1, length=1, center=0.4, inertia=0.01)
    assert odd.replace(mass=2) == Link(mass=2, length=1, center=0.4, inertia=0.01)
    assert odd.replace(center=None, inertia=None) == rod
    with pytest.raises(TypeError, match="massa"):
        rod.replace(massa=2)


def test_dataclasses_replace_does_not_keep_a_rods_inertia_for_another_mass_silently():
    with pytest.raises((TypeError, ValueError)):
        replace(Link(mass=1, length=1), mass=2)


def test_a_replaced_scene_keeps_the_rest_and_blames_the_caller_for_what_is_odd():
    scene = Scene.textbook()
    rod = Link(mass=2, length=1)
    assert scene.replace(links=[rod]) == Scene(links=[rod])
    assert scene.replace(gravity=0).replace(links=[rod]) == Scene(links=[rod], gravity=0)
    with pytest.warns(pc.PendcoreWarning, match=r"^link 1: inertia = 5") as caught:
        scene.replace(links=[rod.replace(inertia=5)])
    assert [warning.filename for warning in caught] == [__file__]


@pytest.mark.parametrize("name", ["links", "gravity", "mass"])
def test_nothing_can_be_changed_in_place(name):
    scene = Scene.textbook()
    with pytest.raises(FrozenInstanceError):
        setattr(scene.links[0] if name == "mass" else scene, name, 2.0)


def test_accelerations_run_over_leading_axes():
    scene, random = Scene.textbook(), np.random.default_rng(1)
    q, qd = random.normal(size=(2, 3, 4, 2))
    together = scene.accelerations(0.0, q, qd)
    assert together.shape == (3, 4, 2)
    for i, j in np.ndindex(3, 4):
        assert np.array_equal(together[i, j], scene.accelerations(0.0, q[i, j], qd[i, j]))


def test_accelerations_broadcast_time_angles_and_rates():
    scene = Scene.textbook()
    assert scene.accelerations(np.zeros(5), [1, 2], [0, 0]).shape == (5, 2)
    assert scene.accelerations(0, np.ones((5, 2)), [0, 0]).shape == (5, 2)
    assert scene.accelerations(np.zeros((3, 1)), np.ones((5, 2)), [0, 0]).shape == (3, 5, 2)
    assert scene.accelerations(np.zeros(0), np.zeros((0, 2)), np.zeros((0, 2))).shape == (0, 2)


@given(q=st.tuples(st.floats(-10, 10), st.floats(-10, 10)))
def test_the_mass_matrix_of_the_textbook(q):
    coupling = np.cos(q[0] - q[1]) / 2
    expected = [[4 / 3, coupling], [coupling, 1 / 3]]
    np.testing.assert_allclose(Scene.textbook().mass_matrix(q), expected, rtol=0, atol=1e-15)


def test_the_mass_matrix_runs_over_leading_axes():
    assert Scene.textbook().mass_matrix(np.zeros((3, 4, 2))).shape == (3, 4, 2, 2)


@pytest.mark.parametrize("n", [1, 2])
def test_mobility_is_three_n_minus_two_c5_minus_c4(n):
    found = Scene(links=[Link(mass=1, length=1)] * n).mobility()
    assert found == pc.Mobility(links=n, c5=n, c4=0, degrees_of_freedom=n)
    assert found.degrees_of_freedom == 3 * found.links - 2 * found.c5 - found.c4


def test_angles_from_the_vertical_and_back():
    theta = [0.0, pi / 2, pi]  # hanging, to the right, upright
    np.testing.assert_allclose(pc.angles_from_vertical(theta), [pi / 2, 0, -pi / 2], atol=1e-16)
    assert pc.angles_to_vertical(pi / 2) == 0.0
    assert np.array_equal(pc.angles_to_vertical(pc.angles_from_vertical(theta)), theta)


def test_angles_from_upright_and_back():
    theta = [0.0, pi / 2, -pi / 2, -pi]  # upright, to the left, to the right, hanging
    q = pc.angles_from_vertical(theta, zero="upright")
    assert np.array_equal(q, [-pi / 2, -pi, 0, pi / 2])
    assert np.array_equal(pc.angles_to_vertical(q, zero="upright"), theta)
    x, y = np.cos(q), np.sin(q)  # right and down
    np.testing.assert_allclose(x, -np.sin(theta), atol=1e-15)  # counter-clockwise as seen
    np.testing.assert_allclose(y, -np.cos(theta), atol=1e-15)


@given(x=st.floats(-100, 100))
@pytest.mark.parametrize("zero", ["hanging", "upright"])
def test_an_angle_from_a_vertical_comes_back_from_it(zero, x):
    there = pc.angles_from_vertical(x, zero=zero)
    assert abs(pc.angles_to_vertical(there, zero=zero) - x) <= np.spacing(102.0)


@pytest.mark.parametrize("zero", ["up", "Upright", "", None, 1, ["upright"]])
@pytest.mark.parametrize("turn", [pc.angles_from_vertical, pc.angles_to_vertical])
def test_another_vertical_than_the_two_is_refused_and_both_are_named(turn, zero):
    wanted = re.escape(f'zero = {zero!r}: must be "hanging" or "upright"')
    with pytest.raises(ValueError, match=f"^{wanted}$"):
        turn(0.0, zero=zero)


def test_more_inertia_than_the_rod_could_have_is_warned_of_once_and_by_name():
    rod = Link(mass=1, length=1)
    with pytest.warns(pc.PendcoreWarning, match=r"^link 2: inertia = 5") as caught:
        scene = Scene(links=[rod, Link(mass=1, length=1, inertia=5)])
    assert len(caught) == 1
    assert caught[0].filename == __file__
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert pickle.loads(pickle.dumps(scene)) == scene


def test_a_lock_is_not_in_the_mass_matrix_and_what_locked_joints_need_is_said():
    rod = pc.Link(mass=1.0, length=1.0)
    free = pc.Scene(links=[rod, rod], effects=[pc.effects.Payload(0.5)])
    locked = free.replace(effects=[*free.effects, pc.effects.Lock(2)])
    q = [0.3, 1.1]
    assert np.array_equal(locked.mass_matrix(q), free.mass_matrix(q))
    assert not np.array_equal(free.mass_matrix(q), free.replace(effects=[]).mass_matrix(q))
    qdd = locked.accelerations(0.0, q, [2.0, 2.0])
    assert qdd[0] == qdd[1]
    assert "It ignores locks" in (pc.Scene.mass_matrix.__doc__ or "")
    assert "its rate, ``qd_i - qd_{i-1}``, must be" in (pc.Scene.accelerations.__doc__ or "")


def test_numbers_that_are_not_finite_have_the_same_sign_on_every_processor():
    """Processors give the NaN of inf - inf different signs."""
    scene = pc.Scene.textbook()
    found = scene.accelerations(0.0, [0.0, 0.0], [1e200, 1e200])
    assert np.isnan(found).all()
    assert not np.signbit(found).any()
