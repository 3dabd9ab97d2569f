"""Each case in examples/cases does what the comment at the head of its file says."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pendcore as pc
import pytest

CASES = Path(__file__).parents[2] / "examples/cases"


def case(name):
    return pc.read_case(CASES / f"{name}.toml")


def run(name):
    sol = case(name).simulate()
    assert sol.success, sol.message
    return sol


def test_a_shaken_pivot_keeps_an_inverted_pendulum_up_and_half_the_shaking_does_not():
    shaken = case("kapitza")
    tilts = []
    for share in (1.0, 0.5):
        (drive,) = shaken.scene.effects
        y = pc.effects.Sinusoid(
            amplitude=share * drive.y.amplitude,
            angular_frequency=drive.y.angular_frequency,
            phase=drive.y.phase,
        )
        scene = shaken.scene.replace(effects=[pc.effects.DrivenPivot(y=y)])
        sol = pc.simulate(scene, q0=shaken.q0, qd0=shaken.qd0, t_span=shaken.t_span)
        assert sol.t[-1] == 10.0
        tilts.append(np.degrees(np.abs(sol.q + np.pi / 2).max(axis=0)))
    assert (tilts[0] < 20).all()
    assert (tilts[1] > 90).all()


def test_motors_lift_an_arm_up_to_what_its_weight_is_over_kp():
    sol = run("motor_pd")
    link_1, link_2 = sol.scene.links
    motors = sol.scene.effects
    assert np.abs(sol.qd[-1]).max() < 1e-6

    moment_2 = link_2.mass * link_2.center * np.cos(sol.q[-1, 1])
    moment_1 = (link_1.mass * link_1.center + link_2.mass * link_1.length) * np.cos(sol.q[-1, 0])
    weight = sol.scene.gravity * np.array([moment_1 + moment_2, moment_2])
    short = sol.relative_angles()[-1] - [motor.pd.reference for motor in motors]
    assert short * [motor.pd.kp for motor in motors] == pytest.approx(weight, rel=1e-6)


def test_at_first_the_motors_give_their_limit():
    arm = case("motor_pd")
    at_limit = [
        pc.effects.Motor(joint=motor.joint, constant=-motor.limit) for motor in arm.scene.effects
    ]
    expected = arm.scene.replace(effects=at_limit).accelerations(0.0, arm.q0, arm.qd0)
    assert arm.scene.accelerations(0.0, arm.q0, arm.qd0) == pytest.approx(expected, rel=1e-12)


def test_a_stick_leans_in_the_wind_as_its_weight_lets_it():
    sol = run("drag_in_wind")
    (stick,), (drag,) = sol.scene.links, sol.scene.effects
    weight = stick.mass * sol.scene.gravity
    wind = drag.air_density * drag.drag_coefficient * drag.diameter * stick.length / 2
    wind *= drag.wind[0] ** 2
    # The stick rests where wind (1 - cos^2 q) = weight cos q.
    leaning = np.arccos((np.hypot(weight, 2 * wind) - weight) / (2 * wind))
    assert sol.q[:, 0].min() < 0 < leaning  # at first the stick swings up beyond the horizontal
    assert sol.q[-1, 0] == pytest.approx(leaning, abs=1e-5)
    assert abs(sol.qd[-1, 0]) < 1e-4


def test_dry_friction_stops_a_spinning_rod_when_and_where_it_must():
    sol = run("dry_friction_stop")
    assert sol.status == "at_rest"
    assert sol.t[-2] == pytest.approx(4.0, abs=1e-12)
    assert sol.q[-2, 0] == pytest.approx(12.0, abs=1e-11)
    assert sol.qd[-1, 0] == 0.0
    assert sol.qd[:, 0] == pytest.approx(np.maximum(6.0 - 1.5 * sol.t, 0.0), abs=1e-11)


def test_ten_rods_swing_as_a_hanging_chain_does():
    sol = run("chain_of_ten")
    length = sum(link.length for link in sol.scene.links)
    t = np.linspace(0.0, sol.t[-1], 4001)
    theta = sol(t)[0] - np.pi / 2
    before = np.flatnonzero(theta[1:] * theta[:-1] < 0)
    share = theta[before] / (theta[before] - theta[before + 1])
    crossings = t[before] + share * (t[before + 1] - t[before])
    frequencies = np.pi / np.diff(crossings)
    slowest = 1.2024128 * np.sqrt(sol.scene.gravity / length)
    assert len(frequencies) > 8
    assert frequencies == pytest.approx(slowest, rel=4e-4)


def test_bearings_take_the_energy_that_the_ledger_says(reference_case):
    sol = run("damped_textbook")
    energy = sol.energy()
    gone = energy.total[0] - energy.total
    assert (np.diff(gone) > 0).all()
    assert gone == pytest.approx(energy.ledger.viscous, abs=1e-7)
    assert gone[-1] == pytest.approx(2.64, abs=0.005)

    known = reference_case("damped_textbook")
    found_at_known_times = sol(known.t).T
    assert found_at_known_times == pytest.approx(np.hstack([known.q, known.qd]), abs=1e-6)
