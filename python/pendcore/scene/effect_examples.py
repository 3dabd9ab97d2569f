"""Examples of effects: values that make sense together, and what comes of them.

The docstrings of `pendcore.effects` show them, and so do the pages in docs/effects. An effect that
is not listed here is shown with any values.
"""

from __future__ import annotations

EXAMPLES = {
    "viscous_joint": ["ViscousJoint(joint=2, damping=0.05)"],
    "dry_joint_friction": [
        "DryJointFriction(joint=1, coulomb=0.2, static=0.3, stribeck_velocity=0.05)"
    ],
    "rod_drag": [
        "RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0))",
    ],
    "torsional_spring": ["TorsionalSpring(joint=2, stiffness=30.0, rest_angle=0.5)"],
    "motor": [
        "Motor(joint=1, constant=2.0)",
        "Motor(joint=1, sinusoid=Sinusoid(amplitude=3.0, angular_frequency=6.0))",
        "Motor(joint=2, table=Table(t=(0.0, 0.5, 2.0), torque=(0.0, 1.5, -1.5)))",
        "Motor(joint=2, pd=PD(kp=40.0, kd=2.0, reference=0.3), limit=8.0)",
    ],
    "rotor_inertia": ["RotorInertia(joint=1, armature=0.02)"],
    "payload": ["Payload(mass=0.5, inertia=0.001)"],
    "joint_stop": [
        "JointStop(joint=2, range=(-0.5, 0.8), restitution=0.4)",
        "JointStop(joint=1, range=(0.0, inf), restitution=0.8, capture_speed=0.001)",
    ],
    "lock": ["Lock(joint=2)", "Lock(joint=2, angle=0.5)"],
    "driven_pivot": [
        "DrivenPivot(y=Sinusoid(amplitude=0.02, angular_frequency=90.0))",
        "DrivenPivot(spline=Spline(t=(0.0, 1.0, 2.0), x=(0.0, 0.3, 0.0), y=(0.0, 0.0, 0.1)))",
    ],
    "compiled_user": ["CompiledUser(damp)"],
    "user": ["User(function=lambda t, q, qd: -0.1 * qd)"],
}
"""Calls by the kind of the effect. The first one is run, on the textbook's scene."""

BEFORE = {
    "compiled_user": """\
>>> from ctypes import CFUNCTYPE, POINTER, c_double, c_int, c_void_p
>>> @CFUNCTYPE(None, c_double, c_int, *[POINTER(c_double)] * 3, c_void_p)
... def damp(t, n, q, qd, Q, data):
...     Q[0] -= 0.1 * qd[0]""",
}
"""What has to stand before a call, by kind."""

OUTCOMES = {
    "viscous_joint": "viscous: 0.504 J",
    "dry_joint_friction": "dry: 0.323 J",
    "rod_drag": "drag: 3.696 J",
    "torsional_spring": "q at 1 s: [2.239, 2.77] rad",
    "motor": "motor: 3.625 J",
    "rotor_inertia": "q at 1 s: [2.128, 2.936] rad",
    "payload": "q at 1 s: [2.007, 2.612] rad",
    "joint_stop": "impact: 0.563 J",
    "lock": "q at 1 s: [2.26, 2.76] rad",
    "driven_pivot": "drive: -0.484 J",
    "compiled_user": "user: -0.339 J",
    "user": "user: -1.305 J",
}
"""What the last line of an example prints, by kind."""
