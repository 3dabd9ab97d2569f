"""The errata of the source, each shown by computation; docs/reference/errata.md names the tests."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from reference import printed_equations as printed
from reference.arithmetic import multiple_precision
from reference.dormand_prince import Array, Run, StepTooSmallError, integrate
from reference.newton_euler import Body, newton_euler, uniform_rod
from reference.printed_equations import ALL_REPAIRS, AS_PRINTED, Instant, Pendulum, Repairs
from reference.rig import Rig

G = 9.807
TEXTBOOK = Pendulum()
UNEQUAL = Pendulum(m1=2.5, m2=0.4, L1=0.7, L2=1.6)
START = [math.pi / 4, math.pi / 3, 0.0, 0.0]
STATES = np.random.default_rng(2).uniform(-3, 3, (20, 4)).tolist()
FORTY = multiple_precision(40)


def bodies(p: Pendulum) -> list[Body]:
    return [uniform_rod(p.m1, p.L1), uniform_rod(p.m2, p.L2)]


def true_instant(p: Pendulum, gravity: float, state: list[float]) -> Instant:
    """Return an instant under Newton's laws; gravity < 0 is the same pendulum with y upward."""
    q1, q2, w1, w2 = state
    motion = newton_euler(bodies(p), gravity, (q1, q2), (w1, w2))
    a1, a2 = motion.accelerations
    x, y = motion.reactions[1]
    return Instant(q1=q1, q2=q2, w1=w1, w2=w2, a1=a1, a2=a2, F21=(-x, -y))


def power(p: Pendulum, gravity: float, state: list[float], qdd: tuple[float, float]) -> float:
    """Return the rate of change of the energy under the given accelerations."""
    s, rig = FORTY.number("1e-15"), Rig(bodies=bodies(p), gravity=gravity, arithmetic=FORTY)

    def ahead(s: float) -> float:
        q = [x + s * w + s * s / 2 * a for x, w, a in zip(state[:2], state[2:], qdd, strict=True)]
        qd = [w + s * a for w, a in zip(state[2:], qdd, strict=True)]
        return sum(rig.energy(0, q, qd))

    return float((ahead(s) - ahead(-s)) / (2 * s))


DOWN, UP = "y downward", "y upward"
EQUATIONS = [
    (printed.determinant_of_2_1, {UP}),
    (printed.equation_2_2, {UP}),
    (printed.x_line_of_2_5, {DOWN, UP}),  # and with it (2.6)
    (printed.y_line_of_2_5, {UP}),  # and with it (2.7)
    (printed.determinant_of_2_5, {DOWN, UP}),
    (printed.equation_2_8, set()),
    (printed.x_line_of_2_9, {DOWN, UP}),
    (printed.y_line_of_2_9, {DOWN}),
    (printed.equation_2_10, set()),
    (printed.equation_2_11, set()),
    (printed.program_link_1, {DOWN}),
    (printed.program_link_2, {DOWN}),
]


@pytest.mark.parametrize(("equation", "holds"), EQUATIONS, ids=lambda x: getattr(x, "__name__", ""))
@pytest.mark.parametrize(("axis", "gravity"), [(DOWN, G), (UP, -G)], ids=["down", "up"])
def test_which_way_y_points_where_an_equation_holds(
    equation: printed.Equation, holds: set[str], axis: str, gravity: float
) -> None:
    for pendulum, state in itertools.product((TEXTBOOK, UNEQUAL), STATES):
        residual = equation(pendulum, true_instant(pendulum, gravity, state))
        assert (abs(residual) < 1e-11) == (axis in holds)


def test_2_5_has_the_mass_of_link_2_where_it_prints_m() -> None:
    p, s = UNEQUAL, true_instant(UNEQUAL, G, STATES[0])
    arm = (-p.L2 / 2 * math.cos(s.q2), -p.L2 / 2 * math.sin(s.q2))
    inertia = printed.cross(arm, (-s.F21[0], -s.F21[1])) / s.a2
    assert inertia == pytest.approx(p.m2 * p.L2**2 / 12)
    assert inertia != pytest.approx(p.m1 * p.L2**2 / 12)


def test_2_8_has_the_opposite_sign_of_the_determinant_it_comes_from() -> None:
    s = Instant(q1=0.3, q2=-1.1, w1=2.0, w2=0.4, a1=-3.0, a2=0.0, F21=(1.7, -2.9))
    assert printed.equation_2_8(UNEQUAL, s) == pytest.approx(
        -printed.determinant_of_2_5(UNEQUAL, s)
    )


def test_the_y_line_of_2_9_is_not_2_7_solved_for_the_force() -> None:
    s = Instant(q1=0.3, q2=-1.1, w1=2.0, w2=0.4, a1=-3.0, a2=5.0, F21=(1.7, -2.9))
    from_2_7 = s.F21[1] - printed.y_line_of_2_5(UNEQUAL, s)
    from_2_9 = s.F21[1] - printed.y_line_of_2_9(UNEQUAL, s)
    assert from_2_9 - from_2_7 == pytest.approx(2 * UNEQUAL.m2 * G)


def test_2_10_gives_the_two_weights_opposite_signs() -> None:
    at_rest = Instant(q1=0.0, q2=0.0, w1=0.0, w2=0.0, a1=0.0, a2=0.0)
    moment = -printed.equation_2_10(UNEQUAL, at_rest)
    p = UNEQUAL
    assert moment == pytest.approx((-p.m1 / 2 + p.m2) * G * p.L1)
    repaired = -printed.equation_2_10(UNEQUAL, at_rest, Repairs(weight_of_link_1=True))
    assert repaired == pytest.approx((p.m1 / 2 + p.m2) * G * p.L1)


