"""Derivatives of the least and the greatest angles and rates of a run."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import chebyshev

from pendcore._messages.arguments import Floats
from pendcore._run.dense_output import with_every_step
from pendcore._run.event_sensitivities import (
    ALIKE,
    BESIDE,
    LAST_BITS,
    Side,
    continuous_part,
    moved_by_a_change,
    sensitivities_at_events,
)
from pendcore._run.sensitivities import along, sensitivities_there
from pendcore._run.solution import Solution

AT_ONCE = 2**20
"""The most numbers in an array."""
TIE = 10.0
"""Values that differ by less than this multiple of the run's tolerances are not told apart."""
SHORT = 2**14
"""The length of a step, in last bits of its time, below which it is a line."""
ROUNDING = 1e-14
"""The share of a component below which the coefficients of its slope are rounding."""


@dataclass(frozen=True, slots=True, eq=False)
class ExtremeSensitivities:
    """The least and the greatest angles and rates of a run, and their derivatives.

    In each array, row 0 is of the least values and row 1 of the greatest; columns are the angles of
    all links, then their rates, as in `pendcore.reducers.Extremes`.

    Attributes
    ----------
    values : ndarray, (2, 2n)
        rad and rad/s.
    t : ndarray, (2, 2n)
        When, s: one of the times, if there are several.
    sensitivities : ndarray, (2, 2n, m)
        d(value)/d(name) for each of the m names of ``sol.sensitivity_names``.

    Examples
    --------
    >>> rod = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)])
    >>> sol = pc.simulate(rod, (0, 2), 0.5, sensitivities=["q0[1]", "gravity"])
    >>> found = sol.extreme_sensitivities()
    >>> found.values[:, 0].round(6)  # rad: from rest to as high on the other side
    array([0.5     , 2.641593])
    >>> abs(found.sensitivities[:, 0]).round(6)  # 1 and -1 rad/rad, whatever gravity is
    array([[1., 0.],
           [1., 0.]])
    """

    values: Floats
    t: Floats
    sensitivities: Floats


class _Place(NamedTuple):
    """Where a component of the state may be extreme."""

    t: float
    value: float
    beside: float = 0.0
    """At the end of a step, where a law may change, how far times beside it are away, s."""
    is_before: bool = False
    """Whether it is the value before a jump."""


def sensitivities_at_extremes(solution: Solution) -> ExtremeSensitivities:
    """See `Solution.extreme_sensitivities`."""
    sensitivities_there(solution)
    n, m = len(solution.scene.links), len(solution.sensitivity_names)
    curve = _Curve(with_every_step(solution))
    found = {at: curve.extremes(at[1], 1.0 if at[0] else -1.0) for at in np.ndindex(2, 2 * n)}
    around = _Around(solution, [place for places in found.values() for place in places])
    known = solution.scene.parameters()
    sizes = np.array([max(1.0, abs(known.get(name, 1.0))) for name in solution.sensitivity_names])
    values, t, by = np.empty((2, 2 * n)), np.empty((2, 2 * n)), np.empty((2, 2 * n, m))
    for at, places in found.items():
        values[at], t[at] = places[0].value, places[0].t
        each = np.array([around.derivative(place, at[1]) for place in places])
        by_rounding = curve.tie(places[0].value) / sizes
        same = np.maximum(ALIKE * around.largest(places), by_rounding)
        by[at] = np.where(np.abs(each - each[0]).max(axis=0) <= same, each[0], np.nan)
    return ExtremeSensitivities(values, t, by)


