"""The pure-Python reference is right before anything is compared with it; no core is needed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from reference import dormand_prince
from reference.arithmetic import DOUBLE, Number, multiple_precision
from reference.effects import Motor
from reference.newton_euler import Body, Motion, uniform_rod
from reference.order_conditions import order_of, trees
from reference.rig import Rig

pytestmark = pytest.mark.unsanitized

BODIES = [
    Body(1.3, 0.8, 0.5, 0.02), Body(0.2, 1.7, 0.1, 0.3),
    Body(4.0, 0.3, 0.3, 0.0), uniform_rod(0.7, 1.1),
]  # fmt: skip
Q, QD, COUPLES = [0.3, -2.1, 4.0, 1.2], [1.5, -3.0, 0.2, 6.0], [0.4, -0.7, 2.0, 0.1]
GRAVITY = 9.81
FIFTY = multiple_precision(50)
MOTORS = [Motor(joint=j, constant=couple) for j, couple in enumerate(COUPLES, start=1)]
RIG = Rig(bodies=BODIES, gravity=GRAVITY, effects=MOTORS, arithmetic=FIFTY)
ROOTED_TREES = [1, 1, 2, 4, 9, 20, 48, 115]  # of 1, 2, ... nodes


def moved(s: Number) -> tuple[list[Number], list[Number]]:
    """Return angles and rates a short time s later, to the second and first order in s."""
    qdd = RIG.motion(0, Q, QD).accelerations
    number = FIFTY.number
    q = [number(x) + s * number(w) + s * s / 2 * a for x, w, a in zip(Q, QD, qdd, strict=True)]
    return q, [number(w) + s * a for w, a in zip(QD, qdd, strict=True)]


def derivative(f: Callable[[Number], Number], order: int = 1) -> Number:
    """Differentiate a function of the short time s at s = 0, to about 20 digits."""
    s = FIFTY.number("1e-12")
    if order == 1:
        return (f(s) - f(-s)) / (2 * s)
    return (f(s) - 2 * f(0 * s) + f(-s)) / s**2


@pytest.fixture(scope="module")
def motion() -> Motion:
    return RIG.motion(0, Q, QD)


@pytest.mark.parametrize("axis", [0, 1])
@pytest.mark.parametrize("i", range(len(BODIES)))
def test_mass_centres_move_as_newton_says_and_as_their_positions_do(i, axis, motion) -> None:
    acceleration = motion.center_accelerations[i][axis]
    position = derivative(lambda s: RIG.instant(0, *moved(s)).mass_center(i + 1)[axis], 2)
    assert abs(acceleration - position) < 1e-18
    mass, reactions = FIFTY.number(BODIES[i].mass), [*motion.reactions, (0, 0)]
    weight = mass * FIFTY.number(GRAVITY) if axis == 1 else 0
    force = reactions[i][axis] - reactions[i + 1][axis] + weight
    assert abs(force - mass * acceleration) < 1e-40


def test_the_energy_grows_by_the_power_of_the_couples() -> None:
    power = derivative(lambda s: sum(RIG.energy(0, *moved(s))))
    relative_rates = np.diff([0.0, *QD])
    assert float(power) == pytest.approx(float(np.dot(COUPLES, relative_rates)), rel=1e-14)


def test_the_angular_momentum_grows_by_the_moments_about_the_pivot() -> None:
    centers = RIG.instant(0, Q, QD).mass_centers()
    moment = sum(b.mass * GRAVITY * x for b, (x, *_) in zip(BODIES, centers, strict=True))
    rate = derivative(lambda s: RIG.angular_momentum(*moved(s)))
    assert float(rate) == pytest.approx(float(moment + COUPLES[0]), rel=1e-14)


def test_doubles_and_fifty_digits_agree(motion) -> None:
    double = replace(RIG, arithmetic=DOUBLE).motion(0, Q, QD)
    for name, rtol in (("accelerations", 1e-12), ("reactions", 1e-11)):
        exact = np.array(getattr(motion, name), dtype=float)
        np.testing.assert_allclose(getattr(double, name), exact, rtol=rtol)


def test_the_tableau_has_order_five_and_four() -> None:
    found = [trees(nodes) for nodes in range(1, 9)]
    assert [len(set(some)) for some in found] == [len(some) for some in found] == ROOTED_TREES
    assert order_of(dormand_prince.A, dormand_prince.B) == 5
    assert order_of(dormand_prince.A, dormand_prince.B_FOURTH_ORDER) == 4
    assert [sum(row) for row in dormand_prince.A] == dormand_prince.C
