"""The laws of the smooth effects in symbols, a file each, and why the others have none here."""

from __future__ import annotations

from typing import Any

from pendcore.derive.laws.law import Definition, Law, LinkLoad
from pendcore.derive.notation import Notation

LAWS: dict[str, type[Law]] = {}
"""By the kind of effect."""


def law_of(effect: Any, notation: Notation) -> Law:
    """Return the law of an effect."""
    return LAWS[effect.kind](effect, notation)


__all__ = ["LAWS", "Definition", "Law", "LinkLoad", "law_of"]
