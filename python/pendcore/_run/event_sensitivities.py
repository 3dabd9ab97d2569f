"""Derivatives of the times at which events are found, and of the states there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from pendcore._messages.arguments import Floats
from pendcore._run.sensitivities import derivatives_of, sensitivities_there
from pendcore._run.solution import Solution
from pendcore._scene.outputs import outputs_at
from pendcore.events import Event, Found, Function, JointAngle, LinkAngle, RateZero, TipLine

BESIDE = 1e-10
"""The distance from an event to the times beside it, as a share of the mean step."""
LAST_BITS = 8
"""The least distance to them, in last bits of the time."""
JUMP = 1e-6
"""The share of the largest rate of change beyond which a difference across an event is a jump."""
ROUNDING = 1e-12
"""The share of its terms below which the slope of an event's function in time is rounding."""
STEP = float(np.cbrt(np.finfo(float).eps))
"""The steps of central differences, as a share of what is moved, or of 1 where that is less."""


@dataclass(frozen=True, slots=True, eq=False)
class EventSensitivities:
    """The derivatives of the times and the states of one event.

    Attributes
    ----------
    t : ndarray, (k, m)
        d(time)/d(name) of each of k times at which the event was found, for each of the m names of
        ``sol.sensitivity_names``: s per unit of what is named.
    y : ndarray, (k, 2n, m)
        d(q, qd)/d(name) of the state at the event, whose time moves: rad and rad/s per unit.

    Examples
    --------
    >>> bottom = pc.events.LinkAngle(1, np.pi / 2)
    >>> how = {"sensitivities": ["gravity"], "events": [bottom]}
    >>> sol = pc.simulate(pc.Scene.textbook(), (0, 2), 0.5, **how)
    >>> (moved,) = sol.event_sensitivities()
    >>> moved.t[:, 0].round(6)  # s^3/m
    array([-0.033303, -0.09808 ])
    >>> (-sol.events[0].t / (2 * 9.807)).round(6)  # from rest, times go as gravity^(-1/2)
    array([-0.033303, -0.09808 ])
    """

    t: Floats
    y: Floats


def sensitivities_at_events(solution: Solution) -> list[EventSensitivities]:
    """See `Solution.event_sensitivities`."""
    sensitivities_there(solution)
    if not (asked := solution.events_asked_for()):
        raise ValueError("the run looked for no events: simulate(..., events=[...]) finds them")
    n, names = len(solution.scene.links), solution.sensitivity_names
    along = _Along(solution)
    results = []
    for event, found in zip(asked, solution.events, strict=True):
        by = np.full((len(found), 1 + 2 * n, len(names)), np.nan)
        for k, one in enumerate(found):
            if one.direction and one.y_before is None:
                by[k] = _of_one(event, one, along)
        results.append(EventSensitivities(by[:, 0], by[:, 1:]))
    return results


def _of_one(event: Event, one: Found, along: _Along) -> Floats:
    """Return the derivatives of the time and the state, (1 + 2n, m); NaN where there are none."""
    S, rates = along.at(one.t, one.y)
    by_state, by_names, by_time = _slopes(event, one, along)
    terms = by_state * rates
    along_the_run = by_time + terms.sum()
    if abs(along_the_run) <= ROUNDING * (abs(by_time) + np.abs(terms).sum()):
        return np.full((1 + len(S), len(along.names)), np.nan)
    dt = -(by_state @ S + by_names) / along_the_run
    return np.vstack([dt, S + np.outer(rates, dt)])


class _Along:
    """The run made again, with sensitivities at the times of its events and just beside them.

    It is made with the steps that it had, and goes on for a few more where an event ended it.
    """

    def __init__(self, solution: Solution) -> None:
        self.scene, self.names = solution.scene, solution.sensitivity_names
        stats, (start, end) = solution.stats, solution.t_span
        self.start = start
        self.mean_step = abs(solution.t_reached - start) / max(stats.accepted, 1)
        times = [t for found in solution.events for t in found.t.tolist()]
        sides = [t for time in times for t in self.beside(time)]
        inside = np.clip([start, *times, *sides], min(start, end), max(start, end))
        grid = sorted(set(inside.tolist()), reverse=end < start)
        watch, other = derivatives_of(
            solution, self.names, t_eval=grid, store=None, events=(),
            max_steps=stats.accepted + stats.rejected + 3,
        )  # fmt: skip
        rows = zip(watch.values, other.y.T, strict=True)
        self.rows: dict[float, tuple[Floats, Floats]] = dict(zip(grid, rows, strict=False))

    def beside(self, t: float) -> tuple[float, float]:
        """Return a time just before t and one just after it."""
        width = max(BESIDE * self.mean_step, LAST_BITS * float(np.spacing(abs(t))))
        return t - width, t + width

    def at(self, t: float, y: Floats) -> tuple[Floats, Floats]:
        """Return sensitivities and rates of change at an event; NaN where a law changes there."""
        rates = self.rates(t, y)
        sides = [self.rates(s, self.rows[s][1]) for s in self.beside(t) if s in self.rows]
        if len(sides) == 2 and np.abs(np.subtract(*sides)).max() > JUMP * np.abs(sides).max():
            rates = np.full_like(rates, np.nan)
        return self.rows[t][0], rates

    def rates(self, t: float, y: Floats) -> Floats:
        q, qd = np.split(y, 2)
        return np.append(qd, self.scene.accelerations(t, q, qd))


def _slopes(event: Event, one: Found, along: _Along) -> tuple[Floats, Floats, float]:
    """Return the derivatives of an event's function by the state, (2n,), by the names and by t."""
    scene, names = along.scene, along.names
    n, by_time = len(scene.links), 0.0
    match event:
        case Function(f):
            slope = _differences(lambda x: float(f(x[0], x[1 : 1 + n], x[1 + n :])), one)
            return slope[1:], np.zeros(len(names)), float(slope[0])
        case LinkAngle(link):
            shares = {f"q[{link}]": 1.0}
        case JointAngle(joint):
            shares = {f"phi[{joint}]": 1.0}
        case RateZero(joint=None, link=link):
            shares = {f"qd[{link}]": 1.0}
        case RateZero(joint=joint):
            shares = {f"phid[{joint}]": 1.0}
        case TipLine(normal=normal):
            shares = {f"x[{n}]": normal[0], f"y[{n}]": normal[1]}
            by_time = float(normal @ scene.velocities(one.t, one.q, one.qd)[0])  # of the pivot
    t = np.asarray(one.t)
    there = outputs_at(scene, t, one.y, names, [*shares], since=one.t - along.start)
    share = np.array([*shares.values()])
    return share @ there.by_state, share @ there.by_names, by_time


def _differences(f: Callable[[Floats], float], one: Found) -> Floats:
    """Return central differences of a user's function by the time and by each number of a state."""
    x = np.append(one.t, one.y)
    found = np.empty_like(x)
    for i, by in enumerate(STEP * np.maximum(np.abs(x), 1)):
        above, below = x.copy(), x.copy()
        above[i], below[i] = x[i] + by, x[i] - by
        found[i] = (f(above) - f(below)) / (above[i] - below[i])
    return found
