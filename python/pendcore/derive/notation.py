"""The symbols of a chain: what they are called in text and in LaTeX, and their numbers.

The names are the textbook's, for any number of links: ``q1``, ``m1``, ``L1``, ``I_C1``, ``g``. The
rates are plain symbols too, ``qd1`` for the rate of ``q1`` and ``qdd1`` for its acceleration, which
keeps every derivative an ordinary partial one; LaTeX shows rates and accelerations with dots.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from sympy import Expr, Rational, Symbol

from pendcore._scene.scene import Scene
from pendcore.derive.writing import (
    ACCELERATION,
    ANGLE,
    CONSTANT,
    GRAVITY,
    LENGTH,
    MASS,
    RATE,
    UNKNOWN,
    Latex,
    Text,
)


@dataclass(frozen=True, slots=True)
class Parameter:
    """A constant of the scene.

    Attributes
    ----------
    symbol : sympy.Symbol
        What stands for it in the equations.
    value : float
        Its number in the scene, in ``unit``.
    unit : str
        SI; ``"1"`` for a ratio.
    meaning : str
        What it is, in a few words.
    """

    symbol: Symbol
    value: float
    unit: str
    meaning: str


class Notation:
    """Time, angles, rates, accelerations and parameters of a scene as symbols.

    Attributes
    ----------
    t : sympy.Symbol
        Time, s.
    q, qd, qdd : tuple of sympy.Symbol, (n,)
        Absolute angles (rad), rates (rad/s) and accelerations (rad/s^2) of the links.
    gravity : sympy.Symbol
        Acceleration of gravity, towards +y, m/s^2.
    masses, lengths : tuple of sympy.Symbol, (n,)
        Masses (kg) and lengths (m) of the links.
    centers, inertias : tuple of sympy.Expr, (n,)
        Distance of the mass centre from the joint where the link begins (m), and moment of inertia
        about the mass centre (kg m^2): symbols, or ``L/2`` and ``m L^2/12`` for a uniform rod.
    latex_names : dict
        How LaTeX writes the symbols.
    """

    def __init__(self, scene: Scene) -> None:
        self.n = n = len(scene.links)
        self.latex_names: dict[Symbol, str] = {}
        self._parameters: list[Parameter] = []
        self._ranks: dict[Symbol, tuple[int, int]] = {}
        self.t = self.symbol("t", "t")
        links = range(1, n + 1)
        self.q = tuple(self.symbol(f"q{i}", f"q_{{{i}}}") for i in links)
        self.qd = tuple(self.symbol(f"qd{i}", rf"\dot{{q}}_{{{i}}}") for i in links)
        self.qdd = tuple(self.symbol(f"qdd{i}", rf"\ddot{{q}}_{{{i}}}") for i in links)
        self.masses = tuple(
            self.parameter(f"m{i}", f"m_{{{i}}}", link.mass, "kg", f"mass of link {i}")
            for i, link in enumerate(scene.links, start=1)
        )
        self.lengths = tuple(
            self.parameter(f"L{i}", f"L_{{{i}}}", link.length, "m", f"length of link {i}")
            for i, link in enumerate(scene.links, start=1)
        )
        centers: list[Expr] = []
        inertias: list[Expr] = []
        for i, link in enumerate(scene.links, start=1):
            own, mass, length = link.particulars(), self.masses[i - 1], self.lengths[i - 1]
            if "center" in own:
                words = f"distance of the mass centre of link {i} from the joint where it begins"
                centers.append(self.parameter(f"c{i}", f"c_{{{i}}}", link.center, "m", words))
            else:
                centers.append(length / 2)
            if "inertia" in own:
                words = f"moment of inertia of link {i} about its mass centre"
                name = f"I_{{C_{{{i}}}}}"
                inertias.append(self.parameter(f"I_C{i}", name, link.inertia, "kg m^2", words))
            else:
                inertias.append(Rational(1, 12) * mass * length**2)
        self.centers, self.inertias = tuple(centers), tuple(inertias)
        self.gravity = self.parameter("g", "g", scene.gravity, "m/s^2", "acceleration of gravity")
        self._ranks |= {self.t: (ANGLE, 0), self.gravity: (GRAVITY, 0)}
        for kind, row in (
            (ANGLE, self.q), (RATE, self.qd), (ACCELERATION, self.qdd),
            (MASS, self.masses), (MASS, self.inertias),
            (LENGTH, self.lengths), (LENGTH, self.centers),
        ):  # fmt: skip
            for i, symbol in enumerate(row, start=1):
                self._ranks[symbol] = (kind, i)

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """The constants of the scene: those of links and gravity first, then the effects'."""
        return tuple(self._parameters)

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene."""
        return {parameter.symbol: parameter.value for parameter in self._parameters}

    def symbol(self, name: str, latex: str, rank: int | None = None, link: int = 0) -> Symbol:
        """Return the real symbol of that name, and remember how it is written and ordered."""
        made = Symbol(name, real=True)
        self.latex_names[made] = latex
        if rank is not None:
            self._ranks[made] = rank, link
        return made

    def parameter(
        self,
        name: str,
        latex: str,
        value: float,
        unit: str,
        meaning: str,
        rank: tuple[int, int] = (CONSTANT, 0),
    ) -> Symbol:
        """Return a new symbol for a constant of the scene.

        A second symbol of the same name, as for two dampers in one joint, gets a number.
        """
        taken = [p.symbol.name for p in self._parameters]
        count = 1 + sum(known == name or known.startswith(f"{name}__") for known in taken)
        if count > 1:
            name, latex = f"{name}__{count}", f"{{{latex}^{{({count})}}}}"
        symbol = self.symbol(name, latex)
        self._parameters.append(Parameter(symbol, float(value), unit, meaning))
        self._ranks[symbol] = rank
        return symbol

    def rank(self, symbol: Symbol) -> tuple[int, int]:
        """Return the kind of a symbol and its link, which order factors and terms."""
        return self._ranks.get(symbol, (UNKNOWN, 0))

    def latex(self, expression: Any) -> str:
        """Write an expression in LaTeX."""
        return Latex(self.rank, self.latex_names).write(expression)

    def terms(self, expression: Expr) -> list[Expr]:
        """Return the terms of a sum in the order in which they are written."""
        return Latex(self.rank, self.latex_names).terms(expression)

    def text(self, expression: Any) -> str:
        """Write an expression as a line of text that Python and SymPy read."""
        return Text(self.rank, self.latex_names).write(expression)
