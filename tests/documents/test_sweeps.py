"""Reduced sweeps leave out cases, and no claim."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import product

import pytest
from sweeps import every, few, spread


@dataclass
class Case:
    nodeid: str
    indices: dict[str, int] = field(default_factory=dict)


def cases(**counts: int) -> list[Case]:
    return [
        Case(f"test_all[{numbers}]", dict(zip(counts, numbers, strict=True)))
        for numbers in product(*(range(count) for count in counts.values()))
    ]


@pytest.mark.parametrize("values", [1, 2, 6])
def test_each_value_that_is_kept_is_met(values: int) -> None:
    sweep = cases(method=7, error=3, joint=20)
    kept = few(sweep, values)
    for name, count in (("method", 7), ("error", 3), ("joint", 20)):
        assert {case.indices[name] for case in kept} == set(spread(range(count), values))
    assert len(kept) <= 3 * values
    assert kept == few(sweep, values)


def test_a_sweep_that_is_small_or_has_no_parameters_is_whole() -> None:
    assert few(cases(method=4), 6) == cases(method=4)
    assert few([Case("test_one")], 1) == [Case("test_one")]


def test_values_that_never_meet_are_met_all_the_same() -> None:
    """Parameters that are given in pairs, not as a product."""
    pairs = [Case(f"test_pairs[{i}]", {"q": i, "t": 9 - i}) for i in range(10)]
    kept = few(pairs, 3)
    assert {0, 9} <= {case.indices["q"] for case in kept}
    assert {0, 9} <= {case.indices["t"] for case in kept}


def test_a_share_of_all_tests_is_the_same_each_time() -> None:
    names = [f"test_{i}" for i in range(1000)]
    assert every(names, 1) == names
    assert 150 < len(every(names, 5)) < 250
    assert every(names, 5) == every(names, 5)
