"""What effects and their parts have in common: the core describes and checks them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import fields
from functools import partial
from typing import Any, ClassVar

from pendcore import _core
from pendcore._messages.arguments import flag, function, number, numbers, whole_number
from pendcore._scene.compiled_function import address
from pendcore._scene.effect_description import Description, Parameter, docstring, effects, parts
from pendcore._scene.parametrized import OfFunction, Parametrized

DESCRIPTIONS = {told.name: told for told in (*parts(), *effects())}
"""What the core says of each class, by name."""


class Described(Parametrized):
    """What has the parameters that the core describes."""

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

    def _for_the_core(self) -> dict[str, Any]:
        """Return every parameter, parts as dictionaries."""
        given = ((p.name, getattr(self, p.name)) for p in self.description.parameters)
        return {name: x._for_the_core() if isinstance(x, Described) else x for name, x in given}


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


class OwnEffect(Effect, OfFunction):
    """A function as an effect: it keeps alive what it is made from."""

    __slots__ = ("_origins",)
    _origins: dict[str, Any]

    def _settle(self, where: str) -> None:
        given = ((f, getattr(self, f.name)) for f in fields(self))
        object.__setattr__(self, "_origins", {f.name: x for f, x in given if x is not f.default})
        super()._settle(where)

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
        "function": function,
    }
    return converted[parameter.type](name, value)
