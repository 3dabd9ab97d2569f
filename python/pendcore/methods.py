"""The methods of integration, as their descriptors in the core describe them.

import pendcore.methods

pendcore.methods.known_methods()["dop853"]["error_order"]   # 7
pendcore.methods.most_accurate()                            # which serve as references
"""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Any

from pendcore import _core

TIGHTEST = 1e-14
"""Below this rtol smaller steps add more rounding than they save truncation."""
TIGHTEST_IMPLICIT = 1e-13
"""The tightest rtol of an implicit method; its equations are not solved more exactly."""


@cache
def known_methods() -> Mapping[str, Mapping[str, Any]]:
    """Return the methods of the core by their names."""
    return MappingProxyType({one["name"]: MappingProxyType(one) for one in _core.methods()})


def error_over_rtol(method: str) -> float:
    """Return the typical largest position error of a run, as a multiple of its rtol."""
    return float(known_methods()[method]["error_over_rtol"])


def most_accurate() -> tuple[str, ...]:
    """Return the methods that give second opinions and serve as references, the best first."""
    ranked = [(one["second_opinion"], one["name"]) for one in known_methods().values()]
    return tuple(name for rank, name in sorted(ranked) if rank)


def implicit_method() -> str:
    """Return the method for stiff scenes."""
    return next(str(one["name"]) for one in known_methods().values() if one["kind"] == "implicit")


def sentences() -> list[str]:
    """Return what docstrings say of each method, after its names."""
    names_of: dict[str, list[str]] = {}  # one sentence may describe several, such as the pairs
    for one in known_methods().values():
        names = [f'``"{name}"``' for name in (one["name"], *one["aliases"])]
        names_of.setdefault(one["sentence"], []).extend(names)
    return [f"{', '.join(names)}: {sentence}" for sentence, names in names_of.items()]


def pair_of(first: str) -> str:
    """Return the pair that begins with a method."""
    pairs = [one for one in known_methods().values() if one["kind"] == "pair"]
    return str(next(pair["name"] for pair in pairs if pair["first"] == first))


def evaluations(method: str, last_method: str, nfev: int) -> str:
    """Return the number of evaluations: Taylor expansions, or right-hand sides by other methods."""
    known = known_methods()
    first = known[method]["first"] or method
    if not known[first]["dense_output_is_series"]:
        return f"{nfev:,} right-hand sides"
    if last_method != first:
        return f"{nfev:,} Taylor expansions and right-hand sides"
    return f"{nfev:,} Taylor expansions"


__all__ = [
    "TIGHTEST",
    "TIGHTEST_IMPLICIT",
    "error_over_rtol",
    "evaluations",
    "implicit_method",
    "known_methods",
    "most_accurate",
    "pair_of",
    "sentences",
]
__dir__ = __all__.copy
