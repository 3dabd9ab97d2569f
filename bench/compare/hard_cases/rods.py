"""The scenes as the peers take them: a rod of moment of inertia 1, and the textbook's two rods."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from hard_cases.case import Contender, Outcome

Array = npt.NDArray[np.float64]

UPRIGHT = -np.pi / 2

ROD = """<mujoco>
 <option timestep="{dt}" gravity="0 0 {down}" integrator="{integrator}" iterations="200"
         tolerance="0"/>
 <worldbody>
  <body>
   <joint name="joint" type="hinge" axis="0 1 0" {joint}/>
   <inertial pos="0 0 {side}0.5" mass="{mass}" diaginertia="{inertia} {inertia} {thin}"/>
   {tip}
  </body>
 </worldbody>
 <actuator><motor joint="joint"/></actuator>
</mujoco>"""

SECOND = """<body pos="0 0 {side}1">
    <joint name="second" type="hinge" axis="0 1 0" {joint}/>
    <inertial pos="0 0 {side}0.5" mass="{mass}" diaginertia="{inertia} {inertia} {thin}"/>
    {load}
   </body>"""

LOAD = """<body pos="0 0 {side}1"><inertial pos="0 0 0" mass="{payload}"
     diaginertia="1e-9 1e-9 1e-9"/></body>"""


def mujoco_rods(
    *,
    dt: float,
    links: int = 1,
    mass: float = 3.0,
    gravity: float = 0.0,
    joint: str = "",
    integrator: str = "implicitfast",
    hanging: bool = True,
    payload: float = 0.0,
) -> Any:
    """Compile uniform rods of 1 m; the joints' angles are 0 where all hang, or all stand.

    `payload` is a point mass at the tip of the second rod.
    """
    import mujoco

    known = {
        "dt": repr(dt), "down": -gravity, "integrator": integrator, "joint": joint, "mass": mass,
        "inertia": mass / 12, "thin": 1e-4, "side": "-" if hanging else "",
        "payload": payload,
    }  # fmt: skip
    known["load"] = LOAD.format(**known) if payload else ""
    tip = SECOND.format(**known) if links == 2 else ""
    return mujoco.MjModel.from_xml_string(ROD.format(tip=tip, **known))


STIFF_FRICTION = 'solimpfriction="0.9999 0.9999 0.001" solreffriction="{} 1"'
"""MuJoCo's friction at its hardest; the time constant, s, is to be filled in."""


def mujoco_steps(
    run: Callable[[float, str], Outcome], *ways: tuple[str, float]
) -> tuple[Contender, ...]:
    """Return MuJoCo with each integrator and step, s, that is given: ``run(step, integrator)``."""
    return tuple(
        Contender(
            program="mujoco",
            how=f"{integrator}, {1e3 * dt:g} ms",
            run=partial(run, dt, integrator),
        )
        for integrator, dt in ways
    )


def driven_mujoco(model: Any, torque: Callable[[float], float], t_end: float) -> Array:
    """Run under a torque in the first joint; return rows of t, the joints' angles and rates."""
    import mujoco

    data = mujoco.MjData(model)
    mujoco.set_mjcb_control(lambda _, d: d.ctrl.fill(torque(d.time)))
    rows = [np.array([0.0, *data.qpos, *data.qvel])]
    for _ in range(round(t_end / model.opt.timestep)):
        mujoco.mj_step(model, data)
        rows.append(np.array([data.time, *data.qpos, *data.qvel]))
    mujoco.set_mjcb_control(None)
    return np.transpose(rows)


def watched_mujoco(model: Any, rate: float, couple: Callable[[Any], Any], t_end: float) -> Any:
    """Run from a rate under a couple until there is a warning; return the last t and q, and words.

    The user has disabled MuJoCo's restart from the start, and looks for warnings after each step.
    """
    import mujoco

    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    data = mujoco.MjData(model)
    data.qvel[0] = rate
    mujoco.set_mjcb_passive(lambda _, d: d.qfrc_passive.__iadd__(couple(d)))
    t, q, words = 0.0, 0.0, ""
    while data.time < t_end and not words:
        t, q = float(data.time), float(data.qpos[0])
        mujoco.mj_step(model, data)
        found = [k for k, warning in enumerate(data.warning) if warning.number]
        words = f"warning `{mujoco.mjtWarning(found[0]).name}`" if found else ""
    mujoco.set_mjcb_passive(None)
    return t, q, words or "no warning"


def textbook_rates(_: float, y: Array) -> Array:
    """Rates of (q_1, q_2, qd_1, qd_2) of two rods of 1 kg and 1 m, g = 9.807."""
    g, d = 9.807, y[0] - y[1]
    a12, h = 0.5 * np.cos(d), 0.5 * np.sin(d)
    r1 = 1.5 * g * np.cos(y[0]) - h * y[3] ** 2
    r2 = 0.5 * g * np.cos(y[1]) + h * y[2] ** 2
    determinant = 4 / 9 - a12**2
    return np.array(
        [y[2], y[3], (r1 / 3 - a12 * r2) / determinant, (4 / 3 * r2 - a12 * r1) / determinant]
    )
