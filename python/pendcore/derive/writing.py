"""Expressions written as a textbook writes them, in text and in LaTeX.

SymPy sorts factors and terms by name. Here a term begins with what is constant, mass before length,
over its numeric denominator, and goes on with rates and sines: ``m1*g*L1/2*cos(q1)``. In a sum,
joint forces come first, then terms link by link, accelerations before rates, and weights last.
The text is valid Python, and SymPy reads it.
"""

from __future__ import annotations

from typing import Any, Protocol

import sympy
from sympy import Expr, Pow, Symbol
from sympy.printing.latex import latex as sympy_latex


class Rank(Protocol):
    """What orders symbols: the place of a kind among the factors, and the number of the link."""

    def __call__(self, symbol: Symbol) -> tuple[int, int]: ...


UNKNOWN, MASS, GRAVITY, CONSTANT, LENGTH, ACCELERATION, RATE, ANGLE = range(8)
"""The kinds of symbols, in the order in which factors are written."""


class Language:
    """How sums, products and functions look; see `Text` and `Latex`."""

    bars = False
    """Whether a fraction has a bar, which brackets what is above and below it."""

    def __init__(self, rank: Rank, names: dict[Symbol, str]) -> None:
        self.rank = rank
        self.names = names

    def write(self, expression: Any) -> str:
        """Write an expression."""
        expression = sympy.sympify(expression)
        if expression.is_Add:
            return self._sum(expression)
        if expression.is_Mul or expression.is_Rational:
            negative, term = self._term(expression)
            return f"-{term}" if negative else term
        if expression.is_Pow:
            return self._power(expression)
        if expression.is_Symbol:
            return self.symbol(expression)
        if isinstance(expression, sympy.Function):
            return self.function(expression, None)
        return self.other(expression)

    def symbol(self, symbol: Symbol) -> str:
        raise NotImplementedError

    def other(self, expression: Expr) -> str:
        raise NotImplementedError

    def bracket(self, inside: str) -> str:
        raise NotImplementedError

    def function(self, applied: Expr, exponent: Expr | None) -> str:
        raise NotImplementedError

    def raised(self, base: str, exponent: str) -> str:
        raise NotImplementedError

    def product(self, factors: list[str]) -> str:
        raise NotImplementedError

    def quotient(self, over: list[str], under: list[str], rest: list[str]) -> str:
        raise NotImplementedError

    def terms(self, expression: Expr) -> list[Expr]:
        """Return the terms of a sum in the order in which they are written."""
        if not expression.is_Add:
            return [expression]
        terms = sorted(expression.args, key=self._place_in_sum)
        if all(term.is_Symbol or (-term).is_Symbol for term in terms):  # such as a joint's angle
            terms.sort(key=lambda term: not term.is_Symbol)
        return terms

    def _sum(self, expression: Expr) -> str:
        written = ""
        for term in self.terms(expression):
            negative, text = self._term(term)
            if written:
                written += f" {'-' if negative else '+'} {text}"
            else:
                written = f"-{text}" if negative else text
        return written

    def _term(self, term: Expr) -> tuple[bool, str]:
        """Write a term of a sum; return whether a minus goes before it, and the rest."""
        number, factors = term.as_coeff_mul(rational=True)
        over: list[Expr] = []
        under: list[Expr] = []
        for factor in factors:
            base, exponent = factor.as_base_exp()
            if exponent.is_number and exponent.could_extract_minus_sign():
                under.append(Pow(base, -exponent))
            else:
                over.append(factor)
        over.sort(key=self._place_in_product)
        under.sort(key=self._place_in_product)
        lead = [x for x in over if self._place_in_product(x)[0] <= LENGTH]
        rest = over[len(lead) :]
        if under:
            lead, rest = over, []
        digits = [] if abs(number.p) == 1 and (over or number.q == 1) else [str(abs(number.p))]
        below = [] if number.q == 1 else [str(number.q)]
        below += [self._factor(x, alone=self.bars and len(below) + len(under) == 1) for x in under]
        top = digits + [
            self._factor(x, alone=self.bars and len(over) + len(digits) == 1) for x in lead
        ]
        end = [self._factor(x) for x in rest]
        if not top and not end:
            top = ["1"]
        if not below:
            return bool(number.p < 0), self.product(top + end)
        return bool(number.p < 0), self.quotient(top, below, end)

    def _factor(self, factor: Expr, alone: bool = False) -> str:
        written = self.write(factor)
        return written if alone or not factor.is_Add else self.bracket(written)

    def _power(self, power: Expr) -> str:
        base, exponent = power.as_base_exp()
        if exponent.is_number and exponent.could_extract_minus_sign():
            return self._term(power)[1]
        if isinstance(base, sympy.Function) and base.func in (sympy.sin, sympy.cos):
            return self.function(base, exponent)
        inside = self.write(base)
        return self.raised(inside if base.is_Symbol else self.bracket(inside), self.write(exponent))

    def _place_in_product(self, factor: Expr) -> tuple[int, int, str]:
        base = factor.as_base_exp()[0]
        if base.is_Symbol:
            return *self.rank(base), base.name
        return (ANGLE + 1 if base.is_Add else ANGLE), 0, str(factor)

    def _place_in_sum(self, term: Expr) -> tuple[object, ...]:
        found = [(*self.rank(x), x.name) for x in term.free_symbols]
        kinds = {kind for kind, *_ in found}
        moving = sorted(
            (link, kind) for kind, link, _ in found if kind in (ACCELERATION, RATE)
        ) or sorted((link, ANGLE) for kind, link, _ in found if kind == ANGLE)
        negative = term.could_extract_minus_sign()
        group = 2 * negative if UNKNOWN in kinds else 3 if GRAVITY in kinds else 1
        masses = sorted(link for kind, link, _ in found if kind == MASS)
        return group, moving, masses, str(term)


