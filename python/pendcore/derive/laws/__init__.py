"""The laws of the smooth effects in symbols, and why other effects have none."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from pendcore.derive.laws import joints
from pendcore.derive.laws.law import Law, NotSmooth
from pendcore.derive.laws.rod_drag import rod_drag
from pendcore.derive.notation import Notation

LAWS: dict[str, Callable[[Any, Notation], Law]] = {
    law.__name__: law
    for law in (
        *(joints.driven_pivot, joints.lock, joints.motor, joints.payload, joints.rotor_inertia),
        *(joints.torsional_spring, joints.viscous_joint, rod_drag),
    )
}
"""The laws, by the kind of effect."""

OWN = "its law is a function, which has no symbols"
USE_A_LAW = "use one of pendcore.effects that has a law in symbols"
NOT_YET = "nobody has written its law in symbols yet", USE_A_LAW
WITHOUT_LAW: dict[str, tuple[str, str]] = {
    "compiled_user": (OWN, USE_A_LAW),
    "dry_joint_friction": (
        "dry friction jumps with the sign of the rate, and a joint at rest sticks: no single "
        "equation of motion holds throughout",
        "use ViscousJoint, the smooth friction",
    ),
    "joint_stop": (
        "at a stop the rates jump: there is no equation of motion through an impact",
        "use TorsionalSpring for a soft bound",
    ),
    "user": (OWN, USE_A_LAW),
}
"""Why the kinds that are not smooth have no law in symbols, and what to use instead."""


def laws_of(effects: Sequence[Any], notation: Notation) -> list[Law]:
    """Return the laws of effects; a ValueError says which has no smooth one, why, what to do."""
    laws = []
    for number, effect in enumerate(effects, start=1):
        try:
            if effect.kind not in LAWS:
                raise NotSmooth(*WITHOUT_LAW.get(effect.kind, NOT_YET))
            laws.append(LAWS[effect.kind](effect, notation))
        except NotSmooth as refused:
            reason, remedy = refused.args
            raise ValueError(
                f"effect {number}, {effect!r}: cannot be derived in symbols: {reason}; {remedy}, "
                "or leave it to pendcore.simulate"
            ) from None
    return laws
