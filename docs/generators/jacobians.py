"""How far the Jacobian of a step is from that of the motion: a table of docs/how_to/linearize.md.

    make write PAGE=jacobians

The textbook's rods, a torque in joint 1 that is held over the step, 100 random states that move and
100 that rest (held by torques in both joints). The Jacobian of the motion over a step is that of
`simulate(sensitivities=...)` at its tightest.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import partial
from typing import Any

import control
import mujoco
import numpy as np
import pendcore as pc
from page_part import ROOT, rewrite, table_of

sys.path.append(str(ROOT / "bench" / "compare"))
import mujoco_models

STATES, STEPS = 100, (0.01, 0.002)
TO_ABSOLUTE = np.kron(np.eye(2), np.tri(2))
"""MuJoCo's angles are those of the joints."""
EULER = mujoco.mjtIntegrator.mjINT_EULER
IMPLICIT = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
START = [f"{kind}[{i}]" for kind in ("q0", "qd0") for i in (1, 2)]


def driven(torques: Iterable[float]) -> pc.Scene:
    """The rods with constant torques in their joints."""
    motors = [pc.effects.Motor(joint=j, constant=x) for j, x in enumerate(torques, 1)]
    return pc.Scene.textbook().replace(effects=motors)


def of_the_motion(dt: float, q: Any, qd: Any, torques: Any) -> np.ndarray:
    names = [*START, "effect[1].constant"]
    sol = pc.simulate(driven(torques), (0, dt), q, qd, rtol=1e-13, atol=1e-16, store="end",
                      sensitivities=names)  # fmt: skip
    assert sol.sensitivities is not None
    return sol.sensitivities[-1]


def of_mujoco(integrator: Any, dt: float, q: Any, qd: Any, torques: Any) -> np.ndarray:
    spec = mujoco_models.chain([1.0, 1.0], [1.0, 1.0], 9.807)
    spec.option.timestep, spec.option.integrator = dt, integrator
    for joint in (1, 2):
        mujoco_models.add_motor(spec, joint)
    left_on = int(mujoco_models.ON_FOR["motor"])
    spec.option.disableflags = int(mujoco_models.EVERYTHING) & ~left_on
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos, data.qvel = np.diff(q, prepend=0.0), np.diff(qd, prepend=0.0)
    data.ctrl = torques
    A, B = np.zeros((4, 4)), np.zeros((4, 2))
    mujoco.mjd_transitionFD(model, data, 1e-6, True, A, B, None, None)  # centred
    A = TO_ABSOLUTE @ A @ np.linalg.inv(TO_ABSOLUTE)
    return np.hstack([A, TO_ABSOLUTE @ B[:, :1]])


def of_python_control(dt: float, q: Any, qd: Any, torques: Any) -> np.ndarray:
    """The equations as a nonlinear system of python-control, which takes forward differences."""

    def rates(t: float, x: Any, u: Any, _: Any) -> np.ndarray:
        scene = driven([u[0], torques[1]])
        return np.hstack([x[2:], scene.accelerations(t, x[:2], x[2:])])

    motion = control.nlsys(rates, None, inputs=1, states=4)
    system = control.linearize(motion, np.hstack([q, qd]), torques[:1]).sample(dt)
    return np.hstack([system.A, system.B])


def of_the_linear_system(dt: float, q: Any, qd: Any, torques: Any) -> np.ndarray:
    system = driven(torques).linearize(q, qd, inputs=[1]).discretize(dt)
    return np.hstack([system.A, system.B])


def of_runs(dt: float, q: Any, qd: Any, torques: Any) -> np.ndarray:
    """Central differences of 1e-6 between runs with the usual tolerances."""

    def end(x: Any) -> np.ndarray:
        sol = pc.simulate(driven(x[4:]), (0, dt), x[:2], x[2:4], store="end")
        return np.hstack([sol.q[-1], sol.qd[-1]])

    here = np.hstack([q, qd, torques])
    moves = 1e-6 * np.eye(5, len(here))
    return np.array([(end(here + one) - end(here - one)) / 2e-6 for one in moves]).T


WAYS: dict[str, Callable[..., np.ndarray]] = {
    "MuJoCo, `mjd_transitionFD`, Euler": partial(of_mujoco, EULER),
    "the same, `implicitfast`": partial(of_mujoco, IMPLICIT),
    "python-control, `linearize(...).sample(dt)`": of_python_control,
    "`scene.linearize(...).discretize(dt)`": of_the_linear_system,
    "central differences of `pc.simulate`": of_runs,
}
"""Each gets the step, s, angles, rates and torques."""


def states(rng: np.random.Generator, *, moving: bool) -> list[tuple[Any, Any, Any]]:
    """Angles, rates and torques."""
    drawn = []
    for _ in range(STATES):
        q = rng.uniform(-np.pi, np.pi, 2)
        torques = pc.Scene.textbook().trim(q, inputs=[1, 2])
        if moving:
            drawn.append((q, rng.normal(0, 2, 2), [rng.uniform(-2, 2), 0.0]))
        else:
            drawn.append((q, np.zeros(2), torques))
    return drawn


def main() -> None:
    rng = np.random.default_rng(1)
    rows = []
    kinds = [states(rng, moving=moving) for moving in (True, False)]
    for name, way in WAYS.items():
        cells = []
        for drawn in kinds:
            for dt in STEPS:
                errors = [
                    np.abs(way(dt, *state) - right).max() / np.abs(right).max()
                    for state in drawn
                    for right in [of_the_motion(dt, *state)]
                ]
                cells.append(f"{np.median(errors):.0e} ({max(errors):.0e})".replace("e-0", "e-"))
        rows.append([name, *cells])
    heads = ["Jacobian of a step", "moving, 10 ms", "2 ms", "at rest, 10 ms", "2 ms"]
    rewrite(ROOT / "docs/how_to/linearize.md", jacobians=table_of(heads, rows))


if __name__ == "__main__":
    main()
