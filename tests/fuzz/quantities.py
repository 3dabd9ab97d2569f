"""Random numbers as scenes have them: ordinary ones, extreme ones, and any that a double can be."""

from __future__ import annotations

from math import pi

from fuzz.choices import Choices, happens

REGIMES = ("ordinary", "extreme", "any")
SPECIAL = (5e-324, 2.2250738585072014e-308, 1e-160, 1e-20, 1e20, 1e150, 1e154, 1e200, 1e300)
ROUND = (0.0, 1.0, 0.5, 2.0, 0.1, 3.0, 10.0)
ANGLES = (0.0, pi / 2, -pi / 2, pi, pi / 4, 2 * pi, 1e-9, 3.0, -1.0)


def regime(choices: Choices) -> str:
    """How far from ordinary the numbers of a case are."""
    return choices.one_of(("ordinary",) * 6 + ("extreme",) * 3 + ("any",))


def size(choices: Choices, regime: str) -> float:
    """Return a positive number, around 1 if ordinary."""
    if happens(choices, 3):
        regime = choices.one_of(REGIMES)
    if regime == "ordinary":
        if happens(choices, 25):
            return choices.one_of(ROUND[1:])
        return float(10 ** choices.real(-1, 1))
    if regime == "extreme":
        return float(10 ** choices.real(-12, 12))
    if happens(choices, 30):
        return choices.one_of(SPECIAL)
    return float(10 ** choices.real(-320, 308))


def non_negative(choices: Choices, regime: str) -> float:
    """Return a size, or zero."""
    return 0.0 if happens(choices, 10) else size(choices, regime)


def signed(choices: Choices, regime: str) -> float:
    """Return any number."""
    return choices.one_of((1.0, -1.0)) * non_negative(choices, regime)


def angle(choices: Choices, regime: str) -> float:
    """Return an angle, rad: of a turn or two if ordinary, round ones among them."""
    if regime == "ordinary" and not happens(choices, 2):
        return choices.one_of(ANGLES) if happens(choices, 25) else choices.real(-4, 4)
    return signed(choices, regime)
