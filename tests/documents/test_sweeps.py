"""Reduced sweeps leave out cases, but no claim."""

from __future__ import annotations

import subprocess
import sys
from dataclasses import dataclass, field, replace
from itertools import product
from pathlib import Path

import pytest
from sweeps import every, few, spread

ROOT = Path(__file__).parents[2]


@dataclass
class Case:
    nodeid: str
    indices: dict[str, int] = field(default_factory=dict)
    kept_whole: frozenset[str] = frozenset()


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


def test_every_value_of_a_parameter_is_met_that_is_kept_whole() -> None:
    sweep = [replace(case, kept_whole=frozenset({"joint"})) for case in cases(method=7, joint=20)]
    kept = few(sweep, 3)
    assert {case.indices["joint"] for case in kept} == set(range(20))
    assert {case.indices["method"] for case in kept} == {0, 3, 6}
    assert len(kept) < 24


def test_values_that_never_meet_are_met_all_the_same() -> None:
    """The parameters are given in pairs, not as a product."""
    pairs = [Case(f"test_pairs[{i}]", {"q": i, "t": 9 - i}) for i in range(10)]
    kept = few(pairs, 3)
    assert {0, 9} <= {case.indices["q"] for case in kept}
    assert {0, 9} <= {case.indices["t"] for case in kept}


def test_a_share_of_all_tests_is_the_same_each_time() -> None:
    names = [f"test_file.py::test_{i}" for i in range(1000)]
    assert every(names, 1) == names
    assert 150 < len(every(names, 5)) < 250
    assert every(names, 5) == every(names, 5)


def test_a_share_has_a_test_of_every_file() -> None:
    names = [f"test_{i}.py::test_{j}" for i in range(100) for j in range(3)]
    assert {name.partition("::")[0] for name in every(names, 1000)} == {
        name.partition("::")[0] for name in names
    }


# This code says which test functions the reduction leaves out of all that are collected, and which
# of these are marked to be left out.
COLLECT = """
import sys
import pytest

def functions(items):
    return {item.nodeid.partition("[")[0] for item in items}

class Reduction:
    @pytest.hookimpl(wrapper=True, tryfirst=True)
    def pytest_collection_modifyitems(self, items):
        every = functions(items)
        whole = functions(item for item in items if item.get_closest_marker("whole"))
        yield
        left = every - functions(items)
        for name in sorted(every):
            print("function", name)
        for name in sorted(left):
            print("marked" if name in whole else "lost", name)

sys.exit(pytest.main(["--collect-only", "-qq", *sys.argv[1:]], plugins=[Reduction()]))
"""


@pytest.mark.outside_build
def test_no_test_is_left_to_test_all_unless_it_is_marked() -> None:
    """A test that `make test` leaves out whole is marked, and takes a build of its own."""
    told = subprocess.run(
        [sys.executable, "-c", COLLECT, "-p", "no:cacheprovider"],
        cwd=ROOT, capture_output=True, text=True, check=True,
    ).stdout.splitlines()  # fmt: skip
    assert sum(line.startswith("function ") for line in told) > 1000
    assert [line for line in told if line.startswith("lost ")] == []
    # They build the core twice with other optimisation, and compute for minutes in many digits.
    builds = "core/test_same_bits.py::test_every_optimisation_gives_the_same_bits"
    digits = "switching/test_energy_of_impacts.py::test_impacts_of_light_links_add_no_energy"
    marked = {f"marked tests/{one}" for one in (builds, digits)}
    assert {line for line in told if line.startswith("marked ")} <= marked
