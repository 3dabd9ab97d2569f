"""How far a run is from the truth, over all of its curve."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt
import pendcore as pc

from true_error.arithmetic import Floats, Longs

WITHIN_A_STEP = 12
MOST_TIMES = 4000


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
