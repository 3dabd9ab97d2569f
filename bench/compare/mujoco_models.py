"""Planar chains of uniform rods as MuJoCo's models: bodies without shapes, with pendcore's effects.

The hinges turn about the y axis; in the model's zero all rods lie along one direction.
"""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from cases import Array
from contenders.contender import Unsupported

OFF = mujoco.mjtDisableBit
EVERYTHING = (
    OFF.mjDSBL_CONSTRAINT | OFF.mjDSBL_EQUALITY | OFF.mjDSBL_FRICTIONLOSS | OFF.mjDSBL_LIMIT
    | OFF.mjDSBL_CONTACT | OFF.mjDSBL_SPRING | OFF.mjDSBL_DAMPER | OFF.mjDSBL_CLAMPCTRL
    | OFF.mjDSBL_ACTUATION | OFF.mjDSBL_SENSOR | OFF.mjDSBL_EULERDAMP | OFF.mjDSBL_AUTORESET
    | OFF.mjDSBL_ISLAND
)  # fmt: skip
ON_FOR = {  # what is switched on again
    "viscous_joint": OFF.mjDSBL_DAMPER,
    "user": OFF.mjDSBL_DAMPER,  # with springs and dampers off, mj_passive does nothing at all
    "rod_drag": OFF.mjDSBL_DAMPER,
    "torsional_spring": OFF.mjDSBL_SPRING,
    "dry_joint_friction": OFF.mjDSBL_CONSTRAINT | OFF.mjDSBL_FRICTIONLOSS,
    "joint_stop": OFF.mjDSBL_CONSTRAINT | OFF.mjDSBL_LIMIT,
    "motor": OFF.mjDSBL_ACTUATION,
}


def chain(
    masses: Iterable[float], lengths: Iterable[float], gravity: float,
    along: Iterable[float] = (1, 0, 0),
) -> Any:  # fmt: skip
    """Make the editable model of the rods."""
    spec, direction = mujoco.MjSpec(), np.array(along, dtype=float)
    spec.compiler.degree = False
    spec.option.gravity = [0, 0, -gravity]
    body, end = spec.worldbody, 0.0 * direction
    for i, (mass, length) in enumerate(zip(masses, lengths, strict=True), 1):
        # MuJoCo would not compile an exactly slender rod. The inertia about its own axis has no
        # effect.
        inertia = mass * length * length / 12 * np.where(direction, 1e-6, 1.0)
        body = body.add_body(
            pos=end, ipos=length / 2 * direction, mass=mass, inertia=inertia, explicitinertial=True
        )
        body.add_joint(name=f"joint {i}", type=mujoco.mjtJoint.mjJNT_HINGE, axis=[0, 1, 0])
        end = length * direction
    return spec


def add_motor(spec: Any, joint: int) -> Any:
    motor = spec.add_actuator(trntype=mujoco.mjtTrn.mjTRN_JOINT, target=f"joint {joint}")
    motor.set_to_motor()
    return motor


def add_effect(spec: Any, effect: Any, tip: Array) -> None:
    """Add an effect of pendcore's; the last rod ends at `tip`, in its own frame."""
    joint = spec.joints[effect.joint - 1] if hasattr(effect, "joint") else None
    match effect.kind:
        case "viscous_joint":
            joint.damping = [effect.damping, effect.damping2, effect.damping3]
        case "dry_joint_friction":
            joint.frictionloss = effect.coulomb
        case "rod_drag":
            spec.option.density = effect.air_density
        case "torsional_spring":
            joint.stiffness[0], joint.springref = effect.stiffness, effect.rest_angle
        case "motor" if effect.table is None:
            motor = add_motor(spec, effect.joint)
            if effect.pd:
                motor.set_to_position(kp=effect.pd.kp, kv=effect.pd.kd)
                motor.forcelimited = True
                motor.forcerange = [-effect.limit, effect.limit]
        case "rotor_inertia":
            joint.armature = effect.armature
        case "payload":
            # One body takes less work than a body that is fixed to another.
            body = spec.bodies[-1]
            mass, beyond = body.mass + effect.mass, tip - body.ipos
            moved = effect.mass / mass * beyond
            body.inertia += (body.mass * moved @ beyond + effect.inertia) * (beyond == 0)
            body.ipos, body.mass = body.ipos + moved, mass
        case "joint_stop":
            joint.limited, joint.range = True, effect.range
        case _:
            raise Unsupported(f"it has no {effect.kind}")


def write_lean(scene: Any, effects: Iterable[Any], file: Path) -> None:
    """Write the model of a scene, in which all is off that it does not need."""
    spec, effects = chain(scene.masses, scene.lengths, scene.gravity), list(effects)
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_RK4
    spec.option.timestep = 0.01
    off = int(EVERYTHING)
    for effect in effects:
        add_effect(spec, effect, np.array([scene.lengths[-1], 0, 0]))
    for kind in (scene.effect, *(effect.kind for effect in effects)):
        off &= ~int(ON_FOR.get(kind, 0))
    spec.option.disableflags = off
    mujoco.mj_saveModel(spec.compile(), str(file))
