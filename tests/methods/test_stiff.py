"""Stiff scenes: radau5 takes them, the others say what is wrong, the pairs change over."""

from __future__ import annotations

import math
import pickle
import re
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.effects import PD, Motor, TorsionalSpring, ViscousJoint

BOOK = pc.Scene.textbook()
ROD = pc.Link(mass=1.0, length=1.0)
START, REST = [0.8, 1.0], 0.2
METHODS = {method["name"]: method for method in pc._core.methods()}
PAIRS = [name for name, method in METHODS.items() if method["kind"] == "pair"]
DAMPER = ViscousJoint(joint=2, damping=1e6 / 3)
SPRING = TorsionalSpring(joint=2, stiffness=1e8, rest_angle=REST)
CONTROLLER = Motor(joint=2, pd=PD(kp=1e6, kd=1e3, reference=REST))


def two_rods(*effects: Any) -> pc.Scene:
    return pc.Scene(links=[ROD, ROD], effects=list(effects))


def locked(t: float) -> pc.Solution:
    return pc.simulate(two_rods(pc.effects.Lock(joint=2)), q0=START, t_span=(0, t), rtol=1e-12)


@pytest.mark.parametrize("effect", [DAMPER, SPRING, CONTROLLER], ids=["damper", "spring", "pd"])
@pytest.mark.parametrize("method", ["radau5", *PAIRS])
def test_what_cannot_turn_moves_as_if_it_were_locked(effect: Any, method: str) -> None:
    """Damper, spring and controller give way by less than a ten-thousandth of a radian."""
    how = {"rtol": 1e-5, "atol": 1e-7, "max_steps": 200_000}
    sol = pc.simulate(two_rods(effect), q0=START, t_span=(0, 0.5), method=method, **how)
    assert sol.success
    assert np.abs(sol.q[-1] - locked(0.5).q[-1]).max() < 2e-4


def test_a_damper_costs_radau5_no_more_steps_than_the_motion_does() -> None:
    sol = pc.simulate(two_rods(DAMPER), q0=START, t_span=(0, 5), method="radau5")
    assert sol.success
    assert sol.stats.accepted + sol.stats.rejected < 1500
    assert sol.stats.njev == sol.stats.accepted
    assert sol.stats.nlu == 2 * (sol.stats.accepted + sol.stats.rejected)
    assert not sol.stats.stiff


def test_one_rod_in_honey_creeps_as_its_exact_solution() -> None:
    # without gravity w = w0 exp(-b t/J): after the transient of 1e-6 s the angle is w0 J/b
    scene = pc.Scene(links=[ROD], gravity=0, effects=[ViscousJoint(joint=1, damping=1e6 / 3)])
    sol = pc.simulate(scene, q0=0, qd0=1.0, t_span=(0, 5), method="radau5", rtol=1e-8, atol=1e-14)
    assert sol.q[-1, 0] == pytest.approx(1e-6, rel=1e-6)
    assert abs(sol.qd[-1, 0]) < 1e-13


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
def test_a_damper_is_found_stiff_within_ten_thousand_steps_and_the_remedy_named(
    method: str,
) -> None:
    sol = pc.simulate(
        two_rods(DAMPER),
        q0=START,
        t_span=(0, 5),
        method=method,
        max_steps=10_000,
        on_failure="ignore",
    )
    assert sol.status == "max_steps"
    assert sol.stats.stiff
    assert sol.message.startswith("the cap on steps was reached (at t = ")  # more help little
    assert 'method="radau5"' in sol.message
    assert '"auto"' in sol.message


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
def test_a_finished_run_that_was_stiff_says_so(method: str) -> None:
    sol = pc.simulate(two_rods(DAMPER), q0=START, t_span=(0, 0.05), method=method)
    assert sol.success
    assert sol.stats.stiff
    assert "limited by stability" in sol.message


