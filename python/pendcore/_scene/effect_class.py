"""Classes made from the descriptions of effects.

Nothing here knows a single effect: one that is added to the core has its class.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import MISSING, field, make_dataclass
from functools import partial
from inspect import Parameter as Argument
from inspect import Signature
from typing import Any, ClassVar, NoReturn, Self

from pendcore import _core
from pendcore._messages.arguments import did_you_mean, flag, in_unit, number, numbers, whole_number
from pendcore._scene.compiled_function import address
from pendcore._scene.effect_description import Description, Parameter, docstring, effects, parts


class Described:
    """What has the parameters of a description: it cannot be changed, compares and hashes."""

    __slots__ = ()
    description: ClassVar[Description]

    def __init__(self, *values: Any, **named: Any) -> None:
        self._fill(type(self).__name__ + ": ", _bound(self.description, values, named))

    def _fill(self, where: str, given: Mapping[str, Any]) -> None:
        """Take the values; what is wrong is told after ``where``."""
        _check_names(where, self.description, given)
        for parameter in self.description.parameters:
            value = given.get(parameter.name, parameter.default)
            plain = _plain(where + parameter.name, parameter, value)
            object.__setattr__(self, parameter.name, plain)
        self._check(where)

    def _check(self, where: str) -> None:
        raise NotImplementedError

    def replace(self, **changes: Any) -> Self:
        """Return an object with other parameters; those not given stay."""
        return type(self)(**{**self.particulars(), **changes})

    __replace__ = replace  # copy.replace() of Python 3.13

    def particulars(self) -> dict[str, Any]:
        """Return the parameters that differ from their defaults, enough to make it again."""
        values = {p.name: (p, getattr(self, p.name)) for p in self.description.parameters}
        return {
            name: value for name, (p, value) in values.items() if p.required or value != p.default
        }

    def _for_the_core(self) -> dict[str, Any]:
        """Return every parameter, parts as dictionaries."""
        values = {p.name: getattr(self, p.name) for p in self.description.parameters}
        return {
            name: value._for_the_core() if isinstance(value, Described) else value
            for name, value in values.items()
        }

    def __repr__(self) -> str:
        values = ", ".join(f"{name}={x!r}" for name, x in self.particulars().items())
        return f"{type(self).__name__}({values})"

    def __copy__(self) -> Self:
        return self

    def __deepcopy__(self, memo: object) -> Self:
        return self

    def __reduce__(self) -> tuple[object, ...]:
        return made, (type(self), self.particulars())


class Part(Described):
    """What a parameter of an effect holds that has parameters of its own.

    Examples
    --------
    >>> wave = pc.effects.Sinusoid(amplitude=3.0, angular_frequency=6.0)
    >>> isinstance(wave, pc.effects.Part)
    True
    """

    __slots__ = ()

    def _check(self, where: str) -> None:
        _core.check_part(where, type(self).__name__, self._for_the_core())


class Effect(Described):
    """What acts on a chain besides gravity.

    Attributes
    ----------
    kind : str
        As in case files.

    Examples
    --------
    >>> effect = pc.effects.ViscousJoint(joint=2, damping=0.05)
    >>> effect.kind, effect.particulars()
    ('viscous_joint', {'joint': 2, 'damping': 0.05})
    >>> effect.replace(damping=0.1)
    ViscousJoint(joint=2, damping=0.1)
    """

    __slots__ = ()
    kind: ClassVar[str]

    def _check(self, where: str) -> None:
        _core.check_effect(where, self._as_pair())

    def _as_pair(self) -> tuple[str, Any]:
        """Return the values from which the core makes an effect."""
        return self.kind, self._for_the_core()


class OwnEffect(Effect):
    """A function as an effect: no file can keep it, and it keeps alive what it is made from."""

    __slots__ = ("_origins",)
    _origins: dict[str, Any]

    def _fill(self, where: str, given: Mapping[str, Any]) -> None:
        object.__setattr__(self, "_origins", dict(given))
        super()._fill(where, given)

    def cannot_be(self, what: str, remedy: str = "") -> TypeError:
        """Return the error that says why it cannot be pickled, written, saved."""
        reason = "a function lives in one process alone"
        return TypeError(f"{self!r}: cannot be {what}: {reason}{remedy}")

    def particulars(self) -> dict[str, Any]:
        """Return the parameters as they were given."""
        return dict(self._origins)

    def __repr__(self) -> str:
        first, *more = self.description.parameters
        function = getattr(self, first.name)
        shown = f"<at {function:#x}>" if isinstance(function, int) else repr(function)
        values = [f"{first.name}={shown}"]
        values += [f"{p.name}={x!r}" for p in more if (x := getattr(self, p.name)) != p.default]
        return f"{type(self).__name__}({', '.join(values)})"

    def __reduce__(self) -> NoReturn:
        raise self.cannot_be("pickled")


class PythonEffect(OwnEffect):
    """An effect that is a Python function."""

    __slots__ = ()
    function: Callable[..., Any]

    def _check(self, where: str) -> None:
        if not callable(self.function):
            raise TypeError(f"{where}function = {self.function!r}: must be a function of t, q, qd")
        super()._check(where)

    def _as_pair(self) -> tuple[str, Any]:
        return self.kind, tuple(self._for_the_core().values())


def made(cls: type[Described], values: Mapping[str, Any], where: str | None = None) -> Any:
    """Make one of a mapping; what is wrong is told after ``where``, or the name of the class.

    A part may be a mapping itself.
    """
    where = f"{cls.__name__}: " if where is None else where
    whole = dict(values)
    for parameter in cls.description.parameters:
        value = values.get(parameter.name)
        if parameter.part and isinstance(value, Mapping):
            inner = f"{where}{parameter.name}."
            whole[parameter.name] = made(PARTS[parameter.part], value, inner)
    new = object.__new__(cls)
    new._fill(where, whole)
    return new


def effect_of(kind: str, values: Mapping[str, Any], where: str | None = None) -> Effect:
    """Make an effect of its kind and a mapping; see `made`."""
    return made(KINDS[kind], values, where)  # type: ignore[no-any-return]


def _class(told: Description, base: type[Any]) -> type[Any]:
    fields = []
    arguments = []
    for p in told.parameters:
        default = MISSING if p.required else p.default
        fields.append((p.name, object, field(default=default)))
        usual = Argument.empty if p.required else p.default
        arguments.append(Argument(p.name, Argument.POSITIONAL_OR_KEYWORD, default=usual))
    names = {
        "__doc__": docstring(told),
        "__signature__": Signature(arguments),
        "description": told,
    } | ({"kind": told.kind} if told.kind else {})
    made = make_dataclass(
        told.name,
        fields,
        bases=(base,),
        namespace=names,
        frozen=True,
        slots=True,
        init=False,
        repr=False,
    )
    made.__module__ = "pendcore.effects"  # from Python 3.12 on, make_dataclass enters its caller
    return made


def _bound(told: Description, values: tuple[Any, ...], named: dict[str, Any]) -> dict[str, Any]:
    names = [parameter.name for parameter in told.parameters]
    if len(values) > len(names):
        raise TypeError(
            f"{told.name}: takes {', '.join(names)}, and was given {len(values)} values"
        )
    given = dict(zip(names, values, strict=False))
    for name in given.keys() & named.keys():
        raise TypeError(f"{told.name}: {name} is given twice")
    return given | named


def _check_names(where: str, told: Description, given: Iterable[str]) -> None:
    names = [parameter.name for parameter in told.parameters]
    for name in given:
        if name not in names:
            owner = f"{where[:-1]} " if where.endswith(".") else where
            raise TypeError(f"{owner}has no parameter {name!r}: {did_you_mean(name, names)}")
    for p in told.parameters:
        if p.required and p.name not in given:
            raise TypeError(f"{where}{p.name} is missing: {p.sentence}{in_unit(p.unit)}")


def _plain(name: str, parameter: Parameter, value: Any) -> Any:
    """Return the value as the type of its parameter."""
    unit, part = parameter.unit, parameter.part
    if value is None and parameter.optional:
        return None
    if part is not None:
        if type(value).__name__ != part or not isinstance(value, Part):
            raise TypeError(f"{name} = {value!r}: must be a pendcore.effects.{part}")
        return value
    converted: dict[str, Callable[[str, Any], Any]] = {
        "bool": flag,
        "int": whole_number,
        "float": partial(number, unit=unit),
        "optional float": partial(number, unit=unit),
        "pair": partial(numbers, unit=unit, count=2, finite="inf" not in parameter.range),
        "floats": partial(numbers, unit=unit),
        "address": partial(address, of_function=parameter.required),
        "function": lambda _, function: function,
    }
    return converted[parameter.type](name, value)


def _base(told: Description) -> type[Effect]:
    types = {parameter.type for parameter in told.parameters}
    return PythonEffect if "function" in types else OwnEffect if "address" in types else Effect


PARTS: dict[str, type[Part]] = {told.name: _class(told, Part) for told in parts()}
"""The classes of what parameters hold that have parameters of their own, by name."""

KINDS: dict[str, type[Effect]] = {told.kind: _class(told, _base(told)) for told in effects()}
"""The classes of effects, by kind."""
