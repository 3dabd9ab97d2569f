"""A swing that passes a mark just before it turns: two events in one step."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from mpmath import asin, ellipf, ellipk, mp, mpf, pi, sin, sqrt

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_rods

G, AMPLITUDE, SWINGS = 9.81, 1.0, 50
SHOWN = 25.0  # ms; the figure shows this much before and after a turn
MARK = 0.99999  # rad from the vertical: passed 1.3 ms before and after the turn


def reference() -> dict[str, list[float]]:
    """Return all passages: the first, from rest at -AMPLITUDE; the others follow by the period."""
    with mp.workdps(30):
        k = sin(mpf(AMPLITUDE) / 2)
        unit = sqrt(2 / (3 * mpf(G)))
        quarter = ellipk(k**2) * unit
        past = ellipf(asin(sin(mpf(MARK) / 2) / k), k**2) * unit
        assert past < quarter < pi
        first, second = quarter + past, 3 * quarter - past
        times = [float(t + 4 * quarter * n) for n in range(SWINGS) for t in (first, second)]
        return {"t": times, "end": [float(4 * quarter * SWINGS)]}


def around_a_turn(times: Sequence[float] | Array) -> list[float]:
    """Return the times that the figure shows, as ms from the tenth turn on the mark's side."""
    first, second = reference()["t"][18:20]
    ms = 1e3 * (np.asarray(times, dtype=float) - (first + second) / 2)
    return ms[np.abs(ms) < SHOWN].tolist()  # type: ignore[no-any-return]


def judged(times: Sequence[float] | Array, steps: Sequence[float] | Array = ()) -> Outcome:
    """Judge the times of the passages that were found; the steps are for the figure."""
    known = np.array(reference()["t"])
    found = np.sort(np.asarray(times, dtype=float))
    trace = {"found": around_a_turn(found), "steps": around_a_turn(steps)}
    words = f"{found.size} of {known.size} passages found"
    if found.size == known.size:
        off = float(np.abs(found - known).max())
        return Outcome(error=off, said=f"{words}, to {off:.0e} s", trace=trace)
    return Outcome(said=words, right=False, trace=trace)


def pendcore(**how: float) -> Outcome:
    import pendcore as pc

    scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=G)
    mark = pc.events.JointAngle(joint=1, value=np.pi / 2 - MARK)
    span = (0, reference()["end"][0])
    sol = pc.simulate(scene, q0=np.pi / 2 + AMPLITUDE, t_span=span, events=[mark], **how)
    return judged([event.t for event in sol.events[0]], sol.t)


def scipy(method: str, **how: float) -> Outcome:
    from scipy.integrate import solve_ivp

    sol = solve_ivp(
        lambda _, y: [y[1], -1.5 * G * np.sin(y[0])],
        (0, reference()["end"][0]),
        [-AMPLITUDE, 0],
        method,
        events=lambda _, y: y[0] - MARK,
        rtol=1e-9,
        atol=1e-12,
        **how,
    )
    return judged(sol.t_events[0], sol.t)


def mujoco(dt: float) -> Outcome:
    import mujoco

    model = mujoco_rods(dt=dt, gravity=G, integrator="RK4")
    data = mujoco.MjData(model)
    data.qpos[0] = -AMPLITUDE
    before, found, times = -1.0, [], [0.0]
    for _ in range(round(reference()["end"][0] / dt)):
        mujoco.mj_step(model, data)
        now = float(data.qpos[0]) - MARK
        if before * now < 0:
            found.append(data.time - dt * now / (now - before))
        before = now
        times.append(data.time)
    return judged(found, times)


CASE = HardCase(
    name="two_roots",
    title="Two events in one step",
    scene=(
        f"One rod swings by {AMPLITUDE} rad, {SWINGS} times, and passes a mark at {MARK} rad "
        "1.3 ms before and after each turn on one side."
    ),
    answer="Every passage, twice in each swing, at the times of the elliptic integral.",
    unit="s",
    allowed=1e-4,
    figure="Steps and passages found about the tenth turn, by each program",
    contenders=(
        *(
            Contender(
                program="pendcore",
                how=f"`JointAngle`, dopri5, rtol {rtol:.0e}".replace("e-0", "e-"),
                run=lambda rtol=rtol: pendcore(rtol=rtol),
            )
            for rtol in (1e-9, 1e-12)
        ),
        Contender(
            program="pendcore",
            how="`JointAngle`, dopri5, rtol 1e-12, max_step 2 ms",
            run=lambda: pendcore(rtol=1e-12, max_step=2e-3),
        ),
        Contender(program="scipy", how="events, RK45", run=lambda: scipy("RK45")),
        Contender(program="scipy", how="events, DOP853", run=lambda: scipy("DOP853")),
        Contender(
            program="scipy",
            how="events, RK45, max_step 2 ms",
            run=lambda: scipy("RK45", max_step=2e-3),
        ),
        *(
            Contender(
                program="mujoco",
                how=f"signs of successive steps, {1e3 * dt:g} ms, RK4",
                run=lambda dt=dt: mujoco(dt),
                own_loop=True,
            )
            for dt in (2e-3, 1e-4)
        ),
        *(
            odeint(
                f"signs of successive steps, bisected on the dense output, dopri5{words}",
                "two_roots",
                repr(reference()["end"][0]),
                repr(longest),
                judge=lambda heard: judged(heard["t"]),
                own_loop=True,
            )
            for longest, words in ((1e9, ""), (2e-3, ", steps of at most 2 ms"))
        ),
    ),
)
