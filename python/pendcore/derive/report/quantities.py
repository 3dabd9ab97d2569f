"""Numbers with their units, in LaTeX: six digits, as a solution by hand would give them."""

from __future__ import annotations

import re
from collections.abc import Iterable
from math import isfinite

from pendcore.derive.derivation import Derivation

DIGITS = 6
ROUNDING = 1e-12
"""Below this share of the scale of its kind, a number is what rounding leaves of 0."""


def number(value: float, digits: int = DIGITS) -> str:
    """Return a number: 0.0833333, 1.5 x 10^-7."""
    if not isfinite(value):
        return r"\text{not a number}"
    mantissa, _, exponent = f"{value + 0.0:.{digits}g}".partition("e")
    return rf"{mantissa} \times 10^{{{int(exponent)}}}" if exponent else mantissa


def unit(name: str) -> str:
    """Return a unit, upright: kg m^2, m/s^2, N m s/rad; nothing for a ratio."""
    if name == "1":
        return ""
    upright = re.sub(r"[A-Za-z]+", lambda word: rf"\text{{{word[0]}}}", name)
    return re.sub(r"\^(\d+)", r"^{\1}", upright).replace(" ", r"\,")


def quantity(value: float, name: str, digits: int = DIGITS) -> str:
    """Return a number and its unit."""
    return rf"{number(value, digits)}\;{unit(name)}".removesuffix(r"\;")


class Scales:
    """Scales by unit, and which numbers are 0 but for rounding.

    A force is measured by the weights, an acceleration by g over the shortest length, a couple or
    an energy by the weights times the lengths, or by the largest ``found`` of its unit where that
    is larger.
    """

    def __init__(self, derivation: Derivation, found: Iterable[tuple[str, float]] = ()) -> None:
        scene, values = derivation.scene, derivation.values
        lengths = [abs(link.length) for link in scene.links]
        mass = sum(float(body.mass.xreplace(values)) for body in derivation.equations.bodies)
        gravity = abs(scene.gravity)
        moment = mass * gravity * sum(lengths)
        self.of = {"rad/s^2": gravity / min(lengths), "N": mass * gravity, "N m": moment,
                   "J": moment}  # fmt: skip
        for name, value in found:
            self.of[name] = max(self.of.get(name, 0.0), abs(value))

    def shown(self, value: float, name: str) -> float:
        """Return a number as it is printed."""
        return value if abs(value) >= ROUNDING * self.of.get(name, 0.0) else 0.0
