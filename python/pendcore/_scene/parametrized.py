"""What links, effects and their parts, and events have in common: they are made of parameters."""

from __future__ import annotations

from dataclasses import dataclass, fields
from functools import partial
from typing import Any, NoReturn, Self


@dataclass(frozen=True, repr=False)
class Parametrized:
    """What is made of parameters: it cannot be changed, compares and hashes."""

    __slots__ = ()

    def particulars(self) -> dict[str, Any]:
        """Return the parameters that differ from their defaults, enough to make it again."""
        return {
            f.name: value for f in fields(self) if (value := getattr(self, f.name)) != f.default
        }

    def replace(self, **changes: Any) -> Self:
        """Return an object with other parameters; those not given stay."""
        return type(self)(**{**self.particulars(), **changes})

    __replace__ = replace  # copy.replace() of Python 3.13

    def _set(self, name: str, value: object) -> None:
        object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={x!r}" for name, x in self.particulars().items())
        return f"{type(self).__name__}({values})"

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __reduce__(self) -> tuple[object, ...]:
        return partial(type(self), **self.particulars()), ()


class OfFunction(Parametrized):
    """What holds a function of the user's: no file can keep it."""

    __slots__ = ()

    def cannot_be(self, what: str, remedy: str = "") -> TypeError:
        """Return the error that says why it cannot be pickled, written, saved."""
        reason = "a function lives in one process alone"
        return TypeError(f"{self!r}: cannot be {what}: {reason}{remedy}")

    def __reduce__(self) -> NoReturn:
        raise self.cannot_be("pickled")