class Text(Language):
    """Python's way of writing, in the textbook's order."""

    def symbol(self, symbol: Symbol) -> str:
        """Return the name."""
        return str(symbol.name)

    def other(self, expression: Expr) -> str:
        """Return what SymPy makes of it."""
        return str(sympy.sstr(expression))

    def bracket(self, inside: str) -> str:
        return f"({inside})"

    def function(self, applied: Expr, exponent: Expr | None) -> str:
        arguments = ", ".join(map(self.write, applied.args))
        name = {"Abs": "abs"}.get(type(applied).__name__, type(applied).__name__)
        called = f"{name}({arguments})"
        return called if exponent is None else self.raised(called, self.write(exponent))

    def raised(self, base: str, exponent: str) -> str:
        return f"{base}**{exponent if exponent.isalnum() else f'({exponent})'}"

    def product(self, factors: list[str]) -> str:
        return "*".join(factors)

    def quotient(self, over: list[str], under: list[str], rest: list[str]) -> str:
        if not over:
            over, rest = rest, []
        below = under[0] if len(under) == 1 else f"({self.product(under)})"
        return self.product([f"{self.product(over)}/{below}", *rest])


class Latex(Language):
    """LaTeX, with fractions and without needless brackets."""

    bars = True

    def symbol(self, symbol: Symbol) -> str:
        """Return the name as it was given with the symbol."""
        return self.names.get(symbol) or str(sympy_latex(symbol))

    def other(self, expression: Expr) -> str:
        """Return what SymPy makes of it."""
        return str(sympy_latex(expression, symbol_names=self.names, fold_func_brackets=True))

    def bracket(self, inside: str) -> str:
        return rf"\left({inside}\right)"

    def function(self, applied: Expr, exponent: Expr | None) -> str:
        inside = ", ".join(map(self.write, applied.args))
        if isinstance(applied, sympy.Abs):
            return rf"\left|{inside}\right|"
        power = "" if exponent is None else f"^{{{self.write(exponent)}}}"
        argument = inside if applied.args[0].is_Symbol else self.bracket(inside)
        return rf"\{type(applied).__name__}{power} {argument}"

    def raised(self, base: str, exponent: str) -> str:
        return f"{base}^{{{exponent}}}"

    def product(self, factors: list[str]) -> str:
        return (r" \, " if any(x[0].isdigit() for x in factors[1:]) else " ").join(factors)

    def quotient(self, over: list[str], under: list[str], rest: list[str]) -> str:
        fraction = rf"\frac{{{self.product(over or ['1'])}}}{{{self.product(under)}}}"
        return self.product([fraction, *rest])
