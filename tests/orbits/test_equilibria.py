"""Equilibria and their modes agree with closed forms, and with eigenvalues in forty digits."""

from __future__ import annotations

import itertools
import warnings

import mpmath
import numpy as np
import pendcore as pc
import pytest

E = pc.effects
TEXTBOOK = pc.Scene.textbook()
NATURAL = [np.sqrt(TEXTBOOK.gravity * (3 + sign * 6 / np.sqrt(7))) for sign in (-1, 1)]


def squared_rates(signs, gravity):
    """Growth rates squared of equal rods of 1 kg and 1 m that hang (1) or stand (-1), exactly.

    About such a pose M dq'' = -K dq, with M_ij = s_i s_j A_ij and K_ii = s_i a_i g.
    """
    n = len(signs)
    a = [mpmath.mpf(1) / 2 + n - 1 - i for i in range(n)]
    mass = mpmath.matrix(n)
    for i, j in itertools.product(range(n), repeat=2):
        own = mpmath.mpf(1) / 3 + n - 1 - i if i == j else a[max(i, j)]
        mass[i, j] = own * signs[i] * signs[j]
    stiff = mpmath.diag([-x * s * mpmath.mpf(gravity) for x, s in zip(a, signs, strict=True)])
    values = mpmath.eig(mpmath.inverse(mass) * stiff, left=False, right=False)
    return sorted(float(mpmath.re(x)) for x in values)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_rods_that_hang_or_stand_are_all_found_and_have_their_rates(n):
    scene = TEXTBOOK.replace(links=[pc.Link(mass=1.0, length=1.0)] * n)
    found = pc.equilibria(scene)
    assert len(found) == 2**n == len({one.name for one in found})
    for one in found:
        signs = [1 if word == "down" else -1 for word in one.name.split("-")]
        with mpmath.workdps(40):
            squares = squared_rates(signs, scene.gravity)
        frequencies = np.sqrt([-x for x in squares if x < 0])[::-1]
        growth = np.sqrt([x for x in squares if x > 0])[::-1]
        np.testing.assert_allclose(one.frequencies, frequencies, rtol=1e-13)
        np.testing.assert_allclose(one.growth, growth, rtol=1e-13)
        np.testing.assert_allclose(one.q, np.pi / 2 * np.array(signs), atol=1e-14)
        assert one.energy == pytest.approx(
            -scene.gravity * sum(s * (n - 0.5 - i) for i, s in enumerate(signs)), abs=1e-12
        )
        values, vectors = one.eigenvalues, one.eigenvectors
        A = scene.linearize(one.q).A
        assert np.abs(A @ vectors - vectors * values).max() < 1e-12 * np.abs(values).max() ** 2


def test_every_mode_of_four_rods_that_goes_on_becomes_an_orbit():
    scene = TEXTBOOK.replace(links=[pc.Link(mass=1.0, length=1.0)] * 4)
    for one in pc.equilibria(scene):
        for mode, w in enumerate(one.frequencies, 1):
            orbit = one.orbit(mode, amplitude=0.05)
            assert orbit.closure < 1e-12
            assert orbit.corrections <= 6
            assert orbit.period == pytest.approx(2 * np.pi / w, rel=0.02)


def test_two_rods_have_the_frequencies_of_the_textbook():
    hanging, _, _, upright = pc.equilibria(TEXTBOOK)
    np.testing.assert_allclose(hanging.frequencies, NATURAL, rtol=1e-14)
    np.testing.assert_allclose(upright.growth, NATURAL[::-1], rtol=1e-14)


@pytest.mark.parametrize(
    ("damping", "kinds"),
    [
        (0.0, ["centre", "saddle-centre", "saddle-centre", "saddle"]),
        (0.1, ["sink", "saddle", "saddle", "saddle"]),
        (-0.1, ["source", "saddle", "saddle", "saddle"]),
    ],
)
def test_kinds(damping, kinds):
    with warnings.catch_warnings(action="ignore"):  # a damping below 0 is allowed, and told
        effects = [E.ViscousJoint(joint=j, damping=damping) for j in (1, 2)] if damping else []
        scene = TEXTBOOK.replace(effects=effects)
    assert [one.kind for one in pc.equilibria(scene)] == kinds


def test_without_gravity_every_pose_is_degenerate():
    (found,) = pc.equilibria(TEXTBOOK.replace(gravity=0.0), near=[0.3, -0.4])
    assert found.kind == "degenerate"
    np.testing.assert_array_equal(found.q, [0.3, -0.4])


def test_a_soft_spring_holds_a_rod_where_its_torque_and_that_of_weight_balance():
    """Upright, with k < m g L/2, it leans: k x = m g L/2 sin x, where x is from upright."""
    spring = E.TorsionalSpring(joint=1, stiffness=3.0, rest_angle=-np.pi / 2)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], gravity=10.0, effects=[spring])
    lean = float(mpmath.findroot(lambda x: 3 * x - 5 * mpmath.sin(x), 1.5))
    (found,) = pc.equilibria(scene, near=[-np.pi / 2 + 1.2])
    np.testing.assert_allclose(found.q, [-np.pi / 2 + lean], rtol=1e-14)
    assert found.name == ""
    assert found.kind == "centre"
    np.testing.assert_allclose(found.frequencies**2, (3 - 5 * np.cos(lean)) * 3, rtol=1e-13)


def test_a_locked_joint_has_no_mode():
    straight = TEXTBOOK.replace(effects=[E.Lock(joint=2, angle=0.0)])
    hanging = pc.equilibria(straight)[0]
    np.testing.assert_allclose(hanging.frequencies, np.sqrt(TEXTBOOK.gravity * 3 / 4), rtol=1e-14)
    np.testing.assert_allclose(np.abs(hanging.eigenvectors[:2]), 1.0)


def test_what_sticks_or_is_no_mode_is_refused():
    sticky = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=2, coulomb=0.3)])
    stopped = TEXTBOOK.replace(effects=[E.JointStop(joint=2, range=(-1, 1))])
    for scene, kind in ((sticky, "dry_joint_friction"), (stopped, "joint_stop")):
        told = rf"scene: effect 1 \({kind}\): where it holds a joint, no motion is linear: leave"
        with pytest.raises(ValueError, match=told):
            pc.equilibria(scene)
    told_of_modes = [
        "mode = 0: must be 1 to 2: so many modes neither grow nor decay here",
        "mode = 0: must be 1, the only mode that neither grows nor decays here",
        "mode = 0: must be 1, the only mode that neither grows nor decays here",
        "mode = 0: there is none: every mode grows or decays here",
    ]
    for one, told in zip(pc.equilibria(TEXTBOOK), told_of_modes, strict=True):
        with pytest.raises(ValueError, match=told):
            one.orbit(0)
    with pytest.raises(ValueError, match=r"near = None: 11 links have 2\*\*11 poses"):
        pc.equilibria(TEXTBOOK.replace(links=[pc.Link(mass=1.0, length=1.0)] * 11))
