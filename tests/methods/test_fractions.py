"""A coefficient is the double nearest to its exact value, whatever a long double is.

The nearest double comes from whole numbers alone: sqrt(6) as a fraction of 2^400, whose error is
far below half of the distance of any of these values from the middle of two doubles.
"""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from math import isqrt
from typing import Any

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from pendcore import _core

EXPLICIT = [method["name"] for method in _core.methods() if method["kind"] == "explicit"]
SQRT_6 = Fraction(isqrt(6 << 800), 1 << 400)
WHOLE = st.integers(-(2**62), 2**62)


def nearest(numerator: int, denominator: int, root: int) -> float:
    return float((numerator + root * SQRT_6) / denominator)


def triples(rows: Any) -> Iterator[tuple[int, int, int]]:
    if isinstance(rows[0], int):
        yield rows
    else:
        for row in rows:
            yield from triples(row)


@pytest.mark.parametrize("method", EXPLICIT)
def test_every_coefficient_is_the_nearest_double(method: str) -> None:
    table = _core.tableau(method)
    assert all(_core.nearest_double(*one) == nearest(*one) for one in triples(list(table.values())))


@given(WHOLE, st.integers(1, 2**62), st.one_of(st.just(0), st.integers(-(2**53), 2**53)))
def test_any_fraction_is_rounded_to_the_nearest_double(
    numerator: int, denominator: int, root: int
) -> None:
    exact = numerator + root * SQRT_6
    assume(abs(exact) > 2**-40 * (abs(numerator) + 1))  # tables have no such cancellation
    assert _core.nearest_double(numerator, denominator, root) == nearest(
        numerator, denominator, root
    )
