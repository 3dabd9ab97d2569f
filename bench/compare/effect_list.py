"""The effects that are compared, and what pendcore promises of each."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from pendcore import effects as fx


@dataclass(frozen=True, slots=True)
class Effect:
    """An effect: `theirs` is its name in MuJoCo, empty if it has none.

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
    Effect(
        "motor_sinusoid", "motor, sinusoid", "motor, control set", most_ns=10,
        most_instructions=61,
    ),
    Effect("motor_table", "motor, table", ""),
    Effect("motor_pd", "motor, PD with limit", "position actuator, forcerange"),
    Effect("rotor_inertia", "rotor inertia", "armature"),
    Effect("payload", "payload", "part of the body"),
    Effect("driven_pivot", "driven pivot, sinusoid", "", most_ns=10, most_instructions=61),
    Effect("dry_joint_friction", "dry friction, sliding", "frictionloss", same_law=False),
    Effect("joint_limit", "joint stop, never reached", "joint limit", felt=False),
    Effect(
        "user", "compiled function of a user's", "mjcb_passive", most_ns=None,
        most_instructions=None,
    ),
)  # fmt: skip

# There are two rods; an effect at a joint is at joint 2, so that it reaches both links.
PARAMETERS: dict[str, list[Any]] = {
    "viscous_joint": [fx.ViscousJoint(joint=2, damping=0.1)],
    "viscous_joint_3": [fx.ViscousJoint(joint=2, damping=0.1, damping2=0.02, damping3=0.005)],
    "rod_drag": [
        fx.RodDrag(link=link, drag_coefficient=1.2, diameter=0.05, air_density=1.225)
        for link in (1, 2)
    ],
    "torsional_spring": [fx.TorsionalSpring(joint=2, stiffness=5.0, rest_angle=0.2)],
    "motor_constant": [fx.Motor(joint=2, constant=0.5)],
    "motor_sinusoid": [
        fx.Motor(joint=2, sinusoid=fx.Sinusoid(amplitude=0.5, angular_frequency=3.0, phase=0.4))
    ],
    "motor_table": [fx.Motor(joint=2, table=fx.Table(t=[-1.0, 10.0], torque=[0.0, 0.5]))],
    "motor_pd": [fx.Motor(joint=2, pd=fx.PD(kp=5.0, kd=0.5, reference=0.3), limit=100.0)],
    "rotor_inertia": [fx.RotorInertia(joint=2, armature=0.05)],
    "payload": [fx.Payload(mass=0.5)],
    "driven_pivot": [fx.DrivenPivot(x=fx.Sinusoid(amplitude=0.01, angular_frequency=20.0))],
    "dry_joint_friction": [fx.DryJointFriction(joint=2, coulomb=0.05)],
    "joint_limit": [fx.JointStop(joint=2, range=(-50.0, 50.0))],
}
COEFFICIENTS = {
    "viscous_joint": "damping",
    "torsional_spring": "stiffness",
    "rod_drag": "drag_coefficient",
}


def parameters(name: str) -> list[Any]:
    """Return the effects of a scene; a name that ends with _0 has a coefficient of 0.

    The bare scene has none, and that of a user has a function of the program's own.
    """
    bare = name.removesuffix("_0")
    found = PARAMETERS.get(bare, [])
    return found if bare == name else [one.replace(**{COEFFICIENTS[bare]: 0.0}) for one in found]
