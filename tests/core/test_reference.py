"""The pure-Python reference is right before anything is compared with it; no core is needed."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import numpy as np
import pytest
from reference import chain, dormand_prince
from reference.arithmetic import Number, multiple_precision
from reference.conserved import angular_momentum, energy, mass_centers
from reference.newton_euler import Body, newton_euler, uniform_rod
from reference.order_conditions import StageWeights, misses, order_of, trees
from reference.trajectories import names, trajectory

pytestmark = pytest.mark.unsanitized

BODIES = [
    Body(1.3, 0.8, 0.5, 0.02),
    Body(0.2, 1.7, 0.1, 0.3),
    Body(4.0, 0.3, 0.3, 0.0),
    uniform_rod(0.7, 1.1),
]
Q, QD, COUPLES = [0.3, -2.1, 4.0, 1.2], [1.5, -3.0, 0.2, 6.0], [0.4, -0.7, 2.0, 0.1]
GRAVITY = 9.81
FIFTY = multiple_precision(50)


def moved(s: Number) -> tuple[list[Number], list[Number]]:
    """Return angles and rates a short time s later, to the second and first order in s."""
    qdd = newton_euler(BODIES, GRAVITY, Q, QD, couples=COUPLES, arithmetic=FIFTY).accelerations
    number = FIFTY.number
    q = [number(x) + s * number(w) + s * s / 2 * a for x, w, a in zip(Q, QD, qdd, strict=True)]
    return q, [number(w) + s * a for w, a in zip(QD, qdd, strict=True)]


def derivative(f: Callable[[Number], Number], order: int = 1) -> Number:
    """Differentiate a function of the short time s at s = 0, to about 20 digits."""
    s = FIFTY.number("1e-12")
    if order == 1:
        return (f(s) - f(-s)) / (2 * s)
    return (f(s) - 2 * f(0 * s) + f(-s)) / s**2


def test_mass_centre_accelerations_are_the_second_derivatives_of_the_positions() -> None:
    motion = newton_euler(BODIES, GRAVITY, Q, QD, couples=COUPLES, arithmetic=FIFTY)
    for i, acceleration in enumerate(motion.center_accelerations):
        for axis in (0, 1):

            def position(s: Number, i: int = i, axis: int = axis) -> Number:
                return mass_centers(BODIES, *moved(s), FIFTY)[i][axis]

            assert abs(acceleration[axis] - derivative(position, 2)) < 1e-18


def test_the_mass_centres_move_as_newton_says() -> None:
    motion = newton_euler(BODIES, GRAVITY, Q, QD, couples=COUPLES, arithmetic=FIFTY)
    reactions = [*motion.reactions, (0, 0)]
    for i, body in enumerate(BODIES):
        for axis, weight in ((0, 0), (1, FIFTY.number(body.mass) * FIFTY.number(GRAVITY))):
            force = reactions[i][axis] - reactions[i + 1][axis] + weight
            inertial = FIFTY.number(body.mass) * motion.center_accelerations[i][axis]
            assert abs(force - inertial) < 1e-40


def test_the_energy_grows_by_the_power_of_the_couples() -> None:
    power = derivative(lambda s: sum(energy(BODIES, GRAVITY, *moved(s), FIFTY)))
    relative_rates = np.diff([0.0, *QD])
    assert float(power) == pytest.approx(float(np.dot(COUPLES, relative_rates)), rel=1e-14)


def test_the_angular_momentum_grows_by_the_moments_about_the_pivot() -> None:
    centers = mass_centers(BODIES, Q, QD, FIFTY)
    moment = sum(b.mass * GRAVITY * x for b, (x, *_) in zip(BODIES, centers, strict=True))
    rate = derivative(lambda s: angular_momentum(BODIES, *moved(s), FIFTY))
    assert float(rate) == pytest.approx(float(moment + COUPLES[0]), rel=1e-14)


def test_doubles_and_fifty_digits_agree() -> None:
    double = newton_euler(BODIES, GRAVITY, Q, QD, couples=COUPLES)
    exact = newton_euler(BODIES, GRAVITY, Q, QD, couples=COUPLES, arithmetic=FIFTY)
    np.testing.assert_allclose(
        double.accelerations, np.array(exact.accelerations, dtype=float), rtol=1e-12
    )
    np.testing.assert_allclose(double.reactions, np.array(exact.reactions, dtype=float), rtol=1e-11)


def test_there_are_as_many_rooted_trees_as_known() -> None:
    found = [trees(nodes) for nodes in range(1, 9)]
    assert [len(set(some)) for some in found] == [1, 1, 2, 4, 9, 20, 48, 115]
    assert [len(some) for some in found] == [1, 1, 2, 4, 9, 20, 48, 115]


def test_the_tableau_has_order_five_and_four() -> None:
    assert order_of(dormand_prince.A, dormand_prince.B) == 5
    assert order_of(dormand_prince.A, dormand_prince.B_FOURTH_ORDER) == 4


def test_the_nodes_are_the_row_sums() -> None:
    assert [sum(row) for row in dormand_prince.A] == dormand_prince.C


def weights_within_the_step(theta: Fraction) -> list[Fraction]:
    """Return the weights of the stages in the continuous extension at ``theta``."""
    weights = []
    for i, (b, d) in enumerate(zip(dormand_prince.B, dormand_prince.D, strict=True)):
        start_bend = (i == 0) - b
        end_bend = b - (i == 6) - start_bend
        inner = start_bend + theta * (end_bend + (1 - theta) * d)
        weights.append(theta * (b + (1 - theta) * inner))
    return weights


@pytest.mark.parametrize("nodes", [1, 2, 3, 4])
def test_the_continuous_extension_has_order_four(nodes: int) -> None:
    weights = StageWeights(dormand_prince.A)
    # Both sides of a condition are polynomials of degree at most 5: equal if equal at 6 places.
    for theta in (Fraction(k, 7) for k in range(1, 7)):
        for tree in trees(nodes):
            assert misses(weights, weights_within_the_step(theta), tree, theta) == 0


def test_the_continuous_extension_is_what_the_integrator_evaluates() -> None:
    stages: list[float] = []

    def f(t: float, y: dormand_prince.Array) -> list[float]:
        stages.append(float(np.cos(3 * t) - y[0] ** 2))
        return stages[-1:]

    run = dormand_prince.integrate(f, [0.3], (0.0, 0.5), rtol=1.0, atol=1.0, first_step=0.5)
    assert run.accepted == 1
    for theta in (Fraction(1, 5), Fraction(2, 3), Fraction(1)):
        weights = [float(w) for w in weights_within_the_step(theta)]
        expected = 0.3 + 0.5 * np.dot(weights, stages)
        assert run(0.5 * float(theta))[0] == pytest.approx(expected, rel=1e-14)


# The largest error of an angle at rtol = atol = 1e-10: how sensitive each motion is.
BOUNDS = {
    "textbook": 2e-9,
    "textbook_long": 2e-7,
    "horizontal_rest": 1e-7,
    "high_energy": 1e-2,
    "unequal": 2e-6,
    "heavy_tip": 3e-10,
    "light_tip": 2e-9,
    "fast_spin": 3e-7,
    "no_gravity": 2e-8,
    "single_rod": 2e-7,
    "damped_textbook": 5e-10,
    "three_links": 1e-8,
    "ten_links": 5e-9,
}


@pytest.mark.parametrize("name", names())
def test_trajectories_follow_the_multiple_precision_ones(name: str) -> None:
    case = trajectory(name)
    run = chain.simulate(
        case.bodies,
        case.gravity,
        case.q0,
        case.qd0,
        (0.0, float(case.t[-1])),
        rtol=1e-10,
        atol=1e-10,
        damping=case.damping,
    )
    n = len(case.q0)
    error = max(np.abs(run(t)[:n] - q).max() for t, q in zip(case.t, case.q, strict=True))
    assert error < BOUNDS[name]


def test_a_backward_run_mirrors_a_forward_one() -> None:
    case = trajectory("textbook")
    span = float(case.t[-1])
    runs = [
        chain.simulate(case.bodies, 9.807, case.q0, case.qd0, (0.0, end), rtol=1e-8, atol=1e-8)
        for end in (span, -span)
    ]
    np.testing.assert_array_equal(np.array(runs[0].t), -np.array(runs[1].t))
    np.testing.assert_array_equal(np.array(runs[0].y)[:, :2], np.array(runs[1].y)[:, :2])
    np.testing.assert_array_equal(runs[0](1.234)[:2], runs[1](-1.234)[:2])
