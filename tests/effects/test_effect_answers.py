"""The core agrees with the exact answers for a rod with an effect.

One uniform rod of mass M and length L on a fixed pivot, without gravity, unless a test says
otherwise; J is its moment of inertia about the pivot.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from numpy.typing import NDArray
from pendcore import effects as fx
from reference.random_rigs import address_of
from reference.rig import LOSSES
from swings import time_to

Array = NDArray[np.float64]
OfTime = Callable[[Array, float], Array]

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


B, STIFFNESS, REST, TORQUE, W = 0.3, 4.0, 0.7, 0.8, 3.0
DECAY = 1.3 * 1.2 * 0.05 / 2 * L**4 / (4 * J)  # of the drag's acceleration, DECAY w^2
OWN, SLOWER = np.sqrt(STIFFNESS / J), np.sqrt(STIFFNESS / (3 * J))
SPRING = fx.TorsionalSpring(joint=1, stiffness=STIFFNESS, rest_angle=REST)
SINUSOID = fx.Sinusoid(amplitude=TORQUE, angular_frequency=W, phase=0.5)


def swing(frequency: float) -> OfTime:
    return lambda t, w: (
        REST + (0.2 - REST) * np.cos(frequency * t) + w / frequency * np.sin(frequency * t)
    )


def slowing(t: Array, w: float) -> Array:
    return np.asarray(w * np.exp(-B * t / J))


# The effects; the rate and the angle at time t after a start from 0.2 rad at w; whose work it is.
MOTIONS: dict[str, tuple[list[fx.Effect], OfTime | None, OfTime | None, str]] = {
    "J w' = -b w": (
        [fx.ViscousJoint(1, damping=B)],
        slowing, lambda t, w: 0.2 + J / B * (w - slowing(t, w)), "viscous",
    ),
    "J w' = -b w abs(w)": (
        [fx.ViscousJoint(1, damping=0.0, damping2=B)],
        lambda t, w: w / (1 + B * abs(w) * t / J), None, "viscous",
    ),
    "J w' = -b w^3": (
        [fx.ViscousJoint(1, damping=0.0, damping3=B)],
        lambda t, w: w / np.sqrt(1 + 2 * B * w**2 * t / J), None, "viscous",
    ),
    "drag: J w' = -k w abs(w) L^4/4": (
        [fx.RodDrag(1, drag_coefficient=1.2, diameter=0.05, air_density=1.3)],
        lambda t, w: w / (1 + DECAY * abs(w) * t),
        lambda t, w: 0.2 + np.sign(w) * np.log(1 + DECAY * abs(w) * t) / DECAY, "drag",
    ),
    "a user's J w' = -b w": ([fx.User(lambda t, q, qd: -B * qd)], slowing, None, "user"),
    "compiled J w' = -b w": ([fx.CompiledUser(address_of(0, 0, B))], slowing, None, "user"),
    "a constant torque": (
        [fx.Motor(1, constant=TORQUE)],
        lambda t, w: w + TORQUE / J * t, lambda t, w: 0.2 + w * t + TORQUE / J * t**2 / 2, "motor",
    ),
    "a sinusoidal torque": (
        [fx.Motor(1, sinusoid=SINUSOID)],
        lambda t, w: w + TORQUE / (W * J) * (np.cos(0.5) - np.cos(W * t + 0.5)), None, "motor",
    ),
    "a spring": ([SPRING], None, swing(OWN), ""),
    "a spring and a rotor of 2 J": (
        [SPRING, fx.RotorInertia(joint=1, armature=2 * J)], None, swing(SLOWER), "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("speed", [3.0, 20.0])
@pytest.mark.parametrize("name", MOTIONS)
def test_a_rod_turns_and_books_its_work_as_its_equation_is_solved(name: str, speed: float) -> None:
    effects, rate, angle, entry = MOTIONS[name]
    for w in (speed, -speed):
        sol = solve(rod(*effects), 0.2, w, ledger=True)
        found = {"q": sol(T)[0], "qd": sol(T)[1]}
        for which, exact in (("q", angle), ("qd", rate)):
            if exact:
                np.testing.assert_allclose(found[which], exact(T, w), rtol=1e-11, atol=1e-12)
        if entry:  # there is no other energy than J w^2/2
            assert rate
            change = J / 2 * (rate(sol.t, w) ** 2 - w**2)
            booked = getattr(sol.energy().ledger, entry)
            np.testing.assert_allclose(
                booked, -change if entry in LOSSES else change, rtol=1e-10, atol=1e-11
            )


def test_wind_gives_what_drag_and_the_rod_take() -> None:
    """The ledger keeps wind and drag apart: the drag's loss is never negative."""
    drag = fx.RodDrag(link=1, drag_coefficient=1.2, diameter=0.5, wind=(0.0, 9.0))
    sol = solve(rod(drag), 0.2, 0.0, 2.0, ledger=True)
    ledger = sol.energy().ledger
    assert ledger.wind[-1] > ledger.drag[-1] > 0
    kinetic = sol.energy().kinetic
    np.testing.assert_allclose(ledger.wind - ledger.drag, kinetic, atol=1e-10 * ledger.wind[-1])


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


