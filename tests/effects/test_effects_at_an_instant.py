"""Exact answers at one instant: couples, drag, splines, and scenes that an effect makes another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from pendcore import effects as fx
from reference.effects import law
from reference.newton_euler import Body, uniform_rod
from reference.random_rigs import address_of, between, links, polynomial
from reference.rig import Rig
from sweeps import random_examples
from unit_rods import rod

SINE = {"amplitude": 2, "angular_frequency": 1}
PD = {"kp": 3, "kd": 0.5, "reference": 1}
STEP = {"t": [0, 0.4, 0.4, 2], "torque": [1, 2, 9, 9]}
RAMP = {"t": [0, 1, 2], "torque": [1, 2, 9]}
DRAG = {"link": 1, "drag_coefficient": 2.0, "diameter": 0.1, "air_density": 1.0}  # k = 0.1 kg/m^2
STRIBECK = {"coulomb": 0.7, "static": 1.7, "stribeck_velocity": 4.5, "exponent": 3}
COUPLES: list[tuple[str, dict[str, Any], float]] = [  # at 0.4 s, -2.4 rad and -4.5 rad/s, N m
    ("viscous_joint", {"damping": 0.2}, 0.9),
    ("viscous_joint", {"damping": 0.2, "damping2": 0.1, "damping3": 0.02}, 4.7475),
    ("dry_joint_friction", {"coulomb": 0.7}, 0.7),
    ("dry_joint_friction", STRIBECK, 0.7 + np.exp(-1)),
    ("torsional_spring", {"stiffness": 2.0}, 4.8),
    ("torsional_spring", {"stiffness": 2.0, "rest_angle": 0.5}, 5.8),
    ("motor", {"constant": 3.0}, 3.0),
    ("motor", {"constant": -3.0, "limit": 2.0}, -2.0),
    ("motor", {"sinusoid": SINE}, 2 * np.sin(0.4)),
    ("motor", {"table": RAMP}, 1.4),
    ("motor", {"table": RAMP | {"hold": True}}, 1.0),
    ("motor", {"table": STEP}, 9.0),
    ("motor", {"table": {"t": [0, 0.4, 2], "torque": [1, 2, 9]}}, 2.0),
    ("motor", {"pd": PD}, 3 * 3.4 + 0.5 * 4.5),
    ("motor", {"pd": PD, "limit": 8}, 8.0),
    ("rod_drag", DRAG, 0.1 * 4.5**2 / 4),  # the integral of k (w s)^2 s
    ("user", {"function": polynomial(0.3, -0.2, 1.1)}, 0.12 + 1.1 * 4.5),
    ("compiled_user", {"address": address_of(0.3, -0.2, 1.1)}, 0.12 + 1.1 * 4.5),
]


@pytest.mark.parametrize(("kind", "told", "couple"), COUPLES)
def test_a_couple_turns_a_rod_of_1_kg_m2(kind: str, told: dict[str, Any], couple: float) -> None:
    """The core's law and the reference's."""
    at = {} if "user" in kind or "link" in told else {"joint": 1}
    described, state = (kind, {**at, **told}), (0.4, [-2.4], [-4.5])
    bodies = [uniform_rod(3, 1)]
    found = scene_of(bodies, 0.0, [described]).accelerations(*state)
    reference = Rig(bodies=bodies, gravity=0.0, effects=[law(described)]).motion(*state)
    assert found.item() == pytest.approx(couple, rel=1e-14)
    assert reference.accelerations[0] == pytest.approx(couple, rel=1e-14)


def test_wind_turns_a_rod_into_it_as_a_vane() -> None:
    """At rest along the wind it stays; at an angle x to it, w = V sin x on all of the rod.

    Without damping of its own the drag is of second order there: k V abs(V) x L^2/2 at rest.
    """
    wind, k = 8.0, 1.225 * 1.2 * 0.05 / 2
    scene = rod(fx.RodDrag(link=1, drag_coefficient=1.2, diameter=0.05, wind=(wind, 0.0)))
    assert scene.accelerations(0, [0.0], [0.0]) == 0.0
    for x in (1e-3, -1e-3, np.pi / 2, -np.pi / 2):
        moment = -np.sign(x) * k * (wind * np.sin(x)) ** 2 / 2
        assert scene.accelerations(0, [x], [0.0]).item() == pytest.approx(moment, rel=1e-12)


UNLIKE = [Body(1.3, 0.8, 0.5, 0.02), uniform_rod(0.7, 1.1)]
FALL = {"t": [0.0, 1.0, 2.0], "x": [0.0] * 3, "y": [0.0, -1.0, 0.0]}  # at 1 s, 3 m/s^2 downward


def test_in_free_fall_nothing_has_weight() -> None:
    falling, floating = (
        pc.simulate(scene_of(UNLIKE, gravity, described), (1.0, 1.0), [0.3, -2.1], [1.5, -3.0])
        for gravity, described in ((3.0, [("driven_pivot", {"spline": FALL})]), (0.0, []))
    )
    np.testing.assert_allclose(falling.accelerations(), floating.accelerations(), rtol=1e-12)
    np.testing.assert_allclose(falling.reactions(), floating.reactions(), rtol=1e-12)


@settings(max_examples=random_examples(200))
@given(*[between(-5, 5)] * 4, links())
def test_drag_is_what_the_polynomials_of_a_linear_speed_integrate_to(wx, wy, angle, rate, link):
    """The formulas of the design, which split where the speed changes sign; the pivot moves."""
    told = {"link": 1, "drag_coefficient": 1.2, "diameter": 0.1, "wind": (wx, wy)}
    moves = {"x": {"amplitude": 0.3, "angular_frequency": 1.0},
             "y": {"amplitude": -0.4, "angular_frequency": 1.0}}  # fmt: skip
    k, length = 1.225 * 1.2 * 0.1 / 2, link.length
    w0 = -np.sin(angle) * (0.3 - wx) + np.cos(angle) * (-0.4 - wy)
    w1 = w0 + length * rate
    if w0 * w1 >= 0:
        sign = np.sign(w0 + w1)
        force = -k * sign * length * (w0**2 + w0 * w1 + w1**2) / 3
        moment = -k * sign * length**2 * (w0**2 + 2 * w0 * w1 + 3 * w1**2) / 12
    else:
        s, b = length * w0 / (w0 - w1), length * w1 / (w1 - w0)
        s0, s1 = np.sign([w0, w1])
        force = -k * (s0 * s * w0**2 + s1 * b * w1**2) / 3
        moment = -k * (s0 * s**2 * w0**2 / 12 + s1 * (s * b * w1**2 / 3 + b**2 * w1**2 / 4))
    # w0 is a difference of two speeds, and is as exact as these are.
    speed, wind = abs(w0) + abs(w1), np.hypot(0.3 - wx, -0.4 - wy)
    size = k * length * speed * (speed + wind)
    scene = scene_of([link], 0.0, [("rod_drag", told), ("driven_pivot", moves)])
    sol = pc.simulate(scene, (0.0, 0.0), [angle], [rate])
    inertia = link.inertia + link.mass * link.center**2
    found = sol.accelerations().item() * inertia
    assert found == pytest.approx(moment, abs=1e-14 * size * length)
    # The pivot holds what the mass centre takes and the air does not give.
    along, across = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
    inertial = link.mass * link.center * (found / inertia * across - rate**2 * along)
    loads = [size, np.abs(inertial).max()]
    assert sol.reactions()[0, 0] == pytest.approx(inertial - force * across, abs=2e-14 * max(loads))


def test_a_spline_of_three_knots_is_the_natural_cubic():
    """Along its rod, which does not turn: place, kinetic energy and force of the pivot."""
    t = np.linspace(0, 1, 11)
    scene = scene_of([uniform_rod(1.7, 0.6)], 0.0, [("driven_pivot", {"spline": FALL})])
    sol = pc.simulate(scene, (0, 1), np.pi / 2, t_eval=t)
    assert sol.positions()[:, 0, 1] == pytest.approx(-(3 * t - t**3) / 2, abs=1e-15)
    assert sol.energy().kinetic == pytest.approx(1.7 / 2 * (1.5 * (1 - t**2)) ** 2, abs=1e-14)
    assert sol.reactions()[:, 0, 1] == pytest.approx(1.7 * 3 * t, abs=1e-14)


# Signs of another source, as conventions.md has them: an arm that counts counter-clockwise, the
# planar elbow manipulator of Spong, Hutchinson, Vidyasagar, Robot Modeling and Control (2006),
# section 7.4. Its angles psi are relative, psi_1 from +x, and y points upward.
MASS, LENGTH, CENTER, INERTIA = (1.3, 0.8), (0.7, 0.5), (0.3, 0.2), (0.05, 0.02)
G = 9.81
KP, KD = 20.0, 3.0
TARGET = np.array([0.4, -0.3])
"""The angles psi at which springs and controllers rest, rad."""
PSI, PSI_DOT = np.array([0.9, -1.4]), np.array([1.1, -2.0])
THETA = np.cumsum(PSI)
CONVENTIONS = {
    "from x": -THETA,
    "from hanging": pc.angles_from_vertical(THETA + np.pi / 2),
    "from upright": pc.angles_from_vertical(THETA - np.pi / 2, zero="upright"),
}


def arm(torques: np.ndarray) -> np.ndarray:
    """Return the accelerations of psi, by the equations of the book."""
    (m1, m2), l1, (c1, c2), (i1, i2) = MASS, LENGTH[0], CENTER, INERTIA
    cosine, (w1, w2) = np.cos(PSI[1]), PSI_DOT
    d12 = m2 * (c2**2 + l1 * c2 * cosine) + i2
    d11 = m1 * c1**2 + m2 * (l1**2 + c2**2 + 2 * l1 * c2 * cosine) + i1 + i2
    h = -m2 * l1 * c2 * np.sin(PSI[1])
    weight = m2 * c2 * G * np.cos(THETA[1])
    rest = [
        h * w2 * w1 + h * (w1 + w2) * w2 + (m1 * c1 + m2 * l1) * G * np.cos(PSI[0]) + weight,
        -h * w1**2 + weight,
    ]
    return np.linalg.solve([[d11, d12], [d12, m2 * c2**2 + i2]], torques - rest)


PULLED = -KP * (PSI - TARGET) - KD * PSI_DOT
# Joint 1 from +x; joint 2 is relative, and has the same minus.
RESTS = [(1, -TARGET[0]), (2, -TARGET[1])]
CASES = {
    "constant": (
        np.array([2.5, -1.7]),
        [fx.Motor(joint=1, constant=-2.5), fx.Motor(joint=2, constant=1.7)],
    ),
    "controller": (
        PULLED,
        [fx.Motor(joint, pd=fx.PD(kp=KP, kd=KD, reference=rest)) for joint, rest in RESTS],
    ),
    "spring and damper": (
        PULLED,
        [fx.TorsionalSpring(joint, stiffness=KP, rest_angle=rest) for joint, rest in RESTS]
        + [fx.ViscousJoint(joint, damping=KD) for joint in (1, 2)],
    ),
    # A torque from the ground on the second link turns both of the arm's angles.
    "from the ground": (np.array([1.9, 1.9]), [fx.User(lambda t, q, qd: [0.0, -1.9])]),
}


@pytest.mark.parametrize("convention", CONVENTIONS)
@pytest.mark.parametrize("case", CASES)
def test_what_turns_an_arm_counter_clockwise_has_a_minus_here(case, convention):
    torques, effects = CASES[case]
    links = [
        pc.Link(mass=m, length=length, center=c, inertia=i)
        for m, length, c, i in zip(MASS, LENGTH, CENTER, INERTIA, strict=True)
    ]
    scene = pc.Scene(links=links, gravity=G, effects=effects)
    qdd = scene.accelerations(0.0, CONVENTIONS[convention], -np.cumsum(PSI_DOT))
    assert not np.allclose(arm(torques), arm(np.zeros(2)), rtol=0.1)
    np.testing.assert_allclose(-np.diff(qdd, prepend=0.0), arm(torques), rtol=1e-12)
