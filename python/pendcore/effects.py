"""What acts on a chain besides gravity: a class for each effect that the core has.

    import pendcore as pc

    pc.effects.ViscousJoint(joint=1, damping=0.1)
    pc.effects.Motor(joint=2, sinusoid=pc.effects.Sinusoid(amplitude=1.0, angular_frequency=6.0))
    pc.effects.kinds()               # every kind, as in case files, with its class

The core has their laws, checks their parameters and describes them, which gives the classes their
docstrings. docs/effects has a page on each.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import inf
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

from pendcore._messages.arguments import did_you_mean, in_unit, require_known
from pendcore._scene.effect_class import Described, Effect, OwnEffect, Part
from pendcore._scene.effect_description import effects as described_effects
from pendcore._scene.effect_description import parts as described_parts

if TYPE_CHECKING:
    from collections.abc import Sequence

    import numpy as np
    import numpy.typing as npt

    Numbers = Sequence[float] | npt.NDArray[np.float64]

Made = TypeVar("Made", bound=Described)


@dataclass(frozen=True, slots=True, repr=False)
class Sinusoid(Part):
    """amplitude sin(angular_frequency t + phase); the amplitude has the unit of what it drives."""

    amplitude: float
    angular_frequency: float
    phase: float = 0.0


@dataclass(frozen=True, slots=True, repr=False)
class Table(Part):
    """Torque at given times, linear between them or held; the run ends where the table ends."""

    t: Numbers
    torque: Numbers
    hold: bool = False


@dataclass(frozen=True, slots=True, repr=False)
class PD(Part):
    """A controller that holds the joint at an angle: kp (reference - phi) - kd w."""

    kp: float
    kd: float
    reference: float


@dataclass(frozen=True, slots=True, repr=False)
class Spline(Part):
    """Natural cubic splines x(t) and y(t) through given points; the run ends where they end."""

    t: Numbers
    x: Numbers
    y: Numbers


@dataclass(frozen=True, slots=True, repr=False)
class ViscousJoint(Effect):
    """Viscous damping in a joint, with a linear, a quadratic and a cubic term."""

    joint: int
    damping: float
    damping2: float = 0.0
    damping3: float = 0.0


@dataclass(frozen=True, slots=True, repr=False)
class DryJointFriction(Effect):
    """Dry friction in a joint, Coulomb's with a static peak (Stribeck)."""

    joint: int
    coulomb: float
    static: float | None = None
    stribeck_velocity: float = 0.1
    exponent: float = 2.0


@dataclass(frozen=True, slots=True, repr=False)
class RodDrag(Effect):
    """Air drag on a link, along the whole rod, quadratic in the speed across it."""

    link: int
    drag_coefficient: float
    diameter: float
    air_density: float = 1.225
    wind: Numbers = (0.0, 0.0)


@dataclass(frozen=True, slots=True, repr=False)
class TorsionalSpring(Effect):
    """A linear torsional spring in a joint."""

    joint: int
    stiffness: float
    rest_angle: float = 0.0


@dataclass(frozen=True, slots=True, repr=False)
class Motor(Effect):
    """A motor in a joint: constant torque, sinusoid, table or PD controller."""

    joint: int
    constant: float | None = None
    sinusoid: Sinusoid | None = None
    table: Table | None = None
    pd: PD | None = None
    limit: float = inf


@dataclass(frozen=True, slots=True, repr=False)
class RotorInertia(Effect):
    """The inertia of a rotor that turns with a joint."""

    joint: int
    armature: float


@dataclass(frozen=True, slots=True, repr=False)
class Payload(Effect):
    """A rigid body at the tip, fixed to the last link."""

    mass: float
    inertia: float = 0.0


@dataclass(frozen=True, slots=True, repr=False)
class Lock(Effect):
    """A joint locked at an angle: one degree of freedom less. It may join massless links."""

    joint: int
    angle: float | None = None


@dataclass(frozen=True, slots=True, repr=False)
class JointStop(Effect):
    """Stops at the ends of the range of a joint, with restitution."""

    joint: int
    range: Numbers
    restitution: float = 0.0
    capture_speed: float | None = None


@dataclass(frozen=True, slots=True, repr=False)
class DrivenPivot(Effect):
    """A pivot that is moved: a sinusoid for each axis, or a spline."""

    x: Sinusoid | None = None
    y: Sinusoid | None = None
    spline: Spline | None = None


@dataclass(frozen=True, slots=True, repr=False)
class CompiledUser(OwnEffect):
    """An effect of the user's own, as a compiled function of t, q and qd."""

    address: Any
    data: Any = 0
    breaks: Numbers = ()


@dataclass(frozen=True, slots=True, repr=False)
class User(OwnEffect):
    """An effect of the user's own, as a Python function of t, q and qd."""

    function: Callable[..., npt.ArrayLike]
    breaks: Numbers = ()

    def _as_pair(self) -> tuple[str, Any]:
        return self.kind, (self.function, self.breaks)


PARTS: dict[str, type[Part]] = {told.name: globals()[told.name] for told in described_parts()}
"""The classes of what parameters hold that have parameters of their own, by name."""

KINDS: dict[str, type[Effect]] = {told.kind: globals()[told.name] for told in described_effects()}
"""The classes of effects, by kind, in the order of the core's registry."""


def made(cls: type[Made], values: Mapping[str, Any], where: str | None = None) -> Made:
    """Make one of a mapping; what is wrong is told after ``where``, or the name of the class.

    A part may be a mapping itself.
    """
    where = f"{cls.__name__}: " if where is None else where
    require_known(where.rstrip(":. "), values, (p.name for p in cls.description.parameters))
    for p in cls.description.parameters:
        if p.required and p.name not in values:
            raise TypeError(f"{where}{p.name} is missing: {p.sentence}{in_unit(p.unit)}")
    new = object.__new__(cls)
    for parameter in cls.description.parameters:
        value: Any = values.get(parameter.name, parameter.default)
        if parameter.part and isinstance(value, Mapping):
            value = made(PARTS[parameter.part], value, f"{where}{parameter.name}.")
        object.__setattr__(new, parameter.name, value)
    new._settle(where)
    return new


def kinds() -> dict[str, type[Effect]]:
    """Return the class of every kind of effect, the kind as in case files.

    Examples
    --------
    >>> pc.effects.kinds()["viscous_joint"](joint=2, damping=0.05)
    ViscousJoint(joint=2, damping=0.05)
    >>> "lock" in pc.effects.kinds()
    True
    """
    return dict(KINDS)


def parts() -> dict[str, type[Part]]:
    """Return the class of every part of an effect, such as the sinusoid of a motor, by its name.

    Examples
    --------
    >>> "Sinusoid" in pc.effects.parts()
    True
    """
    return dict(PARTS)


def __getattr__(name: str) -> NoReturn:
    raise AttributeError(f"pendcore.effects has no {name!r}: {did_you_mean(name, __all__)}")


__all__ = [
    "PD",
    "CompiledUser",
    "DrivenPivot",
    "DryJointFriction",
    "Effect",
    "JointStop",
    "Lock",
    "Motor",
    "Part",
    "Payload",
    "RodDrag",
    "RotorInertia",
    "Sinusoid",
    "Spline",
    "Table",
    "TorsionalSpring",
    "User",
    "ViscousJoint",
    "kinds",
    "parts",
]
__dir__ = __all__.copy
