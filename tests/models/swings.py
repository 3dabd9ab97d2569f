"""When a uniform rod that swings on a pivot passes an angle from hanging, by elliptic integrals."""

from __future__ import annotations

from typing import Any

from mpmath import asin, ellipf, ellipk, mp, mpf, sin, sqrt


def time_to(mark: Any, amplitude: Any, gravity: Any, length: Any = 1) -> Any:
    """When a rod that is let go at an amplitude from hanging first passes a mark, s."""
    with mp.workdps(50):
        k = sin(mpf(amplitude) / 2)
        passed = ellipf(asin(sin(mpf(mark) / 2) / k), k**2)
        return (ellipk(k**2) - passed) * sqrt(2 * mpf(length) / (3 * mpf(gravity)))


def period_of(amplitude: Any, gravity: Any, length: Any = 1) -> Any:
    return 4 * time_to(0, amplitude, gravity, length)
