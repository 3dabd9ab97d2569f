"""Motions that close, by multiple shooting: Newton's method on states and period at once.

The orbit is cut into m arcs of equal times T/m. Unknown are the states x_k with which these begin,
T where no drive sets it, and in a family one number more, p. With phi the motion over an arc:

    phi(x_k) - x_(k+1) = 0        phi(x_(m-1)) - x_0 - (2 pi turns, 0) = 0
    f(x) . (x_0 - x) = 0          the phase, from the last guess x, where nothing depends on time
    E(x_0) - E = 0                where energy is kept

Where energy is kept these are one more than the unknowns, and agree; where it is not known to be,
as with forces of the user's, the system may be singular. Each step is the shortest that solves the
linear system best. Derivatives of phi are those of `simulate(sensitivities=...)`.

Source: Deuflhard, BIT 24 (1984) 456; Doedel et al., Int. J. Bifurcation Chaos 13 (2003) 1353.
"""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from itertools import pairwise
from math import inf
from typing import Any, NamedTuple

import numpy as np

from pendcore import PendcoreWarning, Scene, Solution, simulate
from pendcore.messages import Floats, silence

TOLERANCES: dict[str, Any] = {"rtol": 1e-13, "atol": 1e-16, "store": "end", "on_failure": "raise"}
SECOND_OPINION: dict[str, Any] = {**TOLERANCES, "method": "dop853", "rtol": 1e-14}
CORRECTIONS = 25
CLOSE = 1e-9
"""rad; what fails to close by more is no orbit."""
LONGEST = 0.3
"""The largest change of an angle, rad, or of the period, as a share of it, in a step."""
GROWTH = 30.0
"""By how much a change of the state may grow in an arc before the arc is cut in two."""
MOST_ARCS = 64
_STENCIL = np.array([1 / 280, -4 / 105, 1 / 5, -4 / 5, 0.0, 4 / 5, -1 / 5, 4 / 105, -1 / 280])
_WIDTH = 0.05
"""Central differences of order 8: exact for energies, to rounding."""


class Arcs(NamedTuple):
    """An orbit, or a guess of one: where its arcs begin, its period, and the number p."""

    states: Floats  # (m, 2n)
    period: float  # s
    value: float = 0.0


class System(NamedTuple):
    """The equations about some arcs, in radians and without units."""

    residual: Floats
    jacobian: Floats
    columns: Floats  # what a unit of each unknown is
    transitions: Floats  # (m, 2n, 2n): d phi(x_k)/dx_k
    ends: Floats  # (m, 2n)


class Closed(NamedTuple):
    """Arcs that close, and how surely."""

    arcs: Arcs
    transitions: Floats  # (m, 2n, 2n)
    closure: float  # rad
    errors: Floats  # of the unknowns, in their units
    corrections: int
    tangent: Floats  # the direction in which the family goes on


class NotClosedError(RuntimeError):
    """Newton's method did not find arcs that close."""


def velocity(scene: Scene, t: float, state: Floats) -> Floats:
    """d(q, qd)/dt, (2n,)."""
    q, qd = np.split(state, 2)
    return np.concatenate([qd, scene.accelerations(t, q, qd)])


def silent_run(scene: Scene, span: tuple[float, float], start: Floats, **asked: Any) -> Solution:
    """Simulate a trial; an error where the derivatives that were asked for do not go to its end."""
    with warnings.catch_warnings():  # what is wrong with a trial is told later
        warnings.simplefilter("ignore", PendcoreWarning)
        run = simulate(scene, span, *np.split(start, 2), **{**TOLERANCES, **asked})
    if run.sensitivities is None or np.isfinite(run.sensitivities).all():
        return run
    with warnings.catch_warnings(record=True) as heard:  # the last warning of a run says why
        warnings.simplefilter("always")
        simulate(scene, span, *np.split(start, 2), **{**TOLERANCES, **asked})
    told = [str(one.message) for one in heard if issubclass(one.category, PendcoreWarning)]
    why = f": {told[-1]}" if told else ""
    raise NotClosedError(
        f"the motion from q0 = {np.split(start, 2)[0].round(6).tolist()} has no derivative by its "
        f"start, at least not to its end{why}; begin elsewhere"
    )


