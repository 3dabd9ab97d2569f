"""The rods of the hard cases as the peers take them: rates for SciPy, models for MuJoCo."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
G = 9.807


def two_rods(
    payload: float = 0.0, *, from_hanging: bool = False, of: Any = math
) -> Callable[[float, Array], list[float]]:
    """Rates of two rods of 1 kg and 1 m with a mass at the tip.

    The determinant is free of terms that cancel. Python's floats are quicker than NumPy's, which
    know infinities.
    """
    cos, sin, p, a = of.cos, of.sin, payload, 0.5 + payload

    def rates(_: float, y: Any) -> list[float]:
        q1, q2, w1, w2 = y.tolist() if of is math else y
        c, s = cos(q1 - q2), sin(q1 - q2)
        g1, g2 = (-sin(q1), -sin(q2)) if from_hanging else (cos(q1), cos(q2))
        r1 = (1.5 + p) * G * g1 - a * s * (w2 * w2)
        r2 = a * G * g2 + a * s * (w1 * w1)
        determinant = 7 / 36 + 2 * p / 3 + (a * s) * (a * s)
        a1 = ((1 / 3 + p) * r1 - a * c * r2) / determinant
        return [w1, w2, a1, ((4 / 3 + p) * r2 - a * c * r1) / determinant]

    return rates


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
    *, dt: float, links: int, mass: float, gravity: float, joint: str, integrator: str,
    hanging: bool = True, payload: float = 0.0,
) -> Any:  # fmt: skip
    """Compile one or two uniform rods of 1 m, with a point mass at the tip of the second."""
    import mujoco

    known = {
        "dt": repr(dt), "down": -gravity, "integrator": integrator, "joint": joint, "mass": mass,
        "inertia": mass / 12, "thin": 1e-4, "side": "-" if hanging else "", "payload": payload,
    }  # fmt: skip
    known["load"] = LOAD.format(**known) if payload else ""
    tip = SECOND.format(**known) if links == 2 else ""
    return mujoco.MjModel.from_xml_string(ROD.format(tip=tip, **known))
