"""The coefficients of radau5 are those that its definition gives, and those have its order."""

from __future__ import annotations

from typing import Any

import mpmath
import pytest
from pendcore import _core
from reference.order_conditions import StageWeights, misses, order, trees
from reference.radau_iia import coefficients

EXACT = coefficients()
NAMES = {
    "c": "c",
    "a": "a",
    "real": "real",
    "alpha": "alpha",
    "beta": "beta",
    "t": "transformation",
    "t_inverse": "inverse",
    "interpolant": "interpolant",
    "correction": "correction",
}


def rounded(value: Any) -> Any:
    return [rounded(x) for x in value] if isinstance(value, list) else float(value)


@pytest.mark.parametrize("name", NAMES)
def test_the_core_has_the_exact_numbers_rounded_once(name: str) -> None:
    assert _core.tableau("radau5")[NAMES[name]] == rounded(EXACT[name])


def test_the_weights_have_order_five_and_no_more() -> None:
    with mpmath.workdps(60):
        weights = StageWeights(EXACT["a"])

        def largest(nodes: int) -> float:
            of_trees = [misses(weights, EXACT["a"][2], tree) for tree in trees(nodes)]
            return max(float(abs(miss)) for miss in of_trees)

        assert all(largest(nodes) < 1e-50 for nodes in range(1, 6))
        assert largest(6) > 1e-5
        assert order(trees(6)[0]) == 6


def test_the_nodes_are_the_zeros_of_the_polynomial_of_radau() -> None:
    with mpmath.workdps(60):
        for x in EXACT["c"]:  # d^2/dx^2 (x^2 (x - 1)^3) / (2 (x - 1))
            assert abs((x - 1) * (10 * x**2 - 8 * x + 1)) < mpmath.mpf(10) ** -55
    assert EXACT["c"][2] == 1


def test_the_transformation_takes_the_inverse_to_a_number_and_a_rotation() -> None:
    t, a = mpmath.matrix(EXACT["t"]), mpmath.matrix(EXACT["a"])
    with mpmath.workdps(60):
        found = mpmath.matrix(EXACT["t_inverse"]) * a**-1 * t
        real, alpha, beta = EXACT["real"], EXACT["alpha"], EXACT["beta"]
        wanted = mpmath.matrix([[real, 0, 0], [0, alpha, -beta], [0, beta, alpha]])
        assert mpmath.mnorm(found - wanted, 1) < mpmath.mpf(10) ** -50
