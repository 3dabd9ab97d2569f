"""What a refused error is told: the cause, and a least error that is kept when it is asked for."""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as E

BOOK = pc.Scene.textbook()
CHAOTIC = ([-1.5, -1.4], 0, (0, 100))


def damped(damping: float) -> pc.Scene:
    return BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=damping)])


def test_the_rounding_of_large_angles_is_told() -> None:
    with pytest.raises(pc.AccuracyError, match="to 1e-10 rad; begin with fewer turns") as caught:
        pc.simulate(BOOK, [1e6, 1e6 + 0.5], 0, (0, 5), error=1e-9)
    turns = 2 * np.pi * round(1e6 / (2 * np.pi))
    fewer = pc.simulate(BOOK, [1e6 - turns, 1e6 - turns + 0.5], 0, (0, 5), error=1e-9)
    assert fewer.accuracy is not None
    assert fewer.accuracy.reached
    assert caught.value.least > 1e-9


def test_turns_are_not_to_blame_for_chaos() -> None:
    q0, qd0, span = CHAOTIC
    with pytest.raises(pc.AccuracyError, match="neighbouring motions part too fast"):
        pc.simulate(BOOK, np.array(q0) + 34 * np.pi, qd0, span, error=1e-3)


@pytest.mark.parametrize(
    ("scene", "q0", "t_end", "error"),
    [
        (BOOK, [-1.2, -0.6], 12, 1e-9),
        (BOOK.replace(gravity=0.0), [1, 2], 30, 1e-15),
        (BOOK, [np.pi / 2] * 2, 30, 1e-14),
        (damped(300.0), [0.8, 1.0], 2, 1e-13),
        (damped(1e7), [0.7, 1.0], 3, 3e-13),  # stiff: no trial is looser than the tightest
    ],
)
def test_the_least_error_is_kept(
    scene: pc.Scene, q0: list[float], t_end: float, error: float
) -> None:
    with pytest.raises(pc.AccuracyError) as caught:
        pc.simulate(scene, q0, 0, (0, t_end), error=error)
    least = caught.value.least
    assert f"ask for error = {least:.1e} or more" in str(caught.value)
    told = pc.simulate(scene, q0, 0, (0, t_end), error=least).accuracy
    assert told is not None
    assert told.reached
