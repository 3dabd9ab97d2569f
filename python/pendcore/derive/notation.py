"""The symbols of a chain: what they are called in text and in LaTeX, and their numbers.

The names are the textbook's, for any number of links: ``q1``, ``m1``, ``L1``, ``I_C1``, ``g``. The
rates are plain symbols too, ``qd1`` for the rate of ``q1`` and ``qdd1`` for its acceleration, which
keeps every derivative an ordinary partial one; LaTeX shows rates and accelerations with dots.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from sympy import Expr, Rational, Symbol

from pendcore import Scene
from pendcore.derive import writing
from pendcore.derive.writing import (
    ACCELERATION,
    ANGLE,
    CONSTANT,
    GRAVITY,
    LENGTH,
    MASS,
    RATE,
    UNKNOWN,
)

DOTTED = {"": "{}", "d": r"\dot{{{}}}", "dd": r"\ddot{{{}}}"}
"""How LaTeX writes what the name of a symbol says by d and dd."""


class Parameter(NamedTuple):
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
    parameters : list of Parameter
        The constants of the scene: those of links and gravity first, then the effects'.
    latex_names : dict
        How LaTeX writes the symbols.
    """

    def __init__(self, scene: Scene) -> None:
        self.n = len(scene.links)
        self.latex_names: dict[Symbol, str] = {}
        self.parameters: list[Parameter] = []
        self._ranks: dict[Symbol, tuple[int, int]] = {}
        links = [*enumerate(scene.links, start=1)]
        self.t = self.symbol("t", "t", ANGLE)
        self.q, self.qd, self.qdd = (
            tuple(self.symbol(f"q{dots}{i}", f"{shown.format('q')}_{{{i}}}", kind, i)
                  for i, _ in links)
            for (dots, shown), kind in zip(DOTTED.items(), (ANGLE, RATE, ACCELERATION), strict=True)
        )  # fmt: skip
        self.masses = tuple(
            self.parameter(f"m{i}", f"m_{{{i}}}", link.mass, "kg", f"mass of link {i}", (MASS, i))
            for i, link in links
        )
        self.lengths = tuple(
            self.parameter(
                f"L{i}", f"L_{{{i}}}", link.length, "m", f"length of link {i}", (LENGTH, i)
            )
            for i, link in links
        )
        self.centers: tuple[Expr, ...] = ()
        self.inertias: tuple[Expr, ...] = ()
        for (i, link), mass, length in zip(links, self.masses, self.lengths, strict=True):
            center, inertia = length / 2, Rational(1, 12) * mass * length**2
            if "center" in link.particulars():
                words = f"distance of the mass centre of link {i} from the joint where it begins"
                name = f"c_{{{i}}}"
                center = self.parameter(f"c{i}", name, link.center, "m", words, (LENGTH, i))
            if "inertia" in link.particulars():
                words = f"moment of inertia of link {i} about its mass centre"
                name = f"I_{{C_{{{i}}}}}"
                rank = MASS, i
                inertia = self.parameter(f"I_C{i}", name, link.inertia, "kg m^2", words, rank)
            self.centers += (center,)
            self.inertias += (inertia,)
        words = "acceleration of gravity"
        self.gravity = self.parameter("g", "g", scene.gravity, "m/s^2", words, (GRAVITY, 0))

    @property
    def values(self) -> dict[Symbol, float]:
        """The numbers of the scene."""
        return {parameter.symbol: parameter.value for parameter in self.parameters}

    def symbol(self, name: str, latex: str, rank: int | None = None, link: int = 0) -> Symbol:
        """Return the real symbol of that name, and remember how it is written and ordered."""
        made = Symbol(name, real=True)
        self.latex_names[made] = latex
        if rank is not None:
            self._ranks[made] = rank, link
        return made

    def fresh(self, name: str, latex: str) -> tuple[str, str]:
        """Return a name that no symbol has yet: a second one, as of two dampers, has a number."""
        taken, count = {symbol.name for symbol in self.latex_names}, 1
        while (name if count == 1 else f"{name}_{count}") in taken:
            count += 1
        return (name, latex) if count == 1 else (f"{name}_{count}", f"{{{latex}^{{({count})}}}}")

    def parameter(
        self,
        name: str,
        latex: str,
        value: float,
        unit: str,
        meaning: str,
        rank: tuple[int, int] = (CONSTANT, 0),
    ) -> Symbol:
        """Return a new symbol for a constant of the scene."""
        symbol = self.symbol(*self.fresh(name, latex), *rank)
        self.parameters.append(Parameter(symbol, float(value), unit, meaning))
        return symbol

    def rank(self, symbol: Symbol) -> tuple[int, int]:
        """Return the kind of a symbol and its link, which order factors and terms."""
        return self._ranks.get(symbol, (UNKNOWN, 0))

    def latex(self, expression: Any) -> str:
        """Write an expression in LaTeX."""
        return writing.latex(expression, self.rank, self.latex_names)

    def text(self, expression: Any) -> str:
        """Write an expression as a line of text that Python and SymPy read."""
        return writing.text(expression, self.rank)

    def terms(self, total: Expr) -> list[Expr]:
        """Return the terms of a sum in the order in which they are written."""
        return writing.terms(total, self.rank)