def derivatives(run: Solution) -> Floats:
    """The derivatives that a trial was asked for, (n_t, 2n, k)."""
    assert run.sensitivities is not None
    return run.sensitivities


def total_energy(scene: Scene, states: Floats) -> Floats:
    """J, (...), of states (..., 2n)."""
    kinetic, potential = scene.energy(0.0, *np.split(states, 2, axis=-1))
    return kinetic + potential


def require_energy(name: str, energy: float, scene: Scene) -> None:
    """Refuse an energy that no motion has: springs add to that of weights, if they are not at rest.

    Each link weighs in as a multiple of the sine of its angle.
    """
    effects = [one for one in scene.effects if one.kind != "torsional_spring"]
    with silence():  # what is implausible was said of the scene itself
        alone = scene.replace(effects=effects)
    n = len(scene.links)
    level = total_energy(alone, np.zeros(2 * n))
    by_link = total_energy(alone, np.pi / 2 * np.eye(n, 2 * n)) - level
    least = float(level - np.abs(by_link).sum())
    if energy <= least:
        raise ValueError(
            f"{name} = {energy:.6g}: must be > {least:.6g} (J): links that hang at rest have no "
            "less"
        )


def energy_gradient(scene: Scene, state: Floats) -> Floats:
    """dE/d(q, qd), (2n,)."""
    moves = _WIDTH * np.arange(-4, 5)[:, np.newaxis, np.newaxis] * np.eye(len(state))
    gradient: Floats = _STENCIL @ total_energy(scene, state + moves) / _WIDTH
    return gradient


def tangent_of(made: System) -> Floats:
    """Return the direction along which the equations go on to hold."""
    tangent: Floats = np.linalg.svd(made.jacobian)[2][-1]
    return tangent


