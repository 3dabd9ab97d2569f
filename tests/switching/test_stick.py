"""What friction or a stop holds does not move at all, and is let go exactly when it must be.

Rods of moment of inertia 1 about the pivot, so that torques are accelerations.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import mpmath
import numpy as np
import pendcore as pc
import pytest
from carried import carried
from pendcore import effects as fx
from unit_rods import rod, solve, time_of_rest

METHODS = [method["name"] for method in pc._core.methods() if method["error_order"]]
G = 9.81
WEIGHT = 3 * G / 2  # torque of gravity on the horizontal rod
inf = np.inf


def rubbed(coulomb, joint=1, **more):
    return fx.DryJointFriction(joint=joint, coulomb=coulomb, **more)


def driven(amplitude, w, phase=0.0):
    return fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude, angular_frequency=w, phase=phase))


def by_table(t, torque):
    return fx.Motor(joint=1, table=fx.Table(t=t, torque=torque))


def never_moved(q, qd, still):
    return (q == still).all() and not qd.any()


# Held -------------------------------------------------------------------------------------------

HUMS = {
    "nothing": [],
    "motor": [driven(5.0, 0.3)],
    "pivot": [fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.1, angular_frequency=0.3))],
    "table": [by_table([0, 5e5, 1e6], [0, 5, -5])],
}


@pytest.mark.few_cases
@pytest.mark.unsanitized
@pytest.mark.parametrize("hum", HUMS)
def test_a_rod_held_at_30_degrees_under_a_hum_moves_by_nothing_in_1e6_s(hum, method):
    """Friction of twice what it needs: the hum takes up less than the other half."""
    scene = rod(rubbed(2 * WEIGHT * np.cos(np.pi / 6)), *HUMS[hum], gravity=G)
    sol = pc.simulate(scene, (0, 1e6), np.pi / 6, store="steps", method=method)
    assert sol.success
    assert sol.status == "at_rest" or (HUMS[hum] and sol.t[-1] == 1e6)
    assert never_moved(sol.q, sol.qd, np.pi / 6)


AT_1 = WEIGHT * (3 * np.cos(0.4) + np.cos(-0.7))  # torques on two rods at 0.4 and -0.7
AT_2 = WEIGHT * np.cos(-0.7)
HALF = WEIGHT * np.cos(np.pi / 6)
BALANCED = {  # friction in the joints, angles, whether these are held, how far the first falls
    "one rod held": ([HALF * (1 + 1e-12)], [-np.pi / 6], True, 0.0),
    "one rod not held": ([HALF * (1 - 1e-9)], [-np.pi / 6], False, np.pi / 6),
    "both held": ([AT_1 * (1 + 1e-9), AT_2 * (1 + 1e-9)], [0.4, -0.7], True, 0.0),
    "second not held": ([AT_1 * (1 + 1e-9), AT_2 * (1 - 1e-9)], [0.4, -0.7], False, 0.0),
    "first not held": ([AT_1 * (1 - 1e-9), AT_2 * (1 + 1e-9)], [0.4, -0.7], False, 0.0),
}


@pytest.mark.parametrize("rods", BALANCED)
def test_rods_at_rest_are_held_if_and_only_if_no_joint_is_short_by_a_billionth(rods, method):
    """A rod above the horizontal that begins to fall is pulled the more."""
    friction, q, held, falls = BALANCED[rods]
    frictions = [rubbed(most, joint=j) for j, most in enumerate(friction, 1)]
    scene = rod(*frictions, gravity=G, links=len(q))
    sol = solve(scene, q, 0, 10 if len(q) == 1 else 0.5, method=method)
    assert sol.success
    assert (sol.status == "at_rest" and time_of_rest(sol) == 0.0) == held
    assert bool((sol.q[-1] == q).all()) == held
    assert held or sol.q[-1, 0] > q[0] + falls - 1e-9


def test_a_joint_that_is_held_bent_moves_as_a_locked_one(fine):
    held, locked = (
        solve(rod(hold, gravity=G, links=3), [0.3, 1.2, 0.9], [1.0, 1.0, -2.0], 3, **fine)
        for hold in (rubbed(100.0, joint=2), fx.Lock(joint=2))
    )
    times = np.linspace(0, 3, 31)
    np.testing.assert_allclose(held(times), locked(times), atol=1e-9)
    assert (held.qd[:, 0] == held.qd[:, 1]).all()


@pytest.mark.parametrize(("links", "joint"), [(2, 1), (2, 2), (3, 2)])
def test_friction_in_a_locked_joint_changes_nothing(links, joint):
    def run(*effects):
        return solve(rod(*effects, gravity=G, links=links), 0.3, 0, 2, rtol=1e-11)

    lock, friction = fx.Lock(joint=joint), rubbed(0.3, joint=joint, static=0.5)
    times = np.linspace(0, 2, 50)
    for both in (run(lock, friction), run(friction, lock)):
        assert both.status == "finished"
        np.testing.assert_allclose(both(times), run(lock)(times), atol=1e-8)
        np.testing.assert_array_equal(both.relative_angles()[:, joint - 1], 0.3 * (joint == 1))


# Let go -----------------------------------------------------------------------------------------


class Release(NamedTuple):
    """A rod at rest at q is let go at the time `at`, to `within`; s later its motion is `moved(s)`.

    Where that has no closed form, `moved` is the side to which the rod goes.
    """

    effects: list[Any]
    q: float
    at: float
    lasts: float
    moved: Any
    within: float = 1e-13
    atol: float = 1e-12
    gravity: float = 0.0


def ramp(slope):
    """The torque grows by slope t to the friction of 0.5."""
    at, table = 0.5 / abs(slope), by_table([0, 1e4], [0, 1e4 * slope])
    within = 1e-13 * max(1, at)
    return Release(
        [table, rubbed(0.5)], 0.3, at, 2.0, lambda s: slope / 6 * np.array([s**3, 3 * s**2]), within
    )


def sine(amplitude, w, a, *hold, lasts, phase=0.0, **more):
    """From the angle a of the sine on, the torque is amplitude (sin(a + ws) - sin a)."""

    def moved(s):
        x = a + w * s
        angle = np.cos(a) * s / w - (np.sin(x) - np.sin(a)) / w**2 - np.sin(a) * s**2 / 2
        return amplitude * np.array([angle, (np.cos(a) - np.cos(x)) / w - np.sin(a) * s])

    effects = [driven(amplitude, w, phase), *hold]
    return Release(effects, at=(a - phase) / w, lasts=lasts, moved=moved, **more)


def leant(w, e):
    """-sin(wt) presses the rod on until pi/w, where the gap has a triple root."""
    hold = fx.JointStop(joint=1, range=(0, inf), restitution=e)
    return sine(-1.0, w, np.pi, hold, q=0, lasts=0.8 * np.pi / w, within=1e-9 / w, atol=1e-13)


def shaken(q, amplitude, w, torque, hold, **more):
    """The pivot's acceleration -amplitude w^2 sin(wt) along x turns a rod by 3/2 sin q of it."""
    drive = fx.DrivenPivot(x=fx.Sinusoid(amplitude=amplitude, angular_frequency=w))
    at = np.arcsin(torque / (1.5 * amplitude * w**2 * np.sin(q))) / w
    return Release([drive, hold], q, at, moved=-1, **more)


