"""How far apart two computed motions are.

The measure is the distance between the same joint, or the tip, in both, the largest over the joints
and the tip, divided by the total length: of the order of 1 where the two have nothing in common any
more, and 0 for angles that differ by whole turns. Of link i with the length L_i it is

    L_i (exp(i q) - exp(i r)) = 2 i L_i sin((q - r)/2) exp(i (q + r)/2)

in the complex plane, summed from the pivot outwards; the right-hand side loses no digits where q
and r are close.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from pendcore.arguments import Floats
from pendcore.scene import Scene
from pendcore.solution import Solution

POINTS = 101
"""Times of the fixed grid on which errors are measured, both ends among them."""


def time_grid(t_start: float, t_end: float, points: int = POINTS) -> Floats:
    """Return evenly spaced times of a run, s, (points,): both ends to the last bit, none twice."""
    if t_start == t_end:
        return np.array([t_end])
    times = np.linspace(t_start, t_end, points)
    times[-1] = t_end
    distinct: Floats = times[np.append(True, np.diff(times) != 0)]  # few bits have fewer times
    return distinct


def angles_at(solution: Solution, t: Floats) -> Floats:
    """Return the angles of a solution at times, rad, (n_t, n): kept ones, or interpolated.

    Raises
    ------
    ValueError
        If the solution has neither kept them nor its interpolants.
    """
    if len(solution.t) == len(t) and (solution.t == t).all():
        return solution.q
    return solution(t)[: len(solution.scene.links)].T


def distances(scene: Scene, q: npt.ArrayLike, reference: npt.ArrayLike) -> Floats:
    """Return how far apart two motions of a scene are over time.

    Parameters
    ----------
    scene : Scene
        Whose lengths; a pivot that is driven moves alike in both.
    q, reference : array_like, (..., n)
        Absolute angles, rad.

    Returns
    -------
    ndarray, (...)
        The largest distance over the joints and the tip, as a share of the total length; NaN where
        an angle is not finite.
    """
    q, r = np.asarray(q, dtype=np.float64), np.asarray(reference, dtype=np.float64)
    lengths = np.array([link.length for link in scene.links])
    lengths = lengths / lengths.sum()
    with np.errstate(all="ignore"):
        chord = 2 * lengths * np.sin((q - r) / 2)
        apart: Floats = np.abs(np.cumsum(chord * np.exp(0.5j * (q + r)), axis=-1)).max(axis=-1)
    return apart


def position_error(solution: Solution, reference: Solution, t: Floats) -> float:
    """Return the largest distance of two solutions of a scene at the times t (n_t,), s.

    As a share of the total length. NaN where a state is not finite; infinite where one of the two
    does not reach the last of the times.
    """
    if not (reached(solution, t[-1:]).all() and reached(reference, t[-1:]).all()):
        return np.inf
    q, r = angles_at(solution, t), angles_at(reference, t)
    return float(distances(solution.scene, q, r).max(initial=0.0))


def reached(solution: Solution, t: Floats) -> npt.NDArray[np.bool]:
    """Return at which of the times (n_t,), s, a run was."""
    start, end = solution._run.arguments["t_start"], solution._run.t_reached
    there: npt.NDArray[np.bool] = (min(start, end) <= t) & (t <= max(start, end))
    return there
