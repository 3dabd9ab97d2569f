"""What effects and their parts have in common: they cannot be changed, compare and hash."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any, ClassVar, NoReturn, Self

from pendcore import _core
from pendcore._messages.arguments import did_you_mean, flag, in_unit, number, numbers, whole_number
from pendcore._scene.compiled_function import address
from pendcore._scene.effect_description import Description, Parameter, docstring, effects, parts

DESCRIPTIONS = {told.name: told for told in (*parts(), *effects())}
"""What the core says of each class, by name."""


class Described:
    """What has the parameters of a description: it cannot be changed, compares and hashes."""

    __slots__ = ()
    description: ClassVar[Description]

    def __init_subclass__(cls) -> None:
        if cls.__name__ in DESCRIPTIONS:
            cls.description = DESCRIPTIONS[cls.__name__]
            cls.__doc__ = docstring(cls.description)

    def __post_init__(self) -> None:
        self._settle(f"{type(self).__name__}: ")

    def _settle(self, where: str) -> None:
        """Make plain what was given, and check it; what is wrong is told after ``where``."""
        for parameter in self.description.parameters:
            given = getattr(self, parameter.name)
            plain = _plain(where + parameter.name, parameter, given)
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
        return _unpickled, (type(self), self.particulars())


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

    def __init_subclass__(cls) -> None:
        super().__init_subclass__()
        if cls.__name__ in DESCRIPTIONS:
            cls.kind = cls.description.kind

    def parts(self) -> dict[str, Part]:
        """Return the parts that it has, by the names of its parameters.

        Examples
        --------
        >>> wave = pc.effects.Sinusoid(amplitude=3.0, angular_frequency=6.0)
        >>> pc.effects.Motor(joint=1, sinusoid=wave).parts() == {"sinusoid": wave}
        True
        """
        values = {p.name: getattr(self, p.name) for p in self.description.parameters}
        return {name: value for name, value in values.items() if isinstance(value, Part)}

    def _check(self, where: str) -> None:
        _core.check_effect(where, self._as_pair())

    def _as_pair(self) -> tuple[str, Any]:
        """Return the values from which the core makes an effect."""
        return self.kind, self._for_the_core()


class OwnEffect(Effect):
    """A function as an effect: no file can keep it, and it keeps alive what it is made from."""

    __slots__ = ("_origins",)
    _origins: dict[str, Any]

    def _settle(self, where: str) -> None:
        given = {p.name: getattr(self, p.name) for p in self.description.parameters}
        defaults = {p.name: p.default for p in self.description.parameters if not p.required}
        origins = {name: x for name, x in given.items() if x is not defaults.get(name, self)}
        object.__setattr__(self, "_origins", origins)
        super()._settle(where)

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


def filled(cls: type[Described], values: Mapping[str, Any], where: str) -> Any:
    """Make one of all values by name; what is wrong is told after ``where``."""
    _check_names(where, cls.description, values)
    new = object.__new__(cls)
    for parameter in cls.description.parameters:
        value = values.get(parameter.name, parameter.default)
        object.__setattr__(new, parameter.name, value)
    new._settle(where)
    return new


def _unpickled(cls: type[Described], values: Mapping[str, Any]) -> Any:
    return filled(cls, values, f"{cls.__name__}: ")


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
