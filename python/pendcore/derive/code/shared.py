"""Expressions with what they share computed once, under names that a reader can follow."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import count

import sympy
from sympy import Dummy, Expr, Symbol, cos, sin

Assignment = tuple[Symbol, Expr]


@dataclass(frozen=True, slots=True)
class Computation:
    """What is assigned first, in order, and the results that follow from it.

    Attributes
    ----------
    assignments : tuple of (Symbol, Expr)
        Each in terms of what is known from outside and of those before it.
    results : tuple of Expr
        As many as were asked for, in the same order.
    """

    assignments: tuple[Assignment, ...]
    results: tuple[Expr, ...]

    @property
    def needs(self) -> set[Symbol]:
        """What must be known from outside."""
        inside = {symbol for symbol, _ in self.assignments}
        return {symbol for one in self._every for symbol in one.free_symbols} - inside

    @property
    def operations(self) -> int:
        """The number of additions, multiplications, divisions, powers and calls of functions."""
        return sum(int(sympy.count_ops(one)) for one in self._every)

    @property
    def _every(self) -> list[Expr]:
        return [*(value for _, value in self.assignments), *self.results]


def share(
    results: Sequence[Expr], assignments: Sequence[Assignment] = (), taken: Iterable[str] = ()
) -> Computation:
    """Compute once whatever the results, and the assignments that lead to them, have in common.

    Parameters
    ----------
    results : sequence of Expr
        What is wanted.
    assignments : sequence of (Symbol, Expr)
        Names that the results use, in an order in which they can be computed. Those that nothing
        uses are left out.
    taken : iterable of str
        Names that the language needs for itself.

    Returns
    -------
    Computation
        Sines and cosines are named ``sin_q1``, or ``cos_q1_q2`` for q1 - q2, or ``sin1``, ``cos1``,
        ... for other arguments; everything else that is shared is named ``e1``, ``e2``, ...
    """
    used = _used(results, assignments)
    expressions = [*(value for _, value in used), *results]
    known = {symbol.name for one in expressions for symbol in one.free_symbols} | {*taken}
    known |= {symbol.name for symbol, _ in used}
    called = _named_calls(expressions, known)
    temporary, reduced = sympy.cse(
        [one.xreplace(called) for one in expressions],
        symbols=sympy.numbered_symbols(cls=Dummy),
        order="canonical",
    )
    names = [symbol for symbol, _ in used]
    values = {symbol: call for call, symbol in called.items()} | dict(temporary)
    values |= dict(zip(names, reduced[: len(names)], strict=True))
    wanted = reduced[len(names) :]
    found = [*_in_order(names, wanted, values)]
    numbers = _fresh("e", known)
    final = {symbol: next(numbers) for symbol, _ in found if isinstance(symbol, Dummy)}
    return Computation(
        tuple((final.get(symbol, symbol), value.xreplace(final)) for symbol, value in found),
        tuple(value.xreplace(final) for value in wanted),
    )


def _used(results: Sequence[Expr], assignments: Sequence[Assignment]) -> list[Assignment]:
    """Return the assignments that the results use, directly or through others."""
    needed = {symbol for one in results for symbol in one.free_symbols}
    used: list[Assignment] = []
    for symbol, value in reversed(assignments):
        if symbol in needed:
            needed |= value.free_symbols
            used.insert(0, (symbol, value))
    return used


def _named_calls(expressions: Sequence[Expr], known: set[str]) -> dict[Expr, Symbol]:
    """Name every sine and cosine."""
    calls = {call for one in expressions for call in one.atoms(sin, cos)}
    fresh = {kind: _fresh(kind, known) for kind in ("sin", "cos")}
    named: dict[Expr, Symbol] = {}
    for call in sorted(calls, key=lambda call: (len(call.free_symbols), str(call))):
        kind, words = type(call).__name__, _words(call.args[0])
        name = "_".join([kind, *words])
        named[call] = next(fresh[kind]) if not words or name in known else _symbol(name)
        known.add(str(named[call].name))
    return named


def _words(argument: Expr) -> list[str]:
    """Return what a symbol, or a difference of two, is called; nothing for other arguments."""
    parts = sympy.Add.make_args(argument)
    if argument.is_Symbol:
        return [str(argument.name)]
    if len(parts) == 2 and parts[0].is_Symbol and (-parts[1]).is_Symbol:
        return [str(parts[0].name), str((-parts[1]).name)]
    if len(parts) == 2 and parts[1].is_Symbol and (-parts[0]).is_Symbol:
        return [str(parts[1].name), str((-parts[0]).name)]
    return []


def _symbol(name: str) -> Symbol:
    return Symbol(name, real=True)


def _fresh(letter: str, known: set[str]) -> Iterator[Symbol]:
    for number in count(1):
        if f"{letter}{number}" not in known:
            yield _symbol(f"{letter}{number}")


def _in_order(
    first: Sequence[Symbol], results: Sequence[Expr], values: dict[Symbol, Expr]
) -> Iterator[Assignment]:
    """Yield the assignments, each just before what needs it."""
    done: set[Symbol] = set()

    def reach(symbol: Symbol) -> Iterator[Assignment]:
        if symbol in done or symbol not in values:
            return
        done.add(symbol)
        for needed in sorted(values[symbol].free_symbols, key=str):
            yield from reach(needed)
        yield symbol, values[symbol]

    for symbol in first:
        yield from reach(symbol)
    for result in results:
        for symbol in sorted(result.free_symbols, key=str):
            yield from reach(symbol)
