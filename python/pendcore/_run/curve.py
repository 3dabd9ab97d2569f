"""A run as a curve that is smooth for the eye, whatever the run kept."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from pendcore._messages.arguments import Floats
from pendcore._run.dense_output import with_dense_output
from pendcore._run.solution import Solution
from pendcore._scene.drives import fastest_drive
from pendcore._scene.scene import Scene

TURN = 0.05
"""rad: links, and drives, turn by no more than this from one point to the next."""
FEWEST, MOST = 2000, 2**18
"""The number of points, unless a run has more steps."""
IN_A_STEP = 4
"""The fewest points in a step: it may turn faster within than at its ends."""


class Curve(NamedTuple):
    """What a run was at k times.

    Attributes
    ----------
    t : ndarray, (k,)
        s.
    states : ndarray, (k, 2n)
        Angles, rad, and rates, rad/s.
    ledger : dict of str to ndarray, (k,)
        The entries of the ledger, J; empty if the run kept none.
    """

    t: Floats
    states: Floats
    ledger: dict[str, Floats]


def curve_of(
    solution: Solution, turn: float = TURN, fewest: int = FEWEST, last_steps: int | None = None
) -> Curve:
    """Return a run over its span, at times so close that links turn by ``turn``, rad, at most.

    They are the times that were kept, if these are close enough. Otherwise they are ``fewest`` or
    more times of the dense output; where a run has none, it is simulated anew. ``last_steps`` is
    the number of steps that are of interest.
    """
    kept = solution._run
    if _is_smooth(solution, turn):
        return Curve(kept.t, kept.states, kept.ledger)
    run, (first, last) = with_dense_output(solution)._run, span_of(solution)
    inside = run.step_starts[(run.step_starts - first) * (last - run.step_starts) > 0]
    nodes = np.array([first] if first == last else [first, *inside, last])
    nodes = nodes if last_steps is None else nodes[-last_steps - 1 :]
    t = _refined(solution.scene, nodes, run.evaluate(nodes), turn, fewest)
    return Curve(t, run.evaluate(t), run.ledger_at(t))


def span_of(solution: Solution) -> tuple[float, float]:
    """Return the first and the last time that a run kept, s; all of the run if it kept but one."""
    run = solution._run
    if len(run.t) > 1:
        return float(run.t[0]), float(run.t[-1])
    return float(run.arguments["t_start"]), run.t_reached


def _is_smooth(solution: Solution, turn: float) -> bool:
    """Whether nothing can happen unseen between the times that a run kept."""
    t, (first, last) = solution.t, span_of(solution)
    if solution.store == "dense" or not len(t) or (t[0], t[-1]) != (first, last):
        return False
    # Times that are farther apart than steps may be those at which a swing turns, say.
    step = abs(solution._run.t_reached - solution._run.arguments["t_start"]) / max(
        solution.stats.accepted, 1
    )
    is_close = solution.store == "steps" or np.abs(np.diff(t)).max(initial=0.0) <= step
    return is_close and bool((_turns(solution.scene, t, solution._run.states) <= turn).all())


def _turns(scene: Scene, t: Floats, states: Floats) -> Floats:
    """Return by how much links and drives turn between neighbouring times, rad, (k-1,)."""
    h, (q, qd) = np.abs(np.diff(t)), np.hsplit(np.abs(states), 2)
    with np.errstate(invalid="ignore", over="ignore"):  # a blow-up
        change = np.abs(np.diff(states[:, : q.shape[1]], axis=0)).max(axis=1)
        by_rate = np.maximum(qd[:-1], qd[1:]).max(axis=1) * h
    turns: Floats = np.maximum(np.maximum(change, by_rate), fastest_drive(scene) * h)
    return turns


def _refined(scene: Scene, nodes: Floats, states: Floats, turn: float, fewest: int) -> Floats:
    """Return times with more of them between the nodes."""
    h = np.diff(nodes)
    if not len(h):
        return nodes
    most = max(MOST // len(h), 1)
    least = max(-(-fewest // len(h)), min(IN_A_STEP, most))
    wanted = np.nan_to_num(_turns(scene, nodes, states) / turn, nan=most, posinf=most)
    parts = np.clip(np.ceil(wanted), least, max(least, most)).astype(int)
    of = np.repeat(np.arange(len(h)), parts)
    part = np.arange(len(of)) - np.repeat(np.cumsum(parts) - parts, parts)
    return np.append(nodes[of] + h[of] * (part / parts[of]), nodes[-1])
