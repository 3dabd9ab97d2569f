"""The methods of the core, and what it says of each."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from pendcore import _core


def known_methods() -> dict[str, dict[str, Any]]:
    """Return the methods of the core by their names."""
    return {method["name"]: method for method in _core.methods()}


def methods_named(methods: str | Iterable[str]) -> list[str]:
    """Return methods to compare by their own names, each once.

    ``"auto"`` is refused: it may be one method at one tolerance, and another at the next.
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
    """Return a method's name and, of a pair, those of its two."""
    known = known_methods()[method]
    return {method, known["first"], known["second"]} - {""}


def has_error_estimate(method: str) -> bool:
    """Whether a method chooses its steps from tolerances."""
    return bool(known_methods()[method]["error_order"])


def pair_of(first: str) -> str:
    """Return the pair that begins with a method."""
    pairs = [one for one in _core.methods() if one["kind"] == "pair"]
    return str(next(pair["name"] for pair in pairs if pair["first"] == first))


def method_at_the_end(method: str, message: str) -> str:
    """Return the method that a run ended with: of a pair that has changed over, the second.

    ``message`` is the run's, which tells that it has.
    """
    known = known_methods()[method]
    has_changed = known["second"] and f"went on with {known['second']}" in message
    return str(known["second"] if has_changed else known["first"] or method)
