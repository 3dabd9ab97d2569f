"""How well a run kept its energy: the one thing that it can say about its own error."""

from __future__ import annotations

from math import pi
from typing import NamedTuple

import numpy as np

from pendcore.solution import Solution

TOO_LARGE = "too large to trust this run: tighten rtol and atol (or the step)"


class EnergyDrift(NamedTuple):
    """Total energy over the kept times, the true start and the end that was really reached.

    Attributes
    ----------
    start, end : float
        Total energy, J.
    largest_drift : float
        From the start, J.
    largest_kinetic : float
        J: the measure of the motion, as the zero of the potential energy is arbitrary. Where not
        every step was kept, what the total energy allows: what was kept may all be near rest.
    relative_drift : float or None
        The drift as a share of it; None where nothing moves.
    too_large : bool
        Beyond a thousandth (or not a number), so that the run is not what it says.
    """

    start: float
    end: float
    largest_drift: float
    largest_kinetic: float
    relative_drift: float | None
    too_large: bool


def has_every_step(solution: Solution) -> bool:
    """Whether the kept times are those of the steps, and not those asked for."""
    asked_for = solution._run.arguments["t_eval"] is not None
    return solution.store in ("dense", "steps") and not asked_for


def energy_drift(solution: Solution) -> EnergyDrift:
    """Compute it from what was kept."""
    run = solution._run
    start = np.concatenate([run.arguments["q0"], run.arguments["qd0"]])
    states = np.vstack([start, run.states, run.y_reached])
    n = states.shape[1] // 2
    kinetic, potential = solution.scene._compiled.energy(states[:, :n], states[:, n:])
    with np.errstate(all="ignore"):  # a blow-up's energies may be infinite; that is told in words
        total = kinetic + potential
        drift, moving = float(np.abs(total - total[0]).max()), float(kinetic.max())
    if not has_every_step(solution):
        moving = max(moving, float(total[0]) - _lowest_potential(solution, n))
    # The last bits of the potential energy are no drift, however slow the motion.
    allowed = 1e-3 * moving + 1e-13 * float(np.abs(potential).max())
    share = drift / moving if moving > 0 else None
    return EnergyDrift(total[0], total[-1], drift, moving, share, not drift <= allowed)


def _lowest_potential(solution: Solution, n: int) -> float:
    """Return that of every link hanging (or standing, where its weight pulls that way), J."""
    one_hangs = np.eye(n) * (pi / 2)  # and the others are level, without potential
    _, potential = solution.scene._compiled.energy(one_hangs, np.zeros((n, n)))
    return -float(np.abs(potential).sum())


def text(drift: float | None, share: float | None) -> str:
    """Return drift and share for people; neither is there if it is no number."""
    if drift is None or not np.isfinite(drift):
        return "not a number"
    of_kinetic = "" if share is None else f", {share:.1e} of the largest kinetic energy"
    return f"{drift:.1e} J{of_kinetic}"
