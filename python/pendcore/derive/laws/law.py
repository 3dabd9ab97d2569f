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

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(reason, remedy)


class LinkLoad(NamedTuple):
    """A force on a link (counted from 1), N, and its moment about where the link begins, N m."""

    link: int
    force: Vector
    moment: Expr


class Definition(NamedTuple):
    """A symbol that stands for a longer expression of a law, such as a speed or a force."""

    symbol: Symbol
    value: Expr
    meaning: str


@dataclass(frozen=True)
class Law:
    """What an effect does; most laws have one of these parts.

    Attributes
    ----------
    effect : pendcore.effects.Effect
        The effect.
    statement : str
        What it does, in a sentence with the law's formula between dollars.
    couple : function of (phi, w)
        Torque on the link beyond the effect's joint, N m; phi and w are the joint's angle and rate.
    stored : function of phi
        Energy that the couple stores, J; without it the couple does work.
    definitions : function of the chain
        Symbols in which the load and the power are written, each defined by those before it.
    load : LinkLoad
        A force on a link.
    power : function of (chain, ground_force)
        Power that the effect brings into the chain, W, besides that of its couple; ``ground_force``
        is the force of the ground on link 1, N.
    armature : Expr
        Moment of inertia of a rotor that turns with the effect's joint, kg m^2.
    payload : (Expr, Expr)
        Mass (kg) and moment of inertia (kg m^2) of a body at the tip.
    pivot : (Expr, Expr)
        Position of the pivot over time, m.
    locks : bool
        Whether the effect locks its joint.
    """

    effect: Any
    statement: str
    couple: Callable[[Expr, Expr], Expr] | None = None
    stored: Callable[[Expr], Expr] | None = None
    definitions: Callable[[Chain], tuple[Definition, ...]] = lambda chain: ()
    load: LinkLoad | None = None
    power: Callable[[Chain, Vector], Expr] | None = None
    armature: Expr | None = None
    payload: tuple[Expr, Expr] | None = None
    pivot: Vector | None = None
    locks: bool = False


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