def served(s):
    """Phi'' = 0.2 s - 3 phi - 0.5 phi' from rest: the exponential of its matrix."""
    a = mpmath.matrix([[0, 1, 0, 0], [-3, -0.5, 0.2, 0], [0, 0, 0, 1], [0, 0, 0, 0]])
    ends = [mpmath.expm(a * one) * mpmath.matrix([0, 0, 0, 1]) for one in s]
    return [[float(end[row]) for end in ends] for row in (0, 1)]


SERVO = fx.Motor(
    joint=1, pd=fx.PD(kp=3.0, kd=0.5, reference=0.4)
)  # 0.3 of 0.5, and 0.2 t beside it
TURNED = by_table([0, 1, 3, 4], [-2, -2, 2, 2])
STOP, LEANING = fx.JointStop(joint=1, range=(0, inf)), np.pi / 2 - 0.2
PULLED_OFF = fx.JointStop(joint=1, range=(-inf, LEANING))
RELEASES = {
    **{f"torque of {slope} t": ramp(slope) for slope in (1e-3, 0.7, 40.0, -1e-3, -0.7, -40.0)},
    **{
        f"sine beyond {most}": sine(1.0, 3.0, np.arcsin(most), rubbed(most), q=0.3, lasts=0.05 / 3)
        for most in (0.2, 0.5, 0.99)
    },
    "shaken pivot": shaken(np.pi / 2, 0.2, 4.0, 1.1, rubbed(1.1), lasts=0.1),
    "shaken pivot, rod askew": shaken(0.4, 0.2, 4.0, 1.1, rubbed(1.1), lasts=0.1),
    "servo and ramp": Release(
        [SERVO, by_table([0, 9], [0, 1.8]), rubbed(0.5)], 0.3, 1.0, 0.2, served
    ),
    **{f"stop of e = {e}, w = {w}": leant(w, e) for w in (0.05, 3.0) for e in (0.0, 0.6)},
    "stop under a biased push": sine(
        -1.0, 2.0, np.pi - np.arcsin(0.3), fx.Motor(joint=1, constant=0.3), STOP,
        phase=np.pi / 2, q=0.0, lasts=0.2, within=1e-12,
    ),
    "stop under a shaken pivot": shaken(
        LEANING, 0.1, 6.0, WEIGHT * np.cos(LEANING), PULLED_OFF, lasts=0.05, within=1e-12, gravity=G
    ),
    "static friction above the sliding one": Release(
        [by_table([0, 10], [0, 10]), rubbed(0.4, static=0.9, stribeck_velocity=0.01)], 0.3, 0.9,
        0.6, 1,
    ),
    "stop and friction": Release(
        [TURNED, rubbed(0.5), STOP], 0.0, 2.25, 0.75, lambda s: (s**3 / 3, s**2), within=1e-12
    ),
}  # fmt: skip


