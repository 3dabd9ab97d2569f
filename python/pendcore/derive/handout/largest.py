"""The largest joint forces of a run, found between the times that are drawn."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pendcore.arguments import Floats
from pendcore.solution import Solution

GRID = 48_001
"""Times at which forces are looked at first, and as many in each step:"""
IN_A_STEP = 8
CANDIDATES = 5
"""Highest peaks of the grid between whose neighbours the highest is looked for."""
FINER = 41
"""Times between these, again and again, each time the neighbours of the highest."""
ROUNDS = 4
STEADY = 1e-12
"""Share by which a force may vary, by rounding, that is the same throughout."""


class Peak(NamedTuple):
    """The largest size of a joint force.

    Attributes
    ----------
    size, time : float
        N, s.
    steady : bool
        Whether it is as large all the time.
    """

    size: float
    time: float
    steady: bool


def largest_reactions(solution: Solution) -> list[Peak]:
    """Return where the force of each joint is largest, for a run with its interpolants."""
    times = _grid(solution)
    sizes = _sizes(solution, times)
    return [_peak(solution, times, sizes[:, i], i) for i in range(sizes.shape[1])]


def _grid(solution: Solution) -> Floats:
    """Times in the order of the run: evenly, and in every step."""
    start, end = float(solution.t[0]), float(solution._run.t_reached)
    steps = np.unique([*solution._run.step_starts, start, end])
    share = np.arange(IN_A_STEP) / IN_A_STEP
    inside = (steps[:-1, None] + np.diff(steps)[:, None] * share).ravel()
    times = np.union1d(np.linspace(start, end, GRID), inside)
    times = times[(times >= min(start, end)) & (times <= max(start, end))]
    return times if end >= start else times[::-1]


def _sizes(solution: Solution, times: Floats) -> Floats:
    """Sizes of the forces of all joints, N, (k, n); -1 where a run that failed has none."""
    states = solution(times).T
    n = states.shape[1] // 2
    forces = solution.scene._compiled.reactions(times, states[:, :n], states[:, n:])
    found = np.linalg.norm(forces, axis=-1)
    return np.where(np.isfinite(found), found, -1.0)


def _peak(solution: Solution, times: Floats, sizes: Floats, joint: int) -> Peak:
    largest, last = float(sizes.max()), len(times) - 1
    if largest - float(sizes.min()) <= STEADY * largest:
        return Peak(largest, float(times[0]), steady=True)
    around = np.concatenate([[-np.inf], sizes, [-np.inf]])
    peaks = np.flatnonzero((sizes >= around[:-2]) & (sizes > around[2:]))
    best = largest, float(times[sizes.argmax()])
    for k in peaks[np.argsort(-sizes[peaks], kind="stable")[:CANDIDATES]]:
        low, high = times[max(k - 1, 0)], times[min(k + 1, last)]
        for _ in range(ROUNDS):
            finer = np.linspace(low, high, FINER)
            found = _sizes(solution, finer)[:, joint]
            j = int(found.argmax())
            if found[j] > best[0]:
                best = float(found[j]), float(finer[j])
            low, high = finer[max(j - 1, 0)], finer[min(j + 1, FINER - 1)]
    return Peak(*best, steady=False)
