"""Numbers with their units, in LaTeX: six digits, as a solution by hand would give them."""

from __future__ import annotations

import re
from math import isfinite

DIGITS = 6


def number(value: float, digits: int = DIGITS) -> str:
    """Return a number: 0.0833333, 1.5 x 10^-7."""
    if not isfinite(value):
        return r"\text{not a number}"
    text = f"{value + 0.0:.{digits}g}"
    if "e" not in text:
        return text
    mantissa, exponent = text.split("e")
    return rf"{mantissa} \times 10^{{{int(exponent)}}}"


def unit(name: str) -> str:
    """Return a unit, upright: kg m^2, m/s^2, N m s/rad; nothing for a ratio."""
    if name in ("", "1"):
        return ""
    above, slash, below = name.partition("/")
    return _factors(above) + ("/" + _factors(below) if slash else "")


def quantity(value: float, name: str, digits: int = DIGITS) -> str:
    """Return a number and its unit."""
    shown = unit(name)
    return number(value, digits) + (rf"\;{shown}" if shown else "")


def _factors(product: str) -> str:
    parts = []
    for factor in product.split():
        base, _, power = factor.partition("^")
        base = re.sub(r"[()]", "", base)
        parts.append(rf"\text{{{base}}}" + (f"^{{{power}}}" if power else ""))
    return r"\,".join(parts)
