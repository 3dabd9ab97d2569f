"""The interface of the laws of smooth effects, in symbols; most laws define one of its parts."""

from __future__ import annotations

from typing import Any, NamedTuple

from sympy import Expr, Integer, Symbol, sin

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.notation import Notation


class NotSmooth(Exception):
    """The effect has no law that is smooth; holds the reason, and what to do instead."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(reason, remedy)


class LinkLoad(NamedTuple):
    """A force on a link (counted from 1), N, and its moment about the link's begin, N m."""

    link: int
    force: Vector
    moment: Expr


class Definition(NamedTuple):
    """A symbol that stands for a longer expression of a law, such as a speed or a force."""

    symbol: Symbol
    value: Expr
    meaning: str


class Law:
    """The law of an effect that does nothing; each law overrides what its effect does.

    Parameters
    ----------
    effect : pendcore.effects.Effect
        The effect, with its numbers.
    notation : Notation
        Where the law puts the symbols of its parameters.
    """

    def __init__(self, effect: Any, notation: Notation) -> None:
        self.effect = effect
        self.notation = notation

    def statement(self) -> str:
        """Return what the effect does, in a sentence with the law's formula between dollars."""
        raise NotImplementedError

    def pivot(self) -> Vector | None:
        """Position of the pivot over time, if the effect moves it, m."""
        return None

    def couple(self, chain: Chain) -> Expr | None:
        """Torque of the effect on the link beyond its joint, without that of rotors, N m."""
        return None

    def definitions(self, chain: Chain) -> tuple[Definition, ...]:
        """Symbols in which the loads are written, each defined by those before it."""
        return ()

    def load(self, chain: Chain) -> LinkLoad | None:
        """Force on a link and its moment, in the symbols of `definitions`."""
        return None

    def armature(self) -> tuple[int, Expr] | None:
        """Joint, and moment of inertia of a rotor that turns with the joint, kg m^2."""
        return None

    def payload(self) -> tuple[Expr, Expr] | None:
        """Mass (kg) and moment of inertia (kg m^2) of a body at the tip."""
        return None

    def lock(self) -> int | None:
        """The joint that the effect locks."""
        return None

    def potential_energy(self, chain: Chain) -> Expr:
        """Energy that the effect stores, J."""
        return Integer(0)

    def power(self, chain: Chain, ground_force: Vector) -> Expr | None:
        """Power that the effect brings into the chain, W, in the symbols of `definitions`.

        ``ground_force`` is the force of the ground on link 1, N. The power is None if the effect
        does no work, or stores its work as energy.
        """
        return None

    def sinusoid(
        self, wave: Any, amplitude: tuple[str, str], unit: str, of: str, meaning: str
    ) -> Expr:
        """Return the law of a `pendcore.effects.Sinusoid`, with symbols for its numbers.

        ``amplitude`` is its symbol in text and in LaTeX; ``of`` marks the other symbols.
        """
        s = self.notation
        size = s.parameter(*amplitude, wave.amplitude, unit, f"amplitude of {meaning}")
        frequency = s.parameter(
            f"Omega_{of}", rf"\Omega_{{{of}}}", wave.angular_frequency, "rad/s",
            f"angular frequency of {meaning}",
        )  # fmt: skip
        phase: Expr = Integer(0)
        if wave.phase != 0.0:
            name = rf"\psi_{{{of}}}"
            phase = s.parameter(f"psi_{of}", name, wave.phase, "rad", f"phase of {meaning}")
        return size * sin(frequency * s.t + phase)
