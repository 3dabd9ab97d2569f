"""Runs over all methods and effects that are repeated in JavaScript and compared bit by bit."""

from __future__ import annotations

from typing import Any

import pendcore as pc
from described_scenes import effect_of

RODS = [{"mass": 1.0, "length": 1.0}, {"mass": 0.6, "length": 0.7}]
STOP = {"kind": "joint_stop", "joint": 2, "range": [-0.5, 0.9], "restitution": 0.6}
FRICTION = {"kind": "dry_joint_friction", "joint": 2, "coulomb": 0.1, "static": 0.2}
DAMPER = {"kind": "viscous_joint", "joint": 1, "damping": 0.05, "damping2": 0.01}
SPRING = {"kind": "torsional_spring", "joint": 2, "stiffness": 3.0, "rest_angle": 0.2}
DRAG = {"kind": "rod_drag", "link": 2, "drag_coefficient": 1.2, "diameter": 0.03, "wind": [2, -1]}
WAVE = {"amplitude": 0.5, "angular_frequency": 3.0, "phase": 0.1}
MOTOR = {"kind": "motor", "joint": 2, "sinusoid": WAVE}
TABLE = {"kind": "motor", "joint": 1, "table": {"t": [0, 1, 5], "torque": [0, 2, -1]}}
PD = {"kind": "motor", "joint": 1, "pd": {"kp": 2.0, "kd": 0.3, "reference": 1.0}, "limit": 0.7}
DRIVE = {"kind": "driven_pivot", "y": {"amplitude": 0.05, "angular_frequency": 11.0}}
ROTOR = {"kind": "rotor_inertia", "joint": 2, "armature": 0.01}
LOAD = {"kind": "payload", "mass": 0.3}
LOCK = {"kind": "lock", "joint": 2}
STIFF = {"kind": "viscous_joint", "joint": 2, "damping": 1e4}
CASES: dict[str, tuple[list[dict[str, Any]], dict[str, Any]]] = {
    "bare, dopri5": ([], {"method": "dopri5"}),
    "bare, dop853": ([], {"method": "dop853", "rtol": 1e-12}),
    "bare, taylor": ([], {"method": "taylor", "rtol": 1e-13}),
    "bare, rk4": ([], {"method": "rk4", "step": 0.01}),
    "bare, radau5": ([], {"method": "radau5", "rtol": 1e-7}),
    "bare, of itself": ([], {}),
    "bare, compensated": ([], {"method": "taylor", "compensated": True}),
    "damper": ([DAMPER], {"method": "dopri5"}),
    "spring": ([SPRING], {"method": "taylor"}),
    "drag": ([DRAG], {"method": "dop853"}),
    "motor": ([MOTOR], {}),
    "table": ([TABLE], {"method": "dopri5"}),
    "pd": ([PD], {"method": "dop853"}),
    "drive": ([DRIVE], {}),
    "rotor and load": ([ROTOR, LOAD], {}),
    "lock": ([LOCK], {}),
    "stop": ([STOP], {"method": "dopri5"}),
    "friction": ([FRICTION], {"method": "radau5", "rtol": 1e-6}),
    "stiff": ([STIFF], {"method": "dopri5-radau5", "rtol": 1e-6}),
    "many, with a ledger": ([DAMPER, DRAG, MOTOR, FRICTION, STOP], {"ledger": True}),
    "coarse": ([DAMPER], {"rtol": 1e-3, "atol": [1e-4, 1e-4, 1e-3, 1e-3], "max_step": 0.1}),
}
START = {"q0": [0.4, 0.8], "qd0": [2.0, -3.0], "t0": 0.0, "t_end": 4.0}
STARTS = {"lock": {**START, "qd0": [2.0, 2.0]}}  # a locked joint is at rest


def scene_in_python(effects: list[dict[str, Any]]) -> pc.Scene:
    made = [effect_of((one["kind"], {x: one[x] for x in one if x != "kind"})) for one in effects]
    return pc.Scene(links=[pc.Link(**rod) for rod in RODS], effects=made)
