"""Two rods with dry friction in both joints under a slow motor: the joints stick and slide in turn.

The right answer is solved mode by mode in tests/models/hybrid_chain.py, which tries every pattern
of stick and slip at each switch.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from dense_chain import DenseChain, joints
from hybrid_chain import HybridChain

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import STIFF_FRICTION, Array, driven_mujoco, mujoco_rods

FRICTION = (5.0, 1.5)  # N m
AMPLITUDE, FREQUENCY = 10.0, 1.0  # N m, rad/s; the motor in joint 1
T_END = 9.0
TIMES = np.linspace(0, T_END, 361)[1:]
CHAIN = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=9.807)
SOFT = 1e-3


@cache
def solved() -> tuple[Array, tuple[tuple[float, tuple[int, ...]], ...]]:
    def torques(t: float) -> Array:
        return np.array([AMPLITUDE * np.sin(FREQUENCY * t), 0.0])

    exact = HybridChain(chain=CHAIN, friction=np.array(FRICTION), torques=torques)
    states = exact.run(np.full(2, np.pi / 2), TIMES, h=0.04)
    return states, tuple((float(t), mode) for t, _, mode in exact.switches)


def rest() -> float:
    """Return the middle of a time in which both joints stick."""
    switches = solved()[1]
    number = next(k for k, (_, mode) in enumerate(switches) if mode == (0, 0))
    return (switches[number][0] + switches[number + 1][0]) / 2


def reference() -> Mapping[str, list[float]]:
    states, switches = solved()
    phi = states[:, :2] @ joints(2).T
    return {
        "t": TIMES.tolist(), "phi_1": phi[:, 0].tolist(), "phi_2": phi[:, 1].tolist(),
        "switches": [t for t, _ in switches],
        **{f"mode_{j + 1}": [float(mode[j]) for _, mode in switches] for j in range(2)},
    }  # fmt: skip


def judged(states: Array, at_rest: Array) -> Outcome:
    """Judge the states at TIMES, and the state in the middle of the rest."""
    creep = float(np.abs(at_rest[2:] @ joints(2).T).max())
    phi = states[:, :2] @ joints(2).T
    off = np.abs(phi - solved()[0][:, :2] @ joints(2).T).max(axis=1)
    return Outcome(
        error=float(off.max()),
        said=f"creeps at {creep:.0e} rad/s where both joints rest" if creep else "rests exactly",
        trace={"phi_1": phi[:, 0].tolist(), "phi_2": phi[:, 1].tolist(), "error": off.tolist()},
    )


def pendcore() -> Outcome:
    import pendcore as pc

    hum = pc.effects.Sinusoid(amplitude=AMPLITUDE, angular_frequency=FREQUENCY)
    effects: list[Any] = [pc.effects.Motor(joint=1, sinusoid=hum)]
    effects += [pc.effects.DryJointFriction(joint=j, coulomb=FRICTION[j - 1]) for j in (1, 2)]
    scene = pc.Scene.textbook().replace(effects=effects)
    sol = pc.simulate(scene, q0=np.pi / 2, t_span=(0, T_END), rtol=1e-11)
    return judged(sol(TIMES).T, sol(rest()))


def smoothed(t: float, y: Array) -> Array:
    slide = np.tanh(joints(2) @ y[2:] / SOFT)
    motor = np.array([AMPLITUDE * np.sin(FREQUENCY * t), 0.0])
    forces = CHAIN.forces(y[:2], y[2:], motor - np.array(FRICTION) * slide)
    return np.append(y[2:], np.linalg.solve(CHAIN.mass_matrix(y[:2]), forces))


def scipy_smoothed() -> Outcome:
    from scipy.integrate import solve_ivp

    start = [np.pi / 2, np.pi / 2, 0, 0]
    sol = solve_ivp(smoothed, (0, T_END), start, "Radau", rtol=1e-8, atol=1e-10, dense_output=True)
    return judged(sol.sol(TIMES).T, sol.sol(rest()))


def mujoco(dt: float, tuned: str, integrator: str) -> Outcome:
    """MuJoCo's angles are those of link 1 and joint 2 from hanging, with the opposite sign."""
    model = mujoco_rods(
        dt=dt, links=2, mass=1.0, gravity=9.807, joint=f'frictionloss="1" {tuned}',
        integrator=integrator,
    )  # fmt: skip
    model.dof_frictionloss[:] = FRICTION
    known = driven_mujoco(model, lambda t: -AMPLITUDE * float(np.sin(FREQUENCY * t)), T_END)

    def at(t: Any) -> Array:
        first, second, rate, second_rate = (-np.interp(t, known[0], one) for one in known[1:])
        hanging = np.pi / 2
        return np.array([hanging + first, hanging + first + second, rate, rate + second_rate])

    return judged(at(TIMES).T, at(rest()))


CASE = HardCase(
    name="two_joints",
    title="Joints that stick and slide in turn",
    scene=(
        "The textbook's two rods, hanging, with dry friction of 5 and 1.5 N m in their joints "
        "and a motor of 10 sin t N m in the first: each joint sticks or slips depending on the "
        "other."
    ),
    answer=(
        "The angles over 9 s and 13 switches, solved mode by mode in 12th order. The solution "
        "tries every pattern of stick and slip at each switch, in 130 lines of its own "
        "(tests/models/hybrid_chain.py). A loop around SciPy or Boost.odeint would repeat these "
        "lines: the only hard question here is which joints hold, and neither library helps to "
        "decide it. So no such loop is run."
    ),
    unit="rad",
    allowed=1e-8,
    loop_not_run=("scipy", "odeint"),
    reference=reference,
    figure=(
        "Angles of two joints over time, when each sticks, and how far each program is off; the "
        "curves of SciPy and Boost.odeint, which solve the same smoothed law, coincide"
    ),
    contenders=(
        Contender(program="pendcore", how="`DryJointFriction`, rtol 1e-11", run=pendcore),
        Contender(program="scipy", how="signs smoothed over 1e-3 rad/s, Radau", run=scipy_smoothed),
        Contender(
            program="mujoco",
            how="`frictionloss`, 2 ms",
            run=lambda: mujoco(2e-3, "", "implicitfast"),
        ),
        Contender(
            program="mujoco",
            how="`frictionloss`, hardest constraint, 0.2 ms, RK4",
            run=lambda: mujoco(2e-4, STIFF_FRICTION.format(4e-4), "RK4"),
        ),
        odeint(
            "signs smoothed over 1e-3 rad/s, rosenbrock4",
            "two_joints",
            *(repr(float(t)) for t in TIMES),
            judge=lambda told: judged(
                np.reshape(told["states"], (-1, 4)),
                np.array(
                    [np.interp(rest(), TIMES, x) for x in np.reshape(told["states"], (-1, 4)).T]
                ),
            ),
        ),
    ),
)
