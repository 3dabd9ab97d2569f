"""The figures of a report, numbered, with their captions."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees

import numpy as np

from pendcore._run.solution import Solution
from pendcore.derive.algebra import Algebra
from pendcore.derive.narration.page import Page
from pendcore.derive.report import curves, drawing
from pendcore.derive.report.document import Drawing
from pendcore.derive.report.free_bodies import Acting, Reaction, free_bodies
from pendcore.derive.report.mechanism import mechanism
from pendcore.derive.report.quantities import number


class Figures:
    """Draws the figures of a report, and numbers them.

    Parameters
    ----------
    derivation : Algebra
        The derivation whose symbols name points and forces.
    q : sequence of float, (n,)
        Angles at which the chain is drawn, rad.
    """

    def __init__(self, derivation: Algebra, q: Sequence[float]) -> None:
        self.derivation = derivation
        self.scene = derivation.scene
        self.q = list(q)
        self._page = page = Page(derivation)
        self.points = [page.joint(i)[1] for i in range(derivation.n + 1)]
        self._count = 0

    @property
    def angles_in_words(self) -> str:
        """The angles at which the chain is drawn."""
        return ", ".join(
            rf"$q_{{{i}}} = {number(degrees(q))}$°" for i, q in enumerate(self.q, start=1)
        )

    def mechanism(self) -> Drawing:
        """Draw Fig. 1 of the textbook."""
        with drawing.lettering():
            figure = mechanism(self.scene, self.q, self.points)
        what = {1: "The pendulum", 2: "The double pendulum"}.get(self.derivation.n, "The chain")
        return Drawing(
            "mechanism",
            self._caption(f"{what} at its start: {self.angles_in_words}."),
            figure,
        )

    def free_bodies(self, *, forces: bool = True) -> Drawing:
        """Draw every link alone; without forces the drawing is for those who are to draw them."""
        symbols = self.derivation.equations.forces
        write = self.derivation.symbols.latex
        reactions = [Reaction(write(x), write(y), k == 0) for k, (x, y) in enumerate(symbols)]
        payload = self.derivation.equations.payload
        if payload is not None:
            tip = payload.force
            reactions.append(Reaction(write(tip[0]), write(tip[1]), False))
        with drawing.lettering():
            figure = free_bodies(
                self.scene, self.q, self.points, reactions if forces else [], self._acting()
            )
        words = (
            "The links as free bodies; the arrows show what counts as positive."
            if forces
            else "The links, to be completed into free-body diagrams."
        )
        if forces and self.derivation.equations.loads:
            words += (
                " The drag $D_{i}$ on rod $i$ is drawn as it is for positive $F_{d,i}$; "
                "its moment about the joint where the rod begins is $T_{d,i}$."
            )
        return Drawing("free_bodies" if forces else "links", self._caption(words), figure)

    def _acting(self) -> Acting:
        """What acts on the free bodies besides weights and joint forces."""
        equations, write = self.derivation.equations, self.derivation.symbols.latex
        joints = range(1, self.derivation.n + 1)
        couples = {j: write(c) for j in joints if (c := equations.joint_couple(j)) != 0}
        loads = tuple((load.link, self._page.load(load).latex) for load in equations.loads)
        payload = equations.payload
        if payload is None:
            return Acting(couples, loads)
        turning = payload.inertia * self.derivation.symbols.qdd[-1]
        couple = write(turning) if turning != 0 else ""
        mass = write(payload.mass)
        return Acting(couples, loads, rf"({mass})" if payload.mass.is_Add else mass, couple)

    def angles(self, solution: Solution) -> Drawing:
        """Draw the textbook's figure, the angles over time."""
        with drawing.lettering():
            figure = curves.angles(solution)
        return Drawing("angles", self._caption("The angles of the links over time."), figure)

    def reactions(self, solution: Solution) -> Drawing:
        """Draw the joint forces as the derivation has them: F_01, F_21, ..."""
        forces = solution.reactions().copy()
        forces[:, 1:] *= -1  # F_12 is the core's, F_21 the derivation's
        names = [
            self.derivation.symbols.latex(x).replace("x}", "}")
            for x, _ in self.derivation.equations.forces
        ]
        with drawing.lettering():
            figure = curves.reactions(solution.t, forces, names)
        words = "The joint reactions over time; $y$ points down, so a force upward is negative."
        return Drawing("reactions", self._caption(words), figure)

    def energies(self, solution: Solution) -> Drawing:
        """Draw the energies, and what their balance leaves over."""
        energy = solution.energy()
        found = {"$T$": energy.kinetic, "$V$": energy.potential, "$T + V$": energy.total}
        ledger = energy.ledger
        left = energy.total - energy.total[0] if ledger is None else ledger.residual
        with drawing.lettering():
            figure = curves.energies(solution.t, found, np.asarray(left))
        words = "Above: kinetic, potential and total energy over time. Below: " + (
            "the change of $T + V$ since the start, which should be zero."
            if ledger is None
            else "the change of $T + V$ since the start less all work, which should be zero."
        )
        return Drawing("energies", self._caption(words), figure)

    def empty_axes(self, solution: Solution) -> Drawing:
        """Draw the axes of the figure of the angles, with no curves."""
        with drawing.lettering():
            figure = curves.empty_axes(solution)
        return Drawing("axes", self._caption("The angles of the links over time."), figure)

    def _caption(self, words: str) -> str:
        self._count += 1
        return f"Fig. {self._count}. {words}"
