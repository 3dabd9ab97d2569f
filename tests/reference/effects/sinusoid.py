"""amplitude sin(angular_frequency t + phase), with its first two derivatives."""

from __future__ import annotations

from collections.abc import Mapping

from reference.arithmetic import Arithmetic, Number


def sinusoid(
    t: Number, described: Mapping[str, float], arithmetic: Arithmetic
) -> tuple[Number, Number, Number]:
    """Return value, rate and acceleration at a time."""
    number = arithmetic.number
    amplitude, w = number(described["amplitude"]), number(described["angular_frequency"])
    argument = w * number(t) + number(described.get("phase", 0.0))
    sine, cosine = arithmetic.sin(argument), arithmetic.cos(argument)
    return amplitude * sine, amplitude * w * cosine, -amplitude * w * w * sine
