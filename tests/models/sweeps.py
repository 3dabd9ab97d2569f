"""The cases of a parametrised test that run: all of them, or few that meet every parameter.

`make test` runs few of those that take long, which are marked `few_cases`, so that a newcomer need
not wait; `make test-all` runs all. No test function is left out: a reduced sweep keeps some values
of each parameter, and each of these at least once, and a third of the random examples.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from hashlib import sha256
from typing import Protocol


class Case(Protocol):
    """A case of a parametrised test: its name, and the number of its value for each parameter."""

    nodeid: str

    @property
    def indices(self) -> dict[str, int]: ...

    @property
    def kept_whole(self) -> frozenset[str]:
        """Parameters of which every value is met."""
        ...


reduced = True
"""Whether sweeps are reduced; conftest.py says so before tests are read."""
asked_for: int | None = None
"""How many random examples each test tries, whatever it tries otherwise."""


def random_examples(count: int) -> int:
    """Return how many of so many random examples a test tries: the first ones are plain."""
    if asked_for is not None:
        return asked_for
    return min(count, max(5, count // 3)) if reduced else count


def few(cases: Sequence[Case], values: int) -> list[Case]:
    """Return cases that meet up to `values` values of each parameter, each at least once.

    The choice depends on nothing but the names of the cases and their order.
    """
    if not cases[0].indices:
        return list(cases)
    kept = {}
    for name in cases[0].indices:
        all_values = sorted({case.indices[name] for case in cases})
        count = len(all_values) if name in cases[0].kept_whole else values
        kept[name] = set(spread(all_values, count))
    within = [
        case for case in cases if all(case.indices[name] in some for name, some in kept.items())
    ]
    missed = {(name, value) for name, some in kept.items() for value in some}
    chosen = set()
    for case in (*sorted(within, key=shuffled), *sorted(cases, key=shuffled)):
        met = missed & set(case.indices.items())
        if met:
            chosen.add(case.nodeid)
            missed -= met
    return [case for case in cases if case.nodeid in chosen]


def spread(values: Sequence[int], count: int) -> list[int]:
    """Return `count` of the values, among them the first and the last."""
    if len(values) <= count:
        return list(values)
    if count == 1:
        return [values[0]]
    return [values[round(k * (len(values) - 1) / (count - 1))] for k in range(count)]


def every(names: Iterable[str], share: int) -> list[str]:
    """Return one in `share` names, the same ones each time, and at least one of every file."""
    names = list(names)
    first: dict[str, str] = {}
    for name in sorted(names, key=digest):
        first.setdefault(name.partition("::")[0], name)
    kept = set(first.values())
    return [name for name in names if name in kept or digest(name) % share == 0]


def digest(text: str) -> int:
    return int.from_bytes(sha256(text.encode()).digest()[:8], "big")


def shuffled(case: Case) -> int:
    return digest(case.nodeid)