@pytest.mark.parametrize(
    ("effect", "name"),
    [(SPRING, "torsional_spring"), (CONTROLLER, "motor")],
    ids=["spring", "controller"],
)
@pytest.mark.parametrize("method", ["dopri5", "radau5"])
def test_a_fast_mode_that_sets_the_steps_is_named(effect: Any, name: str, method: str) -> None:
    start = [0.8, 1.001]  # off the rest angle: it swings
    how = {"method": method, "max_steps": 10_000, "on_failure": "ignore"}
    sol = pc.simulate(two_rods(effect), q0=start, t_span=(0, 5), **how)
    if method == "radau5" and name == "motor":
        assert "fast mode" not in sol.message  # well damped: no matter to radau5
        return
    # phi'' = -k/J phi - c/J phi' with both rods free: J by the mass matrix
    matrix = BOOK.mass_matrix(sol.q[-1])
    by_torque = np.array([-1.0, 1.0]) @ np.linalg.solve(matrix, [-1.0, 1.0])
    stiffness, damping = (1e8, 0.0) if name == "torsional_spring" else (1e6, 1e3)
    omega = math.sqrt(stiffness * by_torque)
    ratio = damping * by_torque / (2 * omega)
    told = sol.message.partition("a fast mode set ")[2]
    assert f"{name}" in told
    assert "in joint 2, from effect 1" in told
    frequency = float(told.partition("steps: ")[2].partition(" rad/s")[0])
    damped = float(told.partition("damping ratio ")[2].partition(",")[0])
    assert frequency == pytest.approx(omega, rel=6e-3)
    assert damped == pytest.approx(ratio, rel=6e-3, abs=2e-3)


def test_a_fast_mode_is_told_in_the_joint_of_its_effect() -> None:
    # The free second link turns the other way: its joint turns more.
    spring = pc.effects.TorsionalSpring(1, stiffness=1e6)
    sol = pc.simulate(
        two_rods(spring),
        q0=[0.01, 0.0],
        t_span=(0, 1),
        method="dopri5",
        max_steps=5_000,
        on_failure="ignore",
    )
    assert "in joint 1, from effect 1 (torsional_spring)" in sol.message


def test_a_law_of_the_users_that_jumps_is_told_what_has_the_jump() -> None:
    def rub(t: float, q: Any, qd: Any) -> Any:
        return -0.5 * np.sign(qd)

    sol = pc.simulate(
        two_rods(pc.effects.User(rub)), q0=[1.5, 1.4], t_span=(0, 20), method="dopri5",
        max_steps=10_000, on_failure="ignore",
    )  # fmt: skip
    assert sol.status == "max_steps"
    assert "DryJointFriction" in sol.message


@pytest.mark.parametrize("method", ["dopri5", "dop853", "taylor"])
def test_a_pendulum_has_no_fast_mode_however_long_it_runs(method: str) -> None:
    sol = pc.simulate(BOOK, q0=START, t_span=(0, 1000), method=method)
    assert sol.stats.accepted > 2000
    assert sol.message == "reached the end of the interval"


def test_functions_of_the_users_are_said_to_be_differentiated_by_differences() -> None:
    weak = pc.effects.User(lambda t, q, qd: -0.1 * qd)
    sol = pc.simulate(two_rods(weak), q0=START, t_span=(0, 0.1), method="radau5")
    assert "derivatives of effect 1 (compiled_user) by differences" in sol.message


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_is_its_first_method_where_nothing_is_stiff(pair: str) -> None:
    times = np.linspace(0, 10, 57)
    first = METHODS[pair]["first"]
    one, other = (pc.simulate(BOOK, q0=START, t_span=(0, 10), method=m) for m in (pair, first))
    assert np.array_equal(one.t, other.t)
    assert np.array_equal(one.y, other.y)
    assert np.array_equal(one(times), other(times))


@pytest.mark.parametrize("pair", PAIRS)
def test_a_pair_changes_over_once_and_says_when(pair: str) -> None:
    sol = pc.simulate(two_rods(DAMPER), q0=START, t_span=(0, 5), method=pair)
    assert sol.success
    assert sol.stats.stiff
    assert sol.stats.njev > 0
    assert sol.stats.accepted < 10_000
    since = re.search(r"went on with radau5 from t = (\S+) s", sol.message)
    assert since is not None
    assert 0 < float(since[1]) < 0.02
    exact = pc.simulate(two_rods(DAMPER), q0=START, t_span=(0, 5), method="radau5", rtol=1e-11)
    times = np.linspace(0, 5, 301)
    assert np.abs(sol(times) - exact(times))[:2].max() < 1e-6


@pytest.mark.parametrize("method", ["radau5", *PAIRS])
@pytest.mark.parametrize("compensated", [False, True])
@pytest.mark.parametrize("stop", [1e-3, 0.7])
def test_a_stiff_run_goes_on_bit_by_bit(method: str, stop: float, compensated: bool) -> None:
    scene, how = two_rods(DAMPER), {"method": method, "rtol": 1e-6, "compensated": compensated}
    whole = pc.simulate(scene, q0=START, t_span=(0, 2), **how)
    begun = pc.simulate(scene, q0=START, t_span=(0, stop), **how)
    resumed = pickle.loads(pickle.dumps(begun)).resume(2)
    times = np.linspace(0, 2, 99)
    assert np.array_equal(whole.t, resumed.t)
    assert np.array_equal(whole.y, resumed.y)
    assert np.array_equal(whole(times), resumed(times))
    assert whole.stats == resumed.stats
    assert whole.message == resumed.message


