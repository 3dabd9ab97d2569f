"""Stiff scenes: radau5 takes them, the others say what is wrong, the pairs change over."""

from __future__ import annotations

import math
import pickle
import re

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore.effects import PD, Motor, TorsionalSpring, ViscousJoint

BOOK = pc.Scene.textbook()
ROD = pc.Link(mass=1.0, length=1.0)
START = [0.8, 1.0]
METHODS = {method["name"]: method for method in pc._core.methods()}
PAIRS = [name for name, method in METHODS.items() if method["kind"] == "pair"]
IMPLICIT = ["radau5", *PAIRS]
EXPLICIT = ["dopri5", "dop853", "taylor"]
STIFF = {
    "damper": [ViscousJoint(joint=2, damping=1e6 / 3)],
    "spring": [TorsionalSpring(joint=2, stiffness=1e8, rest_angle=0.2)],
    "controller": [Motor(joint=2, pd=PD(kp=1e6, kd=1e3, reference=0.2))],
    "controller at its limit": [Motor(2, pd=PD(kp=1e7, kd=1e5, reference=0.5), limit=30.0)],
}
STIFF["damper and drag"] = [*STIFF["damper"], fx.RodDrag(2, drag_coefficient=1.2, diameter=0.03)]
STIFF["controller and friction"] = [
    *STIFF["controller"], fx.DryJointFriction(joint=1, coulomb=0.1, static=0.2)
]  # fmt: skip


def run(effects, t_end, q0=START, **how):
    effects = STIFF.get(effects, effects) if isinstance(effects, str) else effects
    return pc.simulate(pc.Scene(links=[ROD, ROD], effects=effects), (0, t_end), q0, **how)


# Right ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("effect", ["damper", "spring", "controller"])
@pytest.mark.parametrize("method", [*IMPLICIT, "auto"])
def test_what_cannot_turn_moves_as_if_it_were_locked(effect, method):
    """Damper, spring and controller give way by less than a ten-thousandth of a radian."""
    how = {} if method == "auto" else {"rtol": 1e-5, "atol": 1e-7}
    sol = run(effect, 0.5, method=method, max_steps=200_000, **how)
    assert sol.success
    locked = run([fx.Lock(joint=2)], 0.5, rtol=1e-12)
    within = 1e-5 if (effect, method) == ("spring", "auto") else 2e-4
    assert np.abs(sol.q[-1] - locked.q[-1]).max() < within


def test_a_damper_costs_radau5_no_more_steps_than_the_motion_does():
    sol = run("damper", 5, method="radau5")
    assert sol.success
    assert sol.stats.accepted + sol.stats.rejected < 1500
    assert sol.stats.njev == sol.stats.accepted
    assert sol.stats.nlu == 2 * (sol.stats.accepted + sol.stats.rejected)
    assert not sol.stats.stiff


def test_one_rod_in_honey_creeps_as_its_exact_solution():
    # without gravity w = w0 exp(-b t/J): after the transient of 1e-6 s the angle is w0 J/b
    honey = pc.Scene(links=[ROD], gravity=0, effects=[ViscousJoint(joint=1, damping=1e6 / 3)])
    sol = pc.simulate(honey, (0, 5), 0, 1.0, method="radau5", rtol=1e-8, atol=1e-14)
    assert sol.q[-1, 0] == pytest.approx(1e-6, rel=1e-6)
    assert abs(sol.qd[-1, 0]) < 1e-13


BESIDE_DOPRI5 = {  # rods, effects, end, tolerances, how far apart
    **{
        f"{n} rods": (
            [pc.Link(mass=1.0, length=0.5)] * n,
            [ViscousJoint(joint=n, damping=0.2), TorsionalSpring(joint=1, stiffness=3.0)],
            1, {"rtol": 1e-9}, 1e-6,
        )
        for n in (1, 3, 10)
    },
    "breaks and held joints": (
        [ROD] * 2,
        [
            fx.DryJointFriction(joint=1, coulomb=0.4),
            Motor(joint=2, table=fx.Table(t=[0, 1, 2], torque=[0, 3, -2])),
            ViscousJoint(joint=2, damping=0.1, damping2=0.2),
        ],
        2, {"rtol": 1e-10, "atol": 1e-12}, 1e-7,
    ),
}  # fmt: skip


