"""Tables of torques lose no digits, wherever in time they lie: against exact fractions."""

from __future__ import annotations

from fractions import Fraction
from itertools import pairwise

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx


def torque_of(table: fx.Table, t: float) -> Fraction:
    knots = zip(map(Fraction, table.t), map(Fraction, table.torque), strict=True)
    for (t0, before), (t1, after) in pairwise(knots):
        if t0 <= t < t1:
            return before + (after - before) / (t1 - t0) * (Fraction(t) - t0)
    raise AssertionError(t)


@pytest.mark.parametrize("begin", [0.0, -0.05, -0.3, -1.0, -10.0, -1000.0, -1e6, 1000.0])
@pytest.mark.parametrize("number", [1, 2])
def test_a_torque_is_right_to_its_last_digits(number: int, begin: float) -> None:
    one = fx.Table(t=[begin, begin + 0.125, begin + 0.4], torque=[0.0, 1.0, -0.5])
    other = fx.Table(t=[begin, begin + 0.25, begin + 0.5], torque=[0.25, -1.0, 1.0])
    tables = [one, other][:number]
    motors = [fx.Motor(1, constant=0.125), *(fx.Motor(1, table=table) for table in tables)]
    rod = pc.Link(mass=3, length=1)  # 1 kg m^2
    scene = pc.Scene(links=[rod], gravity=0, effects=motors)
    for t in np.linspace(begin, begin + 0.4, 97)[1:-1].tolist():
        torque = Fraction(scene.accelerations(t, [0.0], [0.0]).item())
        off = torque - Fraction(0.125) - sum(torque_of(table, t) for table in tables)
        assert abs(off) <= 4 * np.finfo(float).eps
