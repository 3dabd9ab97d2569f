"""Events at elastic impacts are told along the run in backward runs, just as in forward ones."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import rod


def test_elastic_impacts_are_events_on_the_way_back_too(fine: Any) -> None:
    """A rod of inertia 1 falls from 0.4 with -2, to the stop after T = sqrt 0.4, 3 T, 5 T, ...

    The rod passes 0.3 when T/2 from its highest points, which come at 2 T, 4 T, ...
    """
    stop = fx.JointStop(joint=1, range=(0.0, np.inf), restitution=1.0)
    scene = rod(fx.Motor(joint=1, constant=-2.0), stop)
    watched = [ev.JointAngle(joint=1, value=0.0), ev.RateZero(joint=1), ev.JointAngle(1, 0.3)]
    fall, rate = np.sqrt(0.4), 2 * np.sqrt(0.4)
    sol = pc.simulate(scene, q0=0.4, qd0=0.0, t_span=(0, -6.2), events=watched, **fine)
    touches, zeros, passed = sol.events
    assert [one.t for one in touches] == pytest.approx(-fall * np.arange(1, 10, 2), abs=1e-10)
    assert [one.t for one in zeros] == pytest.approx(-fall * np.arange(1, 10), abs=1e-10)
    assert [one.t for one in passed] == pytest.approx(-fall * np.arange(0.5, 10), abs=1e-10)
    for one in [*touches, *zeros[::2]]:
        assert one.direction == -1  # along the run angle and rate fall, the rate from + to -
        np.testing.assert_allclose(one.y_before, [0, rate], atol=1e-9)
        np.testing.assert_allclose(one.y_after, [0, -rate], atol=1e-9)
    for one in zeros[1::2]:
        assert (one.direction, one.y_before, one.y_after) == (1, None, None)
    assert [one.direction for one in passed] == [-1, 1] * 5


def test_what_elastic_impacts_of_a_chain_are_found_backward_is_found_of_its_mirror(
    fine: Any,
) -> None:
    stops = [fx.JointStop(joint=j, range=(-0.4, 0.3), restitution=1.0) for j in (2, 3)]
    scene = rod(*stops, links=3, gravity=9.81)
    watched = [
        *(ev.JointAngle(joint=2, value=x) for x in (-0.4, 0.1, 0.3)),
        ev.TipLine(point=(0.3, 1.0), normal=(1.0, 0.2)),
        ev.RateZero(joint=3),
    ]
    rates = np.array([0.5, 2.0, -3.0])

    def run(sign: int) -> pc.Solution:
        return pc.simulate(
            scene,
            q0=[1.0, 1.1, 1.2],
            qd0=sign * rates,
            t_span=(0, sign * 3.0),
            events=watched,
            **fine,
        )

    turned = np.array([1.0] * 3 + [-1.0] * 3)
    jumps = 0
    for k, (there, back) in enumerate(zip(run(1).events, run(-1).events, strict=True)):
        assert len(there) == len(back) > 0
        for one, other in zip(there, back, strict=True):
            assert (other.t, other.direction) == (-one.t, one.direction * (-1 if k == 4 else 1))
            assert (other.y_before is None) == (one.y_before is None)
            np.testing.assert_array_equal(other.y, one.y * turned)
            if one.y_before is not None:
                jumps += 1
                np.testing.assert_array_equal(other.y_before, one.y_before * turned)
                np.testing.assert_array_equal(other.y_after, one.y_after * turned)
    assert jumps > 10
