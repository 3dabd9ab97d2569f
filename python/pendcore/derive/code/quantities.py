"""The computations of every generated file, ready to be written in a language."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

from sympy import Symbol

from pendcore.derive.algebra import Algebra
from pendcore.derive.code.shared import Computation, share


@dataclass(frozen=True, slots=True)
class Quantities:
    """The computations of a derivation.

    Attributes
    ----------
    accelerations : Computation
        (n,) rad/s^2, of t, q, qd and parameters.
    reactions : Computation
        F_01x, F_01y, F_12x, ... (2n,) N, of these and of qdd.
    energies : Computation
        Kinetic and potential, J, of q, qd and t.
    powers : dict of str to effect
        The effects that bring in or take energy, by kind and place: ``viscous_joint_1``.
    power : Computation
        Their powers, W, of t, q, qd, qdd.
    """

    accelerations: Computation
    reactions: Computation
    energies: Computation
    powers: dict[str, Any]
    power: Computation

    @classmethod
    def of(cls, derivation: Algebra, taken: Iterable[str]) -> Quantities:
        """Collect the computations; `taken` are names that the language needs for itself."""
        taken = {*taken, *(parameter.symbol.name for parameter in derivation.symbols.parameters)}
        laws = [(known.symbol, known.value) for known in derivation.equations.definitions]
        forces = [part for force in derivation.equations.reactions for part in force]
        energy, powers = derivation.energy, derivation.energy.powers_by_definitions
        return cls(
            accelerations=share(derivation.shared_accelerations, derivation.shared, taken),
            reactions=share(forces, laws, taken),
            energies=share([energy.kinetic, energy.potential], laws, taken),
            powers=_named(powers),
            power=share([*powers.values()], laws, taken),
        )

    def symbols(self) -> list[Symbol]:
        """Return the symbols that these computations assign."""
        every = (self.accelerations, self.reactions, self.energies, self.power)
        return list(dict.fromkeys(symbol for one in every for symbol, _ in one.assignments))


def _named(effects: Iterable[Any]) -> dict[str, Any]:
    named: dict[str, Any] = {}
    for effect in effects:
        place = getattr(effect, "joint", getattr(effect, "link", None))
        first = name = effect.kind if place is None else f"{effect.kind}_{place}"
        number = 1
        while name in named:
            number += 1
            name = f"{first}_{number}"
        named[name] = effect
    return named
