"""The core agrees with the exact answers for a rod with an effect.

One uniform rod of mass M and length L on a fixed pivot, without gravity, unless a test says
otherwise; J is its moment of inertia about the pivot.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from numpy.typing import NDArray

Array = NDArray[np.float64]

M, L, G = 1.7, 0.6, 9.81
J = M * L**2 / 3
DOWN = np.pi / 2
T = np.linspace(0.0, 5.0, 101)


def rod(*effects: Any, gravity: float = 0.0, links: int = 1) -> pc.Scene:
    return pc.Scene(
        links=[pc.Link(mass=M, length=L)] * links, gravity=gravity, effects=list(effects)
    )


def solve(scene: pc.Scene, q: Any, qd: Any, t_end: float = 5.0, **options: Any) -> pc.Solution:
    told = {"rtol": 1e-13, "atol": 1e-15, **options}
    sol = pc.simulate(scene, q0=q, qd0=qd, t_span=(0.0, t_end), **told)
    assert sol.success
    return sol


# Damping ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("w0", [3.0, -3.0])
@pytest.mark.parametrize(
    ("damping", "rate"),
    [
        ({"damping": 0.3}, lambda t: np.exp(-0.3 * t / J)),
        ({"damping": 0.0, "damping2": 0.3}, lambda t: 1 / (1 + 0.3 * 3 * t / J)),
        ({"damping": 0.0, "damping3": 0.3}, lambda t: 1 / np.sqrt(1 + 2 * 0.3 * 3**2 * t / J)),
    ],
    ids=["linear", "quadratic", "cubic"],
)
def test_a_damped_rod_slows_down(
    damping: dict[str, float], rate: Callable[[Array], Array], w0: float
) -> None:
    sol = solve(rod(pc.effects.ViscousJoint(joint=1, **damping)), 0.2, w0)
    np.testing.assert_allclose(sol(T)[1], w0 * rate(T), rtol=1e-10, atol=1e-12)


def test_a_damped_rod_comes_as_far_as_its_momentum_lasts() -> None:
    sol = solve(rod(pc.effects.ViscousJoint(joint=1, damping=2.0)), 0.2, 3.0, 10.0)
    np.testing.assert_allclose(sol.q[-1], 0.2 + J * 3.0 / 2.0, rtol=1e-12)


@pytest.mark.parametrize("w0", [20.0, -20.0])
def test_drag_slows_a_rod_like_one_over_time(w0: float) -> None:
    drag = pc.effects.RodDrag(link=1, drag_coefficient=1.2, diameter=0.05, air_density=1.3)
    decay = 1.3 * 1.2 * 0.05 / 2 * L**4 / (4 * J)
    sol = solve(rod(drag), 0.2, w0)
    np.testing.assert_allclose(sol(T)[1], w0 / (1 + decay * abs(w0) * T), rtol=1e-11)
    turned = np.sign(w0) * np.log(1 + decay * abs(w0) * T) / decay
    np.testing.assert_allclose(sol(T)[0], 0.2 + turned, rtol=1e-11)


def test_a_rod_turns_into_the_wind_as_a_vane() -> None:
    """At rest along the wind it stays; a little off it, w is w0 + s qd with w0 = V times the angle.

    Without damping of its own the drag is of second order there: k V abs(V) x L^2/2 at rest.
    """
    wind, x = 8.0, 1e-3
    drag = pc.effects.RodDrag(link=1, drag_coefficient=1.2, diameter=0.05, wind=(wind, 0.0))
    scene = rod(drag)
    np.testing.assert_array_equal(scene.accelerations(0, [0.0], [0.0]), [0.0])
    moment = 1.225 * 1.2 * 0.05 / 2 * (wind * np.sin(x)) ** 2 * L**2 / 2
    for side in (1, -1):
        acceleration = scene.accelerations(0, [side * x], [0.0])
        np.testing.assert_allclose(acceleration, [-side * moment / J], rtol=1e-12)


# Springs and motors -----------------------------------------------------------------------------


def test_a_rod_on_a_spring_swings_harmonically() -> None:
    stiffness, rest = 4.0, 0.7
    spring = pc.effects.TorsionalSpring(joint=1, stiffness=stiffness, rest_angle=rest)
    w = np.sqrt(stiffness / J)
    sol = solve(rod(spring), 1.2, 2.0)
    q = rest + 0.5 * np.cos(w * T) + 2.0 / w * np.sin(w * T)
    np.testing.assert_allclose(sol(T)[0], q, atol=1e-10)


def test_a_rotor_makes_the_rod_slower() -> None:
    spring = pc.effects.TorsionalSpring(joint=1, stiffness=4.0)
    sol = solve(rod(spring, pc.effects.RotorInertia(joint=1, armature=2 * J)), 1.0, 0.0)
    np.testing.assert_allclose(sol(T)[0], np.cos(np.sqrt(4.0 / (3 * J)) * T), atol=1e-10)


def test_a_constant_torque_turns_the_rod_ever_faster() -> None:
    sol = solve(rod(pc.effects.Motor(joint=1, constant=0.8)), 0.1, -1.0)
    np.testing.assert_allclose(sol(T)[0], 0.1 - T + 0.4 / J * T**2, rtol=1e-12, atol=1e-12)


def test_a_sinusoidal_torque() -> None:
    torque = pc.effects.Sinusoid(amplitude=0.8, angular_frequency=3.0, phase=0.5)
    sol = solve(rod(pc.effects.Motor(joint=1, sinusoid=torque)), 0.1, -1.0)
    rate = -1.0 + 0.8 / (3 * J) * (np.cos(0.5) - np.cos(3 * T + 0.5))
    np.testing.assert_allclose(sol(T)[1], rate, atol=1e-11)


def integrated_twice(t: Array, knots: Array, torque: Array) -> Array:
    """The double integral of a torque that is linear between its knots, from rest at 0."""
    angles = []
    for end in t:
        angle = rate = 0.0
        for a, b, before, after in zip(knots, knots[1:], torque, torque[1:], strict=False):
            s = min(b, end) - a
            if s <= 0:
                break
            slope = (after - before) / (b - a)
            angle += rate * s + before * s**2 / 2 + slope * s**3 / 6
            rate += before * s + slope * s**2 / 2
        angles.append(angle)
    return np.array(angles)


KNOTS, TORQUE = np.array([0.0, 0.7, 0.75, 2.0, 5.0]), np.array([0.5, 2.0, -3.0, 1.0, 1.0])


@pytest.mark.parametrize("limit", [np.inf, 1.5])
def test_a_table_of_torques_is_followed_exactly_however_loose_the_tolerance(limit: float) -> None:
    """Between knots the angle is a cubic, which a step of order five takes without error.

    The point where the torque meets its limit is a knot as well.
    """
    table = pc.effects.Table(t=KNOTS, torque=TORQUE)
    motor = pc.effects.Motor(joint=1, table=table, limit=limit)
    edges = [
        a + (level - before) * (b - a) / (after - before)
        for a, b, before, after in zip(KNOTS, KNOTS[1:], TORQUE, TORQUE[1:], strict=False)
        for level in (limit, -limit)
        if (before - level) * (after - level) < 0
    ]
    knots = np.sort([*KNOTS, *edges])
    given = np.clip(np.interp(knots, KNOTS, TORQUE), -limit, limit)
    sol = solve(rod(motor), 0.0, 0.0, rtol=1e-3, atol=1e-3)
    exact = integrated_twice(T, knots, given) / J
    np.testing.assert_allclose(sol(T)[0], exact, rtol=1e-12, atol=1e-12)
    for knot in knots:
        assert np.abs(sol.t - knot).min() < 1e-12
    assert sol.stats.accepted < 60


def test_a_clipped_sinusoid_is_met_where_it_is_clipped() -> None:
    torque = pc.effects.Sinusoid(amplitude=2.0, angular_frequency=3.0)
    sol = solve(rod(pc.effects.Motor(joint=1, sinusoid=torque, limit=1.0)), 0.0, 0.0, rtol=1e-9)
    first = np.arcsin(0.5) / 3
    edges = [k * np.pi / 3 + side * first for k in range(5) for side in (1, -1)]
    edges = [edge for edge in edges if edge > 0]
    for edge in edges:
        assert np.abs(sol.t - edge).min() < 1e-10
    given = np.clip(2 * np.sin(3 * np.linspace(0, 5, 200001)), -1, 1)
    impulse = np.trapezoid(given, dx=5 / 200000)
    np.testing.assert_allclose(sol.qd[-1], impulse / J, rtol=1e-7)


def test_a_limited_servo_goes_along_a_parabola_and_then_rings_down() -> None:
    """PD: full torque until kp (r - q) - kd qd meets the limit, a damped oscillation from there."""
    kp, kd, r, limit = 2.0, 1.1, 2.0, 0.9
    servo = pc.effects.PD(kp=kp, kd=kd, reference=r)
    sol = solve(rod(pc.effects.Motor(joint=1, pd=servo, limit=limit)), 0.0, 0.0, 3.0)
    a = limit / J
    # kp (r - a t^2/2) - kd a t = limit
    edge = (-kd * a + np.sqrt((kd * a) ** 2 + 2 * kp * a * (kp * r - limit))) / (kp * a)
    assert np.abs(sol.t - edge).min() < 1e-11
    t = np.linspace(0, edge, 20)
    np.testing.assert_allclose(sol(t)[0], a * t**2 / 2, atol=1e-12)

    x, v = a * edge**2 / 2 - r, a * edge
    decay, ringing = kd / (2 * J), np.sqrt(kp / J - (kd / (2 * J)) ** 2)

    def free(s: Array) -> Array:
        swing = x * np.cos(ringing * s) + (v + decay * x) / ringing * np.sin(ringing * s)
        return np.asarray(r + np.exp(-decay * s) * swing)

    s = np.linspace(0, 3.0 - edge, 300)
    torque = kp * (r - free(s)) - kd * np.gradient(free(s), s)
    assert np.abs(torque[2:-2]).max() < limit  # never at its limit again
    np.testing.assert_allclose(sol(edge + s)[0], free(s), atol=1e-10)


def test_bang_bang() -> None:
    """A servo without damping is nearly always at its limit: the angle follows parabolas."""
    servo, limit, far = pc.effects.PD(kp=1e9, kd=0.0, reference=0.0), 0.9, 1.0
    sol = solve(rod(pc.effects.Motor(joint=1, pd=servo, limit=limit)), far, 0.0, rtol=1e-11)
    quarter = np.sqrt(2 * far * J / limit)
    turn = np.arange(int(5.0 / quarter) + 1)
    expected = np.array([1.0, 0.0, -1.0, 0.0])[turn % 4] * far
    # Over an angle of 1e-9 the torque is not at its limit, and the switch is rounded off.
    np.testing.assert_allclose(sol(turn * quarter)[0], expected, atol=1e-7)


# Constraints and drives -------------------------------------------------------------------------


@pytest.mark.parametrize("amplitude", [0.3, 2.0])
def test_two_rods_locked_straight_swing_as_one_of_twice_the_length(amplitude: float) -> None:
    parameter = mpmath.sin(mpmath.mpf(amplitude) / 2) ** 2
    period = float(4 * mpmath.ellipk(parameter) * mpmath.sqrt(mpmath.mpf(4) * L / (3 * G)))
    scene = rod(pc.effects.Lock(joint=2), gravity=G, links=2)
    sol = solve(scene, DOWN - amplitude, 0.0, 2 * period)
    quarters = period / 4 * np.arange(9)
    q = (sol(quarters) - DOWN) / amplitude
    np.testing.assert_allclose(q[0], np.tile([-1, 0, 1, 0], 3)[:9], atol=1e-9)
    np.testing.assert_array_equal(sol.q[:, 0], sol.q[:, 1])
    np.testing.assert_array_equal(sol.qd[:, 0], sol.qd[:, 1])


def test_a_rod_pulled_along_itself_passes_the_force_on() -> None:
    drive = pc.effects.Sinusoid(amplitude=0.2, angular_frequency=7.0, phase=0.3)
    sol = solve(rod(pc.effects.DrivenPivot(x=drive)), 0.0, 0.0, t_eval=T)
    np.testing.assert_array_equal(sol.q, 0.0)
    x, v = 0.2 * np.sin(7 * T + 0.3), 1.4 * np.cos(7 * T + 0.3)
    pull = np.stack([-49 * M * x, 0 * T], axis=1)
    np.testing.assert_allclose(sol.reactions()[:, 0], pull, atol=1e-12)
    np.testing.assert_allclose(sol.positions()[:, 0, 0], x, atol=1e-15)
    np.testing.assert_allclose(sol.positions()[:, 1, 0], x + L, atol=1e-15)
    np.testing.assert_allclose(sol.energy().kinetic, M * v**2 / 2, atol=1e-14)


def test_a_rod_on_a_shaken_pivot_swings_at_the_shaking_frequency() -> None:
    """Hanging, small angles x: J x'' = -(M G L/2) x + (M L/2) a(t), with a to the right (+x)."""
    amplitude, w = 1e-6, 3.0
    square = M * G * L / 2 / J
    drive = pc.effects.Sinusoid(amplitude=amplitude, angular_frequency=w)
    sol = solve(rod(pc.effects.DrivenPivot(x=drive), gravity=G), DOWN, 0.0, atol=1e-18)
    # An angle q = pi/2 + x moves the mass to the left: x'' + square x = -(M L/2J) w^2 A sin(w t).
    own = np.sqrt(square)
    forced = -M * L / 2 / J * w**2 * amplitude / (square - w**2)
    x = forced * (np.sin(w * T) - w / own * np.sin(own * T))
    np.testing.assert_allclose((sol(T)[0] - DOWN) / amplitude, x / amplitude, atol=1e-8)


def test_a_pivot_on_a_spline_lands_on_its_knots() -> None:
    knots = np.array([0.0, 0.4, 1.1, 2.3, 3.0])
    spline = pc.effects.Spline(t=knots, x=[0.0, 0.1, -0.2, 0.1, 0.0], y=[0.0] * 5)
    sol = solve(rod(pc.effects.DrivenPivot(spline=spline), gravity=G), 0.0, 0.0, 3.0)
    assert np.isin(knots, sol.t).all()
    np.testing.assert_allclose(
        sol.positions()[np.isin(sol.t, knots), 0, 0], [0.0, 0.1, -0.2, 0.1, 0.0], atol=1e-15
    )


# Time -------------------------------------------------------------------------------------------


def test_a_later_start_is_another_phase() -> None:
    def scene(later: float) -> pc.Scene:
        drive = pc.effects.Sinusoid(amplitude=0.1, angular_frequency=5.0, phase=5.0 * later)
        torque = pc.effects.Sinusoid(amplitude=0.8, angular_frequency=3.0, phase=3.0 * later)
        motor = pc.effects.Motor(joint=2, sinusoid=torque, limit=0.5)
        return rod(pc.effects.DrivenPivot(x=drive, y=drive), motor, gravity=G, links=2)

    told = {"rtol": 1e-12, "atol": 1e-13}
    at_once = pc.simulate(scene(7.0), q0=[0.3, 1.0], qd0=[1.0, -2.0], t_span=(0.0, 2.0), **told)
    later = pc.simulate(scene(0.0), q0=[0.3, 1.0], qd0=[1.0, -2.0], t_span=(7.0, 9.0), **told)
    t = np.linspace(0.0, 2.0, 50)
    np.testing.assert_allclose(later(7.0 + t), at_once(t), atol=1e-8)


def test_there_and_back_across_the_knots_of_a_table_and_a_spline() -> None:
    table = pc.effects.Table(t=KNOTS, torque=TORQUE)
    spline = pc.effects.Spline(t=KNOTS, x=[0.0, 0.1, 0.1, -0.2, 0.1], y=[0.0, 0.1, 0.0, 0.1, 0.1])
    servo = pc.effects.PD(kp=2.0, kd=0.1, reference=1.0)
    scene = rod(
        pc.effects.Motor(joint=1, table=table, limit=1.2),
        pc.effects.Motor(joint=2, pd=servo, limit=0.6),
        pc.effects.DrivenPivot(spline=spline),
        gravity=G,
        links=2,
    )
    told = {"rtol": 1e-12, "atol": 1e-13}
    there = pc.simulate(scene, q0=[0.3, 1.0], qd0=[1.0, -2.0], t_span=(0.0, 2.5), **told)
    back = pc.simulate(scene, q0=there.q[-1], qd0=there.qd[-1], t_span=(2.5, 0.0), **told)
    np.testing.assert_allclose(back.y[:, -1], there.y[:, 0], atol=1e-8)
    for knot in KNOTS[1:-1]:
        assert np.isin(knot, there.t)
        assert np.isin(knot, back.t)
