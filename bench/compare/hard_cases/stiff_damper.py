"""The textbook's two rods with a joint that is damped at a rate of a million per second."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods, textbook_rates

DAMPING = 1e5  # N m s at joint 2; over its moment of inertia, about 0.08, it is 1e6 a second
START = [np.pi / 4, np.pi / 3, 0.0, 0.0]
T_END = 5.0
SOLVE = np.array([[1 / 3, 0], [0, 4 / 3]])


def rates(t: float, y: Array) -> Array:
    """The textbook's rates, with -b (qd_2 - qd_1) on link 2 and its opposite on link 1."""
    f = textbook_rates(t, y)
    a12 = 0.5 * np.cos(y[0] - y[1])
    couple = -DAMPING * (y[3] - y[2])
    m = np.array([[4 / 3, a12], [a12, 1 / 3]])
    f[2:] += np.linalg.solve(m, [-couple, couple])
    return f


@cache
def reference_end() -> tuple[float, ...]:
    """Solve by SciPy's Radau at its tightest; other methods would take five million steps."""
    from scipy.integrate import solve_ivp

    sol = solve_ivp(rates, (0, T_END), START, "Radau", rtol=1e-12, atol=1e-14)
    return tuple(float(x) for x in sol.y[:2, -1])


def reference() -> Mapping[str, list[float]]:
    return {"q": list(reference_end())}


def judged(q: Any, words: str) -> Outcome:
    error = float(np.abs(np.asarray(q) - reference_end()).max())
    if not np.isfinite(error):
        return Outcome(said=f"not a number; {words}", right=False)
    return Outcome(error=error, said=words)


def pendcore(method: str, max_steps: int = 10_000_000) -> Outcome:
    import pendcore as pc

    damper = pc.effects.ViscousJoint(joint=2, damping=DAMPING)
    scene = pc.Scene.textbook().replace(effects=[damper])
    sol = pc.simulate(
        scene, q0=START[:2], t_span=(0, T_END), method=method, rtol=1e-8, atol=1e-10,
        max_steps=max_steps, store="end", on_failure="ignore",
    )  # fmt: skip
    words = f"{sol.stats.accepted} steps{', says `stiff`' if sol.stats.stiff else ''}"
    if not sol.success:
        words = f"status `{sol.status}` at t = {sol.t[-1]:.3g} s: {words}"
        return Outcome(said=words, right=bool(sol.stats.stiff))
    return judged(sol.q[-1], words)


def scipy(method: str) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(rates, (0, T_END), START, method, rtol=1e-8, atol=1e-10)
    words = f"{sol.t.size - 1} steps" + ("" if sol.success else f', "{sol.message}"')
    return judged(sol.y[:2, -1], words)


def mujoco(dt: float, integrator: str) -> Outcome:
    import mujoco

    model = mujoco_rods(dt=dt, links=2, mass=1.0, gravity=9.807, integrator=integrator)
    model.dof_damping[1] = DAMPING
    data = mujoco.MjData(model)
    data.qpos[:] = np.pi / 2 - START[0], START[0] - START[1]
    for _ in range(round(T_END / dt)):
        mujoco.mj_step(model, data)
    q_1 = np.pi / 2 - data.qpos[0]
    return judged([q_1, q_1 - data.qpos[1]], f"{round(T_END / dt)} steps")


CASE = HardCase(
    name="stiff_damper",
    title="A stiff damper",
    scene=(
        "The textbook's two rods for 5 s, with joint 2 damped by 1e5 N m s: one mode decays a "
        "million "
        "times a second, beside swings of seconds."
    ),
    answer=(
        "The angles at 5 s (here by SciPy's Radau at rtol 1e-12), or a message that the problem is "
        "stiff."
    ),
    unit="rad",
    allowed=1e-5,
    reference=reference,
    contenders=(
        Contender(
            program="pendcore",
            how="dopri5, at most 10,000 steps",
            run=lambda: pendcore("dopri5", 10_000),
        ),
        *(
            Contender(program="pendcore", how=method, run=lambda method=method: pendcore(method))
            for method in ("radau5", "dopri5-radau5")
        ),
        *(
            Contender(program="scipy", how=method, run=lambda method=method: scipy(method))
            for method in ("RK45", "Radau", "LSODA")
        ),
        Contender(program="mujoco", how="RK4, 1 ms", run=lambda: mujoco(1e-3, "RK4")),
        *(
            Contender(
                program="mujoco",
                how=f"implicitfast, {1e3 * dt:g} ms",
                run=lambda dt=dt: mujoco(dt, "implicitfast"),
            )
            for dt in (1e-3, 1e-5)
        ),
        odeint(
            "rosenbrock4, Jacobian by differences",
            "stiff_damper",
            judge=lambda heard: judged(heard["q"], f"{heard['steps'][0]:.0f} steps"),
        ),
    ),
)
