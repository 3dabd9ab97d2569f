"""Damping of the wrong sign, w' = w^3: the rate is infinite after a finite time."""

from __future__ import annotations

import warnings

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import mujoco_rods, watched_mujoco

RATE = 1.0
POLE = 1 / (2 * RATE**2)
T_END = 1.0


def told(t: float, words: str, *, says: bool) -> Outcome:
    near = abs(t - POLE) < 1e-3
    return Outcome(
        error=abs(t - POLE), said=f"{words}, last t = {t:.9g} s", right=bool(says and near)
    )


def pendcore() -> Outcome:
    import pendcore as pc

    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # pendcore warns of a negative coefficient
        damping = pc.effects.ViscousJoint(joint=1, damping=0, damping3=-1.0)
        scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=0, effects=[damping])
        sol = pc.simulate(scene, q0=0, qd0=RATE, t_span=(0, T_END), on_failure="ignore")
    return told(sol.t[-1], f"status `{sol.status}`", says=not sol.success)


def scipy(method: str) -> Outcome:
    from scipy.integrate import solve_ivp

    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        sol = solve_ivp(lambda _, y: [y[1], y[1] ** 3], (0, T_END), [0, RATE], method)
    words = "failure" if not sol.success else "success"
    return told(sol.t[-1], f'{words}: "{sol.message}"', says=not sol.success)


def mujoco() -> Outcome:
    import mujoco

    model = mujoco_rods(dt=1e-3, integrator="RK4")
    data = mujoco.MjData(model)
    data.qvel[0] = RATE
    mujoco.set_mjcb_passive(lambda _, d: d.qfrc_passive.__iadd__(d.qvel**3))
    for _ in range(round(T_END / 1e-3)):
        mujoco.mj_step(model, data)
    mujoco.set_mjcb_passive(None)
    again = data.time < 0.99 * T_END
    words = "starts again from the start, with a line on stderr" if again else "goes on"
    return told(float(data.time), words, says=False)


def mujoco_watched() -> Outcome:
    model = mujoco_rods(dt=1e-4, integrator="RK4")
    with np.errstate(over="ignore"):
        t, _, words = watched_mujoco(model, RATE, lambda data: data.qvel**3, T_END)
    return told(t, words, says=words != "no warning")


CASE = HardCase(
    name="blow_up",
    title="Blow-up in finite time",
    scene="One rod without gravity and with negative damping, w' = w^3 from 1 rad/s.",
    answer=f"The rate is infinite at {POLE} s: the run ends there, and a message says so.",
    unit="s",
    allowed=1e-3,
    contenders=(
        Contender(program="pendcore", how="`ViscousJoint`, damping3 = -1", run=pendcore),
        *(
            Contender(
                program="scipy", how=f"{method}, defaults", run=lambda method=method: scipy(method)
            )
            for method in ("RK45", "LSODA")
        ),
        Contender(program="mujoco", how="mjcb_passive, 1 ms, RK4", run=mujoco),
        Contender(
            program="mujoco",
            how="the same, 0.1 ms, no autoreset, warnings looked at after each step",
            run=mujoco_watched,
            own_loop=True,
        ),
        odeint(
            "controlled dopri5, integrate_adaptive",
            "blow_up",
            judge=lambda heard: told(heard["t"][0], "returns without a word", says=False),
        ),
    ),
)
