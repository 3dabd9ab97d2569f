"""A couple of the user's own that is no number beyond an angle: sqrt(0.5 - q)."""

from __future__ import annotations

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods, watched_mujoco

RATE, EDGE, T_END = 1.0, 0.5, 2.0
# q'' = 0, but the couple is not a number beyond the edge, which the rod reaches at 0.5 s


def couple(q: Array) -> Array:
    with np.errstate(invalid="ignore"):
        return 0.0 * np.sqrt(EDGE - q)


def told(t: float, q: float, words: str, *, says: bool) -> Outcome:
    """Judge a program: it is right if it ends the run near that angle and says so."""
    near = abs(t - EDGE / RATE) < 0.01 and np.isfinite(q)
    return Outcome(
        error=abs(t - EDGE / RATE), said=f"{words}, last t = {t:.6g} s, q = {q:.6g} rad",
        right=bool(says and near),
    )  # fmt: skip


def pendcore() -> Outcome:
    import pendcore as pc

    effects = [pc.effects.User(lambda t, q, qd: couple(q))]
    scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=0, effects=effects)
    sol = pc.simulate(scene, q0=0, qd0=RATE, t_span=(0, T_END), on_failure="ignore")
    return told(sol.t[-1], sol.q[-1, 0], f"status `{sol.status}`", says=not sol.success)


def scipy(method: str) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(lambda _, y: [y[1], float(couple(y[0]))], (0, T_END), [0, RATE], method)
    words = "failure" if not sol.success else "success"
    return told(sol.t[-1], sol.y[0, -1], f'{words}: "{sol.message}"', says=not sol.success)


def mujoco() -> Outcome:
    import mujoco

    model = mujoco_rods(dt=1e-3, integrator="RK4")
    data = mujoco.MjData(model)
    data.qvel[0] = RATE
    mujoco.set_mjcb_passive(lambda _, d: d.qfrc_passive.__iadd__(couple(d.qpos)))
    # the user asks for the time, and gets that of the start again
    for _ in range(round(T_END / 1e-3)):
        mujoco.mj_step(model, data)
    mujoco.set_mjcb_passive(None)
    again = data.time < 0.99 * T_END
    words = "starts again from the start, with a line on stderr" if again else "goes on"
    return told(float(data.time), float(data.qpos[0]), words, says=False)


def mujoco_watched() -> Outcome:
    model = mujoco_rods(dt=1e-3, integrator="RK4")
    t, q, words = watched_mujoco(model, RATE, lambda data: couple(data.qpos), T_END)
    return told(t, q, words, says=words != "no warning")


CASE = HardCase(
    name="not_a_number",
    title="Not a number in mid-run",
    scene=(
        "One rod turns freely at 1 rad/s under a user's couple 0 sqrt(0.5 - q), which is not a "
        "number beyond 0.5 rad."
    ),
    answer="The run ends at 0.5 s with a finite state, and a message says so.",
    unit="s",
    allowed=0.01,
    contenders=(
        Contender(program="pendcore", how="`User`", run=pendcore),
        *(
            Contender(
                program="scipy", how=f"{method}, defaults", run=lambda method=method: scipy(method)
            )
            for method in ("RK45", "Radau", "LSODA")
        ),
        Contender(program="mujoco", how="mjcb_passive, 1 ms, RK4", run=mujoco),
        Contender(
            program="mujoco",
            how="the same, no autoreset, warnings looked at after each step",
            run=mujoco_watched,
            own_loop=True,
        ),
        odeint(
            "controlled dopri5, integrate_adaptive",
            "not_a_number",
            judge=lambda heard: told(
                heard["t"][0], heard["q"][0], "returns without a word", says=False
            ),
        ),
    ),
)
