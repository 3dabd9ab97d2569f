"""The order of a Runge-Kutta method, from the rooted trees of Butcher.

A method has order p if sum_i b_i Phi_i(t) = 1/gamma(t) for every rooted tree t of at most p nodes
(Hairer, Norsett, Wanner I, II.2). A tree is the tuple of the trees that hang from its root.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import cache
from itertools import combinations_with_replacement
from math import prod

Tree = tuple["Tree", ...]
Row = Sequence[Fraction]


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


def stage_weights(a: Sequence[Row], tree: Tree) -> list[Fraction]:
    """Return Phi_i(t) of every stage i of a method with the matrix ``a`` (rows may be short)."""
    weights = [Fraction(1)] * len(a)
    for branch in tree:
        inner = stage_weights(a, branch)
        for i, row in enumerate(a):
            weights[i] *= sum((x * y for x, y in zip(row, inner, strict=False)), Fraction(0))
    return weights


def holds(a: Sequence[Row], b: Row, tree: Tree, theta: Fraction = Fraction(1)) -> bool:
    """Tell whether the weights ``b`` at ``theta`` of a step satisfy the condition of a tree."""
    total = sum((x * y for x, y in zip(b, stage_weights(a, tree), strict=True)), Fraction(0))
    return total == theta ** order(tree) / density(tree)


def order_of(a: Sequence[Row], b: Row, at_most: int = 8) -> int:
    """Return the order of a method, counted up to ``at_most``."""
    for p in range(1, at_most + 1):
        if not all(holds(a, b, tree) for tree in trees(p)):
            return p - 1
    return at_most
