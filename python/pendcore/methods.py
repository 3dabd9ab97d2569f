"""The methods of integration, as their descriptors in the core describe them.

import pendcore.methods

pendcore.methods.known_methods()["dop853"]["error_order"]   # 7
pendcore.methods.most_accurate()                            # which serve as references
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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


def line_style(method: str) -> dict[str, Any]:
    """Return how figures draw a method: matplotlib's colour, dash and marker."""
    color, dash, marker = known_methods()[method]["line"]
    lengths = tuple(float(one) for one in dash.split()) if dash[0].isdigit() else None
    linestyle = dash if lengths is None else (0, lengths)
    return {"color": color, "linestyle": linestyle, "marker": marker}


def sentences() -> list[str]:
    """Return what docstrings say of each method, after its names."""
    names_of: dict[str, list[str]] = {}  # one sentence may describe several, such as the pairs
    for one in known_methods().values():
        names = [f'``"{name}"``' for name in (one["name"], *one["aliases"])]
        names_of.setdefault(one["sentence"], []).extend(names)
    return [f"{', '.join(names)}: {sentence}" for sentence, names in names_of.items()]


def methods_named(methods: str | Iterable[str]) -> list[str]:
    """Return the names of methods to compare, without aliases and each once.

    ``"auto"`` is refused: it may choose a different method at each tolerance.
    """
    names = {alias: name for name, m in known_methods().items() for alias in (name, *m["aliases"])}
    try:
        listed = [methods] if isinstance(methods, str) else list(methods)
    except TypeError:
        raise TypeError(f"methods = {methods!r}: must be names of methods, or one") from None
    if not listed:
        raise ValueError("methods: is empty: must name a method, or be left out")
    for method in listed:
        if method not in names:
            what = "is a rule that chooses one" if method == "auto" else "is none"
            raise ValueError(f"methods: {method!r} {what}: known are {', '.join(names)}")
    return [*dict.fromkeys(names[method] for method in listed)]


def methods_of(method: str) -> set[str]:
    """Return a method's name and, for a pair, the names of its two methods."""
    known = known_methods()[method]
    return {method, known["first"], known["second"]} - {""}


def has_error_estimate(method: str) -> bool:
    """Return whether a method chooses its steps from tolerances."""
    return bool(known_methods()[method]["error_order"])


def pair_of(first: str) -> str:
    """Return the pair that begins with a method."""
    pairs = [one for one in known_methods().values() if one["kind"] == "pair"]
    return str(next(pair["name"] for pair in pairs if pair["first"] == first))


def evaluations(method: str, last_method: str, nfev: int) -> str:
    """Return the number of evaluations: series of Taylor's method, right-hand sides of others."""
    known = known_methods()
    first = known[method]["first"] or method
    if not known[first]["dense_output_is_series"]:
        return f"{nfev} right-hand sides"
    if last_method != first:
        return f"{nfev} series and right-hand sides"
    return f"{nfev} series, each as long as many right-hand sides"


def tightest_rtol(method: str) -> float:
    """Return the rtol below which a run by a method gets no more accurate."""
    return TIGHTEST_IMPLICIT if implicit_method() in methods_of(method) else TIGHTEST


__all__ = [
    "evaluations",
    "has_error_estimate",
    "implicit_method",
    "known_methods",
    "line_style",
    "methods_named",
    "methods_of",
    "most_accurate",
    "pair_of",
    "tightest_rtol",
]
