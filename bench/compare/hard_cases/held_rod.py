"""A rod that friction holds at 30 degrees for a million seconds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import STIFF_FRICTION, Array, mujoco_rods

G, T_END = 9.81, 1e6
START = np.pi / 6  # below the horizontal
WEIGHT = 3 * G / 2
FRICTION = float(2 * WEIGHT * np.cos(START))
SOFT = 1e-6  # rad/s; the sign is smoothed over this rate


TRACED = np.geomspace(1e-2, T_END, 161)  # s, for the figure


def moved(
    by: float, *, extrapolated_from: float = 0.0, traced: Sequence[float] | Array = ()
) -> Outcome:
    """Judge how far the rod has moved at the end; `traced` has its way at TRACED."""
    words = f"moves by {by:.1e} rad" if by else "moves by exactly nothing"
    if extrapolated_from:
        words += f" (its rate after {extrapolated_from:.0f} s, times 1e6 s)"
    trace = {"moved": [abs(float(x)) for x in traced]} if len(traced) else {}
    return Outcome(error=abs(by), said=words, trace=trace)


def pendcore() -> Outcome:
    import pendcore as pc

    friction = pc.effects.DryJointFriction(joint=1, coulomb=FRICTION)
    scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=G, effects=[friction])
    sol = pc.simulate(scene, q0=START, t_span=(0, T_END))
    held = moved(abs(sol.q[-1, 0] - START), traced=sol(TRACED)[0] - START)
    return replace(held, said=f"{held.said}; status `{sol.status}`")


def smoothed(_: float, y: Array) -> list[float]:
    return [y[1], WEIGHT * np.cos(y[0]) - FRICTION * np.tanh(y[1] / SOFT)]


def scipy_smoothed() -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(smoothed, (0, T_END), [START, 0], "Radau", rtol=1e-8, atol=1e-12, t_eval=TRACED)
    return moved(sol.y[0, -1] - START, traced=sol.y[0] - START)


def scipy_events() -> Outcome:
    """Use a flag of the user's own: the rod rests if friction can hold it and the rate is zero."""
    held = abs(WEIGHT * np.cos(START)) <= FRICTION
    return moved(0.0) if held else Outcome(said="slides")


def mujoco_creep(dt: float, joint: str, seconds: float = 10.0) -> Outcome:
    import mujoco

    model = mujoco_rods(dt=dt, gravity=G, joint=f'frictionloss="{FRICTION!r}" {joint}')
    data = mujoco.MjData(model)
    data.qpos[0] = np.pi / 2 - START
    times, angles = [0.0], [float(data.qpos[0])]
    for _ in range(round(seconds / dt)):
        mujoco.mj_step(model, data)
        times.append(data.time)
        angles.append(float(data.qpos[0]))
    rate = float(data.qvel[0])
    traced = np.interp(TRACED, times, angles) - angles[0]
    traced += rate * np.maximum(TRACED - seconds, 0)
    return moved(-rate * T_END, extrapolated_from=seconds, traced=traced)


CASE = HardCase(
    name="held_rod",
    title="A rod held by friction for 1e6 s",
    scene=(
        "One rod at 30 degrees below the horizontal, with friction of twice the torque "
        "of its weight."
    ),
    answer="The rod does not move at all.",
    unit="rad",
    allowed=0.0,
    reference=lambda: {"t": TRACED.tolist()},
    figure="How far the rod has crept over the time, by each program",
    contenders=(
        Contender(program="pendcore", how="`DryJointFriction`", run=pendcore),
        Contender(program="scipy", how="sign smoothed over 1e-6 rad/s, Radau", run=scipy_smoothed),
        Contender(program="scipy", how="a flag for rest", run=scipy_events, own_loop=True),
        Contender(program="mujoco", how="`frictionloss`, 2 ms", run=lambda: mujoco_creep(2e-3, "")),
        Contender(
            program="mujoco",
            how="`frictionloss`, hardest constraint, 0.1 ms",
            run=lambda: mujoco_creep(1e-4, STIFF_FRICTION.format(2e-4)),
        ),
        odeint(
            "sign smoothed over 1e-6 rad/s, rosenbrock4",
            "held_rod",
            judge=lambda told: moved(told["q"][0] - START),
        ),
    ),
)
