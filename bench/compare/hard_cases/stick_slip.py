"""A rod under a constant torque and a hum, which moves in a staircase of slides and rests."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache
from typing import Any

import numpy as np
from mpmath import mp, mpf
from stick_slip import DIGITS, Hum, slides

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import STIFF_FRICTION, Array, driven_mujoco, mujoco_rods

BIAS, AMPLITUDE, FREQUENCY, FRICTION = 0.4, 0.5, 2.0, 0.7
STAIRS = 20
TURN = 2 * np.pi / FREQUENCY
T_END = STAIRS * TURN  # within a rest
SOFT = 1e-4


def torque(t: Any) -> Any:
    return BIAS + AMPLITUDE * np.sin(FREQUENCY * t)


@cache
def reference() -> Mapping[str, list[float]]:
    with mp.workdps(DIGITS):
        hum = Hum(
            bias=mpf(BIAS), amplitude=mpf(AMPLITUDE), frequency=mpf(FREQUENCY),
            friction=mpf(FRICTION),
        )  # fmt: skip
        found = list(slides(hum, mpf(T_END)))
        end = float(found[-1].angle_at(found[-1].end))
        return {"end": [end], "rest": [float(found[1].end), float(found[2].begin)]}


def judged(end: float, at_rest: float) -> Outcome:
    """Judge the angle at the end, and the rate in the middle of a rest."""
    creep = "rests exactly" if at_rest == 0 else f"creeps at {abs(at_rest):.0e} rad/s in its rests"
    return Outcome(error=abs(end - reference()["end"][0]), said=creep)


def resting() -> float:
    return float(np.mean(reference()["rest"]))


def pendcore() -> Outcome:
    import pendcore as pc

    hum = pc.effects.Sinusoid(amplitude=AMPLITUDE, angular_frequency=FREQUENCY)
    effects = [
        pc.effects.Motor(joint=1, sinusoid=hum),
        pc.effects.Motor(joint=1, constant=BIAS),
        pc.effects.DryJointFriction(joint=1, coulomb=FRICTION),
    ]
    scene = pc.Scene(links=[pc.Link(mass=3, length=1)], gravity=0, effects=effects)
    sol = pc.simulate(scene, q0=0, t_span=(0, T_END), rtol=1e-11)
    return judged(sol.q[-1, 0], float(sol(resting())[1]))


def scipy_smoothed() -> Outcome:
    from scipy.integrate import solve_ivp

    def rates(t: float, y: Array) -> list[float]:
        return [y[1], torque(t) - FRICTION * np.tanh(y[1] / SOFT)]

    sol = solve_ivp(rates, (0, T_END), [0, 0], "Radau", rtol=1e-9, atol=1e-12, dense_output=True)
    return judged(sol.y[0, -1], sol.sol(resting())[1])


def scipy_events() -> Outcome:
    """Use two modes, a loop, and an event for each way out; max_step keeps steps within a rest."""
    from scipy.integrate import solve_ivp

    def event(function: Callable[[float, Array], float], direction: int = 0) -> Any:
        return type("Event", (), {"__call__": lambda _, t, y: function(t, y), "terminal": True,
                                  "direction": direction})()  # fmt: skip

    leaves = event(lambda t, _: FRICTION - abs(torque(t)), -1)
    how = {"rtol": 1e-11, "atol": 1e-13, "dense_output": True, "max_step": TURN / 20}
    t, y, sliding, pieces = 0.0, np.zeros(2), 0.0, []
    while t < T_END:
        side = sliding
        stops = event(lambda _, y, side=side: side * y[1], -1)
        rates = (lambda t, y, side=side: [y[1], torque(t) - side * FRICTION]) if side else (
            lambda t, y: [0.0, 0.0]
        )  # fmt: skip
        sol = solve_ivp(rates, (t, T_END), y, events=[stops if side else leaves], **how)
        pieces.append(sol)
        if sol.t[-1] <= t:
            raise RuntimeError(f"stuck in its loop at t = {t:.3f}")
        t, y = sol.t[-1], np.array([sol.y[0, -1], 0.0])
        sliding = 0.0 if side and abs(torque(t)) <= FRICTION else np.sign(torque(t))

    def at(t: float) -> Array:
        piece: Array = next(sol for sol in pieces if t <= sol.t[-1]).sol(t)
        return piece

    return judged(pieces[-1].y[0, -1], at(resting())[1])


def mujoco(dt: float, joint: str, integrator: str) -> Outcome:
    model = mujoco_rods(dt=dt, joint=f'frictionloss="{FRICTION}" {joint}', integrator=integrator)
    t, q, qd = driven_mujoco(model, torque, T_END)
    return judged(q[-1], float(np.interp(resting(), t, qd)))


CASE = HardCase(
    name="stick_slip",
    title="Stick and slip under a hum",
    scene=(
        "One rod of moment of inertia 1 kg m^2 without gravity, under the torque 0.4 + 0.5 sin "
        "2t N m "
        f"and friction of 0.7 N m: {STAIRS} slides with rests between them."
    ),
    answer="Exact rest between slides, and the angle at the end by a closed form.",
    unit="rad",
    allowed=1e-9,
    reference=reference,
    contenders=(
        Contender(program="pendcore", how="`DryJointFriction`, rtol 1e-11", run=pendcore),
        Contender(program="scipy", how="sign smoothed over 1e-4 rad/s, Radau", run=scipy_smoothed),
        Contender(
            program="scipy",
            how="a loop over events, 20 lines, RK45",
            run=scipy_events,
            own_loop=True,
        ),
        Contender(
            program="mujoco",
            how="`frictionloss`, 2 ms",
            run=lambda: mujoco(2e-3, "", "implicitfast"),
        ),
        Contender(
            program="mujoco",
            how="`frictionloss`, hardest constraint, 0.5 ms, RK4",
            run=lambda: mujoco(5e-4, STIFF_FRICTION.format(1e-3), "RK4"),
        ),
        odeint(
            "sign smoothed over 1e-4 rad/s, rosenbrock4",
            "stick_slip",
            repr(resting()),
            judge=lambda told: judged(told["end"][0], told["rest"][0]),
        ),
    ),
)
