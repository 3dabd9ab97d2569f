"""What links, effects and their parts, and events have in common: they are made of parameters."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, fields
from functools import partial
from typing import Any, NoReturn, Self, TypeVar

_OF_FUNCTIONS = {"effect": "pendcore.effects.User(f)", "event": "pendcore.events.Function(f)"}
_AN_OBJECT = {
    "link": "pendcore.Link object, such as Link(mass=1.0, length=1.0)",
    "effect": "pendcore.effects object, such as ViscousJoint(joint=1, damping=0.1)",
    "event": "pendcore.events object, such as RateZero(joint=1)",
}


@dataclass(frozen=True, repr=False)
class Parametrized:
    """An object that is made of parameters: none can be changed, and equal ones make it equal."""

    __slots__ = ()

    def particulars(self) -> dict[str, Any]:
        """Return the parameters that differ from their defaults, enough to make it again."""
        return {f.name: x for f in fields(self) if (x := getattr(self, f.name)) != f.default}

    def replace(self, **changes: Any) -> Self:
        """Return an object with other parameters; those not given stay."""
        return type(self)(**{**self.particulars(), **changes})

    __replace__ = replace  # copy.replace() of Python 3.13

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


Member = TypeVar("Member", bound=Parametrized)


def tuple_of(
    noun: str, kind: type[Member], values: Iterable[Member], what: str
) -> tuple[Member, ...]:
    """Return the links, effects or events of a list; raise TypeError for anything else."""
    remedy = f"must be a list of {what}"
    try:
        values = tuple(values)
    except TypeError:
        alone = ": put it in brackets" if isinstance(values, kind) else ""
        raise TypeError(f"{noun}s = {values!r}: {remedy}{alone}") from None
    for i, value in enumerate(values, start=1):
        if isinstance(value, type) and issubclass(value, kind):
            wanted = f"must be a {_AN_OBJECT[noun]}; got the class itself"
            raise TypeError(f"{noun} {i} = {value.__name__}: {wanted}")
        if not isinstance(value, kind):
            if callable(value) and not isinstance(value, type) and noun in _OF_FUNCTIONS:
                remedy = f"is a function: give {_OF_FUNCTIONS[noun]}"
            raise TypeError(f"{noun} {i} = {value!r}: {remedy}")
    return values
