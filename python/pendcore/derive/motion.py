"""The equations of motion collected, solved for the accelerations, and in first-order form.

    M(q) qdd = f(t, q, qd)

The n moment equations without reactions are linear in the accelerations; M and f are their
coefficients, products of sines and cosines written as those of angle differences. They are solved
by Cramer's rule, as short as they get when written out, and by elimination (M = L D L^T) where they
are computed.
"""

from __future__ import annotations

from functools import cached_property

import sympy
from sympy import Expr, ImmutableMatrix, Integer, Matrix, Symbol, expand
from sympy.simplify.fu import TR8

from pendcore.derive.newton_euler import NewtonEuler


def of_differences(expression: Expr) -> Expr:
    """Write products of sines and cosines as sines and cosines of sums; a normal form."""
    return expand(TR8(expand(expression)))


class Motion:
    """Mass matrix, forcing and accelerations of a chain.

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
        """M, (n, n), kg m^2; that of the chain with all its joints free, whatever is locked."""
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
        applied = {d.symbol for d in self.equations.definitions}
        lines = []
        for line in self.equations.without_reactions:
            whole = expand((line.acting - line.inertia).subs(at_rest))
            with_loads = Integer(0)
            if applied:
                own, with_loads = whole.as_independent(*applied, as_Add=True)
                whole = own
            lines.append([of_differences(whole) + with_loads])
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
    def turning_together(self) -> Matrix:
        """B, (n, k): qd = B of the rates of what turns as one; without locks the identity."""
        columns: list[list[int]] = []
        for link in range(1, self.notation.n + 1):
            if link in self.equations.locked:
                if columns:  # else the ground holds it
                    columns[-1].append(link)
            else:
                columns.append([link])
        return ImmutableMatrix(
            self.notation.n, len(columns), lambda i, k: int(i + 1 in columns[k])
        )

    @cached_property
    def accelerations(self) -> tuple[Expr, ...]:
        """The solution written out, in t, q, qd and parameters, rad/s^2."""
        stand_for, solved = self.by_entries
        known = {symbol: value.xreplace(self.definitions) for symbol, value in stand_for.items()}
        return tuple(expression.xreplace(known) for expression in solved)

    @cached_property
    def by_entries(self) -> tuple[dict[Symbol, Expr], tuple[Expr, ...]]:
        """The entries of M and f as symbols, and the accelerations in terms of them."""
        together = self.turning_together
        entries, matrix, right = self._named()
        if together.cols == 0:
            return entries, (Integer(0),) * together.rows
        determinant = matrix.det(method="berkowitz")
        free = []
        for k in range(matrix.rows):
            replaced = matrix.as_mutable()
            replaced[:, k] = right
            free.append(expand(replaced.det(method="berkowitz")) / expand(determinant))
        return entries, tuple(together * ImmutableMatrix(free))

    def _named(self) -> tuple[dict[Symbol, Expr], Matrix, Matrix]:
        """Symbols for the entries, and with them the matrix and right side of what is free."""
        n, symbol = self.notation.n, self.notation.symbol
        entries: dict[Symbol, Expr] = {}

        def entry(i: int, j: int) -> Expr:
            i, j = sorted((i, j))
            value = self.mass_matrix[i, j]
            if value == 0:
                return Integer(0)
            name = symbol(f"M{i + 1}{j + 1}", f"M_{{{i + 1}{j + 1}}}")
            entries[name] = value
            return name

        matrix = Matrix(n, n, entry)
        right = []
        for i, value in enumerate(self.forcing_by_definitions):
            name = symbol(f"f{i + 1}", f"f_{{{i + 1}}}")
            entries[name] = value
            right.append(name if value != 0 else Integer(0))
        together = self.turning_together
        return entries, together.T * matrix * together, together.T * Matrix(right)

    @cached_property
    def shared(self) -> tuple[tuple[Symbol, Expr], ...]:
        """The accelerations computed step by step: assignments, each in terms of those before it.

        Laws, the entries of M and f, and the elimination M = L D L^T; `shared_accelerations` ends
        it. M is positive definite, so nothing needs to be exchanged.
        """
        return self._elimination[0]

    @cached_property
    def shared_accelerations(self) -> tuple[Expr, ...]:
        """The accelerations in terms of the symbols of `shared`, rad/s^2."""
        return self._elimination[1]

    @cached_property
    def _elimination(self) -> tuple[tuple[tuple[Symbol, Expr], ...], tuple[Expr, ...]]:
        entries, matrix, right = self._named()
        done = [(d.symbol, d.value) for d in self.equations.definitions]
        done += entries.items()

        def keep(name: str, latex: str, value: Expr) -> Expr:
            if value.is_Atom:
                return value
            done.append((self.notation.symbol(name, latex), value))
            return done[-1][0]

        size = matrix.rows
        lower = sympy.zeros(size, size)
        pivots: list[Expr] = []
        reduced: list[Expr] = []
        for j in range(size):
            row = f"{j + 1}"
            kept = sum((lower[j, k] ** 2 * pivots[k] for k in range(j)), Integer(0))
            pivots.append(keep(f"D{row}", f"D_{{{row}}}", matrix[j, j] - kept))
            kept = sum((lower[j, k] * reduced[k] for k in range(j)), Integer(0))
            reduced.append(keep(f"h{row}", f"h_{{{row}}}", right[j] - kept))
            for i in range(j + 1, size):
                kept = sum((lower[i, k] * lower[j, k] * pivots[k] for k in range(j)), Integer(0))
                place = f"{i + 1}{row}"
                value = (matrix[i, j] - kept) / pivots[j]
                lower[i, j] = keep(f"l{place}", rf"\ell_{{{place}}}", value)
        free = [Integer(0)] * size
        for i in range(size - 1, -1, -1):
            rest = sum((lower[k, i] * free[k] for k in range(i + 1, size)), Integer(0))
            value = reduced[i] / pivots[i] - rest
            row = f"{i + 1}"
            free[i] = keep(f"a{row}", f"a_{{{row}}}", value) if i > 0 else value
        return tuple(done), tuple(self.turning_together * ImmutableMatrix(size, 1, free))


    def power_of_the_solution_error(self) -> Expr:
        """Return qd . (M qdd - f) at the solved accelerations, for any M and f: 0, W.

        The couples of locks do no work in it, as qd = B (rates of what turns as one).
        """
        _, matrix, right = self._named()
        if matrix.rows == 0:
            return Integer(0)
        _, solved = self.by_entries
        together = self.turning_together
        first = [next(i for i in range(together.rows) if together[i, k]) for k in range(matrix.rows)]
        free = ImmutableMatrix([solved[i] for i in first])
        error = (matrix * free - right).applyfunc(sympy.cancel)
        return sum((self.notation.qd[i] * e for i, e in zip(first, error, strict=True)), Integer(0))
