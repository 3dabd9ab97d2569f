"""The start within its noise from which a simulation stays nearest to a measured swing.

The fit minimises the largest of two kinds of ratios: each difference between simulated and measured
angle over the bound that it has to keep, and each correction of the start over the noise that it
has to stay within. A largest value has no derivative, so it is approached through the p-norm

    ||r||_p = (sum of abs(r_k)^p)^(1/p),      p = 2, 4, 8, 16, 32

each norm from the minimum of the one before. With J the derivatives of the ratios (finite
differences), the step of Gauss and Newton has weights abs(r_k)^(p - 2); it is halved until the norm
falls.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

POWERS = (2, 4, 8, 16, 32)
STEPS_PER_POWER = 6
DIFFERENCE = 0.01  # of the noise: what one correction is changed by to find a derivative


class Fit(NamedTuple):
    """A fitted start."""

    start: Array
    """q_1 .. q_n, qd_1 .. qd_n."""
    correction: float
    """The largest correction, over its noise."""
    difference: float
    """The largest difference of angles, over its bound."""


def p_norm(r: Array, p: int) -> float:
    """The p-norm without overflow."""
    largest = float(np.abs(r).max())
    return largest * float(np.sum((np.abs(r) / largest) ** p)) ** (1 / p)


def fit_start(
    angles_from: Callable[[Array], Array],
    measured: Array,
    start: Array,
    *,
    noise: Array,
    bound: float,
) -> Fit:
    """Fit the start of a simulation to a measured swing.

    Parameters
    ----------
    angles_from
        Simulates from a start, (2n,): the angles at the times of the measurement, (n_t, n), rad.
    measured
        The measured angles, (n_t, n), rad.
    start
        The measured start, q_1 .. q_n, qd_1 .. qd_n.
    noise
        How far each of those may be off, (2n,), rad and rad/s.
    bound
        How far a simulated angle may be from the measured one, rad.
    """
    size = len(start)

    def ratios(correction: Array) -> Array:
        off = angles_from(start + correction * noise) - measured
        return np.concatenate([off.ravel() / bound, correction])

    correction = np.zeros(size)
    r = ratios(correction)
    for p in POWERS:
        for _ in range(STEPS_PER_POWER):
            shifted = [ratios(correction + DIFFERENCE * unit) for unit in np.eye(size)]
            jacobian = np.stack([(ahead - r) / DIFFERENCE for ahead in shifted], axis=1)
            root = (np.abs(r) / np.abs(r).max()) ** ((p - 2) / 2)
            step = np.linalg.lstsq(jacobian * root[:, None], -r * root)[0]
            for halving in range(10):
                tried = correction + step / 2**halving
                if p_norm(r_tried := ratios(tried), p) < p_norm(r, p):
                    correction, r = tried, r_tried
                    break
            else:
                break
    return Fit(
        start + correction * noise, float(np.abs(correction).max()), float(np.abs(r[:-size]).max())
    )
