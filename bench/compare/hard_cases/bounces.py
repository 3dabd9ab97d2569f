"""A rod pressed against a stop, with bounces that accumulate and end."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods

TORQUE, HEIGHT, RESTITUTION, CAPTURE = 2.0, 0.4, 0.8, 1e-9
FIRST = float(np.sqrt(2 * TORQUE * HEIGHT))  # speed of the first impact
T_LAST = FIRST / TORQUE * (1 + 2 * RESTITUTION / (1 - RESTITUTION))  # infinitely many are over
T_END = 8.0
APEX = FIRST * (1 + RESTITUTION) / TORQUE  # the top of the first bounce
RISE = (RESTITUTION * FIRST) ** 2 / (2 * TORQUE)


# s before T_LAST; the figure shows these times
BEFORE = np.append(np.linspace(T_LAST, 1, 300, endpoint=False), np.geomspace(1, 1e-7, 700))
TRACED = T_LAST - BEFORE


def judged(
    q_end: float, t_last: float | None, more: str = "", traced: Sequence[float] | Array = ()
) -> Outcome:
    """Judge where the rod is at the end (exactly 0), and when it came to rest.

    `traced` has the angles at TRACED.
    """
    trace = {"q": [float(q) for q in traced]} if len(traced) else {}
    if abs(q_end) > 1e-3:
        said = f"is at {q_end:.3g} rad at the end: off the stop"
        return Outcome(error=abs(q_end), said=said, trace=trace)
    if t_last is None:
        return Outcome(said=f"never at rest; {more}", right=False, trace=trace)
    said = f"at rest after {t_last:.9f} s{more}"
    return Outcome(error=abs(t_last - T_LAST), said=said, trace=trace)


def pendcore() -> Outcome:
    import pendcore as pc

    effects = [
        pc.effects.Motor(joint=1, constant=-TORQUE),
        pc.effects.JointStop(joint=1, range=(0, np.inf), restitution=RESTITUTION),
    ]
    scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=0, effects=effects)
    sol = pc.simulate(scene, q0=HEIGHT, t_span=(0, T_END), rtol=1e-11)
    moving = np.flatnonzero(sol.qd[:, 0])
    t_last = sol.t[moving[-1] + 1] if sol.status == "at_rest" else None
    return judged(sol.q[-1, 0], t_last, traced=sol(TRACED)[0])


def scipy(guarded: bool) -> Outcome:
    """End each flight by an event and start the next; below the capture speed the rod rests.

    With `guarded`, no step is longer than a quarter of the flight, which the user then must know.
    """
    from scipy.integrate import solve_ivp

    def hits(_: float, y: list[float]) -> float:
        return y[0]

    hits.terminal, hits.direction = True, -1  # type: ignore[attr-defined]
    t, y, traced = 0.0, [HEIGHT, 0.0], np.zeros(TRACED.size)
    while t < T_END:
        flight = 2 * y[1] / TORQUE if guarded and t > 0 else np.inf
        sol = solve_ivp(
            lambda _, y: [y[1], -TORQUE], (t, T_END), y, events=hits, rtol=1e-11, atol=1e-13,
            max_step=flight / 4, dense_output=True,
        )  # fmt: skip
        here = (t <= TRACED) & (sol.t[-1] >= TRACED)
        if here.any():
            traced[here] = sol.sol(TRACED[here])[0]
        t = sol.t[-1]
        if sol.status != 1:
            return judged(sol.y[0, -1], None, traced=traced)
        speed = -RESTITUTION * sol.y[1, -1]
        if abs(speed) < CAPTURE:
            return judged(0.0, t, traced=traced)
        y = [0.0, speed]
    return judged(y[0], None, traced=traced)


def mujoco(dt: float) -> Outcome:
    """Model the stop as a stiff spring and damper that together give the restitution."""
    import mujoco

    stiffness = (0.1 / dt) ** 2  # half a contact takes thirty steps
    damping_ratio = -np.log(RESTITUTION) / np.hypot(np.pi, np.log(RESTITUTION))
    damping = 2 * damping_ratio * np.sqrt(stiffness)
    limit = (
        f'limited="true" range="0 1000" solreflimit="{-stiffness} {-damping}" '
        'solimplimit="0.9999 0.9999 0.001"'
    )
    model = mujoco_rods(dt=dt, joint=limit, integrator="RK4")
    model.jnt_range[0] = [0.0, 1e3]
    data = mujoco.MjData(model)
    data.qpos[0], data.ctrl[0] = HEIGHT, -TORQUE
    last, top, times, angles = 0.0, 0.0, [0.0], [HEIGHT]
    for _ in range(round(T_END / dt)):
        mujoco.mj_step(model, data)
        times.append(data.time)
        angles.append(float(data.qpos[0]))
        if abs(data.qvel[0]) > 1e-3:
            last = data.time
        if FIRST / TORQUE * 1.05 < data.time < 1.05 * APEX:
            top = max(top, float(data.qpos[0]))
    more = f" (as far as the rate is below 1e-3 rad/s); first rise {top / RISE - 1:+.1%}"
    return judged(angles[-1], last, more, np.interp(TRACED, times, angles))


CASE = HardCase(
    name="bounces",
    title="Accumulating bounces",
    scene=(
        "One rod without gravity, pressed against a stop by 2 N m from 0.4 rad, with restitution "
        "0.8: infinitely many bounces in a finite time."
    ),
    answer=f"The rod rests on the stop from t_1 (1 + 2 e/(1 - e)) = {T_LAST:.9f} s on.",
    unit="s",
    allowed=2e-8,
    reference=lambda: {"before": BEFORE.tolist()},
    figure="Height of the bounces over the time that is left, by each program",
    contenders=(
        Contender(program="pendcore", how="`JointStop`, rtol 1e-11", run=pendcore),
        Contender(
            program="scipy",
            how="a terminal event, and again from there, RK45",
            run=lambda: scipy(False),
            own_loop=True,
        ),
        Contender(
            program="scipy",
            how="the same, max_step a quarter of each flight",
            run=lambda: scipy(True),
            own_loop=True,
        ),
        Contender(program="mujoco", how="a limit, 2 ms, RK4", run=lambda: mujoco(2e-3)),
        Contender(program="mujoco", how="a limit, 0.1 ms, RK4", run=lambda: mujoco(1e-4)),
        odeint(
            "steps looked at for the sign of the angle, bisected, dopri5",
            "bounces",
            own_loop=True,
            judge=lambda told: judged(told["q"][0], told["t"][0] if told["t"][0] > 0 else None),
        ),
    ),
)
