"""What a guess of a periodic orbit leaves open: its period, who sets it, and its arcs."""

from __future__ import annotations

from math import ceil, log
from typing import Any

import numpy as np
import numpy.typing as npt

from pendcore import Scene, simulate
from pendcore.messages import Floats, finite_array, numbers, vector, whole_number
from pendcore.orbits.shooting import GROWTH, MOST_ARCS, TOLERANCES, Arcs, Shooting, velocity

_TIMES = np.array([0.0, 0.137, 0.291, 0.418, 0.553, 0.676, 0.811, 0.947])
"""Shares of a period at which it is seen whether anything depends on time."""


def states_given(scene: Scene, q0: npt.ArrayLike, qd0: npt.ArrayLike) -> Floats:
    """Return the states of a guess at equal times, (m, 2n)."""
    n = len(scene.links)
    parts = []
    for name, given, unit in (("q0", q0, "rad"), ("qd0", qd0, "rad/s")):
        array = finite_array(name, given, unit)
        if array.ndim < 2:
            array = np.array([vector(name, given, n, unit)])
        elif array.ndim > 2 or array.shape[1] != n or not len(array):
            raise ValueError(f"{name}: shape {array.shape}: must be ({n},) or (m, {n}) ({unit})")
        parts.append(array)
    if len(parts[1]) not in (1, len(parts[0])):
        raise ValueError(f"qd0: {len(parts[1])} rows: must be as many as q0 has, {len(parts[0])}")
    return np.hstack([parts[0], np.broadcast_to(parts[1], parts[0].shape)])


def finite_positive(name: str, value: Any, unit: str) -> float:
    """Return a number that is finite and above 0."""
    (given,) = numbers(name, [value], unit, finite=False)
    if not (np.isfinite(given) and given > 0):
        raise ValueError(f"{name} = {value!r}: must be finite and > 0{f' ({unit})' * bool(unit)}")
    return given


MOST_GIVEN = 200
"""So many arcs may be asked for: the time of a correction grows with their cube."""


def cut_as_it_grows(shooting: Shooting, guess: Arcs, arcs: int | None) -> Arcs:
    """Return guesses at equal times of the motion from the one that is given."""
    if arcs is None:
        arcs = min(MOST_ARCS, max(1, ceil(log(shooting.growth(guess)) / log(GROWTH))))
    elif not 1 <= whole_number("arcs", arcs) <= MOST_GIVEN:
        raise ValueError(f"arcs = {arcs}: must be 1 to {MOST_GIVEN}")
    times = np.linspace(0.0, guess.period, arcs + 1)[:-1]
    sol = simulate(
        shooting.scene, (0.0, guess.period), *np.split(guess.states[0], 2),
        **{**TOLERANCES, "t_eval": times, "store": "times"},
    )  # fmt: skip
    return Arcs(sol.y.T.copy(), guess.period)


def first_return(scene: Scene, start: Floats) -> float:
    """Return when the motion first comes back close to a state, s."""
    n = len(scene.links)
    q, qd = np.split(start, 2)
    by_q, by_qd = scene.jacobian(0.0, q, qd)
    linear = np.block([[np.zeros((n, n)), np.eye(n)], [by_q, by_qd]])
    turning = np.sqrt(np.abs(scene.accelerations(0.0, q, qd)).max())
    fastest = max(np.abs(np.linalg.eigvals(linear)).max(), np.abs(qd).max(), turning, 1e-9)
    scales = np.repeat([1.0, fastest], n)
    times = np.linspace(0.0, 200 / fastest, 8001)
    sol = simulate(scene, (0.0, times[-1]), q, qd, t_eval=times, on_failure="raise")
    away = sol.y.T - start
    away[:, :n] = (away[:, :n] + np.pi) % (2 * np.pi) - np.pi
    far = np.linalg.norm(away / scales, axis=1)
    ahead = (away / scales) @ (velocity(scene, 0.0, start) / scales)
    back = np.flatnonzero((ahead[:-1] < 0) & (ahead[1:] >= 0) & (far[1:] < 0.4 * far.max())) + 1
    if not len(back):
        raise RuntimeError(
            f"the motion from q0 does not come back within {times[-1]:.6g} s: give a period"
        )
    return float(times[back[0]])


def period_of(scene: Scene, start: Floats, period: float | None) -> tuple[float, bool]:
    """Return the period, guessed if none is given, and whether a drive sets it."""
    if period is not None:
        guess, taken_as = finite_positive("period", period, "s"), ""
    elif scene.fastest_drive() > 0:
        guess, taken_as = 2 * np.pi / scene.fastest_drive(), "the period of the fastest drive"
    else:
        guess, taken_as = first_return(scene, start), "when the motion first comes back"
    return guess, _depends_on_time(scene, start, guess, taken_as)


def _depends_on_time(scene: Scene, start: Floats, period: float, taken_as: str) -> bool:
    """Whether anything depends on time; if so, it must come back after the period.

    ``taken_as`` says what the period is, if it was not given.
    """
    n = len(scene.links)
    near = start + 0.3 * np.sin(np.arange(len(_TIMES))[:, np.newaxis] * (1 + np.arange(2 * n)))
    q, qd = near[:, :n], near[:, n:]
    first, later = scene.accelerations(0.0, q, qd), scene.accelerations(_TIMES * period, q, qd)
    if np.array_equal(first, later):
        return False
    again = scene.accelerations((1 + _TIMES) * period, q, qd)
    if np.abs(again - later).max() > 1e-9 * (1 + np.abs(later).max()):
        told = "what drives this scene is not the same after"
        if taken_as:
            raise ValueError(
                f"period = None: {told} {period:.6g} s, {taken_as}: give one that is a whole "
                "number of the periods of everything that drives it (s), if there is one"
            )
        raise ValueError(f"period = {period}: {told} it: must be a whole number of its periods (s)")
    return True


def require_free_joints(scene: Scene) -> None:
    """Refuse locks."""
    for i, effect in enumerate(scene.effects, 1):
        if effect.kind == "lock":
            raise ValueError(
                f"scene: effect {i} (lock): the rate of a locked joint has no derivative: make one "
                "link of the two that it joins"
            )


def require_same_after(scene: Scene, start: Floats, turns: Floats) -> None:
    """Refuse whole turns that springs or controllers notice."""
    q, qd = np.split(start, 2)
    here, there = (scene.accelerations(0.0, q + x * 2 * np.pi, qd) for x in (0.0, turns))
    if np.abs(here - there).max() > 1e-9 * (1 + np.abs(here).max()):
        raise ValueError(f"turns = {turns.astype(int)}: a scene that has turned so is another one")
