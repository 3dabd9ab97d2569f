"""Members run in this process, by the threads of the core."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import _core
from pendcore._ensemble.members import Members
from pendcore._ensemble.request import Request
from pendcore.reducers import REDUCERS, FirstEvent, Reducer

Arrays = Mapping[str, Any]
"""By the names of `Request.variables`, in memory or in a store."""

SUMMED = ("nfev", "njev", "nlu", "accepted", "rejected")
"""The statistics that are sums over the members."""


@dataclass(slots=True)
class Outcome:
    """What running members came to."""

    arrays: Arrays
    ending: str
    """``"finished"``, or what ended the whole: ``"time_limit"``, ``"interrupted"``."""
    statistics: dict[str, Any]
    """Sums over the members."""
    error: BaseException | None
    """The exception that broke it off, until it is taken."""

    def take_error(self) -> BaseException | None:
        """Return the exception and forget it, so that no frame in its traceback holds it."""
        error, self.error = self.error, None
        return error


def run_members(
    members: Members, request: Request, workers: int, time_limit: float, progress: Any
) -> Outcome:
    """Run all members; ``workers`` is 0 for a thread on each processor."""
    shape, n = members.shape, len(members.scene.links)
    times = () if request.t_eval is None else request.t_eval.shape
    variables = request.variables(n)
    arrays = {one.name: one.empty(shape) for one in variables if one.name not in ("q", "qd")}
    states = np.full((*shape, *times, 2 * n), np.nan)
    given = request.options | {
        "store": "end" if request.t_eval is None else "times",
        "t_eval": request.t_eval,
        "events": [event._as_pair() for event in request.events],
    }
    arrays |= {"q": states[..., :n], "qd": states[..., n:]}
    kept: dict[type[Reducer], npt.NDArray[Any]] = {}
    for name, one in request.reducers.items():
        if isinstance(one, FirstEvent):  # the core finds the first of all events
            first = np.full((*shape, len(request.events)), np.nan)
            arrays[name] = kept.setdefault(FirstEvent, first)[..., request.event_number(name)]
        else:  # two of a kind are one
            arrays[name] = kept.setdefault(type(one), arrays[name])
    filled = {one.name: arrays[one.name] for one in variables}
    return _outcome(filled, *_core.ensemble(
        members.scene._compiled, shape, members.q0, members.qd0,
        list(members.vary), [values[..., np.newaxis] for values in members.vary.values()],
        *request.t_span, given, workers, time_limit, progress, request.sensitivity_names,
        arrays["status"], arrays["t_reached"], states, *(kept.get(kind) for kind in REDUCERS),
    ))  # fmt: skip


def _outcome(
    arrays: Arrays, ending: str, statistics: dict[str, Any], error: BaseException | None
) -> Outcome:
    """Return what a run came to: the frame of that run must not keep the exception.

    The exception of a callback holds the frames that led to it, and would wait for the collector.
    """
    return Outcome(arrays, ending, {name: statistics[name] for name in SUMMED}, error)
