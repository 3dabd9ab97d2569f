"""The frames of a film: their times, and the chain at each of them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pendcore.messages.arguments import Floats, positive
from pendcore.run.result import RunResult

MOST_FRAMES = 54_000
"""Half an hour at 30 frames a second."""
PATH_PARTS = 4
"""The tip's path has so many parts between two frames, so that it is smooth where the tip is
fast."""


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
    path : ndarray, (PATH_PARTS (k-1) + 1, 2)
        The tip, m, also between frames.
    total_length : float
        m.
    """

    states: Floats
    places: Floats
    reactions: Floats
    path: Floats
    total_length: float


def frame_times(solutions: Sequence[RunResult], fps: float, speed: float) -> Floats:
    """Return the times of the frames, s: those of the longest run, at `speed` times true time."""
    rate = positive("fps", fps, "1/s")
    faster = positive("speed", speed, "")
    starts = [float(one.run.arguments["t_start"]) for one in solutions]
    ends = [one.run.t_reached for one in solutions]
    lengths = [end - start for start, end in zip(starts, ends, strict=True)]
    longest = int(np.argmax(np.abs(lengths)))
    start, length = starts[longest], lengths[longest]
    count = abs(length) / faster * rate
    if count > MOST_FRAMES:
        raise ValueError(
            f"speed = {speed}: a film of {abs(length) / faster / 60:.3g} minutes: must have at "
            f"most {MOST_FRAMES} frames: give speed={abs(length) / 60:.3g} for one of a minute"
        )
    frames = max(int(count * (1 + 1e-12)), 1) + 1
    times: Floats = start + np.copysign(faster / rate, length) * np.arange(frames)
    return times


def moves_of(solution: RunResult, times: Floats) -> Moves:
    """Return where a run is at the times of frames; it stays where it ends."""
    start, end = float(solution.run.arguments["t_start"]), solution.run.t_reached
    at = np.clip(times, min(start, end), max(start, end))
    states = states_of(solution, at)
    n = len(solution.scene.links)
    parts = np.linspace(0, len(at) - 1, PATH_PARTS * (len(at) - 1) + 1)
    along = np.interp(parts, np.arange(len(at)), at)
    compiled = solution.scene._compiled
    return Moves(
        states,
        compiled.positions(at, states[:, :n]),
        compiled.reactions(at, states[:, :n], states[:, n:]),
        compiled.positions(along, states_of(solution, along)[:, :n])[:, -1],
        float(sum(link.length for link in solution.scene.links)),
    )


def states_of(solution: RunResult, times: Floats) -> Floats:
    """Return the states at times of a run, (k, 2n).

    Without dense output they are cubic between the times that were kept, which know the rates.
    """
    if solution.store == "dense":
        return solution.run.evaluate(times)
    t, q, qd = solution.t, solution.q, solution.qd
    if len(t) < 2:
        kept = "one time only" if len(t) else "no time"
        raise ValueError(
            f"this run kept {kept}: a film needs more: run it with store='dense', the default"
        )
    direction = 1.0 if t[-1] >= t[0] else -1.0
    before = np.searchsorted(direction * t, direction * times, side="right") - 1
    k = np.clip(before, 0, len(t) - 2)
    h = (t[k + 1] - t[k])[:, np.newaxis]
    with np.errstate(invalid="ignore", divide="ignore"):  # two states at the time of an impact
        x = np.where(h == 0, 0.0, (times - t[k])[:, np.newaxis] / h)
    x = np.clip(x, 0.0, 1.0)
    angle = (
        (1 + 2 * x) * (1 - x) ** 2 * q[k]
        + x**2 * (3 - 2 * x) * q[k + 1]
        + h * x * (1 - x) ** 2 * qd[k]
        - h * x**2 * (1 - x) * qd[k + 1]
    )
    return np.hstack([angle, (1 - x) * qd[k] + x * qd[k + 1]])