@pytest.mark.parametrize("scene", RELEASES)
def test_a_rod_is_let_go_where_the_torque_exceeds_what_holds_it(scene):
    """A point of the run to the last bits, not the least motion before it, and its motion after."""
    effects, q, at, lasts, moved, within, atol, gravity = RELEASES[scene]
    held, s = rod(*effects, gravity=gravity), np.linspace(0.0125, 1, 10) * lasts
    exact = np.array(moved(s)) if callable(moved) else None
    for method in METHODS:
        how = {"method": carried(method, held), "rtol": 1e-12, "atol": 1e-14}
        sol = solve(held, q, 0, at + lasts, **how)
        assert sol.status == "finished"
        assert np.abs(sol.t - at).min() <= within, method
        before = sol.t < at - max(within, 1e-12 * at)
        assert before.any()
        assert never_moved(sol.q[before], sol.qd[before], q)
        if exact is not None:
            np.testing.assert_allclose(sol(at + s) - [[q], [0]], exact, rtol=1e-10, atol=atol)
            np.testing.assert_allclose(sol.y[:, -1], exact[:, -1] + [q, 0], rtol=1e-10)
        else:
            assert moved * (sol.q[-1, 0] - q) > 0
            assert moved * sol.qd[-1, 0] > 0


SETS_FREE_LATER = {
    "sinusoid": driven(1.0, 3.0),
    "table": by_table([0, 9], [0, 9]),
    "sinusoidal pivot": fx.DrivenPivot(y=fx.Sinusoid(amplitude=0.1, angular_frequency=3.0)),
    "spline": fx.DrivenPivot(spline=fx.Spline(t=[0, 4, 5, 9], x=[0, 0, 9, 0], y=[0, 0, 0, 0])),
    "function": fx.User(lambda t, q, qd: np.array([t])),
}


