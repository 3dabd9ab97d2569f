"""Scales of quantities: forces are measured by weights, accelerations by g over a length."""

from __future__ import annotations

from collections.abc import Iterable

from pendcore.derive.algebra import Algebra

ROUNDING = 1e-12
"""Below this share of the scale of its kind, a number is what rounding leaves of 0."""


class Scales:
    """Scales by unit, and which numbers are 0 but for rounding.

    Parameters
    ----------
    derivation : Algebra
        The derivation that has masses, lengths and gravity.
    found : iterable of (str, float)
        Numbers with their units; where one is larger than the scale of its unit, it is the scale.
    """

    def __init__(self, derivation: Algebra, found: Iterable[tuple[str, float]] = ()) -> None:
        scene, payload = derivation.scene, derivation.equations.payload
        lengths = [abs(link.length) for link in scene.links]
        mass = sum(link.mass for link in scene.links)
        if payload is not None:
            mass += float(payload.mass.xreplace(derivation.values))
        weight, gravity = mass * abs(scene.gravity), abs(scene.gravity)
        moment = weight * sum(lengths)
        self.of = {"rad/s^2": gravity / min(lengths), "N": weight, "N m": moment, "J": moment}
        for unit, value in found:
            self.of[unit] = max(self.of.get(unit, 0.0), abs(value))

    def shown(self, value: float, unit: str) -> float:
        """Return a number as it is printed."""
        return value if abs(value) >= ROUNDING * self.of.get(unit, 0.0) else 0.0
