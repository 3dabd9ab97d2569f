"""How well a run kept its energy, which tells of its error without further runs.

And how many digits of its forces are worth printing: no more than its own error leaves right.
"""

from __future__ import annotations

from math import floor, isfinite, log10, pi
from typing import NamedTuple

import numpy as np

from pendcore._messages.arguments import in_a_row
from pendcore._run.solution import Solution
from pendcore._scene.scene import Scene
from pendcore.effects import KINDS

TOO_LARGE = "too large to trust this run: tighten rtol and atol (or the step)"
AMPLIFIED = 10.0
"""The ratio of a force's relative error to the tolerance, at most: errors of steps add up in a run,
as they have in its drift already."""
FEWEST, MOST = 2, 6
"""The least and the most digits of a force."""


class EnergyDrift(NamedTuple):
    """Total energy over the kept times, the true start and the end that was really reached.

    Attributes
    ----------
    start, end : float
        Total energy, J.
    largest_drift : float or None
        The largest change since the start, J; where effects do work, the largest residual of the
        ledger. None if effects do work and there is no ledger: nothing tells work from error.
    largest_kinetic : float
        J: the measure of the motion, as the zero of the potential energy is arbitrary. Where not
        every step was kept, the largest that the total energy allows: what was kept may all be near
        rest.
    relative_drift : float or None
        The drift as a share of the largest kinetic energy; None where nothing moves.
    too_large : bool
        Whether the drift is beyond a thousandth of the largest kinetic energy, or not a number:
        too large to trust the run.
    changed_by : list of str
        The kinds of effects that do work, or lose energy.
    ledger : bool
        Whether a ledger tells how much they do.
    """

    start: float
    end: float
    largest_drift: float | None
    largest_kinetic: float
    relative_drift: float | None
    too_large: bool
    changed_by: list[str]
    ledger: bool

    @property
    def verdict(self) -> str:
        """What follows from a drift that is known and too large; empty otherwise."""
        is_known = self.ledger or not self.changed_by
        return TOO_LARGE if self.too_large and is_known else ""

    @property
    def in_words(self) -> str:
        """How large the drift is, in words."""
        if self.changed_by and not self.ledger:
            return f"not known (changed by {in_a_row(self.changed_by)}): run with ledger=True"
        size, share = self.largest_drift, self.relative_drift
        of_kinetic = "" if share is None else f", {share:.1e} of the largest kinetic energy"
        is_number = size is not None and np.isfinite(size)
        return f"{size:.1e} J{of_kinetic}" if is_number else "not a number"

    def __str__(self) -> str:
        return f"{self.in_words}; {self.verdict}" if self.verdict else self.in_words


def energy_drift(solution: Solution, every: int = 1) -> EnergyDrift:
    """Compute the drift from the states that were kept, or from one state in so many."""
    run, asked = solution._run, solution._run.arguments
    start = np.concatenate([asked["q0"], asked["qd0"]])
    states = np.vstack([start, run.states[::every], run.y_reached])
    times = np.concatenate([[asked["t_start"]], run.t[::every], [run.t_reached]])
    n = states.shape[1] // 2
    kinetic, potential = solution.scene._compiled.energy(times, states[:, :n], states[:, n:])
    effects = solution.scene.effects
    present = {effect.kind for effect in effects if effect.description.account != "none"}
    working = [kind for kind in KINDS if kind in present]
    with np.errstate(all="ignore"):  # a blow-up's energies may be infinite; that is told in words
        total = kinetic + potential
        drift, moving = float(np.abs(total - total[0]).max()), float(kinetic.max())
    ends = float(total[0]), float(total[-1])
    if working:
        ledger = solution.energy().ledger if asked["ledger"] else None
        if ledger is None:
            bad = not np.isfinite(ends[1])
            return EnergyDrift(*ends, None, moving, None, bad, working, ledger=False)
        drift = float(np.abs(ledger.residual).max(initial=0.0))
    elif every > 1 or not solution.keeps_every_step:
        moving = max(moving, float(total[0]) - _lowest_potential(solution.scene))
    # The last bits of the potential energy are no drift, however slow the motion.
    allowed = 1e-3 * moving + 1e-13 * float(np.abs(potential).max())
    share = drift / moving if moving > 0 else None
    too_large = not drift <= allowed
    return EnergyDrift(*ends, drift, moving, share, too_large, working, asked["ledger"])


def trusted_digits(solution: Solution) -> int:
    """See `Solution.trusted_digits`."""
    asked, accuracy = solution.options, solution.accuracy
    shares = [solution.energy_drift().relative_drift or 0.0]
    if asked["step"] is None:  # else tolerances set no step
        shares.append(AMPLIFIED * float(np.max(asked["rtol"])))
    if accuracy is not None and accuracy.times:
        shares.append(accuracy.achieved)
    share = max(shares)
    if not isfinite(share):
        return FEWEST
    return MOST if share == 0 else min(max(floor(-log10(share)), FEWEST), MOST)


def _lowest_potential(scene: Scene) -> float:
    """Return the lowest potential energy: every link hangs, or stands if its weight pulls up, J.

    It is inf if a spring's energy is negative, as its stiffness is: then no pose is the lowest.
    """
    n = len(scene.links)
    all_pull_down = all(link.center >= 0 for link in scene.links)
    # Otherwise one link hangs at a time, and the others are level.
    q = np.full((1, n), pi / 2) if all_pull_down else np.eye(n) * (pi / 2)
    weightless = Scene._unpickled(scene.links, 0.0, scene.effects)
    _, whole = scene._compiled.energy(np.zeros(len(q)), q, np.zeros_like(q))
    _, springs = weightless._compiled.energy(np.zeros(len(q)), q, np.zeros_like(q))
    return np.inf if springs.min() < 0 else -float(np.abs(whole - springs).sum())