@pytest.mark.parametrize("method", ["radau5", *PAIRS])
@pytest.mark.parametrize("cap", [1, 10, 108, 114])  # stiffness: tested about step 100
def test_a_run_stopped_by_its_cap_goes_on_bit_by_bit(method: str, cap: int) -> None:
    scene, how = two_rods(CONTROLLER), {"method": method, "rtol": 1e-9}
    whole = pc.simulate(scene, q0=[0.8, 1.1], t_span=(0, 2), **how)
    stopped = pc.simulate(
        scene, q0=[0.8, 1.1], t_span=(0, 2), max_steps=cap, on_failure="ignore", **how
    )
    assert stopped.status == "max_steps"
    resumed = stopped.resume(2)
    assert np.array_equal(whole.t, resumed.t)
    assert np.array_equal(whole.y, resumed.y)
    assert whole.stats == resumed.stats


def test_a_compensated_state_does_not_drift_with_its_rounding() -> None:
    # a rod that nothing turns goes through 1e5 steps of 1e-3 s at a rate of 0.1 rad/s
    scene = pc.Scene(links=[ROD], gravity=0)
    how = {"method": "radau5", "step": 1e-3, "store": "end"}
    plain, kept = (
        pc.simulate(scene, q0=0.0, qd0=0.1, t_span=(0, 100), compensated=one, **how)
        for one in (False, True)
    )
    assert abs(kept.q[-1, 0] - 10) <= 2 * np.spacing(10.0)
    assert abs(plain.q[-1, 0] - 10) > 10 * np.spacing(10.0)


def test_the_ledger_changes_no_bit_and_closes() -> None:
    damper = ViscousJoint(joint=1, damping=0.5)
    scene = two_rods(damper, Motor(joint=2, constant=1.0))
    how = {"method": "radau5", "rtol": 1e-9}
    without = pc.simulate(scene, q0=START, t_span=(0, 5), **how)
    kept = pc.simulate(scene, q0=START, t_span=(0, 5), ledger=True, **how)
    assert np.array_equal(without.y, kept.y)
    energy = kept.energy()
    ledger = energy.ledger
    work = ledger.motor - ledger.viscous
    assert np.abs(energy.total - energy.total[0] - work).max() < 1e-7


def test_breaks_and_held_joints_are_met_as_with_dopri5() -> None:
    effects = [
        pc.effects.DryJointFriction(joint=1, coulomb=0.4),
        Motor(joint=2, table=pc.effects.Table(t=[0, 1, 2], torque=[0, 3, -2])),
        pc.effects.ViscousJoint(joint=2, damping=0.1, damping2=0.2),
    ]
    one, other = (
        pc.simulate(two_rods(*effects), q0=START, t_span=(0, 2), method=m, rtol=1e-10, atol=1e-12)
        for m in ("radau5", "dopri5")
    )
    assert one.status == other.status
    assert np.abs(one.y[:, -1] - other.y[:, -1]).max() < 1e-7


@pytest.mark.parametrize("n", [1, 3, 10])
def test_chains_of_any_length_agree_with_dopri5(n: int) -> None:
    effects = [ViscousJoint(joint=n, damping=0.2), TorsionalSpring(joint=1, stiffness=3.0)]
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)] * n, effects=effects)
    one, other = (
        pc.simulate(scene, q0=np.linspace(0.5, 1.2, n), t_span=(0, 1), method=m, rtol=1e-9)
        for m in ("radau5", "dopri5")
    )
    assert np.abs(one.y[:, -1] - other.y[:, -1]).max() < 1e-6


def test_no_fixed_step_that_was_not_solved_is_taken() -> None:
    """A step that is cut at a guard's zero is tried anew: it may fail where the whole did not."""
    scene = two_rods(ViscousJoint(joint=2, damping=1e160, damping2=10.0))
    for length in 10.0 ** np.arange(-14, -5):
        for t in (0.0, -2.5):
            sol = pc.simulate(
                scene, q0=[0.0, 0.3], qd0=[0.0, -1.1], t_span=(t, t + length), method="radau5",
                step=1e-4, on_failure="ignore",
            )  # fmt: skip
            assert np.isfinite(sol.y).all()