def _inverse(jacobian: Floats) -> Floats:
    return np.linalg.pinv(jacobian, rcond=1e-11).astype(float)


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class Shooting:
    """What is to hold of an orbit.

    Attributes
    ----------
    scene : Scene
    is_forced : bool
        Whether a drive sets the period.
    energy : float or None
        J, where it is kept.
    turns : ndarray, (n,)
        By how many whole turns each link has gone round when the orbit closes.
    unit : float
        What a rate of 1 means, rad/s: rates over it are comparable with angles.
    free : str
        The number that changes in a family: ``"energy"``, the name of a parameter, or nothing.
    span : float
        The change of that number that counts as large.
    """

    scene: Scene
    is_forced: bool
    energy: float | None
    turns: Floats
    unit: float
    free: str = ""
    span: float = 1.0

    def at(self, value: float) -> Scene:
        """Return the scene at this value of what changes."""
        if self.free in ("", "energy"):
            return self.scene
        return self.scene.with_parameters({self.free: value})

    @property
    def scales(self) -> Floats:
        """Units of angles and rates, (2n,)."""
        return np.repeat([1.0, self.unit], len(self.turns))

    @property
    def names(self) -> list[str]:
        """The start's names, as `simulate(sensitivities=...)` takes them."""
        return [f"{kind}[{i + 1}]" for kind in ("q0", "qd0") for i in range(len(self.turns))]

    def runs(self, arcs: Arcs, **asked: Any) -> list[Solution]:
        """Simulate each arc."""
        spans = pairwise(np.linspace(0.0, arcs.period, len(arcs.states) + 1))
        return [
            silent_run(self.at(arcs.value), span, start, **asked)
            for start, span in zip(arcs.states, spans, strict=True)
        ]

    def growth(self, arcs: Arcs) -> float:
        """Return by how much a change of the state grows in an arc, at most and at any time."""
        found = [
            derivatives(run) * self.scales / self.scales[:, np.newaxis]
            for run in self.runs(arcs, sensitivities=self.names, store="steps")
        ]
        return max(float(np.linalg.norm(one, 2, axis=(1, 2)).max()) for one in found)

    def gaps(self, arcs: Arcs, ends: Floats) -> Floats:
        """How far each arc ends from where the next begins, (m, 2n), in rad."""
        around = np.concatenate([2 * np.pi * self.turns, 0.0 * self.turns])
        following = np.roll(arcs.states, -1, axis=0)
        following[-1] += around
        return (ends - following) / self.scales

    def system(self, arcs: Arcs, about: Arcs) -> System:
        """Return the equations at these arcs, the phase being that of ``about``."""
        m, size = arcs.states.shape
        by_parameter = self.free not in ("", "energy")
        runs = self.runs(arcs, sensitivities=self.names + [self.free] * by_parameter)
        ends = np.array([run.y[:, -1] for run in runs])
        found = np.array([derivatives(run)[-1] for run in runs])
        scene, transitions = self.at(arcs.value), found[:, :, :size]
        jacobian = np.zeros((m, size, m, size))
        for k in range(m):
            jacobian[k, :, k] += transitions[k]
            jacobian[k, :, (k + 1) % m] -= np.eye(size)
        rows, columns = jacobian.reshape(m * size, m * size), np.tile(self.scales * m**0.5, m)
        residual = self.gaps(arcs, ends).reshape(-1)
        by_time = np.array([velocity(scene, arcs.period * (k + 1) / m, ends[k]) for k in range(m)])
        by_time /= m
        extra = np.zeros((m * size, 0))
        if not self.is_forced:
            extra, columns = by_time.reshape(-1, 1), np.append(columns, arcs.period)
        if self.free:
            along = found[:, :, size] if by_parameter else np.zeros((m, size))
            if self.period_follows:
                along = along - by_time * arcs.period / arcs.value
            extra = np.column_stack([extra, along.reshape(-1)])
            columns = np.append(columns, self.span)
        rows = np.hstack([rows, extra]) / np.tile(self.scales, m)[:, np.newaxis]
        if not self.is_forced:
            f = velocity(scene, 0.0, about.states[0]) / self.scales
            row = np.zeros(rows.shape[1])
            row[:size] = f / np.linalg.norm(f) / self.scales
            moved = arcs.states[0] - about.states[0]
            rows, residual = np.vstack([rows, row]), np.append(residual, row[:size] @ moved)
        if self.energy is not None:
            row, off = self._energy_row(arcs, self.energy, rows.shape[1])
            rows, residual = np.vstack([rows, row]), np.append(residual, off)
        return System(residual, rows * columns, columns, transitions, ends)

    @property
    def period_follows(self) -> bool:
        """Whether the number that changes is the frequency that sets the period."""
        return self.is_forced and self.free.endswith("angular_frequency")

    def _energy_row(self, arcs: Arcs, energy: float, width: int) -> tuple[Floats, float]:
        scene, start = self.at(arcs.value), arcs.states[0]
        wanted = arcs.value if self.free == "energy" else energy
        gradient = energy_gradient(scene, start)
        row = np.zeros(width)
        row[: len(start)] = gradient
        if self.free == "energy":
            row[-1] = -1.0
        elif self.free:
            steps = arcs.value + _WIDTH * self.span * np.arange(-4, 5)
            near = [total_energy(self.at(value), start) for value in steps]
            row[-1] = _STENCIL @ np.array(near) / (_WIDTH * self.span)
        size = float(np.linalg.norm(gradient * self.scales))
        return row / size, float(total_energy(scene, start) - wanted) / size

    def moved(self, arcs: Arcs, step: Floats) -> Arcs:
        """Return the arcs after a step of the unknowns."""
        m, size = arcs.states.shape
        rest = list(step[m * size :])
        period = arcs.period if self.is_forced else arcs.period + rest.pop(0)
        value = arcs.value + (rest.pop(0) if self.free else 0.0)
        if self.period_follows:
            period = arcs.period * arcs.value / value
        return Arcs(arcs.states + step[: m * size].reshape(m, size), float(period), float(value))

    def closed(self, guess: Arcs, tangent: Floats | None = None) -> Closed:
        """Return arcs that close, by Newton's method.

        With a tangent, they lie in the plane through the guess to which it is normal; without one,
        the number that changes is held.

        Raises
        ------
        NotClosedError
            With what was reached.
        """
        arcs, before = guess, inf
        for k in range(CORRECTIONS):
            made = self.system(arcs, arcs if tangent is None else guess)
            jacobian, residual = made.jacobian, made.residual
            if tangent is not None:
                away = tangent @ (self._difference(arcs, guess) / made.columns)
                jacobian, residual = np.vstack([jacobian, tangent]), np.append(residual, away)
            elif self.free:
                jacobian = jacobian[:, :-1]
            step, gap = -_inverse(jacobian) @ residual, np.abs(made.residual).max()
            size = float(np.abs(step).max())
            unknowns: Floats = step * made.columns[: len(step)]
            if gap < CLOSE and (size < 1e-14 or (size < 1e-7 and size > before / 4)):
                return self._certain(arcs, made, unknowns, k)
            if self.free and tangent is None:
                unknowns = np.append(unknowns, 0.0)
            arcs, before = self.moved(arcs, unknowns * LONGEST / max(size, LONGEST)), size
        raise NotClosedError(f"after {k + 1} corrections it still fails to close by {gap:.3g} rad")

    def _difference(self, one: Arcs, other: Arcs) -> Floats:
        rest = [] if self.is_forced else [one.period - other.period]
        rest += [one.value - other.value] if self.free else []
        return np.concatenate([(one.states - other.states).reshape(-1), rest])

    def _certain(self, arcs: Arcs, made: System, step: Floats, corrections: int) -> Closed:
        """Return arcs that close, with the errors that runs and rounding leave in them.

        These are three times what a second method, at a tighter tolerance, would correct,
        the last correction, and what the condition makes of rounding errors, at this value of the
        number that changes.
        """
        inverse = _inverse(made.jacobian[:, :-1] if self.free else made.jacobian)
        ends = np.array([run.y[:, -1] for run in self.runs(arcs, **SECOND_OPINION)])
        other = self.gaps(arcs, ends).reshape(-1)
        residual = np.zeros(inverse.shape[1])
        residual[: len(other)] = other
        largest = np.abs(np.vstack([arcs.states, made.ends]) / self.scales).max()
        rounding = np.full(inverse.shape[1], np.finfo(float).eps * (1 + largest))
        if self.energy is not None:
            scene, start = self.at(arcs.value), arcs.states[0]
            parts = np.abs(scene.energy(0.0, *np.split(start, 2))).sum()
            slope = np.linalg.norm(energy_gradient(scene, start) * self.scales)
            rounding[len(other) + 1] = np.finfo(float).eps * parts / slope
        columns = made.columns[: len(inverse)]
        opinion = np.abs(inverse @ residual) + np.linalg.norm(inverse * rounding, axis=1)
        errors = 3 * columns * opinion + np.abs(step[: len(inverse)])
        closure = float(np.abs(self.gaps(arcs, made.ends)).max())
        return Closed(arcs, made.transitions, closure, errors, corrections, tangent_of(made))

    def cut(self, arcs: Arcs) -> Arcs:
        """Return the arcs, each cut in two."""
        halves = arcs._replace(states=np.repeat(arcs.states, 2, axis=0))
        halves.states[1::2] = [run.y[:, -1] for run in self.runs(halves)[::2]]
        return halves
