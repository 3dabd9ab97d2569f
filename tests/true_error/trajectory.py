"""A trajectory in one kind of numbers, with its dense output: Taylor series piece by piece."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import pairwise
from time import monotonic
from typing import Any

import heyoka as hy
import numpy as np

from true_error.arithmetic import Arithmetic, Floats, Longs, as_longs
from true_error.asked import Drawn
from true_error.constants import inertia, smooth_torques
from true_error.equations import System, smooth

STEPS = {"double": 500, "long double": 500, "quadruple": 10}
"""Steps between two looks at the clock."""


class NoReferenceError(Exception):
    """The reference cannot, or will not, say where the chain is."""


class Trajectory:
    """The motion of a drawn scene from its start on, as far as it has been asked for."""

    def __init__(self, drawn: Drawn, arithmetic: Arithmetic) -> None:
        self.drawn = drawn
        self.arithmetic = arithmetic
        self.n = len(drawn.scene.links)
        self.direction = 1.0 if drawn.t_end >= drawn.t_start else -1.0
        number = arithmetic.number
        exact = [Fraction(0), *map(Fraction, drawn.q0)], [Fraction(0), *map(Fraction, drawn.qd0)]
        self.state = np.zeros(2 * self.n, dtype=arithmetic.type)
        self.state[:] = [number(b - a) for of in exact for a, b in pairwise(of)]
        self.t = drawn.t_start
        self.time = number(Fraction(drawn.t_start))
        self.begin = 0.0
        self.pieces: list[tuple[float, Any]] = []
        """Where each begins, s after the start, and its dense output."""

    def extend(self, t_end: float, until: float) -> None:
        """Go on to t_end, s; no longer than until the clock shows ``until``, s."""
        if self.direction * (t_end - self.t) <= 0:
            return
        self._go(t_end, until)
        self.t = t_end

    def angles(self, t: Floats) -> Longs:
        """Return the absolute angles (n_t, n), rad, at times (n_t,), s, within what was run."""
        if not self.pieces:
            return np.repeat(as_longs(np.cumsum(self.state[: self.n]))[None], len(t), axis=0)
        later = self.direction * (t - self.drawn.t_start)
        of = np.searchsorted([begin for begin, _ in self.pieces], later, side="right") - 1
        phi = np.empty((len(t), self.n), dtype=np.longdouble)
        for piece in np.unique(of):
            at = np.flatnonzero(of == piece)
            y = self.pieces[piece][1](self.arithmetic.array(t[at]))
            phi[at] = as_longs(y[:, : self.n])
        return np.cumsum(phi, axis=1)

    def _system(self) -> System:
        """Return the compiled system, its parameters set."""
        values = smooth_torques(self.drawn.scene)
        acted_on = any(values.values())
        system = smooth(self.n, acted_on, self.arithmetic)
        system.begin(inertia(self.drawn.scene) | values)
        return system

    def prepared(self, goal: float) -> System:
        """Return the system, ready to go on from here towards a time, s."""
        system = self._system()
        self._put(system)
        return system

    def _go(self, t_end: float, until: float) -> None:
        system = self.prepared(t_end)
        for _ in self._legs(system, t_end, until):
            raise AssertionError("a smooth system has no events")

    def _put(self, system: System) -> None:
        system.integrator.time = self.time
        system.integrator.state[:] = self.state

    def _later(self) -> float:
        """Return how long after the start it is, s."""
        start = self.arithmetic.number(Fraction(self.drawn.t_start))
        return self.direction * float(self.time - start)

    def _legs(self, system: System, t_end: float, until: float) -> Iterator[int]:
        """Propagate to t_end; yield the number of each event on the way, with the state there."""
        goal = self.arithmetic.number(Fraction(t_end))
        while True:
            self.begin = self._later()
            outcome, *_, output, _ = system.integrator.propagate_until(
                goal, max_steps=STEPS[self.arithmetic.name], c_output=True
            )
            if output is not None:
                self.pieces.append((self.begin, output))
            self.time = system.integrator.time
            self.state = system.integrator.state.copy()
            if outcome == hy.taylor_outcome.time_limit:
                return
            if outcome not in (hy.taylor_outcome.step_limit,) and int(outcome) < -(2**32):
                raise NoReferenceError(f"{self.arithmetic.name}: {outcome}")
            if monotonic() > until:
                raise NoReferenceError(f"{self.arithmetic.name}: the time was up")
            if outcome != hy.taylor_outcome.step_limit:
                yield -int(outcome) - 1
