"""When a uniform rod that swings passes an angle, by elliptic integrals; when rods fall over."""

from __future__ import annotations

from typing import Any

import numpy as np
from dense_chain import DenseChain
from hybrid_chain import extrapolated_step
from mpmath import asin, ellipf, ellipk, mp, mpf, sin, sqrt


def time_to(mark: Any, amplitude: Any, gravity: Any, length: Any = 1) -> Any:
    """When a rod that is let go at an amplitude from hanging first passes a mark, s."""
    with mp.workdps(50):
        k = sin(mpf(amplitude) / 2)
        passed = ellipf(asin(sin(mpf(mark) / 2) / k), k**2)
        return (ellipk(k**2) - passed) * sqrt(2 * mpf(length) / (3 * mpf(gravity)))


def period_of(amplitude: Any, gravity: Any, length: Any = 1) -> Any:
    return 4 * time_to(0, amplitude, gravity, length)


def time_of_fall(links: int, start: float, gravity: float) -> float:
    """When one or two rods of 1 m that stand nearly upright, to the last digit, are 1 rad off, s.

    One by elliptic integrals; two in angles from upright, where nothing is lost by rounding.
    """
    with mp.workdps(50):
        off = mpf(start) + mp.pi / 2
        if links == 1:
            return float(time_to(mp.pi - 1, mp.pi - off, gravity))
    chain = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=gravity)

    def rates(_: float, y: Any) -> Any:
        x, xd = np.split(y, 2)
        spun = (chain.couplings * np.sin(x[:, None] - x)) @ xd**2
        falls = chain.moments * chain.gravity * np.sin(x)
        return np.append(xd, np.linalg.solve(chain.mass_matrix(x), falls - spun))

    t, h, y = 0.0, 0.03, np.array([float(off), float(off), 0.0, 0.0])
    while h > 1e-13:
        after = extrapolated_step(rates, t, y, h)
        if np.abs(after[:2]).max() < 1:
            t, y = t + h, after
        else:
            h /= 2
    return t
