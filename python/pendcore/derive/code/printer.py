"""Expressions as text: one way to write them, and what the languages differ in.

``sympy.octave_code`` writes elementwise operators and multiplies what it does not choose by zero;
``sympy.cxxcode`` divides integers. Here every language writes ``m1*L1**2/12`` as a person would.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, ClassVar

import sympy as sp
from sympy import Symbol
from sympy.printing.str import StrPrinter

OUT_OF_RANGE = "pendcore.derive: {!r} is in no language's list of functions: {}"


class Infix(StrPrinter):
    """Python's operators.

    Parameters
    ----------
    names : dict of Symbol to str
        How symbols are written; the others by their own names.
    """

    functions: ClassVar[dict[str, str]] = {}
    pi: ClassVar[str] = "pi"

    def __init__(self, names: Mapping[Symbol, str]) -> None:
        super().__init__()
        self.names = names

    def _print_Symbol(self, expr: Symbol) -> str:
        return self.names.get(expr, expr.name)

    def _print_Pi(self, expr: sp.Expr) -> str:
        return self.pi

    def _print_Float(self, expr: sp.Float) -> str:
        return number(float(expr))

    def _print_Function(self, expr: sp.Function) -> str:
        name = type(expr).__name__
        if name not in self.functions:
            raise NotImplementedError(OUT_OF_RANGE.format(name, expr))
        return f"{self.functions[name]}({', '.join(map(self.doprint, expr.args))})"

    _print_Abs = _print_sign = _print_Function

    def _print_Min(self, expr: Any) -> str:
        return self._nested("Min", expr.args)

    def _print_Max(self, expr: Any) -> str:
        return self._nested("Max", expr.args)

    def _nested(self, name: str, args: tuple[sp.Expr, ...]) -> str:
        first, *rest = sorted(args, key=sp.default_sort_key)
        text = self.doprint(first)
        for one in rest:
            text = f"{self.functions[name]}({text}, {self.doprint(one)})"
        return text

    def _print_Relational(self, expr: Any) -> str:
        return f"({self.doprint(expr.lhs)} {expr.rel_op} {self.doprint(expr.rhs)})"

    def _print_Piecewise(self, expr: sp.Piecewise) -> str:
        *cases, (last, always) = expr.args
        if always != sp.true:
            raise NotImplementedError(f"pendcore.derive: {expr} is not defined everywhere")
        text = self.doprint(last)
        for value, condition in reversed(cases):
            text = self.chosen(self.doprint(condition), self.doprint(value), text)
        return text

    def chosen(self, condition: str, value: str, otherwise: str) -> str:
        """Write a choice between two values."""
        raise NotImplementedError


class Octave(Infix):
    """Octave and MATLAB, scalars. A choice is a statement there: `octave.py` writes it."""

    functions: ClassVar = {
        **{name: name for name in ("sin", "cos", "tan", "exp", "tanh", "sqrt", "sign")},
        **{"Abs": "abs", "log": "log", "atan": "atan", "Min": "min", "Max": "max"},
    }

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        return str(super()._print_Pow(expr, rational)).replace("**", "^")

    def _print_Relational(self, expr: Any) -> str:
        return str(super()._print_Relational(expr)).replace("!=", "~=")


class NumPy(Infix):
    """NumPy, on numbers and on arrays."""

    functions: ClassVar = {
        **{name: f"np.{name}" for name in ("sin", "cos", "tan", "exp", "tanh", "sqrt", "sign")},
        **{"Abs": "abs", "log": "np.log", "atan": "np.arctan"},
        **{"Min": "np.minimum", "Max": "np.maximum"},
    }
    pi: ClassVar = "np.pi"

    def chosen(self, condition: str, value: str, otherwise: str) -> str:
        return f"np.where({condition}, {value}, {otherwise})"


class Cpp(Infix):
    """C++17: no quotient of integers, and products for small powers."""

    functions: ClassVar = {
        **{name: f"std::{name}" for name in ("sin", "cos", "tan", "exp", "tanh", "sqrt", "log")},
        **{"Abs": "std::abs", "atan": "std::atan", "sign": "sign"},
        **{"Min": "std::min", "Max": "std::max"},
    }
    pi: ClassVar = repr(float(sp.pi))

    def _print_Rational(self, expr: sp.Rational) -> str:
        return f"{expr.p}.0/{expr.q}.0"

    def _print_Integer(self, expr: sp.Integer) -> str:
        return f"{expr.p}.0"

    def _print_Pow(self, expr: sp.Pow, rational: bool = False) -> str:
        base, power = expr.as_base_exp()
        if power == -1 or abs(power) == sp.Rational(1, 2):
            return str(super()._print_Pow(expr, rational))
        if power in (2, 3):
            return f"{'square' if power == 2 else 'cube'}({self.doprint(base)})"
        return f"std::pow({self.doprint(base)}, {self.doprint(power)})"

    def chosen(self, condition: str, value: str, otherwise: str) -> str:
        return f"({condition} ? {value} : {otherwise})"


def number(value: float) -> str:
    """Write a number so that it reads back as the same double, whole numbers without a point."""
    return str(int(value)) if value == int(value) and abs(value) < 1e9 else repr(value)
