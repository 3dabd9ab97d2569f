"""The laws of the smooth effects in symbols, one file each, and why other effects have none."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from pendcore.derive.laws.driven_pivot import DrivenPivot
from pendcore.derive.laws.law import Definition, Law, LinkLoad, NotSmooth
from pendcore.derive.laws.lock import Lock
from pendcore.derive.laws.motor import Motor
from pendcore.derive.laws.payload import Payload
from pendcore.derive.laws.rod_drag import RodDrag
from pendcore.derive.laws.rotor_inertia import RotorInertia
from pendcore.derive.laws.torsional_spring import TorsionalSpring
from pendcore.derive.laws.viscous_joint import ViscousJoint
from pendcore.derive.notation import Notation

LAWS: dict[str, type[Law]] = {
    "driven_pivot": DrivenPivot,
    "lock": Lock,
    "motor": Motor,
    "payload": Payload,
    "rod_drag": RodDrag,
    "rotor_inertia": RotorInertia,
    "torsional_spring": TorsionalSpring,
    "viscous_joint": ViscousJoint,
}
"""The laws, by the kind of effect."""

OWN = "its law is a function, which has no symbols"
USE_A_LAW = "use one of pendcore.effects that has a law in symbols"
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
    """Return the laws of effects.

    Raises
    ------
    ValueError
        If an effect has no smooth law; the message says which one, why, and what to do instead.
    """
    return [_law_of(i, effect, notation) for i, effect in enumerate(effects, start=1)]


def _law_of(number: int, effect: Any, notation: Notation) -> Law:
    try:
        if effect.kind in WITHOUT_LAW:
            raise NotSmooth(*WITHOUT_LAW[effect.kind])
        if effect.kind not in LAWS:
            raise NotSmooth("nobody has written its law in symbols yet", USE_A_LAW)
        return LAWS[effect.kind](effect, notation)
    except NotSmooth as refused:
        raise ValueError(
            f"effect {number}, {effect!r}: cannot be derived in symbols: {refused.reason}; "
            f"{refused.remedy}, or leave it to pendcore.simulate"
        ) from None


__all__ = ["LAWS", "WITHOUT_LAW", "Definition", "Law", "LinkLoad", "laws_of"]