@pytest.mark.parametrize("scene", BESIDE_DOPRI5)
def test_radau5_agrees_with_dopri5(scene):
    links, effects, t_end, how, within = BESIDE_DOPRI5[scene]
    made, start = pc.Scene(links=links, effects=effects), np.linspace(0.5, 1.2, len(links))
    one, other = (
        pc.simulate(made, (0, t_end), start, method=method, **how)
        for method in ("radau5", "dopri5")
    )
    assert one.status == other.status
    assert np.abs(one.y[:, -1] - other.y[:, -1]).max() < within


def test_no_fixed_step_that_was_not_solved_is_taken():
    """A step that is cut at a guard's zero is tried anew: it may fail where the whole did not."""
    scene = BOOK.replace(effects=[ViscousJoint(joint=2, damping=1e160, damping2=10.0)])
    how = {"method": "radau5", "step": 1e-4, "on_failure": "ignore"}
    for length in 10.0 ** np.arange(-14, -5):
        for t in (0.0, -2.5):
            sol = pc.simulate(scene, (t, t + length), [0.0, 0.3], [0.0, -1.1], **how)
            assert np.isfinite(sol.y).all()


# Said -------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("method", "damping"),
    [*((name, 1e6 / 3) for name in EXPLICIT), *(("dopri5", b) for b in (1e3, 1e5, 1e7))],
)
def test_a_damper_is_found_stiff_and_the_remedy_named(method, damping):
    """Within ten thousand steps, after which joint 2 has hardly moved."""
    effects, how = [ViscousJoint(joint=2, damping=damping)], {"method": method}
    sol = run(effects, 5, max_steps=10_000, on_failure="ignore", **how)
    assert sol.status == "max_steps"
    assert sol.stats.stiff
    assert sol.message.startswith("the cap on steps was reached (at t = ")  # more help little
    assert 'method="radau5"' in sol.message
    assert '"auto"' in sol.message
    # its rate decays within 1e-2/damping s
    assert np.abs(np.diff(sol.q[-1]) - 0.2).max() < 1e-2
    assert np.isfinite(sol.y).all()


@pytest.mark.parametrize("method", EXPLICIT)
def test_a_finished_run_that_was_stiff_says_so(method):
    sol = run("damper", 0.05, method=method)
    assert sol.success
    assert sol.stats.stiff
    since = re.search(r"from t = (\S+) s on the steps are limited by stability", sol.message)
    assert since is not None
    assert 0 < float(since[1]) < 0.05


@pytest.mark.parametrize("effect", ["spring", "controller"])
@pytest.mark.parametrize("method", ["dopri5", "radau5"])
def test_a_fast_mode_that_sets_the_steps_is_named(effect, method):
    start = [0.8, 1.001]  # off the rest angle: it swings
    sol = run(effect, 5, start, method=method, max_steps=10_000, on_failure="ignore")
    if method == "radau5" and effect == "controller":
        assert "fast mode" not in sol.message  # well damped: no matter to radau5
        return
    # phi'' = -k/J phi - c/J phi' with both rods free: J by the mass matrix
    by_torque = np.array([-1.0, 1.0]) @ np.linalg.solve(BOOK.mass_matrix(sol.q[-1]), [-1.0, 1.0])
    stiffness, damping = (1e8, 0.0) if effect == "spring" else (1e6, 1e3)
    omega = math.sqrt(stiffness * by_torque)
    told = sol.message.partition("a fast mode set ")[2]
    assert {"spring": "torsional_spring", "controller": "motor"}[effect] in told
    assert "in joint 2, from effect 1" in told
    frequency = float(told.partition("steps: ")[2].partition(" rad/s")[0])
    damped = float(told.partition("damping ratio ")[2].partition(",")[0])
    assert frequency == pytest.approx(omega, rel=6e-3)
    assert damped == pytest.approx(damping * by_torque / (2 * omega), rel=6e-3, abs=2e-3)


