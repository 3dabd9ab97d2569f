"""The errata of the source, each shown by computation; docs/reference/errata.md names the tests."""

from __future__ import annotations

import itertools
import math

import numpy as np
import pytest
from reference import printed_equations as printed
from reference.arithmetic import multiple_precision
from reference.dormand_prince import StepTooSmallError, integrate
from reference.newton_euler import uniform_rod
from reference.printed_equations import AS_PRINTED, Instant, Pendulum, Repairs
from reference.rig import Rig

G = 9.807
TEXTBOOK = Pendulum()
UNEQUAL = Pendulum(m1=2.5, m2=0.4, L1=0.7, L2=1.6)
START = [math.pi / 4, math.pi / 3, 0.0, 0.0]
STATES = np.random.default_rng(2).uniform(-3, 3, (20, 4)).tolist()
FORTY = multiple_precision(40)


def bodies(p):
    return [uniform_rod(p.m1, p.L1), uniform_rod(p.m2, p.L2)]


def true_instant(p, gravity, state):
    """Return an instant under Newton's laws; gravity < 0 is the same pendulum with y upward."""
    q1, q2, w1, w2 = state
    motion = Rig(bodies=bodies(p), gravity=gravity).motion(0, (q1, q2), (w1, w2))
    a1, a2 = motion.accelerations
    x, y = motion.reactions[1]
    return Instant(q1=q1, q2=q2, w1=w1, w2=w2, a1=a1, a2=a2, F21=(-x, -y))


def power(p, gravity, state, qdd):
    """Return the rate of change of the energy under the given accelerations."""
    s, rig = FORTY.number("1e-15"), Rig(bodies=bodies(p), gravity=gravity, arithmetic=FORTY)

    def ahead(s):
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
def test_which_way_y_points_where_an_equation_holds(equation, holds, axis, gravity):
    for pendulum, state in itertools.product((TEXTBOOK, UNEQUAL), STATES):
        residual = equation(pendulum, true_instant(pendulum, gravity, state))
        assert (abs(residual) < 1e-11) == (axis in holds)


@pytest.mark.parametrize("gravity", [G, -G], ids=["down", "up"])
@pytest.mark.parametrize("sign_of_g", [1, -1])
def test_as_printed_energy_is_not_conserved_for_either_sign_of_g(gravity, sign_of_g):
    p = Pendulum(g=sign_of_g * G)
    for state in STATES:
        qdd = printed.printed_accelerations(p, tuple(state[:2]), tuple(state[2:]))
        assert abs(power(p, gravity, state, qdd)) > 1e-6  # W; rounding leaves 1e-13


def test_the_program_conserves_energy():
    for pendulum, state in itertools.product((TEXTBOOK, UNEQUAL), STATES):
        qdd = printed.program_accelerations(pendulum, tuple(state[:2]), tuple(state[2:]))
        assert abs(power(pendulum, G, state, qdd)) < 1e-12


@pytest.mark.parametrize("chosen", list(itertools.product([False, True], repeat=3)))
def test_all_three_repairs_are_needed_and_they_suffice(chosen):
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


def run(p, t_end, *, as_printed, tolerance=1e-6):
    def f(_, y):
        q, qd = (y[0], y[1]), (y[2], y[3])
        if as_printed:
            return [*qd, *printed.printed_accelerations(p, q, qd, AS_PRINTED)]
        return [*qd, *printed.program_accelerations(p, q, qd)]

    return integrate(f, START, (0.0, t_end), rtol=tolerance, atol=tolerance)


@pytest.mark.parametrize(("sign_of_g", "time"), [(1, 0.0895), (-1, 0.0226)])
def test_from_the_texts_initial_state_the_printed_equations_break_down(sign_of_g, time):
    with pytest.raises(StepTooSmallError) as error:
        run(Pendulum(g=sign_of_g * G), 5.0, as_printed=True, tolerance=1e-5)
    reached = error.value.run
    assert reached.t[-1] == pytest.approx(time, abs=5e-5)
    q1, q2, *rates = reached.y[-1]
    assert abs(q1 - q2) == pytest.approx(SINGULAR_ANGLE, abs=1e-6)
    assert max(np.abs(rates)) > 1000


def test_as_printed_the_textbooks_pendulum_gains_5_joules_in_0_08_s():
    def gain(r, gravity):
        rig = Rig(bodies=bodies(TEXTBOOK), gravity=gravity)
        states = [y.tolist() for y in (r.y[0], r.y[-1])]
        start, end = (sum(rig.energy(0, y[:2], y[2:])) for y in states)
        return float(end - start)

    wrong = run(TEXTBOOK, 0.08, as_printed=True)
    assert gain(wrong, G) == pytest.approx(5.18, abs=0.005)
    assert gain(wrong, -G) == pytest.approx(5.67, abs=0.005)
    assert abs(gain(run(TEXTBOOK, 0.08, as_printed=False), G)) < 1e-6
