"""Where a chain truly is, and how well that is known.

A trajectory is computed in two kinds of numbers. Their distance is the error of the one with fewer
bits; that of the other is 2^-(bits more) of it, and counted `MARGIN` bits larger. The rounding of
constants, of the state and of times, the step sizes and how errors grow are all in that distance.
Where it does not suffice, a third kind with yet more digits is used.
"""

from __future__ import annotations

from time import monotonic
from typing import NamedTuple

import numpy as np

from true_error.arithmetic import LADDER, Arithmetic, Floats, Longs
from true_error.asked import Drawn
from true_error.curve import angles_apart, positions_apart
from true_error.switched import SwitchedTrajectory
from true_error.trajectory import NoReferenceError, Trajectory

MARGIN = 4
"""Bits by which a reference may be worse than its bits promise."""
LOST = 0.02
"""A larger distance says nothing of the smaller error, which does not follow it."""


class Truth(NamedTuple):
    """Where a chain truly is at some times.

    Attributes
    ----------
    angles : ndarray, (n_t, n)
        Absolute angles, rad.
    unsure, unsure_angle : ndarrays, (n_t,)
        The error of positions, as a share of the total length, and of angles, rad, up to each of
        the times; infinite where it is not known.
    coarse : ndarray, (n_t,)
        The error of the same integrator in numbers of fewer bits, as a share of the total length.
    """

    angles: Longs
    unsure: Floats
    unsure_angle: Floats
    coarse: Floats


class Reference:
    """The truth of a drawn scene.

    Parameters
    ----------
    drawn : Drawn
    seconds : float
        The time that all of it may take.
    """

    def __init__(self, drawn: Drawn, seconds: float) -> None:
        self.drawn = drawn
        self.left = seconds
        self._ladder = [trajectory(drawn, arithmetic) for arithmetic in LADDER]

    def angles(self, t: Floats, *, finest: bool = False) -> Truth:
        """Return the absolute angles at times (n_t,), s, in the order of the run.

        Parameters
        ----------
        t : ndarray, (n_t,)
        finest : bool
            Whether to ask for the most digits, which takes a hundred times longer.

        Raises
        ------
        NoReferenceError
            Where they cannot be computed, or not in time.
        """
        coarse, fine = self._ladder[1:] if finest else self._ladder[:2]
        began = monotonic()
        try:
            for motion in (coarse, fine):
                motion.extend(t[-1], began + self.left)
        except (ArithmeticError, ValueError, NotImplementedError) as stop:
            raise NoReferenceError(f"{type(stop).__name__}: {stop}") from stop
        finally:
            self.left -= monotonic() - began
        rough, truth = coarse.angles(t), fine.angles(t)
        gained = 2.0 ** (coarse.arithmetic.bits - fine.arithmetic.bits + MARGIN)
        apart, angle = positions_apart(self.drawn.scene, rough, truth), angles_apart(rough, truth)
        followed = np.maximum.accumulate(apart) < LOST
        return Truth(
            angles=truth,
            unsure=np.where(followed, np.maximum.accumulate(apart) * gained, np.inf),
            unsure_angle=np.where(followed, np.maximum.accumulate(angle) * gained, np.inf),
            coarse=apart,
        )


def trajectory(drawn: Drawn, arithmetic: Arithmetic) -> Trajectory:
    """Return the motion of a drawn scene in one kind of numbers, of the kind that it takes."""
    return (SwitchedTrajectory if drawn.is_switched else Trajectory)(drawn, arithmetic)
