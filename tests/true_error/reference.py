"""Where a chain truly is, how well that is known, and how far a run is from it.

A trajectory is computed in two kinds of numbers. Their distance is the error of the one with fewer
bits; that of the other is 2^-(bits more) of it, and counted `MARGIN` bits larger. The rounding of
constants, of the state and of times, the step sizes and how errors grow are all in that distance.
Where it does not suffice, a third kind with yet more digits is used.
"""

from __future__ import annotations

from time import monotonic
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import pendcore as pc

from true_error.arithmetic import LADDER, Arithmetic, Floats, Longs
from true_error.asked import Drawn
from true_error.switched import SwitchedTrajectory
from true_error.trajectory import NoReferenceError, Trajectory

WITHIN_A_STEP = 12
MOST_TIMES = 4000
MARGIN = 4
"""Bits by which a reference may be worse than its bits promise."""
LOST = 0.02
"""A larger distance says nothing of the smaller error, which does not follow it."""


class Truth(NamedTuple):
    """Where a chain truly is at n_t times; positions are shares of the total length."""

    angles: Longs
    """Absolute angles, (n_t, n), rad."""
    unsure: Floats
    """The error of positions up to each of the times, (n_t,); infinite where it is not known."""
    unsure_angle: Floats
    """The same of angles, rad."""
    coarse: Floats
    """The error of the same integrator in numbers of fewer bits, (n_t,)."""


class Reference:
    """The truth of a drawn scene; all of it may take so many seconds."""

    def __init__(self, drawn: Drawn, seconds: float) -> None:
        self.drawn = drawn
        self.left = seconds
        self._ladder = [trajectory(drawn, arithmetic) for arithmetic in LADDER]

    def angles(self, t: Floats, *, finest: bool = False) -> Truth:
        """Return the absolute angles at times (n_t,), s, in the order of the run.

        The most digits, ``finest``, take a hundred times longer. Where angles cannot be computed,
        or not in time, that is a `NoReferenceError`.
        """
        coarse, fine = self._ladder[1:] if finest else self._ladder[:2]
        began = monotonic()
        try:
            for motion in (coarse, fine):
                motion.extend(t[-1], began + self.left)
        except (ArithmeticError, ValueError, NotImplementedError) as stop:
            raise NoReferenceError(f"{type(stop).__name__}: {stop}") from stop
        finally:
            self.left -= monotonic() - began
        rough, truth = coarse.angles(t), fine.angles(t)
        gained = 2.0 ** (coarse.arithmetic.bits - fine.arithmetic.bits + MARGIN)
        apart, angle = positions_apart(self.drawn.scene, rough, truth), angles_apart(rough, truth)
        followed = np.maximum.accumulate(apart) < LOST
        return Truth(
            angles=truth,
            unsure=np.where(followed, np.maximum.accumulate(apart) * gained, np.inf),
            unsure_angle=np.where(followed, np.maximum.accumulate(angle) * gained, np.inf),
            coarse=apart,
        )


def trajectory(drawn: Drawn, arithmetic: Arithmetic) -> Trajectory:
    """Return the motion of a drawn scene in one kind of numbers, of the kind that it takes."""
    return (SwitchedTrajectory if drawn.is_switched else Trajectory)(drawn, arithmetic)


# A run beside the truth, over all of its curve --------------------------------------------------


def times_of(sol: pc.Solution, is_dense: bool, rng: np.random.Generator) -> Floats:
    """Return the times at which a run is compared, in its order, s.

    For a dense run these are many random times inside each step, so that no period falls in with
    them, and the ends of its steps. Otherwise they are the times that were kept, each once.
    """
    kept = sol.t[first_of_each(sol.t)] if len(sol.t) else _end(sol)[0]
    if not is_dense or len(kept) < 2:
        return kept
    share = (np.arange(WITHIN_A_STEP) + rng.random((len(kept) - 1, WITHIN_A_STEP))) / WITHIN_A_STEP
    inside = (kept[:-1, None] + share * np.diff(kept)[:, None]).ravel()
    if len(inside) > MOST_TIMES:
        inside = inside[np.sort(rng.choice(len(inside), MOST_TIMES, replace=False))]
    ends = kept if len(kept) <= MOST_TIMES else kept[:: -(-len(kept) // MOST_TIMES)]
    return np.sort(np.concatenate([ends, inside, kept[-1:]]))[:: 1 if kept[-1] >= kept[0] else -1]


def angles_of(sol: pc.Solution, t: Floats, is_dense: bool) -> Floats:
    """Return the absolute angles (n_t, n) of a run at times of `times_of`, rad."""
    if is_dense:
        return sol(t)[: len(sol.scene.links)].T
    return sol.q[first_of_each(sol.t)] if len(sol.t) else _end(sol)[1]


def first_of_each(t: Floats) -> npt.NDArray[np.bool_]:
    """Return where each time stands first; at a jump it stands twice, with the same angles."""
    return np.append(True, np.diff(t) != 0)[: len(t)]


def _end(sol: pc.Solution) -> tuple[Floats, Floats]:
    """Return time (1,) and angles (1, n) of the event that ended a run before it kept anything."""
    last = [found[-1] for found in sol.events if found]
    n = len(sol.scene.links)
    if not last:
        return np.empty(0), np.empty((0, n))
    return np.array([last[0].t]), np.reshape(last[0].q, (1, n))


def positions_apart(scene: pc.Scene, q: Floats | Longs, truth: Longs) -> Floats:
    """Return the largest distance of a joint or the tip (n_t,), as a share of the total length."""
    share = np.array([link.length for link in scene.links])
    share /= share.sum()
    apart = (q - truth).astype(np.float64)
    middle = (truth + 0.5 * apart).astype(np.float64)
    chord = np.cumsum(2.0 * share * np.sin(0.5 * apart) * np.exp(1j * middle), axis=1)
    return np.abs(chord).max(axis=1)


def angles_apart(q: Floats | Longs, truth: Longs) -> Floats:
    """Return the largest difference of an angle (n_t,), rad."""
    return np.abs(q - truth).max(axis=1).astype(np.float64)
