"""The law of every effect, written in the most direct form, under the name of its kind."""

from __future__ import annotations

from typing import Any

from reference.effects.compiled_user import CompiledUser
from reference.effects.driven_pivot import DrivenPivot
from reference.effects.dry_joint_friction import DryJointFriction
from reference.effects.joint_stop import JointStop
from reference.effects.law import Law
from reference.effects.lock import Lock
from reference.effects.motor import Motor
from reference.effects.payload import Payload
from reference.effects.rod_drag import RodDrag
from reference.effects.rotor_inertia import RotorInertia
from reference.effects.torsional_spring import TorsionalSpring
from reference.effects.user import User
from reference.effects.viscous_joint import ViscousJoint

LAWS: dict[str, type[Law]] = {
    "compiled_user": CompiledUser,
    "driven_pivot": DrivenPivot,
    "dry_joint_friction": DryJointFriction,
    "joint_stop": JointStop,
    "lock": Lock,
    "motor": Motor,
    "payload": Payload,
    "rod_drag": RodDrag,
    "rotor_inertia": RotorInertia,
    "torsional_spring": TorsionalSpring,
    "user": User,
    "viscous_joint": ViscousJoint,
}

Described = tuple[str, dict[str, Any]]
"""An effect: its kind and its parameters; what is an object of its own there is a dict here."""


def law(described: Described) -> Law:
    """Return the law of an effect."""
    kind, parameters = described
    return LAWS[kind](**parameters)
