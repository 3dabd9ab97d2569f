"""Interleaved timing: whatever slows the machine slows all contenders alike.

In every round every run has one short burst, in an order drawn anew.
"""

from __future__ import annotations

import random
import statistics
from collections.abc import Hashable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

import numpy as np
from cases import Case
from contenders.contender import Run
from trajectory_error import end_error, energy_error, position_error

Key = TypeVar("Key", bound=Hashable)


class Timed(Protocol):
    def burst(self, seconds: float) -> list[float]:
        """Call for about so long and list each call's seconds."""


@dataclass(frozen=True, slots=True)
class Timing:
    """Seconds a call: the least and the median of all calls of all rounds."""

    minimum: float
    median: float
    calls: int


def interleave(
    runs: Mapping[Key, Timed], rounds: Iterable[int], burst_seconds: float
) -> dict[Key, Timing]:
    """Time all runs. `rounds` are the rounds' numbers, perhaps with a progress bar around them."""
    seconds: dict[Key, list[float]] = {key: [] for key in runs}
    for number in rounds:
        order = list(runs)
        random.Random(number).shuffle(order)
        for key in order:
            seconds[key] += runs[key].burst(burst_seconds)
    return {
        key: Timing(min(taken), statistics.median(taken), len(taken))
        for key, taken in seconds.items()
    }


def achieved(run: Run, case: Case) -> dict[str, Any]:
    """Tell how wrong the run's states are and what they took; or `failure`, a sentence."""
    try:
        outcome = run.outcome()
    except (RuntimeError, ValueError, ArithmeticError) as failure:
        return {"failure": str(failure) or type(failure).__name__}
    if outcome.states.shape != case.reference.shape or not np.isfinite(outcome.states).all():
        return {"failure": "the run did not reach the end with finite states"}
    q, qd = outcome.states[:, : case.n], outcome.states[:, case.n :]
    known = case.reference[:, : case.n]
    masses, lengths = np.array(case.masses), np.array(case.lengths)
    return {
        "error": position_error(q, known, lengths),
        "end_error": end_error(q, known, lengths),
        "energy_error": energy_error(q, qd, masses, lengths, case.gravity),
        "evaluations": outcome.evaluations,
    }
