"""Expressions in the order in which a textbook writes them, printed by SymPy.

SymPy sorts factors and terms by name. Here a product begins with what is constant, mass before
length, over its numeric denominator, and goes on with rates and sines. In a sum, joint forces come
first, then terms link by link, accelerations before rates, and weights last.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import sympy
from sympy import Add, Expr, Integer, Mul, Symbol

UNKNOWN, MASS, GRAVITY, CONSTANT, LENGTH, ACCELERATION, RATE, ANGLE = range(8)
"""The kinds of symbols, in the order in which factors are written."""

Rank = Callable[[Symbol], tuple[int, int]]
"""What orders symbols: the place of a kind among the factors, and the number of the link."""


def latex(expression: Any, rank: Rank, names: dict[Symbol, str]) -> str:
    """Write an expression in LaTeX, with fractions and without needless brackets."""
    written = sympy.latex(
        arranged(sympy.sympify(expression), rank, has_bars=True),
        order="none", symbol_names=names, fold_func_brackets=True, long_frac_ratio=16,
    )  # fmt: skip
    return re.sub("^- ", "-", written)


def text(expression: Any, rank: Rank) -> str:
    """Write an expression as a line of text that Python and SymPy read."""
    return str(sympy.sstr(arranged(sympy.sympify(expression), rank), order="none"))


def arranged(expression: Expr, rank: Rank, *, has_bars: bool = False) -> Expr:
    """Return the same with all sums and products in order, not to be evaluated again.

    With ``has_bars`` what moves stands behind a fraction's bar, and not above it.
    """

    def ordered(part: Expr) -> Expr:
        if part.is_Add:
            return Add(*map(ordered, terms(part, rank)), evaluate=False)
        if part.is_Mul:
            return product(part)
        if part.args:
            return part.func(*map(ordered, part.args), evaluate=False)
        return part

    def product(part: Expr) -> Expr:
        number, factors = part.as_coeff_mul(rational=False)
        factors = sorted(factors, key=lambda factor: _place_in_product(factor, rank))
        lead = [x for x in factors if _place_in_product(x, rank)[0] <= LENGTH]
        over = any(x.is_Pow and x.exp.could_extract_minus_sign() for x in factors)
        if has_bars and number.is_Rational and number.q > 1 and not over and lead != factors:
            fraction = Mul(abs(number), *map(ordered, lead), evaluate=False)
            sign = [Integer(-1)] if number < 0 else []
            return Mul(*sign, fraction, *map(ordered, factors[len(lead) :]), evaluate=False)
        return Mul(*([] if number == 1 else [number]), *map(ordered, factors), evaluate=False)

    return ordered(expression)


def terms(total: Expr, rank: Rank) -> list[Expr]:
    """Return the terms of a sum in the order in which they are written."""
    found = sorted(Add.make_args(total), key=lambda term: _place_in_sum(term, rank))
    if all(term.is_Symbol or (-term).is_Symbol for term in found):  # such as a joint's angle
        found.sort(key=lambda term: not term.is_Symbol)
    return found


def _place_in_product(factor: Expr, rank: Rank) -> tuple[int, int, str]:
    base = factor.as_base_exp()[0]
    if base.is_Symbol:
        return *rank(base), base.name
    return (ANGLE + 1 if base.is_Add else ANGLE), 0, str(factor)


def _place_in_sum(term: Expr, rank: Rank) -> tuple[object, ...]:
    found = [(*rank(x), x.name) for x in term.free_symbols]
    kinds = {kind for kind, *_ in found}
    moving = sorted(
        (link, kind) for kind, link, _ in found if kind in (ACCELERATION, RATE)
    ) or sorted((link, ANGLE) for kind, link, _ in found if kind == ANGLE)
    negative = term.could_extract_minus_sign()
    group = 2 * negative if UNKNOWN in kinds else 3 if GRAVITY in kinds else 1
    masses = sorted(link for kind, link, _ in found if kind == MASS)
    return group, moving, masses, str(term)
