"""A start so late that a step does not change the time."""

from __future__ import annotations

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import mujoco_rods, textbook_rates

T_START, T_END = 1e17, 1e17 + 160  # ten units in the last place
START = [0.3, 0.3, 0.0, 0.0]


def told(words: str, *, says: bool) -> Outcome:
    return Outcome(said=words, right=says)


def pendcore() -> Outcome:
    import pendcore as pc

    sol = pc.simulate(
        pc.Scene.textbook(), q0=START[:2], t_span=(T_START, T_END), on_failure="ignore"
    )
    words = f'status `{sol.status}`: "{sol.message}"'
    return told(words, says=sol.status == "step_too_small")


def scipy(method: str) -> Outcome:
    from scipy.integrate import solve_ivp

    with np.errstate(all="ignore"):
        sol = solve_ivp(textbook_rates, (T_START, T_END), START, method)
    y = sol.y[:, -1]
    if sol.success:
        words = f'success: "{sol.message}" after {sol.t.size - 1} steps, at q = {y[0]:.3g} rad'
    else:
        words = f'failure: "{sol.message}"'
    return told(words, says=not sol.success)


def mujoco() -> Outcome:
    import mujoco

    model = mujoco_rods(dt=2e-3, links=2, mass=1.0, gravity=9.807, integrator="RK4")
    data = mujoco.MjData(model)
    data.time = T_START
    data.qpos[0] = np.pi / 2 - START[0]
    for _ in range(5000):
        mujoco.mj_step(model, data)
    gone = data.time - T_START
    return told(f"moves on for 10 s while its clock goes by {gone:g} s, no warning", says=False)


def judged(heard: dict[str, list[float]]) -> Outcome:
    (t,), (q,), (steps,) = heard["t"], heard["q"], heard["steps"]
    words = f"returns after {steps:.0f} steps at t0 + {t - T_START:g} s, q = {q:.3g} rad"
    return told(words + ", without a word", says=False)


CASE = HardCase(
    name="late_start",
    title="A time too large for its step",
    scene="The textbook's two rods for 160 s from t = 1e17 s, where doubles are 16 s apart.",
    answer="The run is impossible, and a message says so.",
    unit="",
    allowed=0.0,
    contenders=(
        Contender(program="pendcore", how="defaults", run=pendcore),
        *(
            Contender(
                program="scipy", how=f"{method}, defaults", run=lambda method=method: scipy(method)
            )
            for method in ("RK45", "Radau", "LSODA")
        ),
        Contender(program="mujoco", how="2 ms, RK4", run=mujoco),
        odeint("controlled dopri5, integrate_adaptive", "late_start", judge=judged),
    ),
)
