"""A swing next to the separatrix: modulus 0.999999, 0.16 degrees short of upright."""

from __future__ import annotations

from typing import Any

import numpy as np
from mpmath import ellipk, mp, mpf, sin, sqrt

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import mujoco_rods

G = 9.807
AMPLITUDE = float(2 * np.arcsin(0.999999))
with mp.workdps(30):
    PERIOD = float(4 * ellipk(sin(mpf(AMPLITUDE) / 2) ** 2) * sqrt(2 / (3 * mpf(G))))


def judged(angle: float) -> Outcome:
    """Judge how far the rod is from its start after a period."""
    off = abs(angle - AMPLITUDE)
    return Outcome(error=off, said=f"{off:.1e} rad off after a period")


def pendcore(**how: Any) -> Outcome:
    import pendcore as pc

    scene = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=G)
    sol = pc.simulate(scene, q0=np.pi / 2 - AMPLITUDE, t_span=(0, PERIOD), **how)
    return judged(np.pi / 2 - sol.q[-1, 0])


def scipy(**tolerances: float) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(
        lambda _, y: [y[1], -1.5 * G * np.sin(y[0])], (0, PERIOD), [AMPLITUDE, 0], "DOP853",
        **tolerances,
    )  # fmt: skip
    return judged(sol.y[0, -1])


def mujoco() -> Outcome:
    import mujoco

    steps = round(PERIOD / 1e-4)
    model = mujoco_rods(dt=PERIOD / steps, gravity=G, integrator="RK4")
    data = mujoco.MjData(model)
    data.qpos[0] = AMPLITUDE
    for _ in range(steps):
        mujoco.mj_step(model, data)
    return judged(float(data.qpos[0]))


CASE = HardCase(
    name="separatrix",
    title="A swing next to the separatrix",
    scene="One rod released 0.16 degrees short of upright: elliptic modulus 0.999999.",
    answer=f"The rod is back where it began after 4 K(k) sqrt(2L/3g) = {PERIOD:.9f} s.",
    unit="rad",
    allowed=1e-7,
    contenders=(
        Contender(
            program="pendcore",
            how="dopri5, rtol 1e-12, atol 1e-14",
            run=lambda: pendcore(rtol=1e-12, atol=1e-14),
        ),
        Contender(
            program="pendcore",
            how="dopri5, rtol 3e-14, atol 1e-16, compensated",
            run=lambda: pendcore(rtol=3e-14, atol=1e-16, compensated=True),
        ),
        Contender(program="scipy", how="DOP853, defaults", run=scipy),
        Contender(
            program="scipy",
            how="DOP853, rtol 1e-12, atol 1e-14",
            run=lambda: scipy(rtol=1e-12, atol=1e-14),
        ),
        Contender(
            program="scipy",
            how="DOP853, rtol 3e-14, atol 1e-16",
            run=lambda: scipy(rtol=3e-14, atol=1e-16),
        ),
        Contender(program="mujoco", how="RK4, 0.1 ms", run=mujoco),
        odeint(
            "controlled dopri5, 1e-12, 1e-14",
            "separatrix",
            repr(AMPLITUDE),
            repr(PERIOD),
            judge=lambda heard: judged(heard["q"][0]),
        ),
    ),
)
