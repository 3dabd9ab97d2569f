"""At which times to look how far apart two computed motions are: see `Scene.distances`."""

from __future__ import annotations

from collections.abc import Iterable
from functools import reduce

import numpy as np
import numpy.typing as npt

from pendcore._messages.arguments import Floats
from pendcore._run.solution import Solution

SAMPLES, CUTS = 6, 60
"""The steps of the other runs cut a step of the run into intervals. Each interval holds SAMPLES
times, or a single one where it is one of more than CUTS: the error within a step is a polynomial of
low degree."""


def time_grid(t_start: float, t_end: float, points: int = 101) -> Floats:
    """Return evenly spaced times of a run, s, (points,): both ends to the last bit, none twice."""
    # A span of a few last bits has fewer times than points.
    return _distinct(np.linspace(t_start, t_end, points))


def kept_times(solution: Solution) -> Floats:
    """Return the times that a solution kept, s, each once; at a jump it keeps a time twice."""
    return _distinct(solution.t)


def _distinct(t: Floats) -> Floats:
    return np.asarray(t[np.append(True, np.diff(t) != 0)[: len(t)]])


def times_within_steps(runs: Iterable[Solution]) -> Floats:
    """Return times inside every step of the first run and at the steps of the others, s.

    They go from the start of the runs to the end that comes first.
    """
    solutions = [*runs]
    begin = solutions[0]._run.arguments["t_start"]
    ends = [one._run.t_reached for one in solutions]
    direction = -1.0 if min(ends) < begin else 1.0
    end = direction * min(direction * one for one in ends)
    nodes = np.unique(np.concatenate([direction * one._run.step_starts for one in solutions]))
    nodes = np.append(nodes[nodes < direction * end], direction * end)
    if len(nodes) == 1:
        return np.array([end])
    own = np.searchsorted(direction * solutions[0]._run.step_starts, nodes[:-1], side="right")
    few = np.bincount(own)[own] <= CUTS
    shares = np.arange(1, SAMPLES) / SAMPLES
    inside = nodes[:-1][few, np.newaxis] + np.diff(nodes)[few, np.newaxis] * shares
    return direction * _distinct(np.sort(np.append(inside.ravel(), nodes)))


def angles_at(solution: Solution, t: Floats) -> Floats:
    """Return the angles of a solution at times, rad, (n_t, n); see `states_at`."""
    return states_at(solution, t)[:, : len(solution.scene.links)]


def states_at(solution: Solution, t: Floats) -> Floats:
    """Return angles, rad, and rates, rad/s, at times, (n_t, 2n): kept ones, or interpolated.

    Raise a `ValueError` if the solution has neither kept them nor its interpolants.
    """
    if solution.store == "dense":
        return solution(t).T
    run, kept = solution._run, np.hstack([solution.q, solution.qd])
    if len(solution.t) == len(t) and (solution.t == t).all():
        return kept
    if len(t) == 1 and t[0] == run.t_reached:
        return np.asarray(run.y_reached)[np.newaxis, : kept.shape[1]]
    direction = -1.0 if run.t_reached < run.arguments["t_start"] else 1.0
    rows = np.searchsorted(direction * solution.t, direction * t)
    if (rows == len(solution.t)).any() or (solution.t[rows] != t).any():
        raise ValueError(f"t: the solution kept its state at {len(solution.t)} other times (s)")
    return kept[rows]


def largest_difference(q: Floats, reference: Floats | float = 0.0) -> Floats:
    """Return the largest difference over the links of numbers (..., n), (...)."""
    apart = np.abs(q - reference)
    # numpy is slow along an axis as short as a chain
    return np.asarray(reduce(np.maximum, (apart[..., i] for i in range(apart.shape[-1]))))


def reached(solution: Solution, t: Floats) -> npt.NDArray[np.bool_]:
    """Return at which of the times (n_t,), s, a run was."""
    start, end = solution._run.arguments["t_start"], solution._run.t_reached
    return np.asarray((min(start, end) <= t) & (t <= max(start, end)))
