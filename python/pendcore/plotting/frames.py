"""The frames of a film: their times, and the chain at each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats

MOST_FRAMES = 54_000
"""Half an hour at 30 frames a second."""
FEWEST_PARTS, MOST_PARTS = 4, 64
"""The tip's path has so many parts between two frames, so that it is smooth where the tip is
fast."""
PART = 0.1
"""rad: links turn by no more than this in a part of the path, unless it has `MOST_PARTS`."""


@dataclass(frozen=True, slots=True, eq=False)
class Moves:
    """What moves of one run, at the times of k frames.

    Attributes
    ----------
    states : ndarray, (k, 2n)
        Angles, rad, and rates, rad/s.
    places : ndarray, (k, n+1, 2)
        Pivot, joints and tip, m.
    reactions : ndarray, (k, n, 2)
        The force on each link at its joint, N.
    path : ndarray, (parts (k-1) + 1, 2)
        The tip, m, also between frames.
    parts : int
        The number of parts of the path between two frames.
    total_length : float
        m.
    """

    states: Floats
    places: Floats
    reactions: Floats
    path: Floats
    parts: int
    total_length: float


def frame_times(solutions: Sequence[Solution], fps: float, speed: float) -> Floats:
    """Return the times of the frames, s: those of the longest run, at `speed` times true time."""
    rate, faster = float(fps), float(speed)
    longest = max(solutions, key=lambda one: abs(one.t_reached - one.t_span[0]))
    start, length = longest.t_span[0], longest.t_reached - longest.t_span[0]
    count = abs(length) / faster * rate
    if count > MOST_FRAMES:
        raise ValueError(
            f"speed = {speed}: a film of {abs(length) / faster / 60:.3g} minutes: must have at "
            f"most {MOST_FRAMES} frames: give speed={abs(length) / 60:.3g} for one of a minute"
        )
    frames = max(int(count * (1 + 1e-12)), 1) + 1
    times: Floats = start + np.copysign(faster / rate, length) * np.arange(frames)
    return times


def moves_of(solution: Solution, times: Floats) -> Moves:
    """Return where a run with dense output is at the times of frames; it stays where it ends."""
    start, end = solution.t_span[0], solution.t_reached
    at = np.clip(times, min(start, end), max(start, end))
    states, scene = solution(at).T, solution.scene
    q, qd = np.hsplit(states, 2)
    parts = _parts(at, qd)
    between = np.linspace(0, len(at) - 1, parts * (len(at) - 1) + 1)
    along = np.interp(between, np.arange(len(at)), at)
    return Moves(
        states=states,
        places=scene.positions(at, q),
        reactions=scene.reactions(at, q, qd),
        path=scene.positions(along, np.hsplit(solution(along).T, 2)[0])[:, -1],
        parts=parts,
        total_length=float(sum(link.length for link in scene.links)),
    )


def _parts(times: Floats, rates: Floats) -> int:
    """Return into how many parts the path between two frames is cut."""
    turn = np.abs(rates).max(axis=1) * np.abs(np.diff(times)).max(initial=0.0)
    fastest = float(np.nan_to_num(turn, nan=np.inf).max())
    return int(np.clip(np.ceil(fastest / PART), FEWEST_PARTS, MOST_PARTS))
