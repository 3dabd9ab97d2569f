"""What acts on the links of a chain at one instant, as the equations of motion take it.

Links and joints count from 1. A value comes with its size: how large the terms are that it was
added up from. Where terms cancel, rounding leaves an error of that size, not of the value's.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from reference.arithmetic import Number

Vector = tuple[Number, Number]


@dataclass(slots=True)
class Sum:
    """A sum under way."""

    value: Number = 0
    size: Number = 0

    def add(self, term: Number, size: Number | None = None) -> None:
        """Add a term; its size is its own magnitude unless it is a sum itself."""
        self.value = self.value + term
        self.size = self.size + (abs(term) if size is None else size)


@dataclass(slots=True)
class Loads:
    """Forces and couples on n links, and what else an effect may change in their equations."""

    n: int
    couples: list[Sum] = field(init=False)
    """On each link."""
    forces: list[tuple[Sum, Sum]] = field(init=False)
    """On each link at its mass centre, x and y."""
    pivot_acceleration: Vector = (0, 0)
    pivot_size: Number = 0
    armatures: list[Number] = field(init=False)
    """At each joint: the inertia of a rotor that turns with its relative angle."""
    payloads: list[tuple[Number, Number]] = field(default_factory=list)
    """Mass and inertia of what is welded to the tip."""
    locked: set[int] = field(default_factory=set)
    """Joints that do not turn."""

    def __post_init__(self) -> None:
        self.couples = [Sum() for _ in range(self.n)]
        self.forces = [(Sum(), Sum()) for _ in range(self.n)]
        self.armatures = [0] * self.n

    def couple_on_link(self, link: int, term: Number, size: Number | None = None) -> None:
        """Add a couple from outside the chain."""
        self.couples[link - 1].add(term, size)

    def couple_at_joint(self, joint: int, term: Number, size: Number | None = None) -> None:
        """Add a couple on the link beyond a joint and its opposite on the link before."""
        self.couple_on_link(joint, term, size)
        if joint > 1:
            self.couple_on_link(joint - 1, -term, size)

    def force_on_link(self, link: int, force: Vector, size: Number) -> None:
        """Add a force that acts at the mass centre."""
        for total, component in zip(self.forces[link - 1], force, strict=True):
            total.add(component, size)
