"""The figures of a report, numbered, with their captions."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees
from typing import TYPE_CHECKING

import numpy as np

from pendcore import Solution
from pendcore.derive.algebra import Algebra
from pendcore.derive.document import Drawing
from pendcore.derive.narration.page import Page
from pendcore.derive.report import drawing
from pendcore.derive.report.drawing import Floats
from pendcore.derive.report.free_bodies import free_bodies
from pendcore.derive.report.mechanism import mechanism
from pendcore.derive.report.quantities import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MOST_TICKS = 7
"""The largest number of ticks on an axis that is drawn into by hand."""
OF_LINKS = "The angles of the links over time."


class Figures:
    """Draws the figures of a report, of a chain at the angles ``q``, rad, and numbers them."""

    def __init__(self, derivation: Algebra, q: Sequence[float]) -> None:
        self.derivation = derivation
        self.scene = derivation.scene
        self.q = list(q)
        self._page = page = Page(derivation)
        self.points = [page.joint(i) for i in range(derivation.n + 1)]
        self._count = 0

    def _drawing(self, name: str, caption: str, figure: Figure) -> Drawing:
        self._count += 1
        return Drawing(name, f"Fig. {self._count}. {caption}", figure)

    def mechanism(self) -> Drawing:
        """Draw Fig. 1 of the textbook."""
        with drawing.lettering():
            figure = mechanism(self.scene, self.q, self.points)
        start = (rf"$q_{{{i}}} = {number(degrees(q))}$°" for i, q in enumerate(self.q, start=1))
        return self._drawing("mechanism", f"The chain at its start: {', '.join(start)}.", figure)

    def free_bodies(self, *, forces: bool = True) -> Drawing:
        """Draw every link alone; without forces the drawing is for those who are to draw them."""
        with drawing.lettering():
            figure = free_bodies(self._page, self.q, forces=forces)
        if not forces:
            words = "The links, to be completed into free-body diagrams."
            return self._drawing("links", words, figure)
        words = "The links as free bodies; the arrows show what counts as positive."
        if self.derivation.equations.loads:
            words += (
                " The drag $D_{i}$ on rod $i$ is drawn as it is for positive $F_{d,i}$; "
                "its moment about the joint where the rod begins is $T_{d,i}$."
            )
        return self._drawing("free_bodies", words, figure)

    def angles(self, solution: Solution) -> Drawing:
        """Draw the textbook's figure, the angles over time."""
        with drawing.lettering():
            figure, axes = _sheets(self.derivation.n)
            solution.plot(axes)
            for axis in axes[:-1]:
                axis.set_xlabel("")
        return self._drawing("angles", OF_LINKS, figure)

    def empty_axes(self, solution: Solution) -> Drawing:
        """Draw the axes of the angles with nothing in them: the scale gives nothing away."""
        from matplotlib.ticker import AutoMinorLocator

        span = solution.t[0], solution.t[-1]
        if span[0] == span[1]:  # a run that failed at once
            span = solution.t_span
        with drawing.lettering():
            figure, axes = _sheets(self.derivation.n)
        for i, axis in enumerate(axes, start=1):
            low, high, step = whole_ticks(np.degrees(solution.q[:, i - 1]))
            axis.set(xlim=span, ylim=(low, high), ylabel=f"q{i} (deg)")
            axis.set_yticks(np.arange(low, high + 1.0, step))
            axis.set_yticks(np.arange(low, high + 1.0, step / 3.0), minor=True)
            axis.xaxis.set_minor_locator(AutoMinorLocator(5))
            axis.grid(True, which="major", color="0.6", linewidth=0.6)
            axis.grid(True, which="minor", color="0.85", linewidth=0.5)
        axes[-1].set_xlabel("t (s)")
        return self._drawing("axes", OF_LINKS, figure)

    def reactions(self, solution: Solution) -> Drawing:
        """Draw the joint forces as the derivation has them: F_01, F_21, ..."""
        forces = solution.reactions().copy()
        forces[:, 1:] *= -1  # F_12 is the core's, F_21 the derivation's
        with drawing.lettering():
            figure, axes = _sheets(self.derivation.n, 2.4)
            for i, axis in enumerate(axes):
                x, y = forces[:, i].T
                names = [*map(self.derivation.symbols.latex, self.derivation.equations.forces[i])]
                name = names[0].replace("x}", "}")
                size = rf"|\mathbf{{F}}{name[1:]}|"
                curves = {names[0]: x, names[1]: y, size: np.hypot(x, y)}
                _curves(axis, solution.t, curves, f"${name}$ (N)")
            axes[-1].set_xlabel("t (s)")
        words = "The joint reactions over time; $y$ points down, so a force upward is negative."
        return self._drawing("reactions", words, figure)

    def energies(self, solution: Solution) -> Drawing:
        """Draw the energies, and what their balance leaves over."""
        energy = solution.energy()
        curves = {"T": energy.kinetic, "V": energy.potential, "T + V": energy.total}
        left, less = energy.total - energy.total[0], ""
        if energy.ledger is not None:
            left, less = energy.ledger["residual"], " less all work"
        with drawing.lettering():
            figure, axes = _sheets(2, 2.4)
            _curves(axes[0], solution.t, curves, "energy (J)")
            _curves(axes[1], solution.t, {"": left}, "balance (J)")
            axes[1].set_xlabel("t (s)")
            axes[1].ticklabel_format(axis="y", style="sci", scilimits=(-2, 3), useMathText=True)
        words = (
            "Above: kinetic, potential and total energy over time. Below: the change of $T + V$ "
            f"since the start{less}, which should be zero."
        )
        return self._drawing("energies", words, figure)


def _sheets(rows: int, height: float = 2.1) -> tuple[Figure, list[Axes]]:
    """Return a figure with axes one below the other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(6.6, max(3.0, height * rows)), layout="constrained")
    return figure, list(figure.subplots(rows, 1, squeeze=False, sharex=True)[:, 0])


def _curves(axis: Axes, t: Floats, curves: dict[str, Floats], label: str) -> None:
    """Draw curves over time, with their names beside them."""
    styles = ("r-", "b--", "k-") if len(curves) > 1 else ("k-",)
    for (name, curve), style in zip(curves.items(), styles, strict=True):
        axis.plot(t, curve, style, label=f"${name}$", lw=0.8 if style[0] == "k" else 1.5)
    axis.set_ylabel(label)
    if len(curves) > 1:
        axis.legend(loc="center left", bbox_to_anchor=(1.0, 0.5), frameon=False)
    axis.grid(True, color="0.85", linewidth=0.6)
    axis.margins(x=0)


def whole_ticks(angles: Floats) -> tuple[float, float, float]:
    """Return ends and step of an axis for angles, deg: at most seven ticks, at whole 30 degrees."""
    for step in (30.0, 45.0, 90.0, 180.0, *(360.0 * 2.0 ** np.arange(20))):
        low = step * np.floor(min(0.0, float(angles.min())) / step)
        high = step * np.ceil(max(90.0, float(angles.max()) + 0.05 * step) / step)
        if (high - low) / step <= MOST_TICKS - 1:
            break
    return float(low), float(high), float(step)
