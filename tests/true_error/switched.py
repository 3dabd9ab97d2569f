"""A trajectory from event to event: joints that stick and slip, stops, laws of several pieces.

At an event with rest in it, each joint at rest holds or slides, and each joint at a stop stays or
leaves. Among all these choices exactly one agrees with the accelerations and torques that it leads
to. Where none does, or two do to within rounding, the reference refuses.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np

from true_error.arithmetic import Arithmetic
from true_error.asked import Drawn
from true_error.constants import Parameters, inertia, smooth_torques
from true_error.equations import System
from true_error.switched_equations import SLOTS, SwitchedSystem, switched
from true_error.switches import (
    NEVER,
    Friction,
    Pieces,
    Stop,
    smooth_own_torques,
    switches_of,
    tables_of,
)
from true_error.trajectory import NoReferenceError, Trajectory

CLEAR = 1e-9
"""The share by which a choice must be clear."""
AT_ONCE = 1e-9
"""s; a quantity at a bound first leaves it, so an event there does not count so soon."""
HARDLY = 1e-24
"""rad/s."""
MOST_EVENTS = 3000


class SwitchedTrajectory(Trajectory):
    """The motion of a scene with events."""

    def __init__(self, drawn: Drawn, arithmetic: Arithmetic) -> None:
        super().__init__(drawn, arithmetic)
        self.switches = switches_of(drawn.scene, arithmetic.nothing)
        if len(self.switches) > SLOTS:
            raise NotImplementedError(f"{len(self.switches)} switches: {SLOTS} events are compiled")
        self.tables = tables_of(drawn.scene, arithmetic.nothing)
        self.frictions = [s for s in self.switches if isinstance(s, Friction)]
        self.stops = [s for s in self.switches if isinstance(s, Stop)]
        self.smooth = inertia(drawn.scene) | _sum(
            smooth_torques(drawn.scene), smooth_own_torques(drawn.scene)
        )
        self.changing: Parameters = {}
        """The parameters that states and tables changed so far, with their unchanged values."""
        self.inside = drawn.t_start
        self.events = 0
        self.has_begun = False

    @property
    def phi(self) -> Any:
        return self.state[: self.n]

    @property
    def w(self) -> Any:
        return self.state[self.n :]

    def prepared(self, goal: float) -> SwitchedSystem:
        """Return the system, ready to go on from here towards a time with no knot before it, s."""
        self.inside = 0.5 * (self.t + goal)
        system = switched(self.n, self.arithmetic)
        never = [NEVER.parameters(slot, self.n) for slot in range(SLOTS)]
        system.begin(_sum(self.smooth, *never))
        system.set(self._parameters())
        if not self.has_begun:
            self._begin(system)
            self.has_begun = True
            system.set(self._parameters())
        system.integrator.reset_cooldowns()
        self._put(system)
        return system

    def _go(self, t_end: float, until: float) -> None:
        for goal in [*self._breaks(t_end), t_end]:
            system = self.prepared(goal)
            fresh, since = self._at_bounds(), self._later()
            for slot in self._legs(system, goal, until):
                if slot in fresh and self._later() - since < AT_ONCE:
                    continue
                self._happen(system, slot)
                fresh, since = self._at_bounds(), self._later()
                system.set(self._parameters())
                self._put(system)
            self.t = goal

    def _now(self, system: System) -> Any:
        """Return accelerations, holding torques, rates after unit impulses: (3, n)."""
        assert isinstance(system, SwitchedSystem)
        return system.at(self.time, self.state, {})

    # Parameters ------------------------------------------------------------------------------

    def _breaks(self, t_end: float) -> list[float]:
        """Return the times at which tables have a knot, from here to the end."""
        knots = {t for table in self.tables for begin, end, _ in table.intervals
                 for t in (begin, end)}  # fmt: skip
        sign = self.direction
        return sorted((t for t in knots if sign * self.t < sign * t < sign * t_end),
                      key=lambda t: sign * t)  # fmt: skip

    def _parameters(self) -> Parameters:
        """Return the parameters that change, for the present states and intervals of tables."""
        parts = [switch.parameters() for switch in self.switches]
        for table in self.tables:
            parts += [
                values for begin, end, values in table.intervals if begin <= self.inside < end
            ]
        changed = {name for part in parts for name in part}
        for name in changed - self.changing.keys():
            self.changing[name] = self.smooth.get(name, Fraction(0))
        found = _sum(self.changing, *parts) | self._held()
        for slot, switch in enumerate(self.switches):
            found |= switch.line().parameters(slot, self.n)
        return found

    def _held(self) -> Parameters:
        """Return the parameters that hold joints."""
        held = {s.joint - 1 for s in self.frictions if not s.sign}
        held |= {s.joint - 1 for s in self.stops if s.held}
        return held_parameters(self.n, held)

    # Events ----------------------------------------------------------------------------------

    def _begin(self, system: SwitchedSystem) -> None:
        """Find the states at the start."""
        at_bounds = []
        for switch in self.switches:
            if isinstance(switch, Pieces):
                x = float(switch.value(self.phi, self.w))
                switch.piece = sum(x > bound for bound in switch.bounds)
                if any(abs(x - float(bound)) < CLEAR for bound in switch.bounds):
                    at_bounds.append((switch, x))
            elif isinstance(switch, Friction):
                switch.slide(float(self.w[switch.joint - 1]))
            elif not switch.low < float(self.phi[switch.joint - 1]) < switch.high:
                raise NoReferenceError("a start at a stop")
        if at_bounds:
            # Its laws have no jumps: on either side of a bound it heads the same way.
            system.set(self._parameters())
            wd = self._now(system)[0]
            for switch, x in at_bounds:
                heading = self.direction * float(switch.value(self.w, wd))
                switch.piece = sum(x + 1e-6 * heading > bound for bound in switch.bounds)
        if any(not friction.sign for friction in self.frictions):
            self._decide(system)

    def _at_bounds(self) -> set[int]:
        """Return the slots whose event has just been, or is where the motion begins."""
        found = set()
        for slot, switch in enumerate(self.switches):
            if isinstance(switch, Friction):
                at = switch.sign != 0 and abs(float(self.w[switch.joint - 1])) < 1e-15
            elif isinstance(switch, Stop):
                phi = float(self.phi[switch.joint - 1])
                at = not switch.held and min(abs(phi - switch.low), abs(phi - switch.high)) < 1e-15
            else:
                x = float(switch.value(self.phi, self.w))
                at = any(abs(x - float(bound)) < 1e-12 for bound in switch.bounds)
            if at:
                found.add(slot)
        return found

    def _happen(self, system: SwitchedSystem, slot: int) -> None:
        """Change the state as an event says."""
        self.events += 1
        if self.events > MOST_EVENTS:
            raise NoReferenceError(f"more than {MOST_EVENTS} events")
        switch = self.switches[slot]
        if isinstance(switch, Pieces):
            bound = switch.line()
            x = float(switch.value(self.phi, self.w))
            below = abs(x - float(bound.low)) < abs(x - float(bound.high))
            for other in self.switches:
                if isinstance(other, Pieces) and other.line() == bound:
                    other.piece += -1 if below else 1  # its own event would do this too late
        elif isinstance(switch, Friction):
            rate = abs(float(self.w[switch.joint - 1]))
            if switch.sign and rate > 0.5 * switch.far:
                switch.is_far = not switch.is_far
            elif switch.sign:
                self.w[switch.joint - 1] = self.arithmetic.type(0.0)
                self._decide(system, switch)
            else:
                # It gives way to the torque that it holds against.
                holding = self._now(system)[1][switch.joint - 1]
                self._let_slide(switch, -int(np.sign(float(holding))))
        elif switch.held:
            switch.held = 0
        else:
            self._impact(system, switch)

    def _impact(self, system: SwitchedSystem, stop: Stop) -> None:
        """Let a joint bounce off its stop, or come to rest there."""
        j = stop.joint - 1
        speed = self.w[j]
        at_high = float(speed) > 0
        self.phi[j] = self.arithmetic.number(Fraction(stop.high if at_high else stop.low))
        if abs(abs(float(speed)) - stop.capture_speed) < CLEAR * stop.capture_speed:
            raise NoReferenceError("an impact at the capture speed")
        is_captured = abs(float(speed)) < stop.capture_speed or not stop.restitution
        e = Fraction(0) if is_captured else stop.restitution
        unit = {f"i{k}": Fraction(int(k == j)) for k in range(self.n)}
        after = system.at(self.time, self.state, unit | held_parameters(self.n, set()))[2]
        impulse = -self.arithmetic.number(1 + e) * speed / after[j]
        self.w[:] = self.w + impulse * after
        self.w[j] = -self.arithmetic.number(e) * speed
        for friction in self.frictions:
            friction.slide(float(self.w[friction.joint - 1]))
        if is_captured:
            self._decide(system, stop, side=1 if at_high else -1)

    def _decide(self, system: SwitchedSystem, cause: Any = None, side: int = 0) -> None:
        """Find which joints at rest hold, which slide, and whether one at a stop stays there."""
        resting = [f for f in self.frictions if f is cause or not f.sign]
        contacts = [(s, side or s.held) for s in self.stops if s.held or s is cause]

        def take(signs: tuple[int, ...], stays: tuple[bool, ...]) -> None:
            for friction, sign in zip(resting, signs, strict=True):
                friction.sign = sign
            for (stop, at), is_held in zip(contacts, stays, strict=True):
                stop.held = at if is_held else 0

        found = []
        for signs in product((0, 1, -1), repeat=len(resting)):
            for stays in product((True, False), repeat=len(contacts)):
                take(signs, stays)
                found.append((self._agreement(system, resting, contacts), signs, stays))
        found.sort(key=lambda each: -each[0])
        if found[0][0] < CLEAR or (len(found) > 1 and found[1][0] > -CLEAR):
            raise NoReferenceError(f"whether joints hold is not clear: {found[:2]}")
        _, signs, stays = found[0]
        take(signs, stays)
        for friction, sign in zip(resting, signs, strict=True):
            self._let_slide(friction, sign)

    def _let_slide(self, friction: Friction, sign: int) -> None:
        """Let a joint at rest slide, or hold (0), at a rate that is next to nothing.

        Then the rate has no zero where the slide begins, not even by rounding.
        """
        friction.sign, friction.is_far = sign, False
        self.w[friction.joint - 1] = sign * self.arithmetic.type(HARDLY)

    def _agreement(self, system: SwitchedSystem, resting: list[Friction], contacts: Any) -> float:
        """Return how clearly the states agree with the motion that they lead to; < 0 if not."""
        now = self._parameters()
        wd, holding, _ = np.asarray(system.at(self.time, self.state, now), dtype=np.float64)
        fastest, strongest = np.abs(wd).max() + 1e-300, np.abs(holding).max() + 1e-300
        found = []
        for friction in resting:
            j = friction.joint - 1
            if friction.sign:
                found.append(friction.sign * wd[j] / fastest)
            else:
                found.append(1 - abs(holding[j]) / float(friction.static))
        for stop, at in contacts:
            j = stop.joint - 1
            found.append(-at * (holding[j] / strongest if stop.held else wd[j] / fastest))
        return min(found)


def held_parameters(n: int, held: set[int]) -> Parameters:
    """Return the parameters that hold some joints, counted from 0, and let the others go."""
    found = {}
    for j in range(n):
        found[f"s{j}"] = Fraction(int(j in held))
        for k in range(n):
            found[f"u{j}{k}"] = Fraction(int(not {j, k} & held))
    return found


def _sum(*parts: Parameters) -> Parameters:
    found: Parameters = {}
    for part in parts:
        for name, value in part.items():
            found[name] = found.get(name, Fraction(0)) + value
    return found
