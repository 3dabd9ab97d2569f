"""Interleaved timing: whatever slows the machine slows all contenders alike.

In every round every run has one short burst, in an order drawn anew. A run that takes long beside
the time it may spend has a turn in fewer rounds, spread over all of them.
"""

from __future__ import annotations

import math
import random
import statistics
from collections.abc import Hashable, Mapping
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from cases import Case
from contenders.contender import Run, Timed
from record import Point
from tqdm import tqdm
from trajectory_error import end_error, energy_error, position_error

Key = TypeVar("Key", bound=Hashable)


@dataclass(frozen=True, slots=True)
class Timing:
    """Seconds per call: the least and the median of all calls of all rounds."""

    minimum: float
    median: float
    calls: int

    def row(self, unit: str, units_a_second: float) -> Point:
        return {
            f"minimum_{unit}": units_a_second * self.minimum,
            f"median_{unit}": units_a_second * self.median,
            "calls": self.calls,
        }


LEAST_TURNS = 3


def interleave(
    runs: Mapping[Key, Timed],
    rounds: int,
    burst_seconds: float,
    seconds_a_run: float = math.inf,
    what: str = "rounds",
) -> dict[Key, Timing]:
    """Time all runs; `what` is written beside the progress bar."""
    seconds: dict[Key, list[float]] = {key: [] for key in runs}
    spent: dict[Key, float] = dict.fromkeys(runs, 0.0)
    for turn in tqdm(range(rounds), desc=what, unit="round", disable=None):
        order = list(runs)
        random.Random(turn).shuffle(order)
        for key in order:
            known = seconds[key]
            allowed = max(seconds_a_run, LEAST_TURNS * known[0]) if known else math.inf
            if spent[key] > allowed * turn / rounds:
                continue
            taken = runs[key].burst(burst_seconds)
            known += taken
            spent[key] += sum(taken)
    return {
        key: Timing(min(taken), statistics.median(taken), len(taken))
        for key, taken in seconds.items()
    }


def achieved(run: Run, case: Case) -> Point:
    """Return how wrong the run's states are and what they took, or `failure`, a sentence."""
    try:
        outcome = run.outcome()
    except (RuntimeError, ValueError, ArithmeticError) as failure:
        return {"failure": str(failure) or type(failure).__name__}
    if outcome.states.shape != case.reference.shape or not np.isfinite(outcome.states).all():
        return {"failure": "the run did not reach the end with finite states"}
    q, qd = outcome.states[:, : case.n], outcome.states[:, case.n :]
    known = case.reference[:, : case.n]
    masses, lengths = np.array(case.masses), np.array(case.lengths)
    found = {
        "error": position_error(q, known, lengths),
        "end_error": end_error(q, known, lengths),
        "energy_error": energy_error(q, qd, masses, lengths, case.gravity) if case.bare else None,
        "evaluations": outcome.evaluations,
        "steps": outcome.steps,
    }
    return {**found, "said": outcome.said} if outcome.said else found
