"""What a smooth effect does, in symbols."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

from sympy import Expr, Symbol, sin

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.notation import Notation


class NotSmooth(Exception):
    """The effect has no law that is smooth; holds the reason, and what to do instead."""


class LinkLoad(NamedTuple):
    """A force on a link (counted from 1), N, and its moment about where the link begins, N m."""

    link: int
    force: Vector
    moment: Expr


@dataclass(frozen=True)
class Law:
    """What an effect does; most laws have one of the parts below `statement`."""

    effect: Any
    statement: str  # what it does, in a sentence with the law's formula between dollars
    # Torque on the link beyond the effect's joint, N m, of the joint's angle and rate; the energy
    # that it stores, J, of the angle: without that the couple does work.
    couple: Callable[[Expr, Expr], Expr] | None = None
    stored: Callable[[Expr], Expr] | None = None
    # A force on a link, and what symbols for it and its power stand for, such as a speed: each in
    # terms of those before it.
    load: LinkLoad | None = None
    definitions: Callable[[Chain], dict[Symbol, Expr]] = lambda chain: {}
    # The power that the effect brings into the chain besides that of its couple, W, also of the
    # force of the ground on link 1, N.
    power: Callable[[Chain, Vector], Expr] | None = None
    armature: Expr | None = None  # moment of inertia of a rotor that turns with the joint, kg m^2
    payload: tuple[Expr, Expr] | None = None  # mass, kg, moment of inertia, kg m^2, at the tip
    pivot: Vector | None = None  # the position of the pivot over time, m
    locks: bool = False  # whether the effect locks its joint


def sinusoid(
    s: Notation, wave: Any, amplitude: tuple[str, str], unit: str, of: str, meaning: str
) -> Expr:
    """Return the law of a `pendcore.effects.Sinusoid`, with symbols for its numbers.

    ``amplitude`` is its symbol in text and in LaTeX; ``of`` marks the other symbols.
    """
    size = s.parameter(*amplitude, wave.amplitude, unit, f"amplitude of {meaning}")
    angle = s.t * s.parameter(
        f"Omega_{of}", rf"\Omega_{{{of}}}", wave.angular_frequency, "rad/s",
        f"angular frequency of {meaning}",
    )  # fmt: skip
    if wave.phase != 0.0:
        name = rf"\psi_{{{of}}}"
        angle += s.parameter(f"psi_{of}", name, wave.phase, "rad", f"phase of {meaning}")
    return size * sin(angle)
