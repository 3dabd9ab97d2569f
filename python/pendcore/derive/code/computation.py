"""What every generated file computes, with what its expressions share computed once."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Sequence
from typing import Any, NamedTuple

import sympy
from sympy import Dummy, Expr, Symbol, cos, numbered_symbols, sin

from pendcore.derive.algebra import Algebra
from pendcore.derive.motion import Assignments, needed


class Computation(NamedTuple):
    """Assignments, each of which needs only those before it, and the results."""

    assignments: Assignments
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


def computations(derivation: Algebra) -> dict[str, Computation]:
    """Return what a file computes, of t, q, qd, qdd and the parameters.

    ``accelerations`` (n,), rad/s^2; ``reactions`` F_01x, F_01y, F_12x, ... (2n,), N; ``energy``,
    kinetic and potential, J; ``powers`` of the effects in the order of `powers_by_name`, W.
    """
    laws = [(known.symbol, known.value) for known in derivation.equations.definitions]
    forces = [part for force in derivation.equations.reactions for part in force]
    energy, powers = derivation.energy, derivation.energy.powers_by_definitions
    return {
        "accelerations": share(derivation.shared_accelerations, derivation.shared),
        "reactions": share(forces, laws),
        "energy": share([energy.kinetic, energy.potential], laws),
        "powers": share([*powers.values()], laws),
    }


def powers_by_name(derivation: Algebra) -> dict[str, Any]:
    """Return the effects that bring in or take energy, by kind and place: ``viscous_joint_1``."""
    named: dict[str, Any] = {}
    for effect in derivation.energy.powers_by_definitions:
        place = getattr(effect, "joint", getattr(effect, "link", None))
        first = name = effect.kind if place is None else f"{effect.kind}_{place}"
        number = 1
        while name in named:
            number += 1
            name = f"{first}_{number}"
        named[name] = effect
    return named


def share(results: Sequence[Expr], assignments: Iterable[tuple[Symbol, Expr]] = ()) -> Computation:
    """Compute once whatever the results, and the assignments that lead to them, have in common.

    Sines and cosines are named ``sin_q1``, or ``cos_q1_q2`` for q1 - q2; everything else that is
    shared is named ``e1``, ``e2``, ... Assignments that nothing uses are left out.
    """
    used = needed(assignments, results)
    expressions = [*(value for _, value in used), *results]
    calls = sorted({call for x in expressions for call in x.atoms(sin, cos)}, key=str)
    named = {call: Symbol(_name(call), real=True) for call in calls}
    temporary, reduced = sympy.cse(
        [x.xreplace(named) for x in expressions], numbered_symbols(cls=Dummy), order="canonical"
    )
    names = [symbol for symbol, _ in used]
    values = {symbol: call for call, symbol in named.items()} | dict(temporary)
    values |= dict(zip(names, reduced, strict=False))
    wanted = reduced[len(names) :]
    order = [*_in_order(values, [*names, *(s for x in wanted for s in _sorted(x))])]
    numbers = numbered_symbols("e", real=True)
    final = {symbol: next(numbers) for symbol in order if isinstance(symbol, Dummy)}
    return Computation(
        tuple((final.get(symbol, symbol), values[symbol].xreplace(final)) for symbol in order),
        tuple(x.xreplace(final) for x in wanted),
    )


def _name(call: Expr) -> str:
    words = str(call).replace(" + ", "_plus_").replace(" - ", "_")
    return re.sub(r"\W+", "_", words).strip("_")


def _sorted(expression: Expr) -> list[Symbol]:
    return sorted(expression.free_symbols, key=str)


def _in_order(values: dict[Symbol, Expr], wanted: Iterable[Symbol]) -> Iterator[Symbol]:
    """Yield the symbols that have values, each just before what needs it."""
    done: set[Symbol] = set()

    def reach(symbol: Symbol) -> Iterator[Symbol]:
        if symbol not in done and symbol in values:
            done.add(symbol)
            for other in _sorted(values[symbol]):
                yield from reach(other)
            yield symbol

    for symbol in wanted:
        yield from reach(symbol)
