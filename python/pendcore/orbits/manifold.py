"""Motions that leave a periodic orbit, or come to it: its unstable and its stable manifold."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np

from pendcore import Scene, Solution, events, simulate
from pendcore.messages import Floats, at_least
from pendcore.orbits.shooting import TOLERANCES, derivatives, silent_run

SECTION = "must be an event, such as pc.events.LinkAngle(2, np.pi / 2, every_turn=True)"
"""What ``until`` is."""


@dataclass(frozen=True, slots=True, kw_only=True, eq=False, repr=False)
class Manifold:
    """One side of the unstable or the stable manifold of a periodic orbit.

    The motions begin at ``offset`` from the orbit, one for each phase from 0 to 1: in two links
    they are a tube. `PeriodicOrbit.manifold` makes it; nothing is computed before it is asked for.

    Attributes
    ----------
    scene : Scene
    stability : {"unstable", "stable"}
    multiplier : float
        By how much the distance from the orbit grows in a period.
    period : float
        Of the orbit, s.
    offset : float
        How far from the orbit the motions begin at most, rad: as much nearer at other phases as
        they must be for the distance to grow evenly in time.
    until : event or None
        Where the motions end.
    duration : float
        How long they may take, s.

    Examples
    --------
    >>> orbit = pc.equilibria(pc.Scene.textbook())[1].orbit(1, amplitude=0.1)
    >>> tube = orbit.manifold("unstable", duration=2.0)
    >>> f"{np.abs(tube.start(0.0)[:2] - orbit.q0).max():.0e} rad"
    '2e-05 rad'
    """

    scene: Scene
    stability: Literal["stable", "unstable"]
    multiplier: float
    period: float
    is_forced: bool
    until: events.Event | None
    duration: float
    offset: float
    arcs: Floats
    directions: Floats

    def __repr__(self) -> str:
        return (
            f"<Manifold: {self.stability}, multiplier {self.multiplier:.6g}, from {self.offset:g} "
            f"rad off an orbit of period {self.period:.6g} s>"
        )

    def start(self, phase: float) -> Floats:
        """Return the state at which the motion of a phase begins, (2n,), rad and rad/s.

        A phase of 0.5 belongs to the orbit half a period after its ``q0``.
        """
        m, size = self.arcs.shape
        k, share = divmod(phase % 1.0 * m, 1.0)
        state, along, t0 = self.arcs[int(k)], self.directions[int(k)], k * self.period / m
        if share:
            names = [f"{kind}[{i + 1}]" for kind in ("q0", "qd0") for i in range(size // 2)]
            span = (t0, t0 + share * self.period / m)
            sol = silent_run(self.scene, span, state, sensitivities=names)
            even = abs(self.multiplier) ** (-share / m)
            state, along = sol.y[:, -1], even * derivatives(sol)[-1] @ along
        started: Floats = state + self.offset * along
        return started

    def run(self, phase: float, **options: Any) -> Solution:
        """Simulate the motion of a phase; the options are those of `simulate`.

        It ends at ``until``, or after ``duration``; along a stable manifold it goes backward.
        """
        start = self.start(phase)
        t0 = phase % 1.0 * self.period
        t1 = t0 + (self.duration if self.stability == "unstable" else -self.duration)
        found = [] if self.until is None else [replace(self.until, terminal=self._occurrence)]
        asked = {**TOLERANCES, "store": "steps", "events": found, **options}
        return simulate(self.scene, (t0, t1), *np.split(start, 2), **asked)

    @property
    def _occurrence(self) -> bool | int:
        return getattr(self.until, "terminal", False) or True

    def crossing(self, phase: float, **options: Any) -> Floats:
        """Return the state in which the motion of a phase comes to ``until``, (2n,); NaN if never.

        Raises
        ------
        ValueError
            If there is no ``until``.
        """
        if self.until is None:
            raise ValueError(f"until = None: {SECTION}")
        sol = self.run(phase, **{"store": "end", **options})
        if sol.status != "event":
            return np.full(self.arcs.shape[1], np.nan)
        end: Floats = sol.events[0].y[-1]
        return end

    def crossings(self, count: int) -> Floats:
        """Return where motions of so many even phases come to ``until``, (count, 2n).

        Examples
        --------
        >>> orbit = pc.equilibria(pc.Scene.textbook())[1].orbit(1, amplitude=0.1)
        >>> hanging = pc.events.LinkAngle(2, np.pi / 2, every_turn=True)
        >>> orbit.manifold("unstable", until=hanging).crossings(3)[:, 1] / np.pi
        array([0.5, 0.5, 0.5])
        """
        phases = np.arange(at_least("count", count, 1)) / count
        return np.array([self.crossing(phase) for phase in phases])
