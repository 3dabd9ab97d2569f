"""Random chains and what acts on them, from the descriptions of the effects alone.

An effect that is added to the core is drawn here as soon as it is there.
"""

from __future__ import annotations

import warnings
from math import inf
from typing import Any

import pendcore as pc
from pendcore._scene.effect_class import OwnEffect
from pendcore._scene.effect_description import Description, Parameter
from pendcore.effects import KINDS

from fuzz import own_functions
from fuzz.choices import Choices, angle, happens, non_negative, signed, size

KINDS_OF_NUMBERS = tuple(sorted(k for k, cls in KINDS.items() if not issubclass(cls, OwnEffect)))
"""The kinds of effects that are made of numbers."""


class SceneMaker:
    """Draws what belongs to one chain of n links whose run lasts from `first` to `last`."""

    def __init__(self, choices: Choices, regime: str, n: int, first: float, last: float) -> None:
        self.choices = choices
        self.regime = regime
        self.n = n
        self.first = first
        self.last = last

    def link(self) -> pc.Link:
        choices, regime = self.choices, self.regime
        mass, length = size(choices, regime), size(choices, regime)
        shape = choices.one_of(("rod", "rod", "point", "lump", "massless"))
        if shape == "point":
            return pc.Link.point_mass(mass=mass, length=length)
        if shape == "massless" and regime != "ordinary":
            return pc.Link(mass=0.0, length=length)
        if shape == "lump":
            center = length * choices.real(-0.5, 1.5)
            inertia = mass * length * length * choices.real(0.01, 0.3)
            return pc.Link(mass=mass, length=length, center=center, inertia=inertia)
        return pc.Link(mass=mass, length=length)

    def effect(self, kind: str) -> Any:
        """Return an effect of a kind, or None where eight tries met values that do not agree."""
        if kind == "user":
            name = self.choices.one_of(own_functions.NAMES)
            return pc.effects.User(own_functions.Forces(name, self.n))
        for _ in range(8):
            try:
                return self.of(KINDS[kind])
            except ValueError:
                continue
        return None

    def of(self, cls: Any) -> Any:
        told: Description = cls.description
        chosen = [p for p in told.parameters if p.required or happens(self.choices, 50)]
        points = self.choices.integer(2, 6)
        return cls(**{p.name: self.value(p, points) for p in chosen})

    def value(self, p: Parameter, points: int) -> Any:
        if p.part:
            return self.of(getattr(pc.effects, p.part))
        if p.type == "bool":
            return happens(self.choices, 50)
        if p.type == "int":
            return self.choices.integer(1, self.n)
        if p.type == "pair" and "range" in p.name:
            return tuple(sorted((self.bound(-inf), self.bound(inf))))
        if p.type == "pair":
            return (self.number(p), self.number(p))
        if p.type == "floats":
            return self.times(points) if p.name == "t" else [self.number(p) for _ in range(points)]
        return self.number(p)

    def number(self, p: Parameter) -> float:
        """Return a number of the range that a description tells in words."""
        choices, regime = self.choices, self.regime
        if "inf" in p.range and "finite" not in p.range and happens(choices, 20):
            return inf
        if "1" in p.range and "0" in p.range and ">" not in p.range:
            return choices.one_of((0.0, 1.0, choices.real(0, 1)))
        if ">= 1" in p.range:
            return 1.0 + non_negative(choices, regime)
        if ">= 0" in p.range:
            return non_negative(choices, regime)
        if "> 0" in p.range:
            return size(choices, regime)
        if p.unit == "rad":
            return angle(choices, regime)
        value = signed(choices, regime)
        # Negative damping ends most runs in a blow-up: let that be the smaller part.
        return abs(value) if "damping" in p.name and happens(choices, 80) else value

    def bound(self, open_end: float) -> float:
        return open_end if happens(self.choices, 25) else angle(self.choices, self.regime)

    def times(self, points: int) -> list[float]:
        """Return knots that mostly enclose the run."""
        first, last = min(self.first, self.last), max(self.first, self.last)
        length = (last - first) or 1.0
        if happens(self.choices, 80):
            low, high = first - 0.1 * length, last + 0.1 * length
        else:
            low, high = first + self.choices.real(-1, 1) * length, last + length
        inner = [low + (high - low) * self.choices.real(0, 1) for _ in range(points - 2)]
        return [low, *sorted(inner), high]


def scene(choices: Choices, regime: str, span: tuple[float, float]) -> pc.Scene:
    """Return a scene; raises ValueError where eight tries met parts that do not agree."""
    for _ in range(7):
        try:
            return _one_scene(choices, regime, span)
        except ValueError:
            continue
    return _one_scene(choices, regime, span)


def _one_scene(choices: Choices, regime: str, span: tuple[float, float]) -> pc.Scene:
    n = choices.one_of((1, 2, 2, 3, 4, 5, 6))
    maker = SceneMaker(choices, regime, n, *span)
    links = [maker.link() for _ in range(n)]
    count = choices.one_of((0, 0, 1, 1, 1, 2, 2, 3, 4, 6))
    effects = [maker.effect(choices.one_of(KINDS_OF_NUMBERS)) for _ in range(count)]
    if happens(choices, 4):
        effects.append(maker.effect("user"))
    gravity = choices.one_of((9.807, 9.807, 0.0, signed(choices, regime)))
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=links, gravity=gravity, effects=[e for e in effects if e])
