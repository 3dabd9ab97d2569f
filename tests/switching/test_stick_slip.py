"""Stick and slip in turn, against closed forms and a reference in many digits (stick_slip.py)."""

from __future__ import annotations

import functools
import itertools

import mpmath
import numpy as np
import pytest
from mpmath import mp, mpf
from pendcore import effects as fx
from stick_slip import DIGITS, Hum, slides
from unit_rods import rod, solve

HUMS = {
    "both ways": {"amplitude": 1.0, "friction": 0.7, "bias": 0.0},
    "both ways, nearly held": {"amplitude": 1.0, "friction": 0.999, "bias": 0.0},
    "both ways, nearly free": {"amplitude": 1.0, "friction": 0.54, "bias": 0.0},
    "never at rest for long": {"amplitude": 1.0, "friction": 0.2, "bias": 0.0},
    "a staircase": {"amplitude": 0.5, "friction": 0.7, "bias": 0.4},
    "a staircase the other way": {"amplitude": 0.5, "friction": 0.7, "bias": -0.4},
}
CYCLES = 12


@functools.cache
def solved(name, frequency):
    """The scene, when CYCLES turns of the torque end, the slides until then in many digits."""
    hum, turns = HUMS[name], CYCLES * 2 * np.pi / frequency
    exact = Hum(frequency=mpf(frequency), **{key: mpf(value) for key, value in hum.items()})
    found = [slide for slide in slides(exact, mpf(turns)) if slide.end < turns]
    sinusoid = fx.Sinusoid(amplitude=hum["amplitude"], angular_frequency=frequency)
    motors = [fx.Motor(joint=1, sinusoid=sinusoid), fx.Motor(joint=1, constant=hum["bias"])]
    return rod(*motors, fx.DryJointFriction(joint=1, coulomb=hum["friction"])), turns, found


@pytest.mark.few_cases
@pytest.mark.parametrize("frequency", [2.0, 0.01])
@pytest.mark.parametrize("hum", HUMS)
def test_under_a_sinusoidal_torque_each_slide_begins_and_ends_when_it_should(hum, frequency, fine):
    with mp.workdps(DIGITS):
        scene, turns, found = solved(hum, frequency)
        sol = solve(scene, 0, 0, turns, **fine)
        assert sol.status == "finished"
        scale = float(max(abs(slide.angle_at(slide.end)) for slide in found))
        for slide, after in itertools.pairwise(found):
            begin, end = float(slide.begin), float(slide.end)
            for switch in (begin, end):
                assert np.abs(sol.t - switch).min() < 1e-10 * switch
            middle = (slide.begin + slide.end) / 2
            exact = [float(slide.angle_at(middle)), float(slide.rate(middle))]
            np.testing.assert_allclose(sol(float(middle)), exact, atol=1e-10 * max(scale, 1))
            if after.begin > slide.end * (1 + mpf(10) ** -9):
                angles, rates = sol(np.linspace(end, float(after.begin), 7)[1:-1])
                assert not rates.any()  # not small: nothing
                assert np.ptp(angles) == 0
                assert angles[0] == pytest.approx(float(after.angle), abs=1e-10 * max(scale, 1e-3))


def test_what_the_motor_gives_is_what_friction_takes(fine):
    """The staircase ends in the stick after the last slide; the work is the friction's path."""
    with mp.workdps(DIGITS):
        scene, _, found = solved("a staircase", 2.0)
        path = float(found[-1].angle_at(found[-1].end))
        sol = solve(scene, 0, 0, float(found[-1].end) + 1e-3, ledger=True, **fine)
    ledger = sol.energy().ledger
    for booked in (ledger.dry, ledger.motor):
        assert booked[-1] == pytest.approx(HUMS["a staircase"]["friction"] * path, rel=1e-10)


STIFFNESS = 4.0


def towed(v, **friction):
    """A rod on a spring whose far end goes at v."""
    tow = fx.Motor(joint=1, table=fx.Table(t=[0, 100], torque=[0, 100 * STIFFNESS * v]))
    spring = fx.TorsionalSpring(joint=1, stiffness=STIFFNESS)
    return rod(spring, tow, fx.DryJointFriction(joint=1, **friction))


def test_a_rod_towed_by_a_spring_touches_rest_in_passing_where_friction_is_constant(fine):
    """Towed at v from v t k = tc on: phi' = v (1 - cos ws), which touches zero and slides on."""
    v, coulomb, w = 0.05, 0.3, np.sqrt(STIFFNESS)
    begin = coulomb / (STIFFNESS * v)
    s = np.linspace(0, 7.3 * 2 * np.pi / w, 200)
    sol = solve(towed(v, coulomb=coulomb), 0, 0, begin + s[-1], **fine)
    np.testing.assert_allclose(sol(begin + s)[0], v * s - v / w * np.sin(w * s), atol=1e-9)


V, COULOMB, STATIC, STRIBECK = 0.02, 0.3, 0.5, 0.2


@functools.cache
def phases():
    """Stick and slip of a towed rod: three phases' begin, angle and end, by Taylor series."""

    def rates(_, y):  # elongation of the spring, rate, angle
        rubs = COULOMB + (STATIC - COULOMB) * mp.exp(-((y[1] / STRIBECK) ** 2))
        return [V - y[1], STIFFNESS * y[0] - rubs, y[1]]

    found, phi, step = [], mpf(0), mpf(1) / 20
    while len(found) < 3:
        begin = (STATIC / STIFFNESS + phi) / V
        motion = mpmath.odefun(rates, 0, [STATIC / STIFFNESS, mpf(0), phi])
        high = step
        while motion(high)[1] > 0:
            high += step
        low = high - step
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if motion(middle)[1] > 0 else (low, middle)
        found.append((begin, phi, begin + low, motion(low)[2]))
        phi = motion(low)[2]
    return found


@pytest.mark.few_cases
def test_stick_and_slip_of_a_rod_that_a_spring_tows_slowly(fine):
    """The classic: static friction above the sliding one, a spring whose far end goes at v."""
    friction = {"coulomb": COULOMB, "static": STATIC, "stribeck_velocity": STRIBECK, "exponent": 2}
    sol = solve(towed(V, **friction), 0, 0, 30, **fine)
    assert sol.status == "finished"
    with mp.workdps(20):
        for begin, held, end, after in phases():
            for switch, at_rest, angle in ((begin, -1e-6, held), (end, 1e-6, after)):
                assert np.abs(sol.t - float(switch)).min() < 1e-8
                q, qd = sol(float(switch) + at_rest)
                assert qd == 0
                assert q == pytest.approx(float(angle), abs=1e-9)
