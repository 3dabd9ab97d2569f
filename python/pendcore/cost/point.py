"""A point of a work-precision diagram, and the front of those that no other beats.

Between the points of the front, log time is taken to be linear in log error.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

_UNITS = ((1e-3, 1e6, "us"), (1.0, 1e3, "ms"), (float("inf"), 1.0, "s"))


@dataclass(frozen=True, slots=True, kw_only=True)
class Point:
    """What one method does at one tolerance, or with one fixed step.

    Attributes
    ----------
    method : str
    rtol, atol : float or None
        None where the step is fixed.
    step : float or None
        Fixed step, s.
    error : float
        Largest distance of a joint or the tip from the reference, as a share of the total length;
        infinite if the run failed.
    seconds, median : float
        The least and the median time of a call, s; infinite if it failed.
    repeats : int
        How many calls were timed.
    nfev : int
        Right-hand sides; of ``taylor``, series.
    accepted : int
        Steps.
    failure : str
        Why there is no error; empty if there is one.
    """

    method: str
    rtol: float | None = None
    atol: float | None = None
    step: float | None = None
    error: float = inf
    seconds: float = inf
    median: float = inf
    repeats: int = 0
    nfev: int = 0
    accepted: int = 0
    failure: str = ""

    @property
    def setting(self) -> str:
        """How the method is called, for people."""
        if self.step is not None:
            return f"step {self.step:.3g} s"
        return f"rtol {self.rtol:.3g}"


def front(points: Iterable[Point], uncertainty: float) -> list[Point]:
    """Return the points that no other beats in both error and time, the cheapest first.

    Errors below the uncertainty of the reference count as equal to it.
    """
    kept: list[Point] = []
    for point in sorted(points, key=lambda p: (max(p.error, uncertainty), p.seconds)):
        if point.error < inf and point.seconds < (kept[-1].seconds if kept else inf):
            kept.append(point)
    return kept[::-1]


def seconds_at(error: float, points: Sequence[Point], uncertainty: float) -> float | None:
    """Return the time at which the front reaches an error, s; None beyond its best."""
    errors = [max(p.error, uncertainty, 1e-300) for p in reversed(points)]  # 0 has no logarithm
    if not errors or error < errors[0]:
        return None
    seconds = [p.seconds for p in reversed(points)]
    return float(np.exp(np.interp(np.log(error), np.log(errors), np.log(seconds))))


def duration(seconds: float) -> str:
    """Return a time in three digits and the unit that suits it."""
    for below, factor, unit in _UNITS:
        if seconds < below:
            return f"{seconds * factor:.3g} {unit}"
    return "-"
