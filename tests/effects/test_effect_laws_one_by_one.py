"""The reference laws one at a time: numbers, derivatives and limits that are known beforehand.

These tests need no core. Exact results are checked in fifty digits.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from reference.arithmetic import DOUBLE, Number, multiple_precision
from reference.effects import law
from reference.effects.natural_spline import natural_spline
from reference.effects.sinusoid import sinusoid
from reference.instant import Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Body, uniform_rod
from reference.random_rigs import address_of, between, links, polynomial
from reference.rig import Rig

FIFTY = multiple_precision(50)
S = FIFTY.number("1e-13")


def slope(f: Callable[[Number], Number]) -> Number:
    """Differentiate at 0, to about 25 digits."""
    return (f(S) - f(-S)) / (2 * S)


PAIR = [Body(1.3, 0.8, 0.5, 0.02), uniform_rod(0.7, 1.1)]
Q, QD = [0.3, -2.1], [1.5, -3.0]


def couples(kind: str, t: float = 0.4, **told: object) -> list[float]:
    """The couples that an effect in joint 2 puts on the two links."""
    loads = Loads(2)
    law((kind, {"joint": 2, **told})).act(Instant(bodies=PAIR, gravity=9.8, q=Q, qd=QD, t=t), loads)
    return [couple.value for couple in loads.couples]


@pytest.mark.parametrize(
    ("kind", "told", "couple"),
    [  # the joint is turned by -2.4 rad and turns by -4.5 rad/s
        ("viscous_joint", {"damping": 0.2}, 0.9),
        ("viscous_joint", {"damping": 0.2, "damping2": 0.1, "damping3": 0.02}, 4.7475),
        ("dry_joint_friction", {"coulomb": 0.7}, 0.7),
        (
            "dry_joint_friction",
            {"coulomb": 0.7, "static": 1.7, "stribeck_velocity": 4.5, "exponent": 3},
            0.7 + np.exp(-1),
        ),
        ("torsional_spring", {"stiffness": 2.0}, 4.8),
        ("torsional_spring", {"stiffness": 2.0, "rest_angle": 0.5}, 5.8),
        ("motor", {"constant": 3.0}, 3.0),
        ("motor", {"constant": -3.0, "limit": 2.0}, -2.0),
        ("motor", {"sinusoid": {"amplitude": 2, "angular_frequency": 1}}, 2 * np.sin(0.4)),
        ("motor", {"table": {"t": [0, 1, 2], "torque": [1, 2, 9]}}, 1.4),
        ("motor", {"table": {"t": [0, 1, 2], "torque": [1, 2, 9], "hold": True}}, 1.0),
        ("motor", {"table": {"t": [0, 0.4, 0.4, 2], "torque": [1, 2, 9, 9]}}, 9.0),
        ("motor", {"table": {"t": [0, 0.4, 2], "torque": [1, 2, 9]}}, 2.0),
        ("motor", {"pd": {"kp": 3, "kd": 0.5, "reference": 1}}, 3 * 3.4 + 0.5 * 4.5),
        ("motor", {"pd": {"kp": 3, "kd": 0.5, "reference": 1}, "limit": 8}, 8.0),
    ],
)
def test_a_couple_at_a_joint(kind: str, told: dict[str, object], couple: float) -> None:
    assert couples(kind, **told) == pytest.approx([-couple, couple], rel=1e-14)


@settings(max_examples=200)
@given(*[between(-5, 5)] * 4, links())
def test_drag_along_the_rod_is_what_the_polynomials_of_a_linear_speed_integrate_to(
    wx: float, wy: float, angle: float, rate: float, link: Body
) -> None:
    """The formulas of the design, which split where the speed changes sign."""
    drag = law(
        (
            "rod_drag",
            {"link": 1, "drag_coefficient": 1.2, "diameter": 0.1, "wind": (wx, wy)},
        )
    )
    instant = Instant(
        bodies=[link],
        gravity=0.0,
        q=[angle],
        qd=[rate],
        pivot=PivotMotion(velocity=(0.3, -0.4)),
    )
    loads = Loads(1)
    drag.act(instant, loads)
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
    fx, fy = (component.value for component in loads.forces[0])
    assert (fx, fy) == pytest.approx(
        (-np.sin(angle) * force, np.cos(angle) * force), abs=1e-14 * size
    )
    about_joint = loads.couples[0].value + link.center * force
    assert about_joint == pytest.approx(moment, abs=1e-14 * size * length)


def test_a_compiled_function_is_called_as_a_python_function_is() -> None:
    instant = Instant(bodies=PAIR, gravity=9.8, q=Q, qd=QD, t=0.4)
    compiled, python = Loads(2), Loads(2)
    law(("compiled_user", {"address": address_of(0.3, -0.2, 1.1)})).act(instant, compiled)
    law(("user", {"function": polynomial(0.3, -0.2, 1.1)})).act(instant, python)
    by_hand = [0.12 + 0.2 * 2.4 - 1.1 * 1.5, 0.12 - 0.2 * 2.4 + 1.1 * 3.0]
    for loads in (compiled, python):
        values = [couple.value for couple in loads.couples]
        assert values == pytest.approx(by_hand, rel=1e-14)


def test_wind_along_a_rod_at_rest_does_nothing_and_across_it_pushes() -> None:
    instant = Instant(bodies=[uniform_rod(1, 2.0)], gravity=0.0, q=[0.0], qd=[0.0])
    told = {"link": 1, "drag_coefficient": 2.0, "diameter": 0.1, "air_density": 1.0}
    for wind, force in (((3.0, 0.0), 0.0), ((0.0, 3.0), 0.1 * 3**2 * 2)):
        loads = Loads(1)
        law(("rod_drag", {**told, "wind": wind})).act(instant, loads)
        assert loads.forces[0][1].value == pytest.approx(force, rel=1e-14)
        assert loads.couples[0].value == pytest.approx(0, abs=1e-14)


KNOTS, VALUES = [0.0, 0.5, 1.5, 1.75, 3.0], [1.0, -1.0, 0.3, 0.8, 0.0]


def spline(t: Number) -> tuple[Number, ...]:
    return natural_spline(t, KNOTS, VALUES, FIFTY)


def test_the_spline_goes_through_its_points_and_is_straight_at_the_ends() -> None:
    assert [float(spline(t)[0]) for t in KNOTS] == pytest.approx(VALUES, abs=1e-15)
    assert [spline(t)[2] for t in (KNOTS[0], KNOTS[-1])] == [0, 0]


@pytest.mark.parametrize("t", KNOTS[1:-1])
def test_the_splines_derivatives_do_not_jump_at_a_knot(t: float) -> None:
    for before, after in zip(spline(t - S), spline(t + S), strict=True):
        assert abs(after - before) < 1e-10


@pytest.mark.parametrize("motion", ["spline", "sinusoid"])
@pytest.mark.parametrize("t", [0.1, 0.7, 1.6, 2.9])
def test_rates_and_accelerations_are_derivatives(motion: str, t: float) -> None:
    told = {"amplitude": 1.5, "angular_frequency": 3.0, "phase": 0.4}

    def path(s: Number) -> tuple[Number, ...]:
        then = FIFTY.number(t) + s
        return spline(then) if motion == "spline" else sinusoid(then, told, FIFTY)

    _, rate, acceleration = path(FIFTY.number(0))
    assert abs(slope(lambda s: path(s)[0]) - rate) < 1e-20
    assert abs(slope(lambda s: path(s)[1]) - acceleration) < 1e-20


def test_the_spline_bends_least() -> None:
    """No curve through the points has a smaller integral of the squared acceleration."""

    def bending(other: float) -> float:
        total = 0.0
        for a, b in pairwise(KNOTS):
            for x, weight in zip(*np.polynomial.legendre.leggauss(5), strict=True):
                t = (a + b) / 2 + x * (b - a) / 2
                # The second derivative of (t - a)^2 (b - t)^2, which is zero at the knots.
                bump = 2 * ((b - t) ** 2 - 4 * (t - a) * (b - t) + (t - a) ** 2)
                acceleration = natural_spline(t, KNOTS, VALUES, DOUBLE)[2] + other * bump
                total += weight * (b - a) / 2 * acceleration**2
        return total

    assert bending(0.0) < bending(1e-3)
    assert bending(0.0) < bending(-1e-3)


def test_the_locked_joint_stays_and_what_hangs_on_it_swings_as_one_body() -> None:
    """Two rods locked straight are one rod of their masses and lengths."""
    halves = [uniform_rod(2.0, 0.5), uniform_rod(2.0, 0.5)]
    locked = Rig(bodies=halves, gravity=9.8, effects=[law(("lock", {"joint": 2}))])
    whole = Rig(bodies=[uniform_rod(4.0, 1.0)], gravity=9.8)
    pair, single = locked.motion(0, [0.7, 0.7], [2, 2]), whole.motion(0, [0.7], [2])
    assert pair.accelerations == pytest.approx(single.accelerations * 2, rel=1e-13)
    assert pair.reactions[0] == pytest.approx(single.reactions[0], rel=1e-13)


def test_a_payload_is_a_heavier_link() -> None:
    bare, load = Body(2.0, 1.0, 0.4, 0.1), {"mass": 3.0, "inertia": 0.2}
    center = (2.0 * 0.4 + 3.0 * 1.0) / 5.0
    inertia = 0.1 + 2.0 * (center - 0.4) ** 2 + 0.2 + 3.0 * (1.0 - center) ** 2
    loaded = Rig(bodies=[bare], gravity=9.8, effects=[law(("payload", load))])
    heavy = Rig(bodies=[Body(5.0, 1.0, center, inertia)], gravity=9.8)
    one, other = (rig.motion(0, [0.7], [2.0]) for rig in (loaded, heavy))
    assert one.accelerations == pytest.approx(other.accelerations, rel=1e-13)
    assert one.reactions[0] == pytest.approx(other.reactions[0], rel=1e-13)


def test_a_freely_falling_pivot_takes_the_weight_away() -> None:
    """In free fall only what turns keeps turning: no gravity is felt."""
    fall = {"t": [0.0, 1.0, 2.0], "x": [0.0] * 3, "y": [0.0, 1.0, 0.0]}
    driven = law(("driven_pivot", {"spline": fall}))
    acceleration = driven.pivot(1.0, DOUBLE).acceleration[1]  # type: ignore[union-attr]
    falling = Rig(bodies=PAIR, gravity=acceleration, effects=[driven]).motion(1.0, Q, QD)
    floating = Rig(bodies=PAIR, gravity=0.0).motion(1.0, Q, QD)
    assert falling.accelerations == pytest.approx(floating.accelerations, rel=1e-12)
    assert np.ravel(falling.reactions) == pytest.approx(np.ravel(floating.reactions), rel=1e-12)
