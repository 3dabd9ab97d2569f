"""The equations of motion of a scene in symbols: derived step by step, as the textbook does it."""

from __future__ import annotations

from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sympy import Expr, Integer, Symbol, expand

from pendcore import Case, Scene
from pendcore.derive.chain import Chain, Vector, dot, of_differences
from pendcore.derive.laws import laws_of
from pendcore.derive.motion import Motion
from pendcore.derive.newton_euler import NewtonEuler
from pendcore.derive.notation import Notation
from pendcore.derive.step import Step
from pendcore.messages import Progress

if TYPE_CHECKING:
    from pendcore.derive.report import Report

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
    n : int
        Number of links.
    symbols : Notation
        ``t``, ``q``, ``qd``, ``qdd`` and the parameters.
    chain : Chain
        Kinematics.
    equations : NewtonEuler
        Newton's and Euler's equations, with the reactions as unknowns.
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

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene, SI units."""
        return self.symbols.values

    @classmethod
    def textbook(cls) -> Derivation:
        """Derive section 2.1 of the textbook: two uniform rods."""
        return cls(Scene.textbook())

    @property
    def in_words(self) -> str:
        """What the chain is called: a double pendulum."""
        kinds = {1: "pendulum", 2: "double pendulum", 3: "triple pendulum"}
        return kinds.get(self.n, f"chain of {self.n} links")

    @cached_property
    def reactions(self) -> tuple[Vector, ...]:
        """Force on each link where it begins, (n,) pairs, N, in t, q, qd, qdd: F_01, F_12, ..."""
        known = self.definitions
        return tuple((x.xreplace(known), y.xreplace(known)) for x, y in self.equations.reactions)

    @cached_property
    def holding_couples(self) -> dict[int, Expr]:
        """Couple of each locked joint on the link beyond it, N m, in t, q, qd, qdd."""
        return {joint: couple.xreplace(self.known) for joint, couple in self.holding.items()}

    @cached_property
    def energies_by_definitions(self) -> Vector:
        """T, of links, payload and rotors, and V, J, with the pivot's motion as symbols."""
        s, chain = self.symbols, self.chain
        kinetic = potential = Integer(0)
        for body in self.equations.bodies:
            velocity = chain.velocity(body.center)
            kinetic += body.mass * dot(velocity, velocity) / 2 + body.inertia * body.rate**2 / 2
            potential -= s.gravity * body.mass * body.center[1]
        for joint, armature in enumerate(self.equations.armatures, start=1):
            kinetic += armature * chain.joint(joint)[1] ** 2 / 2
        potential = expand(potential)
        for law in self.equations.laws:
            if law.stored is not None:
                potential += law.stored(chain.joint(law.effect.joint)[0])
        return of_differences(kinetic), potential

    @property
    def kinetic_energy(self) -> Expr:
        """T, J, in t, q, qd and parameters."""
        return self.energies_by_definitions[0].xreplace(self.definitions)

    @property
    def potential_energy(self) -> Expr:
        """V, of weights and springs, J, in t, q and parameters; zero at the origin's height."""
        return self.energies_by_definitions[1].xreplace(self.definitions)

    @cached_property
    def powers_by_forces(self) -> dict[Any, Expr]:
        """The power of each effect, W, with its loads and joint forces as symbols."""
        found: dict[Any, Expr] = {}
        for law in self.equations.laws:
            if law.power is not None:
                power = law.power(self.chain, self.equations.forces[0])
            elif law.couple is not None and law.stored is None:
                phi, w, _ = self.chain.joint(law.effect.joint)
                power = law.couple(phi, w) * w
            else:
                continue
            found[law.effect] = found.get(law.effect, Integer(0)) + power
        return found

    @cached_property
    def powers_by_definitions(self) -> dict[Any, Expr]:
        """The power of each effect, W, with its loads as symbols."""
        known = self.equations.solved_forces
        return {effect: p.xreplace(known) for effect, p in self.powers_by_forces.items()}

    @cached_property
    def powers(self) -> dict[Any, Expr]:
        """The power that each effect brings into the chain, W, in t, q, qd, qdd."""
        known = self.definitions
        return {effect: p.xreplace(known) for effect, p in self.powers_by_definitions.items()}

    def energy_rate(self) -> Expr:
        """Return d/dt (T + V) minus the powers of all effects, along the motion: exactly 0.

        The accelerations are put in by two steps, each of them exact. Let R(qdd) be this difference
        for any accelerations, and let e = M qdd - f. The first step brings R(qdd) - qd . e to a
        normal form: that is 0 for all accelerations if forces, energies and powers fit together.
        The second step adds qd . e at the solved accelerations: that is 0 if they solve the
        equations.
        """
        s = self.symbols
        torques = dict(self.equations.torques.values())
        residual = self.chain.rate(sum(self.energies_by_definitions))
        residual -= sum(self.powers_by_definitions.values(), Integer(0))
        for i, rate in enumerate(s.qd):
            line = sum(self.mass_matrix[i, k] * a for k, a in enumerate(s.qdd))
            residual -= rate * (line - self.forcing_by_definitions[i].xreplace(torques))
        rates = dict[Symbol, Expr]()  # of links beyond a lock: those of the links before it
        for joint in self.equations.locked:
            before = s.qd[joint - 2] if joint > 1 else Integer(0)
            rates[s.qd[joint - 1]] = rates.get(before, before)
        left = residual.xreplace(torques).subs(rates).xreplace(self.chain.path)
        return of_differences(left) + self.power_of_the_error()

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
    ) -> Report:
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
            One that cannot be written is left out, with a warning. The list's ``is_whole`` says
            that none is, and that the run is as it was asked for.
        """
        from pendcore.derive.report import write_report

        if case.scene != self.scene:
            raise ValueError("case: has another scene than the derivation: derive case.scene")
        folder = Path(folder)
        folder.mkdir(parents=True, exist_ok=True)
        return write_report(self, case, folder, with_worksheet=worksheet, progress=progress)

    def to_octave(self, name: str = "RR") -> str:
        """Return a function file for ``ode45`` of MATLAB and Octave, like the textbook's RR.m.

        The scene's numbers stand at its top, by name, and what expressions share is computed once.
        The file has to have the name of the function, with ``.m``.
        """
        from pendcore.derive.code import octave

        return octave.function_file(self, name)

    def to_octave_inline(self, name: str = "g") -> str:
        """Return the textbook's inline form: statements that make the inline function ``g``.

        An inline function is one expression: the scene's numbers are put in, and nothing is shared.
        """
        from pendcore.derive.code import octave

        return octave.inline_function(self, name)

    def to_python(self) -> str:
        """Return a Python module for NumPy, with the scene's numbers at its top, by name.

        ``right_hand_side(t, y)`` is for SciPy's ``solve_ivp``; ``accelerations``, ``reactions``,
        ``energies`` and ``powers`` take ``t, q, qd`` with any axes after that of the links.
        """
        from pendcore.derive.code import python

        return python.module(self)

    def to_cpp(self, name: str = "Chain", namespace: str = "pendulum") -> str:
        """Return a C++17 header that needs the standard library alone.

        Its struct has the scene's numbers as defaults, and ``accelerations``, ``right_hand_side``,
        ``reactions``, ``energy`` and, where effects do work, ``powers``.
        """
        from pendcore.derive.code import cpp

        return cpp.header(self, name, namespace)
