"""The frames of a film: their times, and the chain at each of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from pendcore import Solution
from pendcore.messages import Floats

MOST_FRAMES = 54_000
"""Half an hour at 30 frames a second."""


class Moves(NamedTuple):
    """What moves of one run, at the times of k frames.

    Angles and rates, (k, 2n), rad and rad/s; the places of pivot, joints and tip, (k, n+1, 2), m;
    the force on each link at its joint, (k, n, 2), N.
    """

    states: Floats
    places: Floats
    reactions: Floats


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
    return np.asarray(start + np.copysign(faster / rate, length) * np.arange(frames))


def moves_of(solution: Solution, times: Floats) -> Moves:
    """Return where a run with dense output is at the times of frames; it stays where it ends."""
    low, high = sorted((solution.t_span[0], solution.t_reached))
    at = np.clip(times, low, high)
    states, scene = solution(at).T, solution.scene
    q, qd = np.hsplit(states, 2)
    return Moves(states, scene.positions(at, q), scene.reactions(at, q, qd))
