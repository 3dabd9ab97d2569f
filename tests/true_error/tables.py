"""What begins and ends at given times: tables of torque, splines of the pivot, pulses."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise
from typing import Any

import pendcore as pc
from reference.arithmetic import eliminate
from reference.curves import second_derivatives

from true_error.constants import Parameters


@dataclass
class Tables:
    """What begins and ends at given times, s: intervals of (begin, end, parameters)."""

    intervals: list[tuple[float, float, Parameters]]


def tables_of(scene: pc.Scene, nothing: float) -> list[Tables]:
    """Return what begins and ends at given times: tables of torque, splines of the pivot, pulses.

    A pulse is one where it is more than nothing: see `Friction.is_far`.
    """
    found = []
    for effect in scene.effects:
        if effect.kind == "motor" and effect.table is not None:
            j = effect.joint - 1
            points = list(zip(effect.table.t, effect.table.torque, strict=True))
            found.append(_linear([(f"c{j}", f"d{j}", points)], effect.table.hold))
        elif effect.kind == "driven_pivot" and effect.spline is not None:
            spline = effect.spline
            found.append(_linear([
                (axis + "c", axis + "d", list(zip(spline.t, bends(spline.t, along), strict=True)))
                for axis, along in (("x", spline.x), ("y", spline.y))
            ]))  # fmt: skip
        elif getattr(getattr(effect, "function", None), "name", "") == "pulse":
            j, (height, middle, width) = effect.function.joint - 1, effect.function.values
            reach = width * nothing**0.5
            ends = middle - reach, middle + reach
            values = {f"gh{j}": height, f"gm{j}": middle, f"gi{j}": 1 / Fraction(width)}
            exact = {name: Fraction(value) for name, value in values.items()}
            found.append(Tables([(*ends, exact)]))
    return found


def _linear(of: list[tuple[str, str, list[tuple[Any, Any]]]], hold: bool = False) -> Tables:
    intervals: dict[tuple[float, float], Parameters] = {}
    for constant, slope, points in of:
        exact = [(Fraction(t), Fraction(value)) for t, value in points]
        for (t0, a), (t1, b) in pairwise(exact):
            if t0 == t1:
                continue
            rise = Fraction(0) if hold else (b - a) / (t1 - t0)
            values = intervals.setdefault((float(t0), float(t1)), {})
            values |= {constant: a - rise * t0, slope: rise}
    return Tables([(*ends, values) for ends, values in intervals.items()])


def bends(t: tuple[float, ...], x: tuple[float, ...]) -> list[Fraction]:
    """Return the second derivatives of the natural cubic spline through points, exactly."""
    return second_derivatives([*map(Fraction, t)], [*map(Fraction, x)], eliminate)
