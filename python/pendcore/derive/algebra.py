"""The equations of motion of a scene in symbols, from its kinematics to its energies."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from sympy import Expr, Integer, Symbol

from pendcore import Scene
from pendcore.derive.chain import Chain, Vector
from pendcore.derive.energy import Energy
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation

WRITTEN_OUT = (5, 137, 1207, 10190, 90219)
"""Operations of the accelerations of 1, 2, ... uniform rods, written out; a test counts them."""


class Algebra(Motion):
    """The equations themselves, without words and code; `Derivation` documents the attributes."""

    def __init__(self, scene: Scene) -> None:
        n = len(scene.links)
        if n > len(WRITTEN_OUT):
            counts = ", ".join(f"{count:_}".replace("_", " ") for count in WRITTEN_OUT)
            most = len(WRITTEN_OUT)
            raise ValueError(
                f"scene: {n} links: at most {most} are derived in symbols: written out, the "
                f"accelerations of 1 to {most} bare rods take {counts} operations, some nine "
                "times more with every link; pendcore.simulate takes any number, by an O(n) "
                "recursion that never writes them out"
            )
        self.scene = scene
        symbols = Notation(scene)
        laws = laws_of(scene.effects, symbols)
        moved = [law.pivot for law in laws if law.pivot is not None]
        x, y = (sum((pivot[k] for pivot in moved), Integer(0)) for k in (0, 1))
        self.chain = Chain(symbols, (x, y))
        super().__init__(NewtonEuler(self.chain, laws))
        self.energy = Energy(self)

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene, SI units."""
        return self.symbols.values

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, (n,) pairs, N, in t, q, qd, qdd: F_01, F_12, ..."""
        known = self.definitions
        return tuple((x.xreplace(known), y.xreplace(known)) for x, y in self.equations.reactions)

    @cached_property
    def holding_couples(self) -> dict[int, Expr]:
        """Couple of each locked joint on the link beyond it, N m, in t, q, qd, qdd."""
        return {joint: couple.xreplace(self.known) for joint, couple in self.holding.items()}

    @property
    def kinetic_energy(self) -> Expr:
        """T, J, in t, q, qd and parameters."""
        return self.energy.kinetic.xreplace(self.definitions)

    @property
    def potential_energy(self) -> Expr:
        """V, of weights and springs, J, in t, q and parameters; zero at the origin's height."""
        return self.energy.potential.xreplace(self.definitions)

    @property
    def powers(self) -> dict[Any, Expr]:
        """The power that each effect brings into the chain, W, in t, q, qd, qdd."""
        return self.energy.powers

    def energy_rate(self) -> Expr:
        """Return d/dt (T + V) minus all powers, along the motion: exactly 0."""
        return self.energy.rate()
