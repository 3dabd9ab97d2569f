"""The order of a Runge-Kutta method, from the rooted trees of Butcher.

A method has order p if sum_i b_i Phi_i(t) = 1/gamma(t) for every rooted tree t of at most p nodes
(Hairer, Norsett, Wanner I, II.2). A tree is the tuple of the trees that hang from its root.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from math import prod
from typing import Any

Tree = tuple["Tree", ...]


@dataclass(frozen=True, slots=True, eq=False)
class Quadratic:
    """``rational`` + ``root`` sqrt(6), for tables that need such numbers."""

    rational: Fraction
    root: Fraction

    def __add__(self, other: Number) -> Quadratic:
        more = of(other)
        return Quadratic(self.rational + more.rational, self.root + more.root)

    __radd__ = __add__

    def __neg__(self) -> Quadratic:
        return Quadratic(-self.rational, -self.root)

    def __sub__(self, other: Number) -> Quadratic:
        return self + -of(other)

    def __rsub__(self, other: Number) -> Quadratic:
        return of(other) - self

    def __mul__(self, other: Number) -> Quadratic:
        by = of(other)
        return Quadratic(
            self.rational * by.rational + 6 * self.root * by.root,
            self.rational * by.root + self.root * by.rational,
        )

    __rmul__ = __mul__

    def __bool__(self) -> bool:
        return bool(self.rational or self.root)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Quadratic | Fraction | int) and not self - other

    def __hash__(self) -> int:
        return hash((self.rational, self.root)) if self.root else hash(self.rational)


Number = Quadratic | Fraction | int


def of(number: Number) -> Quadratic:
    """Return the same as a number of the field."""
    return number if isinstance(number, Quadratic) else Quadratic(Fraction(number), Fraction(0))


@cache
def trees(nodes: int) -> tuple[Tree, ...]:
    """Return all rooted trees of that many nodes."""
    forests = _forests(nodes - 1, nodes - 1)
    return tuple(tuple(sorted(forest)) for forest in forests)


def _forests(nodes: int, largest: int) -> list[Tree]:
    """All collections of trees with that many nodes together, none with more than ``largest``."""
    if nodes == 0:
        return [()]
    found: list[Tree] = []
    for size in range(1, min(nodes, largest) + 1):
        for count in range(1, nodes // size + 1):
            rest = _forests(nodes - count * size, size - 1)
            for chosen in combinations_with_replacement(trees(size), count):
                found += [(*chosen, *other) for other in rest]
    return found


def order(tree: Tree) -> int:
    """Count the nodes of a tree."""
    return 1 + sum(order(branch) for branch in tree)


def density(tree: Tree) -> int:
    """Return gamma(t): the product of the sizes of a tree and of all its subtrees."""
    return order(tree) * prod(density(branch) for branch in tree)


class StageWeights:
    """Phi_i(t) of every stage i of a method, for any tree; those of hanging trees are found once.

    ``a`` is the matrix of the method; rows may be short. Its numbers only need to add and multiply.
    """

    def __init__(self, a: Sequence[Sequence[Any]]) -> None:
        self._a = a
        self._found: dict[Tree, list[Any]] = {(): [Fraction(1)] * len(a)}

    def __call__(self, tree: Tree) -> list[Any]:
        """Return one number a stage."""
        if tree not in self._found:
            *others, branch = tree
            self._found[tree] = [
                weight * sum((x * y for x, y in zip(row, self(branch), strict=False) if x and y), 0)
                for weight, row in zip(self(tuple(others)), self._a, strict=True)
            ]
        return self._found[tree]


def misses(weights: StageWeights, b: Sequence[Any], tree: Tree, theta: Number = 1) -> Any:
    """Return by how much ``b`` misses the condition of a tree, at ``theta`` of a step.

    Missing weights are zero; they belong to stages that only the dense output needs.
    """
    total = sum((x * y for x, y in zip(b, weights(tree), strict=False) if x), Fraction(0))
    return total - Fraction(1, density(tree)) * theta ** order(tree)


def order_of(a: Sequence[Sequence[Any]], b: Sequence[Any], at_most: int = 9) -> int:
    """Return the order of a method, counted up to ``at_most``."""
    weights = StageWeights(a)
    for p in range(1, at_most + 1):
        if any(misses(weights, b, tree) for tree in trees(p)):
            return p - 1
    return at_most
