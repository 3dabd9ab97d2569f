"""Two rods that stand a billionth of a radian off upright, and the time of their fall by 1 rad."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import UPRIGHT, Array, mujoco_rods, textbook_rates

OFF = 1e-9
START = UPRIGHT + OFF
T_END = 6.0


@cache
def fall_time() -> float:
    """Return when link 1 or 2 is 1 rad off, in 25 digits, from the exact double START."""
    from mpmath import cos, findroot, mp, mpf, odefun, sin

    with mp.workdps(25):
        g = mpf(9.807)

        def rates(_: Any, y: Any) -> list[Any]:
            a12, h = cos(y[0] - y[1]) / 2, sin(y[0] - y[1]) / 2
            r1 = 3 * g * cos(y[0]) / 2 - h * y[3] ** 2
            r2 = g * cos(y[1]) / 2 + h * y[2] ** 2
            det = mpf(4) / 9 - a12**2
            return [y[2], y[3], (r1 / 3 - a12 * r2) / det, (4 * r2 / 3 - a12 * r1) / det]

        motion = odefun(rates, 0, [mpf(START), mpf(START), 0, 0])

        def off(t: Any) -> Any:
            return max(abs(x - mpf(UPRIGHT)) for x in motion(t)[:2]) - 1

        t = mpf(1)
        while off(t) < 0:
            t += mpf(1) / 10
        return float(findroot(off, (t - mpf(1) / 10, t), solver="anderson", tol=1e-30))


def reference() -> Mapping[str, list[float]]:
    return {"t": [fall_time()]}


def judged(t: float) -> Outcome:
    return Outcome(error=abs(t - fall_time()), said=f"{t:.9f} s")


def first(distance: Callable[[float], float], times: Array) -> float:
    """Return when the distance is first 1, bisected between two of the times."""
    after = next(k for k, t in enumerate(times) if distance(t) > 1)
    low, high = times[after - 1], times[after]
    for _ in range(80):
        middle = (low + high) / 2
        low, high = (low, middle) if distance(middle) > 1 else (middle, high)
    return float(high)


def pendcore() -> Outcome:
    import pendcore as pc

    sol = pc.simulate(pc.Scene.textbook(), q0=START, t_span=(0, T_END), rtol=1e-12, atol=1e-15)
    return judged(first(lambda t: np.abs(sol(t)[:2] - UPRIGHT).max(), sol.t))


def scipy(**tolerances: float) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(
        textbook_rates, (0, T_END), [START, START, 0, 0], "DOP853", dense_output=True, **tolerances
    )
    return judged(first(lambda t: np.abs(sol.sol(t)[:2] - UPRIGHT).max(), sol.t))


def mujoco() -> Outcome:
    import mujoco

    dt = 1e-4
    model = mujoco_rods(dt=dt, links=2, mass=1.0, gravity=9.807, integrator="RK4", hanging=False)
    data = mujoco.MjData(model)
    data.qpos[:] = START - UPRIGHT, 0.0
    before = 0.0
    while data.time < T_END:
        mujoco.mj_step(model, data)
        now = max(abs(data.qpos[0]), abs(data.qpos[0] + data.qpos[1]))
        if now > 1:
            return judged(data.time - dt * (now - 1) / (now - before))
        before = now
    return Outcome(said="does not fall", right=False)


CASE = HardCase(
    name="upright",
    title="The fall from upright",
    scene="The textbook's two rods at rest, 1e-9 rad off upright: when has a link fallen by 1 rad?",
    answer="The time, known in 25 digits; the last bits of a double leave it uncertain by 1e-8 s.",
    unit="s",
    allowed=1e-6,
    reference=reference,
    contenders=(
        Contender(program="pendcore", how="dopri5, rtol 1e-12, atol 1e-15", run=pendcore),
        Contender(program="scipy", how="DOP853, defaults", run=scipy),
        Contender(
            program="scipy",
            how="DOP853, rtol 1e-12, atol 1e-15",
            run=lambda: scipy(rtol=1e-12, atol=1e-15),
        ),
        Contender(program="mujoco", how="RK4, 0.1 ms", run=mujoco),
        odeint(
            "dopri5 with dense output, rtol 1e-12, atol 1e-15",
            "upright",
            *(repr(float(x)) for x in (START, UPRIGHT, 1e-12, 1e-15)),
            judge=lambda heard: judged(heard["t"][0]),
        ),
    ),
)
