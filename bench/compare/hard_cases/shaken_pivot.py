"""A rod upright on a pivot that shakes up and down, and the frequency at which it stands.

theta'' = (3/2L) (g - eps w^2 cos wt) sin theta. With tau = wt/2 small swings obey Mathieu's
equation, theta'' + (a - 2 q cos 2 tau) theta = 0, with a = -6 g/(L w^2) and q = -3 eps/L. The
border is where a is the lowest characteristic value a_0(q), the least eigenvalue of an infinite
tridiagonal matrix.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from math import cos, pi, sin
from typing import Any

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import ask
from hard_cases.rods import UPRIGHT, mujoco_rods

G = 9.807
EPS = 0.2  # m; the rod has 1 m
SMALL = 1e-5  # rad from upright; the nonlinear part is its square, relatively


def border() -> float:
    size = np.arange(30)
    beside = np.full(29, 3 * EPS)
    beside[0] *= np.sqrt(2)
    matrix = np.diag(4.0 * size**2) + np.diag(beside, 1) + np.diag(beside, -1)
    return float(np.sqrt(-6 * G / np.linalg.eigvalsh(matrix)[0]))


def reference() -> Mapping[str, list[float]]:
    return {"w": [border()]}


def sought(angle_after: Callable[[float], float]) -> Outcome:
    """Seek the frequency at which a small angle is the same again after a period of the drive.

    The equation is even in time. Therefore the trace of the map over a period is twice the ratio of
    the two angles, and the trace is 2 at the border.
    """
    from scipy.optimize import brentq

    guess = border()
    w = brentq(lambda w: angle_after(w) / SMALL - 1, 0.9 * guess, 1.1 * guess, xtol=1e-13)
    return Outcome(error=abs(w / guess - 1), said=f"stands from {w:.10f} rad/s on")


def pendcore(w: float) -> float:
    import pendcore as pc

    shaking = pc.effects.Sinusoid(amplitude=EPS, angular_frequency=w, phase=pi / 2)
    scene = pc.Scene(
        links=[pc.Link(mass=1, length=1)],
        gravity=G,
        effects=[pc.effects.DrivenPivot(y=shaking)],
    )
    sol = pc.simulate(
        scene, q0=UPRIGHT + SMALL, t_span=(0, 2 * pi / w), rtol=1e-13, atol=1e-17, store="end"
    )
    return float(sol.q[-1, 0] - UPRIGHT)


def scipy(w: float) -> float:
    from scipy.integrate import solve_ivp

    def rates(t: float, y: Any) -> tuple[float, float]:
        return y[1], 1.5 * (G - EPS * w**2 * cos(w * t)) * sin(y[0])

    sol = solve_ivp(rates, (0, 2 * pi / w), [SMALL, 0], "DOP853", rtol=1e-12, atol=1e-17)
    return float(sol.y[0, -1])


def mujoco(w: float, steps: int) -> float:
    """Run in the frame of the pivot, whose acceleration acts on the rod as a passive torque."""
    import mujoco

    model = mujoco_rods(dt=2 * pi / w / steps, mass=1.0, gravity=G, integrator="RK4", hanging=False)
    data = mujoco.MjData(model)
    data.qpos[0] = SMALL

    def shaking(_: Any, d: Any) -> None:
        d.qfrc_passive[0] -= 0.5 * EPS * w**2 * cos(w * d.time) * sin(d.qpos[0])

    mujoco.set_mjcb_passive(shaking)
    mujoco.mj_step(model, data, steps)
    mujoco.set_mjcb_passive(None)
    return float(data.qpos[0])


def odeint(w: float) -> float:
    return ask("shaken", repr(EPS), repr(w), repr(SMALL))["q"][0]


CASE = HardCase(
    name="shaken_pivot",
    title="The border at which a shaken pivot holds a rod up",
    scene=(
        "One rod upright, its pivot shaken up and down by 0.2 of its length: above which angular "
        "frequency does the rod stand?"
    ),
    answer=(
        f"{border():.10f} rad/s, where -6 g/(L w^2) is the characteristic value a_0 of Mathieu's "
        "equation. The error is a share of this frequency."
    ),
    unit="of the frequency",
    allowed=1e-8,
    reference=reference,
    contenders=(
        Contender(
            program="pendcore",
            how="`DrivenPivot`, rtol 1e-13, atol 1e-17",
            run=lambda: sought(pendcore),
        ),
        Contender(
            program="scipy",
            how="the pivot's acceleration in the equation, DOP853, rtol 1e-12, atol 1e-17",
            run=lambda: sought(scipy),
        ),
        *(
            Contender(
                program="mujoco",
                how=f"the pivot's acceleration by mjcb_passive, RK4, {steps} steps a period",
                run=lambda steps=steps: sought(lambda w: mujoco(w, steps)),
            )
            for steps in (100, 5000)
        ),
        Contender(
            program="odeint",
            how="the pivot's acceleration in the equation, controlled dopri5, rtol 1e-12",
            run=lambda: sought(odeint),
        ),
    ),
)