class _Curve:
    """The dense output of a run as Chebyshev series, one for each step and component."""

    def __init__(self, run: Solution) -> None:
        self.run, asked = run, run.options
        self.rtol, self.atol = np.max(asked["rtol"]), np.max(asked["atol"])
        self.t = np.append(run.step_starts, run.t_reached)  # of the ends of the steps
        way = np.sign(self.t[-1] - self.t[0])
        self.before = np.searchsorted(way * run.t, way * self.t, side="left")
        self.after = np.searchsorted(way * run.t, way * self.t, side="right") - 1
        degree = run._run.dense_degree
        self.nodes = chebyshev.chebpts1(degree + 1)
        self.from_nodes = np.linalg.inv(chebyshev.chebvander(self.nodes, degree))
        steps, at_once = np.arange(len(self.t) - 1), AT_ONCE // (len(self.nodes) * len(run.y)) + 1
        # After the last step there is one of no length, for a jump at the end of the run.
        self.middle, self.reach = np.zeros((2, len(self.t), len(run.y)))
        self.middle[-1] = run.y[:, -1]
        for k in range(0, len(steps), at_once):
            series = self.series(some := steps[k : k + at_once])
            self.middle[some], self.reach[some] = series[:, 0], np.abs(series[:, 1:]).sum(axis=1)

    def series(self, steps: Any) -> Floats:
        """Return the coefficients of the curve in some steps, (k, degree + 1, 2n)."""
        low, high = self.t[steps], self.t[steps + 1]
        t = 0.5 * (low + high)[:, np.newaxis] + 0.5 * np.outer(high - low, self.nodes)
        states = self.run._run.evaluate(t.ravel()).reshape(*t.shape, -1)[..., : len(self.run.y)]
        found: Floats = self.from_nodes @ states
        # So near its ends, a step of few bits has no times inside: a line from end to end.
        short = np.abs(high - low) < SHORT * np.spacing(np.maximum(np.abs(low), np.abs(high)))
        first, last = self.run.y.T[self.after[steps]], self.run.y.T[self.before[steps + 1]]
        found[short] = 0.0
        found[short, 0], found[short, 1] = 0.5 * (first + last)[short], 0.5 * (last - first)[short]
        return found

    def extremes(self, i: int, sign: float) -> list[_Place]:
        """Return the places of the greatest value of a component times a sign, best first.

        These are all highest points of the curve that the run's tolerances cannot tell from it.
        """
        best = float(np.max(sign * self.run.y[i]))
        highest = sign * self.middle[:, i] + self.reach[:, i]
        points: dict[int, list[_Place]] = {}
        for k in np.argsort(-highest).tolist():
            if highest[k] < best - self.tie(best):
                break
            points[k] = self.points(k, i)
            best = max(best, *(sign * point.value for point in points[k]))
        line: list[_Place] = []
        for k in sorted(points):
            if k - 1 not in points:  # a step that is left out begins and ends lower
                line.append(_Place(np.nan, -sign * np.inf))
            again = points[k][0].value == line[-1].value  # the state at which the step before ended
            line += points[k][1:] if again else points[k]
        heights = sign * np.array([point.value for point in [*line, line[0]]])
        is_top = (heights[1:-1] >= heights[:-2]) & (heights[1:-1] >= heights[2:])
        tops = np.flatnonzero(is_top & (heights[1:-1] >= best - self.tie(best))) + 1
        return sorted((line[k] for k in tops), key=lambda place: -sign * place.value)

    def tie(self, value: float) -> float:
        """Return the difference from a value that the tolerances of the run cannot tell from 0."""
        return float(TIE * (self.atol + self.rtol * abs(value)))

    def points(self, k: int, i: int) -> list[_Place]:
        """Return a component at the start of a step, at its turning points, and at its end."""
        first = _Place(float(self.t[k]), float(self.run.y[i, self.after[k]]), self.width(k))
        if k + 1 == len(self.t):
            return [first]
        low, high = self.t[k], self.t[k + 1]
        c = chebyshev.chebtrim(self.series(np.array([k]))[0, :, i], 0)
        slope = chebyshev.chebtrim(chebyshev.chebder(c), ROUNDING * np.abs(c).sum())
        roots = chebyshev.chebroots(slope)
        turns = np.sort(roots[np.abs(roots.imag) < 1e-3].real)
        turns = turns[np.abs(turns) < 1]
        values = chebyshev.chebval(turns, c)
        inside = (0.5 * (low + high) + 0.5 * (high - low) * turns, values)
        last = float(self.run.y[i, self.before[k + 1]])
        return [
            first,
            *(_Place(float(t), float(x)) for t, x in zip(*inside, strict=True)),
            _Place(float(high), last, self.width(k + 1), is_before=True),
        ]

    def width(self, k: int) -> float:
        """Return how far times beside the end of a step are away, s; 0 at the start of the run."""
        if k == 0:
            return 0.0
        shortest = float(np.abs(np.diff(self.t[k - 1 : k + 2])).min())
        mean = float(np.abs(np.diff(self.t)).mean())
        bits = LAST_BITS * float(np.spacing(abs(self.t[k])))
        return min(0.5 * shortest, max(BESIDE * mean, bits))


class _Around:
    """The run made again, with sensitivities at some places and just beside them."""

    def __init__(self, solution: Solution, places: list[_Place]) -> None:
        self.solution, start = solution, solution.t_span[0]
        self.ends = start, solution.t_reached
        self.way = np.sign(self.ends[1] - start)
        times = np.array(sorted({t for place in places for t in self.beside(place)}))
        S, y = along(solution, times)
        q, qd = np.split(y, 2, axis=-1)
        rates = np.hstack([qd, solution.scene.accelerations(times, q, qd)])
        sides = map(Side, S, rates)
        self.at: dict[float, Side] = dict(zip(times.tolist(), sides, strict=True))

    def beside(self, place: _Place) -> tuple[float, float, float]:
        """Return times before a place, at it, and after it, within the run."""
        by = self.way * place.beside
        return place.t - by, place.t, float(np.clip(place.t + by, min(self.ends), max(self.ends)))

    def largest(self, places: list[_Place]) -> Floats:
        """Return the largest sensitivity to each name at some places and beside them, (m,)."""
        S = [self.at[t].S for place in places for t in self.beside(place)]
        return np.asarray(np.abs(S).max(axis=(0, 1)))

    def derivative(self, place: _Place, i: int) -> Floats:
        """Return the derivatives of a component at a place that moves along, (m,).

        Where no law changes, either the rate is zero or the time is fixed.
        """
        before, at, after = (self.at[t] for t in self.beside(place))
        if (part := continuous_part(before, after)) is not None:
            side = before if place.is_before else after
            return np.asarray(side.S[i] + side.rates[i] * moved_by_a_change(before, after, part))
        if place.beside and place.t == self.ends[1] and self.solution.status == "event":
            return np.asarray(self.at_the_last_event[i])
        return np.asarray(at.S[i])

    @cached_property
    def at_the_last_event(self) -> Floats:
        """Return the derivatives of the state at the event that ended the run, (2n, m)."""
        of_events = sensitivities_at_events(self.solution)
        asked = self.solution.events_asked_for()
        return next(
            one.y[-1]
            for event, found, one in zip(asked, self.solution.events, of_events, strict=True)
            if event.terminal and len(found) and found[-1].t == self.ends[1]
        )
