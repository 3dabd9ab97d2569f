"""A chain of 100 links that is let go from horizontal.

The right answer comes from Newton's and Euler's equations of each link, with the forces in the
joints as unknowns, which make a banded system. It is integrated in 12th order. None of the programs
solves the equations in this form.
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from hybrid_chain import extrapolated_step

from hard_cases.case import Contender, HardCase, Outcome
from hard_cases.odeint import odeint
from hard_cases.rods import Array, mujoco_steps

G = 9.81
LINKS = 100
MASS = LENGTH = 1 / LINKS
T_END = 1.0
STEPS = 2000  # of the reference; 1000 move the tip by 3e-7 m, a 12th order makes it 1e-10 m


def rates_by_forces(_: float, y: Array) -> Array:
    """Force F_i acts on link i at its upper end, and -F_{i+1} at its lower end.

    The joints stay together, so that the two ends that meet have equal accelerations.
    """
    from scipy.linalg import solveh_banded

    q, qd = y[:LINKS], y[LINKS:]
    along = np.column_stack([np.cos(q), np.sin(q)])  # the y axis points down
    across = np.column_stack([-np.sin(q), np.cos(q)])
    spin = LENGTH / 2 * (qd**2)[:, None] * along
    inertia = MASS * LENGTH**2 / 12
    turned = LENGTH**2 / (4 * inertia) * across[:, :, None] * across[:, None, :]
    same = np.eye(2) / MASS + turned  # an end's acceleration by the force there,
    other = (turned - np.eye(2) / MASS)[:-1]  # less the acceleration by the force at the other end
    same[1:] += same[:-1].copy()
    banded = np.zeros((4, 2 * LINKS))
    banded[3, ::2], banded[3, 1::2], banded[2, 1::2] = same[:, 0, 0], same[:, 1, 1], same[:, 0, 1]
    banded[1, 2::2], banded[0, 3::2] = other[:, 0, 0], other[:, 0, 1]
    banded[2, 2::2], banded[1, 3::2] = other[:, 1, 0], other[:, 1, 1]
    apart = -spin
    apart[1:] -= spin[:-1]
    apart[0] -= [0, G]
    forces = solveh_banded(banded, apart.ravel(), check_finite=False).reshape(LINKS, 2)
    both = forces.copy()
    both[:-1] += forces[1:]
    return np.append(qd, -LENGTH / (2 * inertia) * np.sum(across * both, axis=1))


def tip(q: Any) -> Array:
    return LENGTH * np.array([np.sum(np.cos(q)), np.sum(np.sin(q))])


@cache
def tip_at_the_end() -> Array:
    y = np.zeros(2 * LINKS)
    for _ in range(STEPS):
        y = extrapolated_step(rates_by_forces, 0.0, y, T_END / STEPS)
    return tip(y[:LINKS])


def reference() -> Mapping[str, list[float]]:
    return {"tip": tip_at_the_end().tolist()}


def judged(q: Any, words: str) -> Outcome:
    return Outcome(error=float(np.abs(tip(q) - tip_at_the_end()).max()), said=words)


def pendcore(**tolerances: float) -> Outcome:
    import pendcore as pc

    scene = pc.Scene(links=[pc.Link(mass=MASS, length=LENGTH)] * LINKS, gravity=G)
    sol = pc.simulate(scene, q0=0.0, t_span=(0, T_END), store="end", **tolerances)
    return judged(sol.q[-1], f"{sol.stats.accepted} steps")


def scipy(**tolerances: float) -> Outcome:
    """Use the dense mass matrix of the angles, M = A cos(q_i - q_j), factorised by Cholesky."""
    from scipy.integrate import solve_ivp
    from scipy.linalg import cho_factor, cho_solve

    beyond = LINKS - 0.5 - np.arange(LINKS)
    moments = MASS * LENGTH * beyond
    coupled = LENGTH * np.minimum.outer(moments, moments)
    np.fill_diagonal(coupled, LENGTH * (moments - MASS * LENGTH / 6))

    def rates(_: float, y: Array) -> Array:
        c, s, squares = np.cos(y[:LINKS]), np.sin(y[:LINKS]), y[LINKS:] ** 2
        matrix = coupled * (np.outer(c, c) + np.outer(s, s))
        forces = moments * G * c - s * (coupled @ (c * squares)) + c * (coupled @ (s * squares))
        factor = cho_factor(matrix, overwrite_a=True, check_finite=False)
        return np.append(y[LINKS:], cho_solve(factor, forces, check_finite=False))

    sol = solve_ivp(rates, (0, T_END), np.zeros(2 * LINKS), "DOP853", **tolerances)
    return judged(sol.y[:LINKS, -1], f"{sol.t.size - 1} steps")


def mujoco(dt: float, integrator: str) -> Outcome:
    import mujoco

    inertia = MASS * LENGTH**2 / 12
    link = (
        '<body pos="{} 0 0"><joint type="hinge" axis="0 1 0"/>'
        f'<inertial pos="{LENGTH / 2} 0 0" mass="{MASS}" diaginertia="1e-9 {inertia} {inertia}"/>'
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="{dt}" gravity="0 0 {-G}" integrator="{integrator}"/>'
        f"<worldbody>{link.format(0)}{link.format(LENGTH) * (LINKS - 1)}{'</body>' * LINKS}"
        "</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    steps = round(T_END / dt)
    for done in range(steps):
        mujoco.mj_step(model, data)
        if any(warning.number for warning in data.warning):
            words = f"diverges after {done * dt:.2g} s, starts again, with a line on stderr"
            return Outcome(said=words, right=False)
    return judged(np.cumsum(data.qpos), f"{steps} steps")


CASE = HardCase(
    name="let_go",
    title="A chain of 100 links let go",
    scene=(
        "100 rods, 1 m and 1 kg in all, start horizontal and at rest; 1 s, with the "
        "crack of the tip."
    ),
    answer=(
        "The position of the tip at the end, to 2e-10 m, by the equations of force and torque of "
        "each link, with the joints' forces as unknowns, in 12th order."
    ),
    unit="m",
    allowed=1e-6,
    reference=reference,
    contenders=(
        Contender(program="pendcore", how="dopri5, defaults", run=pendcore),
        Contender(
            program="pendcore",
            how="dopri5, rtol 1e-11, atol 1e-14",
            run=lambda: pendcore(rtol=1e-11, atol=1e-14),
        ),
        Contender(program="scipy", how="a dense matrix, DOP853, defaults", run=scipy),
        Contender(
            program="scipy",
            how="a dense matrix, DOP853, rtol 1e-9, atol 1e-12",
            run=lambda: scipy(rtol=1e-9, atol=1e-12),
        ),
        *mujoco_steps(mujoco, ("RK4", 2e-3), ("implicitfast", 2e-3), ("RK4", 5e-5)),
        odeint(
            "a dense matrix, controlled fehlberg78, rtol 1e-9, atol 1e-12",
            "chain",
            repr(LINKS),
            repr(T_END),
            judge=lambda heard: judged(heard["q"], f"{heard['steps'][0]:.0f} steps"),
        ),
    ),
)
