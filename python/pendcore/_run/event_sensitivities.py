"""Derivatives of the times at which events are found, and of the states there."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from pendcore._messages.arguments import Floats
from pendcore._run.sensitivities import derivatives_of, sensitivities_there
from pendcore._run.solution import Solution
from pendcore._scene.outputs import outputs_at
from pendcore.events import Event, Found, Function, JointAngle, LinkAngle, RateZero, TipLine

ALIKE = 1e-6
"""The share of its size below which a derivative differs from another by errors alone."""
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
            by[k] = _of_one(event, one, along)
        results.append(EventSensitivities(by[:, 0], by[:, 1:]))
    return results


class Side(NamedTuple):
    """A run at one time, or just before or after it."""

    S: Floats
    """The sensitivities, (2n, m)."""
    rates: Floats
    """The rates of change of the state, (2n,)."""

    def carried(self, by: float) -> Side:
        """Return the same a little later, s: the angles go on, the rates hardly change."""
        S, rates, n = self.S.copy(), self.rates.copy(), len(self.rates) // 2
        S[:n] += by * S[n:]
        rates[:n] += by * rates[n:]
        return Side(S, rates)


def continuous_part(before: Side, after: Side) -> slice | None:
    """Return which components of the state stay as they are where their rates jump; None if none.

    These are the angles at an impact, and otherwise all, where accelerations jump.
    """
    jumps, n = np.abs(after.rates - before.rates), len(before.rates) // 2
    least = JUMP * np.abs([before.rates, after.rates]).max()
    if jumps[:n].max() > least:
        return slice(0, n)
    return slice(0, 2 * n) if jumps.max() > least else None


def moved_by_a_change(before: Side, after: Side, part: slice) -> Floats:
    """Return d(time)/d(name) of a change of laws between two sides, (m,).

    The components in ``part`` do not jump, and so ``(S+ - S-) dp + (f+ - f-) dt = 0`` gives dt.
    """
    jumps = (after.rates - before.rates)[part]
    c = int(np.abs(jumps).argmax())
    return np.asarray((before.S[c] - after.S[c]) / jumps[c])


def _of_one(event: Event, one: Found, along: _Along) -> Floats:
    """Return the derivatives of the time and the state, (1 + 2n, m); NaN where there are none."""
    sides = along.sides(one.t)
    part = sides and continuous_part(*sides)
    if one.y_before is not None:
        part = slice(0, len(one.q))
    if part is None:  # no law changes there
        there = along.at(one.t)
        dt = _crossing(event, one, there, along) * (1.0 if one.direction else np.nan)
        return np.vstack([dt, there.S + np.outer(there.rates, dt)])
    if sides is None:
        return np.full((1 + len(one.y), len(along.names)), np.nan)
    before, after = sides
    if _is_by_the_jump(event, one):
        dt = moved_by_a_change(before, after, part)
        return np.vstack([dt, after.S + np.outer(after.rates, dt)])
    dt_before = _crossing(event, _before(one), before, along)
    dt_after = _crossing(event, one, after, along)
    return _where_a_law_changes(before, after, part, dt_before, dt_after)


def _where_a_law_changes(
    before: Side, after: Side, part: slice, dt_before: Floats, dt_after: Floats
) -> Floats:
    """Return the derivatives of an event that lies on a change of a law, (1 + 2n, m).

    By names that keep the event there, it has the derivatives of the side after the change; by
    others, those that both sides have in common.
    """
    S, rates = np.abs([before.S, after.S]), np.abs([before.rates, after.rates])
    apart = after.S - before.S + np.outer(after.rates - before.rates, dt_before)
    stays = np.abs(apart[part]).max(axis=0) <= ALIKE * S.max(axis=(0, 1))
    kept = np.vstack([dt_before, after.S + np.outer(after.rates, dt_before)])
    left = np.vstack([dt_before, before.S + np.outer(before.rates, dt_before)])
    right = np.vstack([dt_after, after.S + np.outer(after.rates, dt_after)])
    sizes = np.maximum(np.abs(left), np.abs(right))
    sizes[0] += S.max(axis=(0, 1)) / rates.max()
    sizes[1:] = sizes[1:].max(axis=0)
    common = np.where(np.abs(left - right) <= ALIKE * sizes, left, np.nan)
    return np.where(stays, kept, common)


def _crossing(event: Event, one: Found, there: Side, along: _Along) -> Floats:
    """Return d(time)/d(name) of a zero of the event's function, (m,); NaN where it turns back."""
    by_state, by_names, by_time = _slopes(event, one, along)
    terms = by_state * there.rates
    along_the_run = by_time + terms.sum()
    if abs(along_the_run) <= ROUNDING * (abs(by_time) + np.abs(terms).sum()):
        return np.full(len(along.names), np.nan)
    return np.asarray(-(by_state @ there.S + by_names) / along_the_run)


def _is_by_the_jump(event: Event, one: Found) -> bool:
    """Whether it is a jump of the state that takes the event's function to zero or beyond."""
    states = _before(one), one
    match event:
        case Function(f):
            before, after = (float(f(there.t, there.q, there.qd)) for there in states)
        case RateZero(link=int(link)):
            before, after = (there.qd[link - 1] for there in states)
        case RateZero(joint=int(joint)):
            before, after = (np.diff(there.qd, prepend=0.0)[joint - 1] for there in states)
        case _:
            return False  # angles and places do not jump
    return before * after < 0 or (before != 0 and after == 0)


def _before(one: Found) -> Found:
    """Return an event with the state before the jump, if there is one."""
    return one if one.y_before is None else replace(one, y=one.y_before)


class _Along:
    """The run made again, with sensitivities at the times of its events and just beside them.

    It is made with the steps that it had, and goes on for a few more where an event ended it.
    """

    def __init__(self, solution: Solution) -> None:
        self.scene, self.names = solution.scene, solution.sensitivity_names
        stats, (start, end) = solution.stats, solution.t_span
        self.start, self.way = start, float(np.sign(end - start))
        self.mean_step = abs(solution.t_reached - start) / max(stats.accepted, 1)
        times = [t for found in solution.events for t in found.t.tolist()]
        sides = [t for time in times for t in self.beside(time)]
        inside = np.clip([start, *times, *sides], min(start, end), max(start, end))
        grid = sorted(set(inside.tolist()), reverse=end < start)
        for more in (3, 30, 300):  # attempts beyond an event that ended the run
            watch, other = derivatives_of(
                solution, self.names, t_eval=grid, store=None, events=(),
                max_steps=stats.accepted + stats.rejected + more,
            )  # fmt: skip
            if len(watch.values) == len(grid):
                break
        rows = zip(watch.values, other.y.T, strict=True)
        self.rows: dict[float, tuple[Floats, Floats]] = dict(zip(grid, rows, strict=False))

    def beside(self, t: float) -> tuple[float, float]:
        """Return a time just before t and one just after it."""
        width = max(BESIDE * self.mean_step, LAST_BITS * float(np.spacing(abs(t))))
        return t - self.way * width, t + self.way * width

    def sides(self, t: float) -> tuple[Side, Side] | None:
        """Return the run just before a time and just after it, where it has both."""
        before, after = self.beside(t)
        if before not in self.rows or after not in self.rows:
            return None
        return self.at(before).carried(t - before), self.at(after).carried(t - after)

    def at(self, t: float) -> Side:
        """Return the run at one of these times: after a jump, where there is one."""
        S, y = self.rows[t]
        q, qd = np.split(y, 2)
        return Side(S, np.append(qd, self.scene.accelerations(t, q, qd)))


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
