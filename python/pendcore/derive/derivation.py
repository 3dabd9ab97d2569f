"""The derivation of a scene's equations of motion, step by step, as the textbook does it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import Any

from sympy import Expr, Integer, Matrix, Symbol

from pendcore.case import Case
from pendcore.derive.chain import Chain, Vector
from pendcore.derive.energy import Energy
from pendcore.derive.growth import check_length
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.narration import steps
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation
from pendcore.derive.solution import Assignments, Solution
from pendcore.derive.step import Step
from pendcore.progress import Progress
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
        What is left when the reactions are eliminated.
    solution : Solution
        The accelerations.
    energy : Energy
        Energies, powers, and their balance.
    """

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
        return self.solution.accelerations

    @property
    def shared(self) -> Assignments:
        """Assignments that lead to the accelerations, each in terms of those before it.

        `shared_accelerations` are in terms of them.
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

    def latex(self) -> str:
        """Return all steps in LaTeX, for ``amsmath``."""
        return "\n\n".join(step.latex() for step in self.steps) + "\n"

    def _repr_markdown_(self) -> str:
        return "\n\n".join(step._repr_markdown_() for step in self.steps)

    def __str__(self) -> str:
        return "\n\n".join(map(str, self.steps)) + "\n"

    def __reduce__(self) -> tuple[object, ...]:
        return Derivation, (self.scene,)

    def __repr__(self) -> str:
        return f"Derivation({self.scene!r})"

    def report(
        self, case: Case, folder: Path | str, *, worksheet: bool = False, progress: Progress = None
    ) -> list[Path]:
        """Write the derivation with numbers and the solution of a case, to hand in or teach from.

        Parameters
        ----------
        case : Case
            A start and a time for this scene.
        folder : Path or str
            Where to; it is made if it is not there.
        worksheet : bool
            Whether to write a worksheet as well: the same with blanks.
        progress : None, bool or callable
            As in `pendcore.simulate`.

        Returns
        -------
        list of Path
            What was written, the report first: Markdown always, HTML and PDF where there are
            converters.
        """
        from pendcore.derive.handout import write_handout

        if case.scene != self.scene:
            raise ValueError("case: is of another scene than the derivation: derive case.scene")
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        made = write_handout(self, case, folder, with_worksheet=worksheet, progress=progress)
        return made.files

    def to_octave(self, name: str = "RR") -> str:
        """Return a function file of MATLAB and Octave, as the textbook's RR.m."""
        from pendcore.derive.code.octave import function_file

        return function_file(self, name)

    def to_octave_inline(self, name: str = "g") -> str:
        """Return the textbook's inline form: statements that make the inline function ``g``."""
        from pendcore.derive.code.octave import inline_function

        return inline_function(self, name)

    def to_python(self) -> str:
        """Return a Python module with right-hand side, reactions and energies, for NumPy."""
        from pendcore.derive.code.python import module

        return module(self)

    def to_cpp(self, name: str = "Chain", namespace: str = "pendulum") -> str:
        """Return a C++17 header: a struct with right-hand side, reactions and energies."""
        from pendcore.derive.code.cpp import header

        return header(self, name, namespace)
