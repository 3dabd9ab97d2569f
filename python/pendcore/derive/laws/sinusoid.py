"""A sinusoid of time in symbols: amplitude sin(angular_frequency t + phase)."""

from __future__ import annotations

from typing import Any, NamedTuple

from sympy import Expr, Integer, sin

from pendcore.derive.notation import Notation


class Named(NamedTuple):
    """The names of a sinusoid's symbols, its unit, and its meaning in words."""

    text: str
    latex: str
    amplitude: str
    amplitude_latex: str
    unit: str
    meaning: str


def sinusoid(wave: Any, notation: Notation, named: Named) -> Expr:
    """Return the law of a `pendcore.effects.Sinusoid`, with symbols for its numbers."""
    amplitude = notation.parameter(
        named.amplitude, named.amplitude_latex, wave.amplitude, named.unit,
        f"amplitude of {named.meaning}",
    )  # fmt: skip
    frequency = notation.parameter(
        f"Omega_{named.text}", rf"\Omega_{{{named.latex}}}", wave.angular_frequency, "rad/s",
        f"angular frequency of {named.meaning}",
    )  # fmt: skip
    phase: Expr = Integer(0)
    if wave.phase != 0.0:
        phase = notation.parameter(
            f"psi_{named.text}", rf"\psi_{{{named.latex}}}", wave.phase, "rad",
            f"phase of {named.meaning}",
        )  # fmt: skip
    return amplitude * sin(frequency * notation.t + phase)
