"""What pickle keeps of a frozen dataclass with slots: the values of its fields.

Python adds the same two functions by itself, but without docstrings: `help` would show a comment of
the standard library.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import fields
from typing import Any, TypeVar

Kind = TypeVar("Kind", bound=type)


def get_fields(self: Any) -> list[Any]:
    """Return the values of the fields, for pickle."""
    return [getattr(self, field.name) for field in fields(self)]


def set_fields(self: Any, values: Iterable[Any]) -> None:
    """Set the fields to what was pickled."""
    for field, value in zip(fields(self), values, strict=True):
        object.__setattr__(self, field.name, value)


def frozen_state(cls: Kind) -> Kind:
    """Give a frozen dataclass with slots these two functions; write it above ``@dataclass``."""
    setattr(cls, "__getstate__", get_fields)  # noqa: B010  (mypy knows no such assignment)
    setattr(cls, "__setstate__", set_fields)  # noqa: B010
    return cls
