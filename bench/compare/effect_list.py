"""The effects that are compared, and what pendcore promises of each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Effect:
    """An effect: `name` is its name in effect_parameters.hpp, `theirs` its name in MuJoCo.

    `ours` says whether pendcore has it. `same_law` says that both sides must give the same
    accelerations, and `felt` that these must differ from those of the bare scene. The last two are
    the most that pendcore promises, None where it promises nothing. Friction that slides is one
    torque more. A stop that is not reached has no torque, but its scene uses the kernel of joint
    torques.
    """

    name: str
    label: str
    theirs: str
    ours: bool = True
    same_law: bool = True
    felt: bool = True
    most_ns: float | None = 6
    most_instructions: int | None = 60


BARE = Effect("none", "bare scene", "")
EFFECTS = (
    Effect("viscous_joint", "viscous joint", "joint damping"),
    Effect("viscous_joint_3", "viscous joint, three terms", "joint damping, 3 terms"),
    Effect(
        "rod_drag", "rod drag, both links", "fluid forces, inertia box", same_law=False,
        most_ns=15, most_instructions=150,
    ),
    Effect("torsional_spring", "torsional spring", "joint stiffness"),
    Effect("motor_constant", "motor, constant", "motor actuator"),
    Effect("motor_sinusoid", "motor, sinusoid", "motor, control set", most_ns=10),
    Effect("motor_table", "motor, table", ""),
    Effect("motor_pd", "motor, PD with limit", "position actuator, forcerange"),
    Effect("rotor_inertia", "rotor inertia", "armature"),
    Effect("payload", "payload", "part of the body"),
    Effect("driven_pivot", "driven pivot, sinusoid", "", most_ns=10),
    Effect("dry_joint_friction", "dry friction, sliding", "frictionloss", same_law=False),
    Effect("joint_limit", "joint stop, never reached", "joint limit", felt=False),
    Effect(
        "user", "compiled function of a user's", "mjcb_passive", most_ns=None,
        most_instructions=None,
    ),
)  # fmt: skip
