"""The energy of the textbook's case over 2000 s."""

from __future__ import annotations

from math import cos, sin
from typing import Any

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods, mujoco_steps

G = 9.807
START = (np.pi / 4, np.pi / 3)
T_END = 2000.0
TIMES = np.linspace(0, T_END, 201)


def energy(states: Any) -> Array:
    """Return the energy, J, of two rods of 1 kg and 1 m in states (..., 4)."""
    q1, q2, w1, w2 = np.moveaxis(np.asarray(states), -1, 0)
    kinetic = 2 / 3 * w1**2 + w2**2 / 6 + np.cos(q1 - q2) * w1 * w2 / 2
    return np.asarray(kinetic - G * (1.5 * np.sin(q1) + 0.5 * np.sin(q2)))


def judged(states: Any, words: str) -> Outcome:
    """Judge the largest drift at TIMES, as a share of the energy at the start."""
    at_start = energy((*START, 0, 0))
    return Outcome(error=float(np.abs(energy(states) / at_start - 1).max()), said=words)


def pendcore(**how: Any) -> Outcome:
    import pendcore as pc

    sol = pc.simulate(pc.Scene.textbook(), q0=START, t_span=(0, T_END), t_eval=TIMES, **how)
    return judged(sol.y.T, f"{sol.stats.accepted} steps")


def rates(_: float, y: Any) -> tuple[float, ...]:
    """Return the rates, computed with Python's floats, which are quicker than NumPy's."""
    q1, q2, w1, w2 = y.tolist()
    a12, h = 0.5 * cos(q1 - q2), 0.5 * sin(q1 - q2)
    r1 = 1.5 * G * cos(q1) - h * w2**2
    r2 = 0.5 * G * cos(q2) + h * w1**2
    determinant = 4 / 9 - a12**2
    return w1, w2, (r1 / 3 - a12 * r2) / determinant, (4 / 3 * r2 - a12 * r1) / determinant


def scipy(method: str, **tolerances: float) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(rates, (0, T_END), [*START, 0, 0], method, t_eval=TIMES, **tolerances)
    return judged(sol.y.T, f"{sol.nfev} evaluations")


def mujoco(dt: float, integrator: str) -> Outcome:
    import mujoco

    model = mujoco_rods(dt=dt, links=2, mass=1.0, gravity=G, integrator=integrator)
    data = mujoco.MjData(model)
    data.qpos[:] = np.pi / 2 - START[0], START[0] - START[1]
    states = []
    for _ in TIMES[1:]:
        mujoco.mj_step(model, data, round(TIMES[1] / dt))
        (first, second), (rate, second_rate) = data.qpos, data.qvel
        q1 = np.pi / 2 - first
        states.append([q1, q1 - second, -rate, -rate - second_rate])
    return judged(states, f"{round(T_END / dt)} steps")


CASE = HardCase(
    name="drift",
    title="The energy of a long run",
    scene="The textbook's case for 2000 s, about 1000 swings.",
    answer="The energy at the start, compared at 200 times; the error is a share of this energy.",
    unit="of the energy",
    allowed=1e-9,
    contenders=(
        *(
            Contender(
                program="pendcore",
                how=f"dopri5, rtol {rtol:g}, atol {atol:g}, compensated",
                run=lambda rtol=rtol, atol=atol: pendcore(rtol=rtol, atol=atol, compensated=True),
            )
            for rtol, atol in ((1e-12, 1e-14), (3e-14, 1e-16))
        ),
        Contender(
            program="pendcore",
            how="dopri5, rtol 3e-14, atol 1e-16, max_step 0.5 ms, compensated",
            run=lambda: pendcore(rtol=3e-14, atol=1e-16, max_step=5e-4, compensated=True),
        ),
        Contender(
            program="scipy",
            how="DOP853, rtol 3e-14, atol 1e-16",
            run=lambda: scipy("DOP853", rtol=3e-14, atol=1e-16),
        ),
        *mujoco_steps(mujoco, ("implicitfast", 2e-3), ("RK4", 2e-3), ("RK4", 5e-4)),
        *(
            odeint(
                f"controlled {name}, rtol {rtol:g}, atol {atol:g}",
                "drift",
                *(repr(float(x)) for x in (order, rtol, atol, *START, *TIMES)),
                judge=lambda heard: judged(np.reshape(heard["states"], (-1, 4)), "integrate_times"),
            )
            for order, name, rtol, atol in (
                (5, "dopri5", 1e-12, 1e-14),
                (8, "fehlberg78", 3e-14, 1e-16),
            )
        ),
    ),
)