KNOTS, TORQUES = np.array([0.0, 0.7, 0.75, 2.0, 5.0]), np.array([0.5, 2.0, -3.0, 1.0, 1.0])


@pytest.mark.parametrize("limit", [np.inf, 1.5])
def test_a_table_of_torques_is_followed_exactly_however_loose_the_tolerance(limit: float) -> None:
    """Between knots the angle is a cubic, which a step of order five takes without error.

    The point where the torque meets its limit is a knot as well.
    """
    motor = fx.Motor(joint=1, table=fx.Table(t=KNOTS, torque=TORQUES), limit=limit)
    edges = [
        a + (level - before) * (b - a) / (after - before)
        for a, b, before, after in zip(KNOTS, KNOTS[1:], TORQUES, TORQUES[1:], strict=False)
        for level in (limit, -limit)
        if (before - level) * (after - level) < 0
    ]
    knots = np.sort([*KNOTS, *edges])
    given = np.clip(np.interp(knots, KNOTS, TORQUES), -limit, limit)
    sol = solve(rod(motor), 0.0, 0.0, rtol=1e-3, atol=1e-3)
    exact = integrated_twice(T, knots, given) / J
    np.testing.assert_allclose(sol(T)[0], exact, rtol=1e-12, atol=1e-12)
    assert np.abs(sol.t - knots[:, None]).min(axis=1).max() < 1e-12
    assert sol.stats.accepted < 60


def test_a_limited_servo_goes_along_a_parabola_and_then_rings_down() -> None:
    """PD: full torque until kp (r - q) - kd qd meets the limit, a damped oscillation from there."""
    kp, kd, r, limit = 2.0, 1.1, 2.0, 0.9
    servo = fx.PD(kp=kp, kd=kd, reference=r)
    sol = solve(rod(fx.Motor(joint=1, pd=servo, limit=limit)), 0.0, 0.0, 3.0)
    a = limit / J
    # kp (r - a t^2/2) - kd a t = limit
    edge = (-kd * a + np.sqrt((kd * a) ** 2 + 2 * kp * a * (kp * r - limit))) / (kp * a)
    assert np.abs(sol.t - edge).min() < 1e-11
    t = np.linspace(0, edge, 20)
    np.testing.assert_allclose(sol(t)[0], a * t**2 / 2, atol=1e-12)

    x, v = a * edge**2 / 2 - r, a * edge
    decay, ringing = kd / (2 * J), np.sqrt(kp / J - (kd / (2 * J)) ** 2)
    s = np.linspace(0, 3.0 - edge, 300)
    swing = x * np.cos(ringing * s) + (v + decay * x) / ringing * np.sin(ringing * s)
    free = r + np.exp(-decay * s) * swing
    torque = kp * (r - free) - kd * np.gradient(free, s)
    assert np.abs(torque[2:-2]).max() < limit  # never at its limit again
    np.testing.assert_allclose(sol(edge + s)[0], free, atol=1e-10)


def test_bang_bang() -> None:
    """A servo without damping is nearly always at its limit: the angle follows parabolas."""
    servo, limit, far = fx.PD(kp=1e9, kd=0.0, reference=0.0), 0.9, 1.0
    sol = solve(rod(fx.Motor(joint=1, pd=servo, limit=limit)), far, 0.0, rtol=1e-11)
    quarter = np.sqrt(2 * far * J / limit)
    turn = np.arange(int(5.0 / quarter) + 1)
    expected = np.array([1.0, 0.0, -1.0, 0.0])[turn % 4] * far
    # Over an angle of 1e-9 the torque is not at its limit, and the switch is rounded off.
    np.testing.assert_allclose(sol(turn * quarter)[0], expected, atol=1e-7)


# Constraints and drives -------------------------------------------------------------------------


@pytest.mark.parametrize("hold", [fx.Lock(joint=2), fx.DryJointFriction(joint=2, coulomb=100.0)])
@pytest.mark.parametrize("amplitude", [0.3, 2.0])
def test_two_rods_held_straight_swing_as_one_of_twice_the_length(amplitude: float, hold) -> None:
    quarter = float(time_to(0, amplitude, G, 2 * L))
    scene = rod(hold, gravity=G, links=2)
    quarters = quarter * np.arange(9)
    sol = solve(scene, DOWN - amplitude, 0.0, quarters[-1])
    q = (sol(quarters) - DOWN) / amplitude
    np.testing.assert_allclose(q[0], np.tile([-1, 0, 1, 0], 3)[:9], atol=1e-9)
    np.testing.assert_array_equal(sol.q[:, 0], sol.q[:, 1])
    np.testing.assert_array_equal(sol.qd[:, 0], sol.qd[:, 1])


