"""A run as a curve that is smooth for the eye, whatever the run kept."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from pendcore import Energy, Scene, Solution
from pendcore.messages import Floats

TURN = 0.05
"""rad: links, and drives, turn by no more than this from one point to the next."""
FEWEST, MOST = 2000, 2**18
"""The number of points, unless a run has more steps."""
IN_A_STEP = 4
"""The fewest points in a step: it may turn faster within than at its ends."""


class Curve(NamedTuple):
    """What a run was at k times (s): angles, rad, and rates, rad/s, (k, n), and the energy."""

    t: Floats
    q: Floats
    qd: Floats
    energy: Callable[[], Energy]


def curve_of(
    solution: Solution, turn: float = TURN, fewest: int = FEWEST, last_steps: int | None = None
) -> Curve:
    """Return a run over its span, at times so close that links turn by ``turn``, rad, at most.

    They are the times that were kept, if these are close enough. Otherwise they are ``fewest`` or
    more times of the dense output; where a run has none, it is simulated anew. ``last_steps`` is
    the number of steps that are of interest.
    """
    if _is_smooth(solution, turn):
        return Curve(solution.t, solution.q, solution.qd, solution.energy)
    dense, (first, last) = solution.with_dense_output(), span_of(solution)
    starts = dense.step_starts
    inside = starts[(starts - first) * (last - starts) > 0]
    nodes = np.array([first] if first == last else [first, *inside, last])
    nodes = nodes if last_steps is None else nodes[-last_steps - 1 :]
    t = _refined(nodes, _turns(solution.scene, nodes, dense(nodes).T) / turn, fewest)
    q, qd = np.hsplit(dense(t).T, 2)
    return Curve(t, q, qd, partial(dense.energy, t))


def span_of(solution: Solution) -> tuple[float, float]:
    """Return the first and the last time that a run kept, s; all of the run if it kept but one."""
    t = solution.t
    if len(t) > 1:
        return float(t[0]), float(t[-1])
    return solution.t_span[0], solution.t_reached


def _is_smooth(solution: Solution, turn: float) -> bool:
    """Whether nothing can happen unseen between the times that a run kept."""
    t = solution.t
    if solution.store == "dense" or not len(t) or (t[0], t[-1]) != span_of(solution):
        return False
    # Times that are farther apart than steps may be those at which a swing turns, say.
    step = abs(solution.t_reached - solution.t_span[0]) / max(solution.stats.accepted, 1)
    is_close = solution.store == "steps" or np.abs(np.diff(t)).max(initial=0.0) <= step
    return is_close and bool((_turns(solution.scene, t, solution.y.T) <= turn).all())


def _turns(scene: Scene, t: Floats, states: Floats) -> Floats:
    """Return by how much links and drives turn between neighbouring times, rad, (k-1,)."""
    h, (q, qd) = np.abs(np.diff(t)), np.hsplit(np.abs(states), 2)
    with np.errstate(invalid="ignore", over="ignore"):  # a blow-up
        change = np.abs(np.diff(states[:, : q.shape[1]], axis=0)).max(axis=1)
        by_rate = np.maximum(qd[:-1], qd[1:]).max(axis=1) * h
    return np.asarray(np.maximum(np.maximum(change, by_rate), scene.fastest_drive() * h))


def _refined(nodes: Floats, wanted: Floats, fewest: int) -> Floats:
    """Return times with more of them between the nodes, if possible as many as are wanted."""
    h = np.diff(nodes)
    if not len(h):
        return nodes
    most = max(MOST // len(h), 1)
    least = max(-(-fewest // len(h)), min(IN_A_STEP, most))
    wanted = np.ceil(np.nan_to_num(wanted, nan=most, posinf=most))
    parts = np.clip(wanted, least, max(least, most)).astype(int)
    of = np.repeat(np.arange(len(h)), parts)
    part = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.append(nodes[of] + h[of] * (part / parts[of]), nodes[-1])
