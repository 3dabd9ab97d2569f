"""Expressions as text: one way to write them, and where the languages differ.

``sympy.octave_code`` writes elementwise operators, ``sympy.cxxcode`` splits fractions off. Here
every language has ``L1**2*m1/12`` as a person would write it.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import sympy
from sympy import Symbol
from sympy.printing.str import StrPrinter


class Infix(StrPrinter):  # type: ignore[misc]
    """Python's operators; a function that is not listed raises NotImplementedError.

    Parameters
    ----------
    names : dict of Symbol to str
        How symbols are written; symbols that are not in it are written by their own names.
    """

    functions: ClassVar[dict[str, str]]
    """What the language calls SymPy's functions of one argument."""

    def __init__(self, names: Mapping[Symbol, str]) -> None:
        super().__init__()
        self.names = names

    def _print_Symbol(self, symbol: Symbol) -> str:
        return self.names.get(symbol, str(symbol.name))

    def _print_Float(self, value: sympy.Float) -> str:
        return number(float(value))

    def _print_Function(self, call: sympy.Function) -> str:
        name = type(call).__name__
        if name not in self.functions or len(call.args) != 1:
            raise NotImplementedError(
                f"{call}: {type(self).__module__} does not say how {type(self).__name__} writes it"
            )
        return f"{self.functions[name]}({self.doprint(call.args[0])})"

    _print_Abs = _print_Function


class Octave(Infix):
    """Octave and MATLAB, on numbers."""

    functions: ClassVar = {"sin": "sin", "cos": "cos", "Abs": "abs"}

    def _print_Pow(self, power: sympy.Pow, rational: bool = False) -> str:
        return str(super()._print_Pow(power, rational)).replace("**", "^")


class NumPy(Infix):
    """NumPy, on numbers and on arrays."""

    functions: ClassVar = {"sin": "np.sin", "cos": "np.cos", "Abs": "abs"}


class Cpp(Infix):
    """C++17: no quotient of integers, and products for small powers."""

    functions: ClassVar = {"sin": "std::sin", "cos": "std::cos", "Abs": "std::abs"}
    powers: ClassVar = {2: "square", 3: "cube"}

    def _print_Rational(self, value: sympy.Rational) -> str:
        return f"{value.p}.0/{value.q}.0"

    def _print_Integer(self, value: sympy.Integer) -> str:
        return f"{value.p}.0"

    def _print_Pow(self, power: sympy.Pow, rational: bool = False) -> str:
        base, exponent = power.as_base_exp()
        if exponent in self.powers:
            return f"{self.powers[int(exponent)]}({self.doprint(base)})"
        if exponent == -1:
            return str(super()._print_Pow(power, rational))
        return f"std::pow({self.doprint(base)}, {self.doprint(exponent)})"


def number(value: float) -> str:
    """Write a number so that it reads back as the same double, whole numbers without a point."""
    return str(int(value)) if abs(value) < 1e9 and value == int(value) else repr(value)
