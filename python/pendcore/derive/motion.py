"""The equations of motion collected: M(q) qdd = f(t, q, qd), and with locks M qdd = f + lambda.

The n moment equations without reactions are linear in the accelerations; M and f are their
coefficients, with products of sines and cosines written as sines and cosines of differences.
"""

from __future__ import annotations

from functools import cached_property
from typing import NamedTuple

from sympy import Expr, ImmutableMatrix, Integer, Matrix, Symbol

from pendcore.derive.chain import of_differences
from pendcore.derive.newton_euler import NewtonEuler


class Named(NamedTuple):
    """M and f with a symbol for each entry that is not 0.

    Attributes
    ----------
    entries : dict
        What the symbols stand for, with torques and loads as symbols.
    matrix, right : sympy.Matrix, (n, n), (n, 1)
        M and f in terms of them.
    """

    entries: dict[Symbol, Expr]
    matrix: Matrix
    right: Matrix


class Motion:
    """Mass matrix and forcing of a chain.

    Parameters
    ----------
    equations : NewtonEuler
        Newton's and Euler's equations.
    """

    def __init__(self, equations: NewtonEuler) -> None:
        self.equations = equations
        self.notation = equations.notation

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M, (n, n), kg m^2, of the chain with all its joints free, even if some are locked."""
        rows = [
            [of_differences((line.inertia - line.acting).diff(a)) for a in self.notation.qdd]
            for line in self.equations.without_reactions
        ]
        return ImmutableMatrix(rows)

    @cached_property
    def forcing_by_definitions(self) -> Matrix:
        """f, (n, 1), N m, with torques and loads as symbols, without the couples of locks."""
        at_rest = dict.fromkeys(self.notation.qdd, Integer(0))
        at_rest |= dict.fromkeys(self.equations.holding.values(), Integer(0))
        lines = []
        for line in self.equations.without_reactions:
            lines.append([of_differences((line.acting - line.inertia).subs(at_rest))])
        return ImmutableMatrix(lines)

    @cached_property
    def definitions(self) -> dict[Symbol, Expr]:
        """The symbols of torques and loads, in t, q, qd and parameters alone."""
        known: dict[Symbol, Expr] = {}
        for definition in self.equations.definitions:
            known[definition.symbol] = definition.value.xreplace(known)
        return known

    @cached_property
    def forcing(self) -> Matrix:
        """f, (n, 1), N m, in t, q, qd and parameters."""
        return self.forcing_by_definitions.xreplace(self.definitions)

    @cached_property
    def named(self) -> Named:
        """M and f with a symbol for each entry that is not 0."""
        n, symbol = self.notation.n, self.notation.symbol
        entries: dict[Symbol, Expr] = {}
        matrix = Matrix.zeros(n, n)
        for i in range(n):
            for j in range(i, n):
                if self.mass_matrix[i, j] != 0:
                    name = symbol(f"M{i + 1}{j + 1}", f"M_{{{i + 1}{j + 1}}}")
                    entries[name] = self.mass_matrix[i, j]
                    matrix[i, j] = matrix[j, i] = name
        right = Matrix.zeros(n, 1)
        for i, value in enumerate(self.forcing_by_definitions, start=1):
            if value != 0:
                right[i - 1] = symbol(f"f{i}", f"f_{{{i}}}")
                entries[right[i - 1]] = value
        return Named(entries, matrix.as_immutable(), right.as_immutable())

    @cached_property
    def locking(self) -> dict[Symbol, Expr]:
        """The couple of locks on each link, if any: lambda_i = Lambda_i - Lambda_(i+1), N m."""
        couples, found = self.equations.holding, dict[Symbol, Expr]()
        for i in range(1, self.notation.n + 1):
            value = couples.get(i, Integer(0)) - couples.get(i + 1, Integer(0))
            if value != 0:
                found[self.notation.symbol(f"lambda{i}", rf"\lambda_{{{i}}}")] = value
        return found

    @property
    def law(self) -> str:
        """The equations of motion in LaTeX; the couples of locks, if any, are on the right."""
        return r"M \ddot{q} = f" + (r" + \lambda" if self.equations.locked else "")

    @cached_property
    def turning_together(self) -> Matrix:
        """B, (n, k), in qd = B r, where r are the k rates of links that turn as one.

        Without locks B is the identity.
        """
        columns: list[list[int]] = []
        for link in range(1, self.notation.n + 1):
            if link not in self.equations.locked:
                columns.append([link])
            elif columns:  # otherwise the ground holds the link
                columns[-1].append(link)
        size = self.notation.n, len(columns)
        return ImmutableMatrix(*size, lambda i, k: int(i + 1 in columns[k]))