def test_2_10_has_the_wrong_mass_which_equal_masses_hide() -> None:
    p, mended = UNEQUAL, Repairs(mass_of_link_1=True)
    q = (0.4, 1.9)
    difference = np.subtract(
        printed.printed_mass_matrix(p, q, mended), printed.printed_mass_matrix(p, q)
    )
    expected = [[(p.m1 - p.m2) * p.L1**2 / 3, 0.0], [0.0, 0.0]]
    np.testing.assert_allclose(difference, expected, atol=1e-15)
    assert printed.printed_mass_matrix(TEXTBOOK, q, mended) == printed.printed_mass_matrix(
        TEXTBOOK, q
    )


def test_2_11_gives_link_2_a_negative_inertia() -> None:
    p = UNEQUAL
    assert printed.printed_mass_matrix(p, (0.4, 1.9))[1][1] == pytest.approx(-p.m2 * p.L2**2 / 6)
    mended = printed.printed_mass_matrix(p, (0.4, 1.9), ALL_REPAIRS)
    assert mended[1][1] == pytest.approx(p.m2 * p.L2**2 / 3)


@pytest.mark.parametrize("gravity", [G, -G], ids=["down", "up"])
@pytest.mark.parametrize("sign_of_g", [1, -1])
def test_as_printed_energy_is_not_conserved_for_either_sign_of_g(
    gravity: float, sign_of_g: int
) -> None:
    p = Pendulum(g=sign_of_g * G)
    for state in STATES:
        qdd = printed.printed_accelerations(p, tuple(state[:2]), tuple(state[2:]))
        assert abs(power(p, gravity, state, qdd)) > 1e-6  # W; rounding leaves 1e-13


def test_the_program_conserves_energy() -> None:
    for pendulum, state in itertools.product((TEXTBOOK, UNEQUAL), STATES):
        qdd = printed.program_accelerations(pendulum, tuple(state[:2]), tuple(state[2:]))
        assert abs(power(pendulum, G, state, qdd)) < 1e-12


@pytest.mark.parametrize("chosen", list(itertools.product([False, True], repeat=3)))
def test_all_three_repairs_are_needed_and_they_suffice(chosen: tuple[bool, bool, bool]) -> None:
    repairs = Repairs(
        weight_of_link_1=chosen[0], mass_of_link_1=chosen[1], sign_of_moment=chosen[2]
    )
    for state in STATES:
        q, qd = tuple(state[:2]), tuple(state[2:])
        mended = printed.printed_accelerations(UNEQUAL, q, qd, repairs)
        program = printed.program_accelerations(UNEQUAL, q, qd)
        assert np.allclose(mended, program, rtol=1e-12) == all(chosen)
        assert (abs(power(UNEQUAL, G, state, mended)) < 1e-11) == all(chosen)


SINGULAR_ANGLE = math.asin(1 / 3)  # 19.47 degrees


@pytest.mark.parametrize("pendulum", [TEXTBOOK, UNEQUAL], ids=["equal", "unequal"])
def test_the_printed_mass_matrix_is_singular_at_19_47_degrees(pendulum: Pendulum) -> None:
    assert math.degrees(SINGULAR_ANGLE) == pytest.approx(19.47, abs=0.005)
    size = (pendulum.m2 * pendulum.L1 * pendulum.L2) ** 2

    def determinant(difference: float) -> float:
        return float(np.linalg.det(printed.printed_mass_matrix(pendulum, (0.7 + difference, 0.7))))

    for difference in (0.0, 0.2, 1.0, 2.5):
        expected = size * (math.cos(difference) ** 2 / 4 - 2 / 9)
        assert determinant(difference) == pytest.approx(expected, rel=1e-12)
    for side in (1, -1):
        assert abs(determinant(side * SINGULAR_ANGLE)) < 1e-15 * size
        below, above = (determinant(side * SINGULAR_ANGLE + d) for d in (-0.01, 0.01))
        assert below * above < 0


def run(p: Pendulum, t_end: float, *, as_printed: bool) -> Run:
    def f(_: float, y: Array) -> list[float]:
        q, qd = (y[0], y[1]), (y[2], y[3])
        if as_printed:
            return [*qd, *printed.printed_accelerations(p, q, qd, AS_PRINTED)]
        return [*qd, *printed.program_accelerations(p, q, qd)]

    return integrate(f, START, (0.0, t_end), rtol=1e-6, atol=1e-6)


@pytest.mark.parametrize(("sign_of_g", "time"), [(1, 0.0895), (-1, 0.0226)])
def test_from_the_texts_initial_state_the_printed_equations_break_down(
    sign_of_g: int, time: float
) -> None:
    with pytest.raises(StepTooSmallError) as error:
        run(Pendulum(g=sign_of_g * G), 5.0, as_printed=True)
    reached = error.value.run
    assert reached.t[-1] == pytest.approx(time, abs=5e-5)
    q1, q2, *rates = reached.y[-1]
    assert abs(q1 - q2) == pytest.approx(SINGULAR_ANGLE, abs=1e-6)
    assert max(np.abs(rates)) > 1000


def test_as_printed_the_textbooks_pendulum_gains_5_joules_in_0_08_s() -> None:
    def gain(r: Run, gravity: float) -> float:
        rig = Rig(bodies=bodies(TEXTBOOK), gravity=gravity)
        states = [y.tolist() for y in (r.y[0], r.y[-1])]
        start, end = (sum(rig.energy(0, y[:2], y[2:])) for y in states)
        return float(end - start)

    wrong = run(TEXTBOOK, 0.08, as_printed=True)
    assert gain(wrong, G) == pytest.approx(5.18, abs=0.005)
    assert gain(wrong, -G) == pytest.approx(5.67, abs=0.005)
    assert abs(gain(run(TEXTBOOK, 0.08, as_printed=False), G)) < 1e-6
