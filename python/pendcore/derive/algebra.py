"""The equations of motion of a scene in symbols, from its kinematics to its energies."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from sympy import Expr, Integer, Matrix, Symbol

from pendcore._scene.scene import Scene
from pendcore.derive.chain import Chain, Vector
from pendcore.derive.energy import Energy
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation
from pendcore.derive.size_limit import check_length
from pendcore.derive.solution import Assignments, Solution


class Algebra:
    """The equations themselves, without words and code; `Derivation` documents the attributes."""

    def __init__(self, scene: Scene) -> None:
        check_length(len(scene.links))
        self.scene = scene
        self.n = len(scene.links)
        self.symbols = Notation(scene)
        laws = laws_of(scene.effects, self.symbols)
        moved = [pivot for law in laws if (pivot := law.pivot()) is not None]
        x, y = (sum((pivot[k] for pivot in moved), Integer(0)) for k in (0, 1))
        self.chain = Chain(self.symbols, (x, y))
        self.equations = NewtonEuler(self.chain, laws)
        self.motion = Motion(self.equations)
        self.solution = Solution(self.motion)
        self.energy = Energy(self.solution)

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene, SI units."""
        return self.symbols.values

    @property
    def mass_matrix(self) -> Matrix:
        """M of ``M qdd = forcing``, (n, n), kg m^2."""
        return self.motion.mass_matrix

    @property
    def forcing(self) -> Matrix:
        """The right side of ``M qdd = forcing``, (n, 1), N m, in t, q, qd and parameters."""
        return self.motion.forcing

    @property
    def accelerations(self) -> tuple[Expr, ...]:
        """Angular accelerations written out, in t, q, qd and parameters, (n,), rad/s^2."""
        return self.solution.accelerations

    @property
    def shared(self) -> Assignments:
        """Assignments that lead to the accelerations, each in terms of those before it.

        `shared_accelerations` are written with the symbols that they assign.
        """
        return self.solution.shared

    @property
    def shared_accelerations(self) -> tuple[Expr, ...]:
        """The accelerations in terms of `shared`, (n,), rad/s^2."""
        return self.solution.shared_accelerations

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, (n,) pairs, N, in t, q, qd, qdd: F_01, F_12, ..."""
        known = self.motion.definitions
        return tuple((x.xreplace(known), y.xreplace(known)) for x, y in self.equations.reactions)

    @cached_property
    def holding_couples(self) -> dict[int, Expr]:
        """Couple of each locked joint on the link beyond it, N m, in t, q, qd, qdd."""
        known = {
            s: x.xreplace(self.motion.definitions) for s, x in self.motion.named.entries.items()
        }
        return {joint: couple.xreplace(known) for joint, couple in self.solution.holding.items()}

    @property
    def kinetic_energy(self) -> Expr:
        """T, J, in t, q, qd and parameters."""
        return self.energy.kinetic.xreplace(self.motion.definitions)

    @property
    def potential_energy(self) -> Expr:
        """V, of weights and springs, J, in t, q and parameters; zero at the origin's height."""
        return self.energy.potential.xreplace(self.motion.definitions)

    @property
    def powers(self) -> dict[Any, Expr]:
        """The power that each effect brings into the chain, W, in t, q, qd, qdd."""
        return self.energy.powers

    def energy_rate(self) -> Expr:
        """Return d/dt (T + V) minus all powers, along the motion: exactly 0."""
        return self.energy.rate()
