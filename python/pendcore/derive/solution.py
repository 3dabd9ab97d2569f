"""The equations of motion solved for the accelerations, M qdd = f.

They are solved by Cramer's rule, which is short where it is written out, and by elimination,
M = L D L^T, which is short where it is computed. Links that turn as one have one unknown: with
qd = B r the couples of locks, which do no work, drop out of

    B^T M B rd = B^T f
"""

from __future__ import annotations

from functools import cached_property

import sympy
from sympy import Expr, ImmutableMatrix, Integer, Matrix, Symbol, expand

from pendcore.derive.motion import Motion

Assignments = tuple[tuple[Symbol, Expr], ...]
"""Symbols and what they stand for, each in terms of those before it."""


class Solution:
    """The accelerations of a chain.

    Parameters
    ----------
    motion : Motion
        The equations of motion.
    """

    def __init__(self, motion: Motion) -> None:
        self.motion = motion
        self.notation = motion.notation
        self.equations = motion.equations

    @cached_property
    def accelerations(self) -> tuple[Expr, ...]:
        """The solution written out, in t, q, qd and parameters, rad/s^2."""
        known = {
            symbol: value.xreplace(self.motion.definitions)
            for symbol, value in self.motion.named.entries.items()
        }
        return tuple([expression.xreplace(known) for expression in self.by_entries])

    @cached_property
    def by_entries(self) -> tuple[Expr, ...]:
        """The accelerations in the symbols of `Motion.named`, from Cramer's rule."""
        matrix, right = self._free
        together = self.motion.turning_together
        if matrix.rows == 0:
            return tuple([Integer(0)] * self.notation.n)
        determinant = expand(matrix.det(method="berkowitz"))
        free = []
        for k in range(matrix.rows):
            replaced = matrix.as_mutable()
            replaced[:, k] = right
            free.append(expand(replaced.det(method="berkowitz")) / determinant)
        return tuple(together * ImmutableMatrix(free))

    @cached_property
    def holding(self) -> dict[int, Expr]:
        """The couple of each locked joint on the link beyond it, N m.

        It is what M qdd - f leaves over, in the symbols of `Motion.named` and the accelerations.
        """
        _, matrix, right = self.motion.named
        found: dict[int, Expr] = {}
        for joint in reversed(self.equations.locked):
            i = joint - 1
            line = sum((matrix[i, k] * a for k, a in enumerate(self.notation.qdd)), -right[i])
            found[joint] = line + found.get(joint + 1, Integer(0))
        return dict(sorted(found.items()))

    @property
    def shared(self) -> Assignments:
        """Assignments that lead to the accelerations: laws, entries of M and f, elimination."""
        return self._elimination[0]

    @property
    def by_elimination(self) -> Assignments:
        """The part of `shared` that eliminates: D, L, h and a, in the symbols of `Motion.named`."""
        known = {d.symbol for d in self.equations.definitions} | self.motion.named.entries.keys()
        return tuple((symbol, value) for symbol, value in self.shared if symbol not in known)

    @property
    def shared_accelerations(self) -> tuple[Expr, ...]:
        """The accelerations in terms of the symbols of `shared`, rad/s^2."""
        return self._elimination[1]

    def power_of_the_error(self) -> Expr:
        """Return qd . (M qdd - f), W, at the solved accelerations: 0 for any M and f."""
        matrix, right = self._free
        together = self.motion.turning_together
        first = [
            next(i for i in range(together.rows) if together[i, k]) for k in range(matrix.rows)
        ]
        free = Matrix(len(first), 1, [self.by_entries[i] for i in first])
        error = (matrix * free - right).applyfunc(sympy.cancel)
        return sum((self.notation.qd[i] * e for i, e in zip(first, error, strict=True)), Integer(0))

    @cached_property
    def _free(self) -> tuple[Matrix, Matrix]:
        """B^T M B and B^T f."""
        _, matrix, right = self.motion.named
        together = self.motion.turning_together
        return together.T * matrix * together, together.T * right

    @cached_property
    def _elimination(self) -> tuple[Assignments, tuple[Expr, ...]]:
        """M = L D L^T, L h = f, L^T a = D^-1 h; no pivoting, because M is positive definite."""
        matrix, right = self._free
        done = [(d.symbol, d.value) for d in self.equations.definitions]
        done += self.motion.named.entries.items()

        def keep(letter: str, index: str, value: Expr) -> Expr:
            if value.is_Atom:
                return value
            latex = rf"\ell_{{{index}}}" if letter == "l" else f"{letter}_{{{index}}}"
            done.append((self.notation.symbol(f"{letter}{index}", latex), value))
            return done[-1][0]

        size = matrix.rows
        lower = sympy.zeros(size, size)
        pivots: list[Expr] = []
        reduced: list[Expr] = []
        for j in range(size):
            known = sum((lower[j, k] ** 2 * pivots[k] for k in range(j)), Integer(0))
            pivots.append(keep("D", f"{j + 1}", matrix[j, j] - known))
            known = sum((lower[j, k] * reduced[k] for k in range(j)), Integer(0))
            reduced.append(keep("h", f"{j + 1}", right[j] - known))
            for i in range(j + 1, size):
                known = sum((lower[i, k] * lower[j, k] * pivots[k] for k in range(j)), Integer(0))
                lower[i, j] = keep("l", f"{i + 1}{j + 1}", (matrix[i, j] - known) / pivots[j])
        free = [Integer(0)] * size
        for i in reversed(range(size)):
            known = sum((lower[k, i] * free[k] for k in range(i + 1, size)), Integer(0))
            value = reduced[i] / pivots[i] - known
            free[i] = keep("a", f"{i + 1}", value) if i > 0 else value
        solved = tuple(self.motion.turning_together * ImmutableMatrix(size, 1, free))
        return _needed(done, solved), solved


def _needed(assignments: list[tuple[Symbol, Expr]], wanted: tuple[Expr, ...]) -> Assignments:
    """Return the assignments on which the wanted expressions depend."""
    needed = set[Symbol]().union(*(expression.free_symbols for expression in wanted))
    found = []
    for symbol, value in reversed(assignments):
        if symbol in needed:
            needed |= value.free_symbols
            found.append((symbol, value))
    return tuple(reversed(found))