def test_a_rod_pulled_along_itself_passes_the_force_on_and_books_its_speed() -> None:
    drive = fx.Sinusoid(amplitude=0.2, angular_frequency=7.0, phase=0.3)
    # The rod does not turn, so that nothing but max_step keeps the steps short.
    scene = rod(fx.DrivenPivot(x=drive))
    sol = solve(scene, 0.0, 0.0, t_eval=T, max_step=0.005, ledger=True)
    np.testing.assert_array_equal(sol.q, 0.0)
    x, v = 0.2 * np.sin(7 * T + 0.3), 1.4 * np.cos(7 * T + 0.3)
    pull = np.stack([-49 * M * x, 0 * T], axis=1)
    np.testing.assert_allclose(sol.reactions()[:, 0], pull, atol=1e-12)
    np.testing.assert_allclose(sol.positions()[:, 0, 0], x, atol=1e-15)
    np.testing.assert_allclose(sol.positions()[:, 1, 0], x + L, atol=1e-15)
    kinetic = sol.energy().kinetic
    np.testing.assert_allclose(kinetic, M * v**2 / 2, atol=1e-14)
    np.testing.assert_allclose(sol.energy().ledger.drive, kinetic - kinetic[0], atol=1e-10)


def test_a_rod_on_a_shaken_pivot_swings_at_the_shaking_frequency() -> None:
    """Hanging, small angles x: J x'' = -(M G L/2) x + (M L/2) a(t), with a to the right (+x)."""
    amplitude, w = 1e-6, 3.0
    square = M * G * L / 2 / J
    drive = fx.Sinusoid(amplitude=amplitude, angular_frequency=w)
    sol = solve(rod(fx.DrivenPivot(x=drive), gravity=G), DOWN, 0.0, atol=1e-18)
    # An angle q = pi/2 + x moves the mass to the left: x'' + square x = -(M L/2J) w^2 A sin(w t).
    own = np.sqrt(square)
    forced = -M * L / 2 / J * w**2 * amplitude / (square - w**2)
    x = forced * (np.sin(w * T) - w / own * np.sin(own * T))
    np.testing.assert_allclose((sol(T)[0] - DOWN) / amplitude, x / amplitude, atol=1e-8)


# Time -------------------------------------------------------------------------------------------

START = {"q0": [0.3, 1.0], "qd0": [1.0, -2.0], "rtol": 1e-12, "atol": 1e-13}


def test_a_later_start_is_another_phase() -> None:
    def scene(later: float) -> pc.Scene:
        drive = fx.Sinusoid(amplitude=0.1, angular_frequency=5.0, phase=5.0 * later)
        torque = fx.Sinusoid(amplitude=0.8, angular_frequency=3.0, phase=3.0 * later)
        motor = fx.Motor(joint=2, sinusoid=torque, limit=0.5)
        return rod(fx.DrivenPivot(x=drive, y=drive), motor, gravity=G, links=2)

    at_once = pc.simulate(scene(7.0), t_span=(0.0, 2.0), **START)
    later = pc.simulate(scene(0.0), t_span=(7.0, 9.0), **START)
    t = np.linspace(0.0, 2.0, 50)
    np.testing.assert_allclose(later(7.0 + t), at_once(t), atol=1e-8)


def test_there_and_back_across_the_knots_of_a_table_and_a_spline() -> None:
    at, x, y = [0.0, 0.4, 1.1, 2.3, 5.0], [0.0, 0.1, 0.1, -0.2, 0.1], [0.0, 0.1, 0.0, 0.1, 0.1]
    scene = rod(
        fx.Motor(joint=1, table=fx.Table(t=KNOTS, torque=TORQUES), limit=1.2),
        fx.Motor(joint=2, pd=fx.PD(kp=2.0, kd=0.1, reference=1.0), limit=0.6),
        fx.DrivenPivot(spline=fx.Spline(t=at, x=x, y=y)),
        gravity=G,
        links=2,
    )
    there = pc.simulate(scene, t_span=(0.0, 2.5), **START)
    end = {"q0": there.q[-1], "qd0": there.qd[-1]}
    back = pc.simulate(scene, t_span=(2.5, 0.0), **(START | end))
    np.testing.assert_allclose(back.y[:, -1], there.y[:, 0], atol=1e-8)
    for sol in (there, back):
        assert np.isin([*KNOTS[1:-1], *at[:-1]], sol.t).all()
        pivots = dict(zip(sol.t, sol.positions()[:, 0], strict=True))
        for t, *pivot in zip(at[:-1], x[:-1], y[:-1], strict=True):
            np.testing.assert_allclose(pivots[t], pivot, atol=1e-15)
