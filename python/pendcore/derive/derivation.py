"""The derivation of a scene's equations of motion, step by step, as the textbook does it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path

from pendcore import Case, Scene
from pendcore.derive import narration
from pendcore.derive.algebra import Algebra
from pendcore.derive.code import cpp, octave, python
from pendcore.derive.report import write_report
from pendcore.derive.step import Step
from pendcore.messages import Progress


class Derivation(Algebra):
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

    @classmethod
    def textbook(cls) -> Derivation:
        """Derive section 2.1 of the textbook: two uniform rods."""
        return cls(Scene.textbook())

    @cached_property
    def steps(self) -> tuple[Step, ...]:
        """The derivation, from the positions to the first-order form."""
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
        if case.scene != self.scene:
            raise ValueError("case: has another scene than the derivation: derive case.scene")
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        return write_report(self, case, folder, with_worksheet=worksheet, progress=progress).files

    def to_octave(self, name: str = "RR") -> str:
        """Return a function file for MATLAB and Octave, like the textbook's RR.m."""
        return octave.function_file(self, name)

    def to_octave_inline(self, name: str = "g") -> str:
        """Return the textbook's inline form: statements that make the inline function ``g``."""
        return octave.inline_function(self, name)

    def to_python(self) -> str:
        """Return a Python module with right-hand side, reactions and energies, for NumPy."""
        return python.module(self)

    def to_cpp(self, name: str = "Chain", namespace: str = "pendulum") -> str:
        """Return a C++17 header: a struct with right-hand side, reactions and energies."""
        return cpp.header(self, name, namespace)