@pytest.mark.parametrize("w0", [0.0, 0.01])
@pytest.mark.parametrize("effect", SETS_FREE_LATER)
def test_rest_that_will_not_last_is_not_said_to_be_for_good(effect, w0):
    """The torque grows from zero and exceeds friction later: the rod sticks, and slides again."""
    sol = solve(rod(rubbed(0.5), SETS_FREE_LATER[effect]), np.pi / 2 - 1, w0, 8)
    assert sol.status == "finished"
    assert (sol.qd[:-1, 0] == 0.0).sum() > 1
    assert abs(sol.qd[:, 0]).max() > 0.01


def test_rest_that_lasts_is_told_without_a_reservation():
    for effect in (fx.Motor(joint=1, constant=0.4), fx.TorsionalSpring(joint=1, stiffness=0.1)):
        sol = solve(rod(rubbed(0.5), effect), 0, 0.1, 8)
        assert sol.status == "at_rest"
        assert "for good" in sol.message


# Comes to rest ----------------------------------------------------------------------------------


def test_friction_that_stops_the_rod_at_the_end_never_stops_it_later():
    """It slides for w0/tc: whether the run finishes there or finds rest is a matter of a bit."""
    for w0, coulomb in np.random.default_rng(4).uniform(0.1, 10, (200, 2)):
        t_end = w0 / coulomb
        sol = solve(rod(rubbed(coulomb)), 0, w0, t_end)
        assert sol.status in {"finished", "at_rest"}, sol.message
        assert t_end * (1 - 1e-13) <= sol.t[-1] <= t_end
        assert (np.diff(sol.t) > 0).all()
        np.testing.assert_allclose(sol.y[:, -1], [w0 * t_end / 2, 0], rtol=1e-12, atol=1e-12 * w0)


def test_a_joint_that_sticks_before_the_least_double_of_time_sticks_at_once():
    """The friction stops the joint within w/tc = 1.5e-434 s."""
    scene = rod(rubbed(1.8e150, stribeck_velocity=2.1e-61))
    sol = pc.simulate(scene, (0.0, 3.1e-322), q0=0.0, qd0=2.8e-284, first_step=1.5e-151)
    assert (sol.status, sol.stats.accepted, *sol.t) == ("at_rest", 0, 0.0, 3.1e-322)
    assert sol.qd[0] == sol.qd[-1] == 0.0


# Beside a stiff controller ----------------------------------------------------------------------


def servo(kp, kd, reference, coulomb, length):
    pd = fx.Motor(joint=2, pd=fx.PD(kp=kp, kd=kd, reference=reference))
    return pc.Scene(links=[pc.Link(mass=1, length=length)] * 2, effects=[rubbed(coulomb, 2), pd])


@pytest.mark.parametrize("k", range(0, 25, 3))
def test_a_slipping_joint_is_not_stopped_and_friction_gives_nothing_back(k):
    scene = servo(1e3, 5.0, 0.8, 0.5, 0.5)
    sol = pc.simulate(scene, (0, 4), [0.3 + 0.03 * k, 1.1 + 0.03 * k], ledger=True)
    ledger = sol.energy().ledger
    assert np.abs(np.diff(ledger.residual)).max() < 1e-5
    assert np.diff(ledger.dry).min() >= -1e-12


@pytest.mark.parametrize("kp", [1e4, 1e5])
@pytest.mark.parametrize("k", range(6))
def test_stick_beside_a_stiff_controller_gets_to_its_end(kp, k):
    scene = servo(kp, 1.0, 1.0, 0.3, 1.0)
    sol = pc.simulate(scene, (0, 5), [0.5 + 0.02 * k, 1.5 + 0.02 * k], max_steps=300_000)
    assert sol.success, sol.message
