"""The derivation of a scene's equations of motion, step by step, as the textbook does it."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from sympy import Expr, Integer, Matrix, Symbol

from pendcore.derive.chain import Chain, Vector
from pendcore.derive.energy import Energy
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.narration import steps
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation
from pendcore.derive.step import Step
from pendcore.scene import Scene


class Derivation:
    """The equations of motion of a scene, derived in symbols.

    Parameters
    ----------
    scene : Scene
        Its effects have to be smooth.

    Raises
    ------
    ValueError
        If an effect has no law in symbols, or the chain is too long to be written out; the message
        says why, and what to do instead.

    Attributes
    ----------
    scene : Scene
        As given.
    n : int
        Number of links.
    symbols : Notation
        ``t``, ``q``, ``qd``, ``qdd`` and the parameters.
    chain : Chain
        Kinematics.
    equations : NewtonEuler
        Newton's and Euler's equations, with the reactions as unknowns.
    motion : Motion
        What is left when the reactions are eliminated, and its solution.
    energy : Energy
        Energies, powers, and their balance.
    """

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self.n = len(scene.links)
        self.symbols = Notation(scene)
        laws = laws_of(scene.effects, self.symbols)
        moved = [pivot for law in laws if (pivot := law.pivot()) is not None]
        x, y = (sum((pivot[k] for pivot in moved), Integer(0)) for k in (0, 1))
        self.chain = Chain(self.symbols, (x, y))
        self.equations = NewtonEuler(self.chain, laws)
        self.motion = Motion(self.equations)
        self.energy = Energy(self.motion)

    @classmethod
    def textbook(cls) -> Derivation:
        """Derive section 2.1 of the textbook: two uniform rods."""
        return cls(Scene.textbook())

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene, SI units."""
        return self.symbols.values

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The derivation, from the positions to the first-order form."""
        return steps(self)

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
        return self.motion.accelerations

    @property
    def shared(self) -> tuple[tuple[Symbol, Expr], ...]:
        """Assignments that lead to the accelerations, each in terms of those before it.

        `shared_accelerations` are in terms of them.
        """
        return self.motion.shared

    @property
    def shared_accelerations(self) -> tuple[Expr, ...]:
        """The accelerations in terms of `shared`, (n,), rad/s^2."""
        return self.motion.shared_accelerations

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, (n,) pairs, N, in t, q, qd, qdd: F_01, F_12, ..."""
        known = self.motion.definitions
        return tuple((x.xreplace(known), y.xreplace(known)) for x, y in self.equations.reactions)

    @property
    def kinetic_energy(self) -> Expr:
        """T, J."""
        return self.energy.kinetic

    @property
    def potential_energy(self) -> Expr:
        """V, of weights and springs, J; zero at the height of the origin."""
        return self.energy.potential

    @property
    def powers(self) -> dict[Any, Expr]:
        """The power that each effect brings into the chain, W, in t, q, qd, qdd."""
        return self.energy.powers

    def energy_rate(self) -> Expr:
        """Return d/dt (T + V) minus all powers, along the motion: exactly 0."""
        return self.energy.rate()

    def latex(self) -> str:
        """Return all steps in LaTeX, for ``amsmath``."""
        return "\n\n".join(step.latex() for step in self.steps) + "\n"

    def _repr_latex_(self) -> str:
        return self.latex()

    def _repr_markdown_(self) -> str:
        return "\n\n".join(step._repr_markdown_() for step in self.steps)

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.steps)) + "\n"

    def __repr__(self) -> str:
        return f"Derivation({self.scene!r})"

    def to_octave(self, name: str = "RR") -> str:
        """Return a function file of MATLAB and Octave, as the textbook's RR.m."""
        from pendcore.derive.code.octave import function_file

        return function_file(self, name)

    def to_octave_inline(self) -> str:
        """Return the textbook's inline form: a statement that makes the function ``g``."""
        from pendcore.derive.code.octave import inline_function

        return inline_function(self)

    def to_python(self) -> str:
        """Return a Python module with the right-hand side, for NumPy."""
        from pendcore.derive.code.python import module

        return module(self)

    def to_cpp(self) -> str:
        """Return a C++ header with the right-hand side."""
        from pendcore.derive.code.cpp import header

        return header(self)