def test_a_fast_mode_is_told_in_the_joint_of_its_effect():
    # The free second link turns the other way: its joint turns more.
    how = {"method": "dopri5", "max_steps": 5_000, "on_failure": "ignore"}
    sol = run([TorsionalSpring(1, stiffness=1e6)], 1, [0.01, 0.0], **how)
    assert "in joint 1, from effect 1 (torsional_spring)" in sol.message


@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_swing_that_every_method_has_to_follow_is_not_stiff(method):
    swinging = [TorsionalSpring(joint=2, stiffness=1e5, rest_angle=0.2)]
    sol = run(swinging, 20, [0.8, 1.1], method=method)
    assert sol.stats.accepted > 3000
    assert not sol.stats.stiff
    assert "a fast mode set" in sol.message


@pytest.mark.parametrize("method", EXPLICIT)
def test_a_pendulum_has_no_fast_mode_however_long_it_runs(method):
    sol = run([], 1000, method=method)
    assert sol.stats.accepted > 2000
    assert sol.message == "reached the end of the interval"


def test_functions_of_the_users_are_said_to_be_differentiated_by_differences():
    sol = run([fx.User(lambda t, q, qd: -0.1 * qd)], 0.1, method="radau5")
    assert "derivatives of effect 1 (user) by differences" in sol.message


# Pairs ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_is_its_first_method_where_nothing_is_stiff(pair):
    times = np.linspace(0, 10, 57)
    one, other = (run([], 10, method=method) for method in (pair, METHODS[pair]["first"]))
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.y, other.y)
    assert np.array_equal(one(times), other(times))


@pytest.mark.parametrize(
    "case",
    [
        *((pair, "damper", START) for pair in [*PAIRS, "auto"]),
        ("auto", "damper and drag", START),
        ("auto", "controller", START),
        ("auto", "controller", [0.8, 1.3]),
        ("auto", "controller and friction", START),
        ("auto", "controller at its limit", START),
    ],
)
def test_a_pair_changes_over_once_and_says_when(case):
    pair, effects, q0 = case
    sol = run(effects, 5, q0, method=pair, max_steps=30_000)
    assert sol.success, sol.message
    assert sol.stats.stiff
    assert sol.stats.njev > 0
    since = re.search(r"stiff: went on with radau5 from t = (\S+) s", sol.message)
    assert since is not None
    exact, times = run(effects, 5, q0, method="radau5", rtol=1e-11), np.linspace(0, 5, 301)
    assert np.abs(sol(times[-1]) - exact(times[-1]))[:2].max() < 1e-6
    if effects == "damper":
        assert sol.stats.accepted < 10_000
        assert 0 < float(since[1]) < 0.02
        assert np.abs(sol(times) - exact(times))[:2].max() < 1e-6


@pytest.mark.parametrize("method", IMPLICIT)
@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("cap", [1, 10, 108, 114])  # stiffness: tested about step 100
def test_a_run_stopped_by_its_cap_goes_on_bit_by_bit(method, cap, compensated):
    how = {"method": method, "rtol": 1e-9, "compensated": compensated}
    stopped = run("controller", 2, [0.8, 1.1], max_steps=cap, on_failure="ignore", **how)
    assert stopped.status == "max_steps"
    resumed = pickle.loads(pickle.dumps(stopped)).resume(2)
    whole, times = run("controller", 2, [0.8, 1.1], **how), np.linspace(0, 2, 99)
    assert np.array_equal(whole.t, resumed.t)
    assert np.array_equal(whole.y, resumed.y)
    assert np.array_equal(whole(times), resumed(times))
    assert (whole.stats, whole.message) == (resumed.stats, resumed.message)
