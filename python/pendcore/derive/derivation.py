"""The derivation of a scene's equations of motion, step by step, as the textbook does it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sympy import Expr, Integer, Symbol

from pendcore import Case, Scene
from pendcore.derive.chain import Chain, Vector
from pendcore.derive.energy import Energy
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation

if TYPE_CHECKING:
    from pendcore._messages.progress import Progress
    from pendcore.derive.step import Step

WRITTEN_OUT = (5, 137, 1207, 10190, 90219)
"""Operations of the accelerations of 1, 2, ... uniform rods, written out; a test counts them."""


class Derivation(Motion):
    """The equations of motion of a scene, derived in symbols.

    Parameters
    ----------
    scene : Scene
        The scene to derive; its effects have to be smooth.

    Raises
    ------
    ValueError
        If an effect has no law in symbols, or the chain is too long to be written out; the message
        says why, and what to do instead.

    Attributes
    ----------
    scene : Scene
        The scene that is derived.
    n : int
        Number of links.
    symbols : Notation
        ``t``, ``q``, ``qd``, ``qdd`` and the parameters.
    chain : Chain
        Kinematics.
    equations : NewtonEuler
        Newton's and Euler's equations, with the reactions as unknowns.
    energy : Energy
        Energies, powers, and their balance.
    """

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

    @classmethod
    def textbook(cls) -> Derivation:
        """Derive section 2.1 of the textbook: two uniform rods."""
        return cls(Scene.textbook())

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

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The derivation, from the positions to the first-order form."""
        from pendcore.derive import narration

        return narration.steps(self)

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
            Where to write; the folder is made if it does not exist.
        worksheet : bool
            Whether to write a worksheet as well: the same problem with blanks.
        progress : None, bool or callable
            As in `pendcore.simulate`.

        Returns
        -------
        list of Path
            The files, the report first: Markdown always, HTML and PDF where there are converters.
            One that cannot be written is left out, with a warning.
        """
        from pendcore.derive.report import write_report

        if case.scene != self.scene:
            raise ValueError("case: has another scene than the derivation: derive case.scene")
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        return write_report(self, case, folder, with_worksheet=worksheet, progress=progress).files

    def to_octave(self, name: str = "RR") -> str:
        """Return a function file for MATLAB and Octave, like the textbook's RR.m."""
        from pendcore.derive.code import octave

        return octave.function_file(self, name)

    def to_octave_inline(self, name: str = "g") -> str:
        """Return the textbook's inline form: statements that make the inline function ``g``."""
        from pendcore.derive.code import octave

        return octave.inline_function(self, name)

    def to_python(self) -> str:
        """Return a Python module with right-hand side, reactions and energies, for NumPy."""
        from pendcore.derive.code import python

        return python.module(self)

    def to_cpp(self, name: str = "Chain", namespace: str = "pendulum") -> str:
        """Return a C++17 header: a struct with right-hand side, reactions and energies."""
        from pendcore.derive.code import cpp

        return cpp.header(self, name, namespace)
