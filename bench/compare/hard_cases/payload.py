"""The textbook's two rods with a million times their mass at the tip.

The slow and the fast mode belong to the equations linearised about hanging, M q'' = -K q with
M = [[4/3 + p, 1/2 + p], [1/2 + p, 1/3 + p]] and K = g diag(3/2 + p, 1/2 + p). They hold for angles
between the rods far below p^(-1/2), 1e-3 rad, so the answer at the end is integrated.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import cache
from math import cos, sin
from typing import Any

import numpy as np
from hybrid_chain import extrapolated_step
from mpmath import mp, mpf, sqrt

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods, mujoco_steps

G = 9.807
RATIO = 1e6
AMPLITUDE = 1e-4
STEPS = 40_000  # steps of the reference; half as many move the end by 3e-10 rad


@cache
def modes() -> tuple[tuple[Any, Any], ...]:
    """Return the angular frequency of each mode and its ratio of angles, second rod to first."""
    with mp.workdps(40):
        p, g = mpf(RATIO), mpf(G)
        m11, m12, m22 = p + mpf(4) / 3, p + mpf(1) / 2, p + mpf(1) / 3
        k1, k2 = g * (p + mpf(3) / 2), g * (p + mpf(1) / 2)
        a, b, c = m11 * m22 - m12**2, -(m11 * k2 + m22 * k1), k1 * k2
        root = sqrt(b**2 - 4 * a * c)
        squares = 2 * c / (-b + root), (-b + root) / (2 * a)
        return tuple((sqrt(s), (k1 - s * m11) / (s * m12)) for s in squares)


PERIOD = float(2 * mp.pi / modes()[0][0])
START = tuple(AMPLITUDE * float(x) for x in (2, modes()[0][1] + modes()[1][1]))  # from hanging


def hamilton(_: float, y: Array) -> Array:
    """Hamilton's equations, in angles from hanging and momenta p = M q'."""
    q1, q2, p1, p2 = y.tolist()
    a, c, s = 0.5 + RATIO, cos(q1 - q2), sin(q1 - q2)
    m11, m22 = 4 / 3 + RATIO, 1 / 3 + RATIO
    determinant = 7 / 36 + 2 * RATIO / 3 + (a * s) ** 2
    w1 = (m22 * p1 - a * c * p2) / determinant
    w2 = (m11 * p2 - a * c * p1) / determinant
    turning = a * s * w1 * w2
    weight = RATIO * G
    f1, f2 = (weight + 1.5 * G) * sin(q1), (weight + 0.5 * G) * sin(q2)
    return np.array([w1, w2, -turning - f1, turning - f2])


def solved(start: Sequence[float], steps: int = STEPS) -> Array:
    y = np.array([*start, 0.0, 0.0])
    for _ in range(steps):
        y = extrapolated_step(hamilton, 0.0, y, PERIOD / steps)
    return y[:2]


@cache
def end() -> tuple[float, ...]:
    return tuple(solved(START).tolist())


def reference() -> Mapping[str, list[float]]:
    return {"q": list(end())}


def judged(from_hanging: Any, words: str) -> Outcome:
    error = float(np.abs(np.asarray(from_hanging) - end()).max())
    if not np.isfinite(error):
        return Outcome(said=f"not a number; {words}", right=False)
    return Outcome(error=error, said=words)


def pendcore(**how: Any) -> Outcome:
    import pendcore as pc

    scene = pc.Scene.textbook().replace(effects=[pc.effects.Payload(mass=RATIO)])
    start = np.pi / 2 + np.array(START)
    sol = pc.simulate(scene, q0=start, t_span=(0, PERIOD), store="end", on_failure="ignore", **how)
    words = f"{sol.stats.accepted} steps"
    if not sol.success:
        return Outcome(said=f"status `{sol.status}`: {words}", right=False)
    return judged(sol.q[-1] - np.pi / 2, words)


def rates(_: float, y: Any) -> tuple[float, ...]:
    """Return the rates, in angles from hanging. The determinant is free of terms that cancel."""
    q1, q2, w1, w2 = y.tolist()
    c, s, a = cos(q1 - q2), sin(q1 - q2), 0.5 + RATIO
    r1 = -(1.5 + RATIO) * G * sin(q1) - a * s * w2**2
    r2 = -a * G * sin(q2) + a * s * w1**2
    determinant = 7 / 36 + 2 * RATIO / 3 + (a * s) ** 2
    qdd1 = ((1 / 3 + RATIO) * r1 - a * c * r2) / determinant
    return w1, w2, qdd1, ((4 / 3 + RATIO) * r2 - a * c * r1) / determinant


def scipy(method: str, **tolerances: float) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(rates, (0, PERIOD), [*START, 0, 0], method, **tolerances)
    return judged(sol.y[:2, -1], f"{sol.t.size - 1} steps")


def mujoco(dt: float, integrator: str) -> Outcome:
    import mujoco

    steps = round(PERIOD / dt)
    model = mujoco_rods(
        dt=PERIOD / steps, links=2, mass=1.0, gravity=G, integrator=integrator, payload=RATIO
    )
    data = mujoco.MjData(model)
    data.qpos[:] = START[0], START[1] - START[0]
    mujoco.mj_step(model, data, steps)
    words = f"{steps} steps"
    if any(warning.number for warning in data.warning):
        words = "diverges, starts again from hanging, with a line on stderr"
        return Outcome(said=words, right=False)
    return judged([data.qpos[0], data.qpos[0] + data.qpos[1]], words)


CASE = HardCase(
    name="payload",
    title="A payload of a million links",
    scene=(
        "The textbook's two rods with 1e6 kg at the tip, over a period of the slow mode. They "
        "start "
        f"with {AMPLITUDE:g} rad of the slow mode and as much of the fast mode, whose frequency is "
        f"{float(modes()[1][0] / modes()[0][0]):.0f} times as high."
    ),
    answer=(
        "The angles at the end, by Hamilton's equations in 12th order. (The programs solve "
        "Lagrange's equations, or their own.)"
    ),
    unit="rad",
    allowed=1e-6,
    reference=reference,
    contenders=(
        Contender(program="pendcore", how="dopri5, defaults", run=pendcore),
        Contender(
            program="pendcore",
            how="dopri5, rtol 1e-12, atol 1e-15",
            run=lambda: pendcore(rtol=1e-12, atol=1e-15),
        ),
        Contender(
            program="pendcore",
            how="radau5, rtol 1e-12, atol 1e-15",
            run=lambda: pendcore(method="radau5", rtol=1e-12, atol=1e-15),
        ),
        Contender(program="scipy", how="Radau, defaults", run=lambda: scipy("Radau")),
        Contender(
            program="scipy",
            how="DOP853, rtol 1e-12, atol 1e-15",
            run=lambda: scipy("DOP853", rtol=1e-12, atol=1e-15),
        ),
        *mujoco_steps(
            mujoco, ("RK4", 2e-3), ("implicitfast", 2e-3), ("implicitfast", 2e-5), ("RK4", 5e-6)
        ),
        odeint(
            "controlled fehlberg78, rtol 1e-12, atol 1e-15",
            "payload",
            *(repr(x) for x in (RATIO, *START, PERIOD)),
            judge=lambda heard: judged(heard["q"], f"{heard['steps'][0]:.0f} steps"),
        ),
    ),
)
