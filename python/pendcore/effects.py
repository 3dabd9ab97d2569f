"""What acts on a chain besides gravity: a class for each effect that the core has.

    import pendcore as pc

    pc.effects.ViscousJoint(joint=1, damping=0.1)
    pc.effects.Motor(joint=2, sinusoid=pc.effects.Sinusoid(amplitude=1.0, angular_frequency=6.0))
    pc.effects.kinds()               # every kind, as in case files, with its class

The classes are made from what the core says of each effect; effects.pyi shows them. docs/effects
has a page on each.
"""

from __future__ import annotations

from typing import NoReturn

from pendcore._messages.arguments import did_you_mean
from pendcore._scene.effect_class import KINDS, PARTS, Effect, Part

globals().update(PARTS | {cls.__name__: cls for cls in KINDS.values()})


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


__all__ = ["Effect", "Part", "kinds", "parts", *PARTS, *(cls.__name__ for cls in KINDS.values())]
