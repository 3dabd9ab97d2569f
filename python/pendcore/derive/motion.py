"""The equations of motion collected, M(q) qdd = f(t, q, qd), and solved for the accelerations.

The n moment equations without reactions are linear in the accelerations; M and f are their
coefficients, with products of sines and cosines written as sines and cosines of differences. With
locks, M qdd = f + lambda: links that turn as one have one unknown, and with qd = B r the couples of
locks, which do no work, drop out of

    B^T M B rd = B^T f

Cramer's rule solves them, which is short where it is written out, and so does elimination,
M = L D L^T, which is short where it is computed.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cached_property
from typing import NamedTuple

import sympy
from sympy import Expr, ImmutableMatrix, Integer, Matrix, Symbol, expand

from pendcore.derive.chain import of_differences
from pendcore.derive.newton_euler import NewtonEuler

Assignments = tuple[tuple[Symbol, Expr], ...]
"""Symbols and what they stand for, each in terms of those before it."""


class Named(NamedTuple):
    """M and f with a symbol for each entry that is not 0, and what the symbols stand for."""

    entries: dict[Symbol, Expr]
    matrix: Matrix
    right: Matrix


class Motion:
    """Mass matrix, forcing and accelerations of a chain, from Newton's and Euler's equations."""

    def __init__(self, equations: NewtonEuler) -> None:
        self.equations = equations
        self.symbols = equations.notation
        self.n = equations.n

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M of ``M qdd = forcing``, (n, n), kg m^2, of the chain with all its joints free."""
        rows = [
            [of_differences((line.inertia - line.acting).diff(a)) for a in self.symbols.qdd]
            for line in self.equations.without_reactions
        ]
        return ImmutableMatrix(rows)

    @cached_property
    def forcing_by_definitions(self) -> Matrix:
        """f, (n, 1), N m, with torques and loads as symbols, without the couples of locks."""
        at_rest = dict.fromkeys([*self.symbols.qdd, *self.equations.holding.values()], Integer(0))
        return ImmutableMatrix([
            of_differences((line.acting - line.inertia).subs(at_rest))
            for line in self.equations.without_reactions
        ])  # fmt: skip

    @cached_property
    def definitions(self) -> dict[Symbol, Expr]:
        """The symbols of torques and loads, in t, q, qd and parameters alone."""
        known: dict[Symbol, Expr] = {}
        for symbol, value in self.equations.definitions.items():
            known[symbol] = value.xreplace(known)
        return known

    @cached_property
    def forcing(self) -> Matrix:
        """The right side of ``M qdd = forcing``, (n, 1), N m, in t, q, qd and parameters."""
        return self.forcing_by_definitions.xreplace(self.definitions)

    @cached_property
    def named(self) -> Named:
        """M and f with a symbol for each entry that is not 0."""
        entries: dict[Symbol, Expr] = {}

        def named(letter: str, value: Expr, *place: int) -> Expr:
            if value == 0:
                return value
            index = "".join(str(k + 1) for k in sorted(place))  # M is symmetric
            name = self.symbols.symbol(f"{letter}{index}", f"{letter}_{{{index}}}")
            entries[name] = value
            return name

        mass, forcing, n = self.mass_matrix, self.forcing_by_definitions, self.n
        matrix = ImmutableMatrix(n, n, lambda i, j: named("M", mass[i, j], i, j))
        right = ImmutableMatrix(n, 1, lambda i, _: named("f", forcing[i], i))
        return Named(entries, matrix, right)

    @cached_property
    def known(self) -> dict[Symbol, Expr]:
        """The symbols of `named`, in t, q, qd and parameters alone."""
        return {name: x.xreplace(self.definitions) for name, x in self.named.entries.items()}

    @cached_property
    def locking(self) -> dict[Symbol, Expr]:
        """The couple of locks on each link, if any: lambda_i = Lambda_i - Lambda_(i+1), N m."""
        couples, symbol = self.equations.holding, self.symbols.symbol
        return {
            symbol(f"lambda{i}", rf"\lambda_{{{i}}}"): couples.get(i, 0) - couples.get(i + 1, 0)
            for i in range(1, self.n + 1)
            if i in couples or i + 1 in couples
        }

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
        for link in range(1, self.n + 1):
            if link not in self.equations.locked:
                columns.append([link])
            elif columns:  # otherwise the ground holds the link
                columns[-1].append(link)
        return ImmutableMatrix(self.n, len(columns), lambda i, k: int(i + 1 in columns[k]))

    @cached_property
    def _free(self) -> tuple[Matrix, Matrix]:
        """B^T M B and B^T f."""
        _, matrix, right = self.named
        together = self.turning_together
        return together.T * matrix * together, together.T * right

    @cached_property
    def determinant(self) -> Expr:
        """The determinant of B^T M B, in the symbols of `named`."""
        return expand(self._free[0].det(method="berkowitz"))

    @cached_property
    def by_entries(self) -> tuple[Expr, ...]:
        """The accelerations in the symbols of `named`, from Cramer's rule."""
        matrix, right = self._free
        free = (matrix.adjugate(method="berkowitz") * right).applyfunc(expand) / self.determinant
        return tuple(self.turning_together * free)

    @cached_property
    def accelerations(self) -> tuple[Expr, ...]:
        """Angular accelerations written out, in t, q, qd and parameters, (n,), rad/s^2."""
        return tuple([expression.xreplace(self.known) for expression in self.by_entries])

    @cached_property
    def holding(self) -> dict[int, Expr]:
        """The couple of each locked joint on the link beyond it, N m.

        It is what M qdd - f leaves over, in the symbols of `named` and the accelerations.
        """
        left = self.named.matrix * Matrix(self.symbols.qdd) - self.named.right
        found: dict[int, Expr] = {}
        for joint in reversed(self.equations.locked):
            found[joint] = left[joint - 1] + found.get(joint + 1, Integer(0))
        return dict(sorted(found.items()))

    def power_of_the_error(self) -> Expr:
        """Return qd . (M qdd - f), W, at the solved accelerations: 0 for any M and f."""
        matrix, right = self._free
        together = self.turning_together
        first = [[*together[:, k]].index(1) for k in range(matrix.rows)]
        free = Matrix(len(first), 1, [self.by_entries[i] for i in first])
        error = (matrix * free - right).applyfunc(sympy.cancel)
        return sum((self.symbols.qd[i] * e for i, e in zip(first, error, strict=True)), Integer(0))

    @property
    def shared(self) -> Assignments:
        """What leads to `shared_accelerations`: laws, entries of M and f, elimination."""
        return self._elimination[0]

    @property
    def by_elimination(self) -> Assignments:
        """The part of `shared` that eliminates: D, L, h and a, in the symbols of `named`."""
        known = self.definitions.keys() | self.named.entries.keys()
        return tuple((symbol, x) for symbol, x in self.shared if symbol not in known)

    @property
    def shared_accelerations(self) -> tuple[Expr, ...]:
        """The accelerations in terms of the symbols of `shared`, (n,), rad/s^2."""
        return self._elimination[1]

    @cached_property
    def _elimination(self) -> tuple[Assignments, tuple[Expr, ...]]:
        """M = L D L^T, L h = f, L^T a = D^-1 h; no pivoting, because M is positive definite."""
        matrix, right = (entries.as_mutable() for entries in self._free)
        done = [*self.equations.definitions.items(), *self.named.entries.items()]

        def keep(letter: str, index: str, value: Expr) -> Expr:
            if value.is_Atom:
                return value
            latex = rf"\ell_{{{index}}}" if letter == "l" else f"{letter}_{{{index}}}"
            done.append((self.symbols.symbol(f"{letter}{index}", latex), value))
            return done[-1][0]

        size = matrix.rows
        lower = sympy.zeros(size, size)
        pivots: list[Expr] = []
        reduced: list[Expr] = []
        for j in range(size):
            pivots.append(keep("D", f"{j + 1}", matrix[j, j]))
            reduced.append(keep("h", f"{j + 1}", right[j]))
            for i in range(j + 1, size):
                lower[i, j] = keep("l", f"{i + 1}{j + 1}", matrix[i, j] / pivots[j])
            matrix -= pivots[j] * lower[:, j] * lower[:, j].T
            right -= reduced[j] * lower[:, j]
        free = sympy.zeros(size, 1)
        for i in reversed(range(size)):
            value = reduced[i] / pivots[i] - lower[:, i].dot(free)
            free[i] = keep("a", f"{i + 1}", value) if i > 0 else value
        solved = tuple(self.turning_together * free)
        return needed(done, solved), solved


def needed(assignments: Iterable[tuple[Symbol, Expr]], wanted: Iterable[Expr]) -> Assignments:
    """Return the assignments on which the wanted expressions depend."""
    symbols = set[Symbol]().union(*(expression.free_symbols for expression in wanted))
    found: Assignments = ()
    for symbol, value in reversed([*assignments]):
        if symbol in symbols:
            symbols |= value.free_symbols
            found = ((symbol, value), *found)
    return found
