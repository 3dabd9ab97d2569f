"""The effects that are compared, and what pendcore promises of each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
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


BARE = Effect(name="none", label="bare scene", theirs="")
EFFECTS = (
    Effect(name="viscous_joint", label="viscous joint", theirs="joint damping"),
    Effect(
        name="viscous_joint_3", label="viscous joint, three terms", theirs="joint damping, 3 terms"
    ),
    Effect(
        name="rod_drag",
        label="rod drag, both links",
        theirs="fluid forces, inertia box",
        same_law=False,
        most_ns=15,
        most_instructions=150,
    ),
    Effect(name="torsional_spring", label="torsional spring", theirs="joint stiffness"),
    Effect(name="motor_constant", label="motor, constant", theirs="motor actuator"),
    Effect(name="motor_sinusoid", label="motor, sinusoid", theirs="motor, control set", most_ns=10),
    Effect(name="motor_table", label="motor, table", theirs=""),
    Effect(name="motor_pd", label="motor, PD with limit", theirs="position actuator, forcerange"),
    Effect(name="rotor_inertia", label="rotor inertia", theirs="armature"),
    Effect(name="payload", label="payload", theirs="part of the body"),
    Effect(name="driven_pivot", label="driven pivot, sinusoid", theirs="", most_ns=10),
    Effect(
        name="dry_joint_friction",
        label="dry friction, sliding",
        theirs="frictionloss",
        same_law=False,
    ),
    Effect(
        name="joint_limit",
        label="joint stop, never reached",
        theirs="joint limit",
        felt=False,
    ),
    Effect(
        name="user",
        label="compiled function of a user's",
        theirs="mjcb_passive",
        most_ns=None,
        most_instructions=None,
    ),
)
