"""Several laws that change at one time, and steps too coarse to tell which comes first."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain
from pendcore import effects as fx
from reference.dormand_prince import integrate
from unit_rods import links, rod, solve


@pytest.mark.parametrize("ways", [{"rtol": 1e-11}, {"step": 0.003}, {"step": 1 / 64}])
@pytest.mark.parametrize("order", [1, -1])
def test_friction_stops_a_rod_with_quadratic_damping(method, ways, order):
    """At sqrt(2) atan(sqrt(2)), from w' = -(1/2 + w^2): there both laws have two sides."""
    damping = fx.ViscousJoint(joint=1, damping=0.0, damping2=1.0)
    laws = fx.DryJointFriction(joint=1, coulomb=0.5), damping
    event = pc.events.RateZero(joint=1)
    sol = solve(rod(*laws[::order]), 0, 1, 3, method=method, events=[event], **ways)
    assert sol.status == "at_rest", sol.message
    [stop] = sol.events[0]
    exact = np.sqrt(2) * np.arctan(np.sqrt(2))
    assert stop.t == pytest.approx(exact, abs=1e-9 if "rtol" in ways else 1e-4)
    assert sol.y[1, -1] == 0.0


@pytest.mark.parametrize("rtol", [1e-5, 1e-8])
@pytest.mark.parametrize("start", [0.3, 7.0, 13.7, 1e4])
def test_two_joints_are_let_go_at_one_time(method, rtol, start):
    """Alike in both, sin(t - start) leaves the range of the friction pi/6 after the start."""
    hum = fx.Sinusoid(1.0, angular_frequency=1.0, phase=-start)
    effects = []
    for j in (1, 2):
        effects += [fx.DryJointFriction(joint=j, coulomb=0.5), fx.Motor(joint=j, sinusoid=hum)]
    scene = rod(*effects, links=2)
    run = pc.simulate(scene, (start, start + 2), 0, method=method, rtol=rtol)
    assert run.status == "finished", run.message
    moving = run.t[(run.qd != 0).any(axis=1)]
    assert moving[0] > start + np.pi / 6
    at_release = run.t[np.searchsorted(run.t, start + np.pi / 6 - 1e-9)]
    assert at_release == pytest.approx(start + np.pi / 6, abs=1e-9)


def test_a_pulse_is_seen_however_far_away_the_end_is(method):
    """1e3 N m at the top of 2e-6 s give an impulse of 1e-3, which friction takes in 0.1 s."""
    table = fx.Table(t=[-1, 1.0, 1.000001, 1.000002, 1e11], torque=[0, 0, 1e3, 0, 0])
    scene = rod(fx.Motor(joint=1, table=table), fx.DryJointFriction(joint=1, coulomb=0.01))
    ends = [pc.simulate(scene, (0, t), 0, method=method).q[-1, 0] for t in (10.0, 1e9)]
    assert ends[0] == pytest.approx(0.001**2 / (2 * 0.01), rel=1e-3)
    assert ends[1] == ends[0]


@pytest.mark.parametrize("step", [1 / 64, 1 / 128])
def test_coarse_steps_pump_no_energy_into_a_joint_at_its_stop(step, method):
    rods = [pc.Link(mass=1, length=1), pc.Link(mass=1.75, length=0.307)]
    effects = [
        fx.JointStop(joint=2, range=(-1.6, -0.11228775226469723), restitution=0.3),
        fx.ViscousJoint(joint=2, damping=0.1, damping2=0.1),
        fx.DryJointFriction(joint=2, coulomb=0.029, static=0.0436),
    ]
    start = [-0.15020579195563455, -1.115133372329371]
    how = {"method": method, "step": step, "max_steps": 3000}
    sol = pc.simulate(pc.Scene(links=rods, effects=effects), (0, 3), start, **how)
    assert sol.success, sol.message
    assert np.count_nonzero(np.diff(sol.t) == 0) < 30
    assert np.diff(sol.energy().total).max() < 1e-3


TURNS = {  # masses, lengths, damping of the last joint, start, span, options, tolerance
    "four rods": (
        [1.0, 1.0, 0.1477663410806247, 1.0], [1.0, 1.0, 0.12178566430015074, 1.0],
        (2.0, 3.501669126225858, 0.5),
        [1.0, -0.02322384604230976, 0.4604624584291299, 0.0],
        [0.11755537426220058, -0.2588252337710221, 0.3780789664178426, -0.5],
        (-2.5, -1.5), {"rtol": 0.0004462848991616165}, 2e-2,
    ),
    "six rods": (
        [1.0] * 5 + [0.25388284558067603], [1.0] * 5 + [0.32626915673860074],
        (9.057963501304451, 0.1, 0.1),
        [0.0] * 6, [0.0, 0.0, 0.0, 0.0, -0.18516116621458723, 1.0],
        (1.0, 2.5), {"rtol": 3.2626125863133584e-05, "method": "dop853"}, 1e-2,
    ),
}  # fmt: skip


@pytest.mark.parametrize("rods", TURNS)
def test_a_joint_turns_where_its_acceleration_is_zero_but_for_rounding(rods):
    """The rounding of the acceleration leads to one side of the rate zero, the steps to the other.

    The reference takes |w| w as it is, in steps that need not end where the rate is zero.
    """
    masses, lengths, damping, q0, qd0, span, options, bar = TURNS[rods]
    chain = DenseChain(masses=np.array(masses), lengths=np.array(lengths), gravity=9.807)
    n = chain.n

    def rates(_, y):
        w = y[-1] - y[-2]
        torques = np.zeros(n)
        torques[-1] = -damping[0] * w - damping[1] * abs(w) * w - damping[2] * w**3
        qdd = np.linalg.solve(chain.mass_matrix(y[:n]), chain.forces(y[:n], y[n:], torques))
        return np.concatenate([y[n:], qdd])

    law = fx.ViscousJoint(joint=n, damping=damping[0], damping2=damping[1], damping3=damping[2])
    scene = pc.Scene(links=links(chain), gravity=9.807, effects=[law])
    sol = pc.simulate(scene, span, q0, qd0, **options)
    assert sol.success, sol.message
    exact = integrate(rates, np.concatenate([q0, qd0]), span, rtol=1e-8, atol=1e-8)
    assert np.abs(sol.q[-1] - exact.y[-1][:n]).max() < bar
