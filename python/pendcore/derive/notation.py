"""The symbols of a chain: what they are called in text and in LaTeX, and their numbers.

The names are the textbook's, for any number of links: ``q1``, ``m1``, ``L1``, ``I_C1``, ``g``. The
rates are plain symbols too, ``qd1`` for the rate of ``q1`` and ``qdd1`` for its acceleration, which
keeps every derivative an ordinary partial one; LaTeX shows rates and accelerations with dots.

SymPy sorts factors and terms by name. Here they are written as a textbook does: a product begins
with what is constant, mass before length, over its numeric denominator, and goes on with rates and
sines. In a sum, joint forces come first, then terms link by link, accelerations before rates, and
weights last.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

import sympy
from sympy import Add, Expr, Integer, Mul, Rational, Symbol

from pendcore import Scene

UNKNOWN, MASS, GRAVITY, CONSTANT, LENGTH, ACCELERATION, RATE, ANGLE = range(8)
"""The kinds of symbols, in the order in which factors are written."""


class Parameter(NamedTuple):
    """A constant of the scene: its symbol, and its number in the scene, in ``unit``.

    The unit is SI, ``"1"`` for a ratio; ``meaning`` says what it is, in a few words.
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
    latex_names, meanings : dict
        How LaTeX writes the symbols, and what those of laws mean, in words with the unit last.
    """

    def __init__(self, scene: Scene) -> None:
        self.n = len(scene.links)
        self.latex_names: dict[Symbol, str] = {}
        self.meanings: dict[Symbol, str] = {}
        self.parameters: list[Parameter] = []
        self._ranks: dict[Symbol, tuple[int, int]] = {}
        links = [*enumerate(scene.links, start=1)]
        self.t = self.symbol("t", "t", ANGLE)
        self.q, self.qd, self.qdd = zip(*(self.moving("q", i, i, i) for i, _ in links), strict=True)
        make = self.parameter
        self.masses = tuple(
            make(f"m{i}", f"m_{{{i}}}", link.mass, "kg", f"mass of link {i}", (MASS, i))
            for i, link in links
        )
        self.lengths = tuple(
            make(f"L{i}", f"L_{{{i}}}", link.length, "m", f"length of link {i}", (LENGTH, i))
            for i, link in links
        )
        self.centers: tuple[Expr, ...] = ()
        self.inertias: tuple[Expr, ...] = ()
        for (i, link), mass, length in zip(links, self.masses, self.lengths, strict=True):
            center, inertia = length / 2, Rational(1, 12) * mass * length**2
            if "center" in link.particulars():
                words = f"distance of the mass centre of link {i} from the joint where it begins"
                center = make(f"c{i}", f"c_{{{i}}}", link.center, "m", words, (LENGTH, i))
            if "inertia" in link.particulars():
                words = f"moment of inertia of link {i} about its mass centre"
                name = f"I_C{i}", f"I_{{C_{{{i}}}}}"
                inertia = make(*name, link.inertia, "kg m^2", words, (MASS, i))
            self.centers += (center,)
            self.inertias += (inertia,)
        words = "acceleration of gravity"
        self.gravity = make("g", "g", scene.gravity, "m/s^2", words, (GRAVITY, 0))

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

    def moving(
        self, letter: str, mark: object, latex: object, link: int = 0
    ) -> tuple[Symbol, Symbol, Symbol]:
        """Return the symbols of a coordinate, its rate and its acceleration: q1, qd1, qdd1."""
        return (
            self.symbol(f"{letter}{mark}", f"{letter}_{{{latex}}}", ANGLE, link),
            self.symbol(f"{letter}d{mark}", rf"\dot{{{letter}}}_{{{latex}}}", RATE, link),
            self.symbol(f"{letter}dd{mark}", rf"\ddot{{{letter}}}_{{{latex}}}", ACCELERATION, link),
        )

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

    def latex(self, expression: Any) -> str:
        """Write an expression in LaTeX, with fractions and without needless brackets."""
        written = sympy.latex(
            self.arranged(expression, has_bars=True), order="none", symbol_names=self.latex_names,
            fold_func_brackets=True, long_frac_ratio=16,
        )  # fmt: skip
        return re.sub("^- ", "-", written)

    def text(self, expression: Any) -> str:
        """Write an expression as a line of text that Python and SymPy read."""
        return str(sympy.sstr(self.arranged(expression), order="none"))

    def arranged(self, expression: Any, *, has_bars: bool = False) -> Expr:
        """Return the same with all sums and products in order, not to be evaluated again.

        With ``has_bars`` what moves stands behind a fraction's bar, and not above it.
        """

        def ordered(part: Expr) -> Expr:
            if part.is_Add:
                return Add(*map(ordered, self.terms(part)), evaluate=False)
            if part.is_Mul:
                return product(part)
            if part.args:
                return part.func(*map(ordered, part.args), evaluate=False)
            return part

        def product(part: Expr) -> Expr:
            number, factors = part.as_coeff_mul(rational=False)
            factors = sorted(factors, key=self._place_in_product)
            lead = [x for x in factors if self._place_in_product(x)[0] <= LENGTH]
            over = any(x.is_Pow and x.exp.could_extract_minus_sign() for x in factors)
            if has_bars and number.is_Rational and number.q > 1 and not over and lead != factors:
                fraction = Mul(abs(number), *map(ordered, lead), evaluate=False)
                sign = [Integer(-1)] if number < 0 else []
                return Mul(*sign, fraction, *map(ordered, factors[len(lead) :]), evaluate=False)
            return Mul(*([] if number == 1 else [number]), *map(ordered, factors), evaluate=False)

        return ordered(sympy.sympify(expression))

    def terms(self, total: Expr) -> list[Expr]:
        """Return the terms of a sum in the order in which they are written."""
        found = sorted(Add.make_args(total), key=self._place_in_sum)
        if all(term.is_Symbol or (-term).is_Symbol for term in found):  # such as a joint's angle
            found.sort(key=lambda term: not term.is_Symbol)
        return found

    def _place_in_product(self, factor: Expr) -> tuple[int, int, str]:
        base = factor.as_base_exp()[0]
        if base.is_Symbol:
            return *self._rank(base), base.name
        return (ANGLE + 1 if base.is_Add else ANGLE), 0, str(factor)

    def _place_in_sum(self, term: Expr) -> tuple[object, ...]:
        found = [(*self._rank(x), x.name) for x in term.free_symbols]
        kinds = {kind for kind, *_ in found}
        moving = sorted(
            (link, kind) for kind, link, _ in found if kind in (ACCELERATION, RATE)
        ) or sorted((link, ANGLE) for kind, link, _ in found if kind == ANGLE)
        negative = term.could_extract_minus_sign()
        group = 2 * negative if UNKNOWN in kinds else 3 if GRAVITY in kinds else 1
        masses = sorted(link for kind, link, _ in found if kind == MASS)
        return group, moving, masses, str(term)

    def _rank(self, symbol: Symbol) -> tuple[int, int]:
        """Return the kind of a symbol and its link, which order factors and terms."""
        return self._ranks.get(symbol, (UNKNOWN, 0))
