"""Stick and slip in turn, against closed forms and a reference in many digits (stick_slip.py)."""

from __future__ import annotations

import functools
import itertools
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from mpmath import mp, mpf
from pendcore import effects as fx
from stick_slip import DIGITS, Hum, Slide, slides
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
def solved(frequency: float, **hum: float) -> tuple[Hum, list[Slide], float]:
    """The slides in CYCLES turns of the torque, in many digits, and a time in a late stick."""
    turns = CYCLES * 2 * np.pi / frequency
    exact = Hum(frequency=mpf(frequency), **{name: mpf(value) for name, value in hum.items()})
    found = list(slides(exact, mpf(turns)))
    return exact, found, turns


def scene_of(frequency: float, amplitude: float, friction: float, bias: float) -> pc.Scene:
    hum = fx.Sinusoid(amplitude=amplitude, angular_frequency=frequency)
    motors = [fx.Motor(joint=1, sinusoid=hum), fx.Motor(joint=1, constant=bias)]
    return rod(*motors, fx.DryJointFriction(joint=1, coulomb=friction))


@pytest.mark.parametrize("frequency", [2.0, 0.01])
@pytest.mark.parametrize("hum", HUMS.values(), ids=HUMS.keys())
def test_under_a_sinusoidal_torque_each_slide_begins_and_ends_when_it_should(
    hum: dict[str, float], frequency: float, fine: Any
) -> None:
    with mp.workdps(DIGITS):
        _, found, turns = solved(frequency, **hum)
        sol = solve(scene_of(frequency, **hum), 0, 0, turns, **fine)
        assert sol.status == "finished"
        done = [slide for slide in found if slide.end < turns]
        scale = float(max(abs(slide.angle_at(slide.end)) for slide in done))
        for slide, after in itertools.pairwise(done):
            begin, end = float(slide.begin), float(slide.end)
            for switch in (begin, end):
                assert np.abs(sol.t - switch).min() < 1e-10 * switch
            middle = (slide.begin + slide.end) / 2
            exact = [slide.angle_at(middle), slide.rate(middle)]
            np.testing.assert_allclose(
                sol(float(middle)), [float(x) for x in exact], atol=1e-10 * max(scale, 1)
            )
            if after.begin > slide.end * (1 + mpf(10) ** -9):
                inside = np.linspace(end, float(after.begin), 7)[1:-1]
                states = sol(inside)
                np.testing.assert_array_equal(states[1], 0)  # not small: nothing
                assert np.ptp(states[0]) == 0
                assert states[0, 0] == pytest.approx(
                    float(after.angle), abs=1e-10 * max(scale, 1e-3)
                )


def test_what_the_motor_gives_is_what_friction_takes(fine: Any) -> None:
    """The staircase ends in the stick after the last slide; the work is the friction's path."""
    hum = HUMS["a staircase"]
    with mp.workdps(DIGITS):
        _, found, turns = solved(2.0, **hum)
        last = [slide for slide in found if slide.end < turns][-1]
        sol = solve(scene_of(2.0, **hum), 0, 0, float(last.end) + 1e-3, ledger=True, **fine)
        path = float(last.angle_at(last.end))
    ledger = sol.energy().ledger
    assert ledger.dry[-1] == pytest.approx(hum["friction"] * path, rel=1e-10)
    assert ledger.motor[-1] == pytest.approx(hum["friction"] * path, rel=1e-10)


def test_a_rod_towed_by_a_spring_touches_rest_in_passing_where_friction_is_constant(
    fine: Any,
) -> None:
    """Towed at v from v t k = tc on: phi' = v (1 - cos ws), which touches zero and slides on."""
    k, v, coulomb = 4.0, 0.05, 0.3
    spring = fx.TorsionalSpring(joint=1, stiffness=k)
    tow = fx.Motor(joint=1, table=fx.Table(t=[0, 100], torque=[0, 100 * k * v]))
    scene = rod(spring, tow, fx.DryJointFriction(joint=1, coulomb=coulomb))
    begin, w = coulomb / (k * v), np.sqrt(k)
    end = begin + 7.3 * 2 * np.pi / w
    sol = solve(scene, 0, 0, end, **fine)
    s = np.linspace(0, end - begin, 200)
    np.testing.assert_allclose(sol(begin + s)[0], v * s - v / w * np.sin(w * s), atol=1e-9)


@functools.cache
def towed(static: float, coulomb: float, ws: float, k: float, v: float) -> Any:
    """Stick and slip of a towed rod: three phases' begin, angle and end, by Taylor series."""

    def friction(w: Any) -> Any:
        return coulomb + (static - coulomb) * mp.exp(-((w / ws) ** 2))

    phases, phi = [], mpf(0)
    while len(phases) < 3:
        begin = (static / k + phi) / v

        def rates(_: Any, y: Any) -> list[Any]:
            # y: elongation of the spring, rate, angle
            return [v - y[1], k * y[0] - friction(y[1]), y[1]]

        motion = mpmath.odefun(rates, 0, [static / k, mpf(0), phi])
        step = mpf(1) / 20
        s = step
        while motion(s)[1] > 0:
            s += step
        low, high = s - step, s
        for _ in range(60):
            middle = (low + high) / 2
            low, high = (middle, high) if motion(middle)[1] > 0 else (low, middle)
        after = motion(low)[2]
        phases.append((begin, phi, begin + low, after))
        phi = after
    return phases


def test_stick_and_slip_of_a_rod_that_a_spring_tows_slowly(fine: Any) -> None:
    """The classic: static friction above the sliding one, a spring whose far end goes at v."""
    static, coulomb, ws, k, v = 0.5, 0.3, 0.2, 4.0, 0.02
    tow = fx.Motor(joint=1, table=fx.Table(t=[0, 100], torque=[0, 100 * k * v]))
    friction = fx.DryJointFriction(
        joint=1, coulomb=coulomb, static=static, stribeck_velocity=ws, exponent=2
    )
    scene = rod(fx.TorsionalSpring(joint=1, stiffness=k), tow, friction)
    sol = solve(scene, 0, 0, 30, **fine)
    assert sol.status == "finished"
    with mp.workdps(20):
        for begin, held, end, after in towed(static, coulomb, ws, k, v):
            for switch in (float(begin), float(end)):
                assert np.abs(sol.t - switch).min() < 1e-8
            assert sol(float(begin) - 1e-6)[1] == 0
            assert sol(float(begin) - 1e-6)[0] == pytest.approx(float(held), abs=1e-9)
            assert sol(float(end) + 1e-6)[1] == 0
            assert sol(float(end) + 1e-6)[0] == pytest.approx(float(after), abs=1e-9)
