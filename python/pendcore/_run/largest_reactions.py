"""The largest joint forces of a run, found between its steps and on both sides of every jump."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, pi
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from numpy.lib.stride_tricks import sliding_window_view

from pendcore import _core
from pendcore._messages.arguments import Floats
from pendcore._messages.progress import Progress, reporting
from pendcore._scene.scene import Scene

IN_A_PIECE = 8
"""The number of times in each piece of a step at which forces are computed first."""
PIECES_A_PERIOD = 2
"""The number of pieces in each period of a drive; a step without a faster drive is one piece."""
MOST_PIECES = 2**16
"""The most pieces of one step."""
BEFORE_THE_END = 1e-6
"""Forces are extrapolated to the end of a piece, where a law may change, from times this share of
the piece and twice this share before the end."""
LAST_BITS = 8
"""The least distance of these times from the end, in last bits of the time."""
ROUNDS = 16
"""The most refinements of a peak, each between the neighbours of the highest of `IN_A_PIECE` + 1
times. The error falls as the square of their distance, so half as many rounds often suffice."""
ROUNDING = 1e-13
"""The share of a force below which a difference is rounding."""
JUMP = 1e-9
"""The share of a force beyond which a difference between the two sides of a time is a jump."""
HELD = 4 * float(np.finfo(float).eps)
"""The share of two links' rates below which their difference is rounding."""
STEADY = 1e-12
"""The share by which a force may vary that counts as constant."""
AT_ONCE = 2**18
"""The most numbers in an array."""


class LargestReaction(NamedTuple):
    """The largest size of a joint's force in a run.

    Attributes
    ----------
    joint : int
        Number of the joint, from 1: link ``joint`` begins there.
    force : float
        N; inf where forces were beyond the range of doubles.
    t : float
        When, s.
    just_before : bool
        Whether the force has this size just before ``t``, where it jumps: an impact, or a joint
        that begins to stick or slide.
    steady : bool
        Whether the force has this size all the time.

    Examples
    --------
    >>> first, second = pc.Case.textbook().simulate().largest_reactions()
    >>> f"{second.force:.2f} N at joint {second.joint}, t = {second.t:.3f} s"
    '22.12 N at joint 2, t = 0.644 s'
    >>> second.just_before, second.steady
    (False, False)
    """

    joint: int
    force: float
    t: float
    just_before: bool
    steady: bool


def largest_reactions(scene: Scene, run: _core.Run, progress: Progress) -> list[LargestReaction]:
    """See `pendcore.Solution.largest_reactions`."""
    search = _Search(scene, run)
    if run.store != "dense":
        search.take(run.t, search.sizes_at(run.t, run.states))
        return search.found(is_over_time=len(set(run.t)) > 1)
    starts, end = run.step_starts, run.t_reached
    with reporting(progress, "looking for the largest reactions") as report:
        for low, high in search.pieces():
            search.look(low, high)
            report(abs(high[-1] - starts[0]) / abs(end - starts[0]))
    search.take(np.array([end]), search.sizes(np.array([end])))
    return search.found()


class _Search:
    """The largest forces so far, (n,), and when they were."""

    def __init__(self, scene: Scene, run: _core.Run) -> None:
        self.scene, self.run = scene, run
        self.n = n = len(scene.links)
        self.best, self.least = np.full(n, -inf), np.full(n, inf)
        self.when, self.before = np.full(n, np.nan), np.zeros(n, dtype=bool)
        self.at_once = max(AT_ONCE // (4 * IN_A_PIECE * n), 16)

    def found(self, is_over_time: bool = True) -> list[LargestReaction]:
        """Return the largest forces; an empty list where there were no times."""
        if np.isinf(self.least).all() and (self.best < 0).all():
            return []
        steady = (self.best < inf) & (self.least >= self.best * (1 - STEADY)) & is_over_time
        columns = (x.tolist() for x in (self.best, self.when, self.before, steady))
        return [LargestReaction(*row) for row in zip(range(1, self.n + 1), *columns, strict=True)]

    def pieces(self) -> Iterator[tuple[Floats, Floats]]:
        """Yield the times at which pieces of steps begin and end, in blocks of bounded size."""
        starts, drive = self.run.step_starts, self.scene.fastest_drive()
        for first in range(0, len(starts), self.at_once):
            low = starts[first : first + self.at_once]
            high = starts[first + 1 : first + 1 + self.at_once]
            if len(high) < len(low):
                high = np.append(high, self.run.t_reached)
            periods = np.abs(high - low) / (2 * pi) * drive
            count = np.clip(np.ceil(PIECES_A_PERIOD * periods), 1, MOST_PIECES).astype(int)
            until = np.cumsum(count)
            for begin in range(0, int(until[-1]), self.at_once):
                k = np.arange(begin, min(begin + self.at_once, int(until[-1])))
                of = np.searchsorted(until, k, side="right")
                part = k - (until - count)[of]
                length = ((high - low) / count)[of]
                end = low[of] + (part + 1) * length
                yield low[of] + part * length, np.where(part + 1 == count[of], high[of], end)

    def sizes(self, t: Floats) -> Floats:
        """Return sizes of the forces at times of the curve, N, (..., n)."""
        found = self.sizes_at(t.ravel(), self.run.evaluate(t.ravel()))
        return found.reshape(*t.shape, self.n)

    def sizes_at(self, t: Floats, states: Floats) -> Floats:
        """Return sizes of the forces at states, N, (k, n); inf where they are not finite."""
        q, qd = states[:, : self.n], states[:, self.n : 2 * self.n].copy()
        # In the interpolant, a held joint may turn by the last bits of its links' rates.
        for j in range(1, self.n):
            size = np.abs(qd[:, j]) + np.abs(qd[:, j - 1])
            is_held = np.abs(qd[:, j] - qd[:, j - 1]) <= HELD * size
            qd[is_held, j] = qd[is_held, j - 1]
        with np.errstate(all="ignore"):
            forces = self.scene._compiled.reactions(t, q, qd)
            found: Floats = np.hypot(forces[..., 0], forces[..., 1])
        return np.where(np.isfinite(found), found, inf)

    def take(self, t: Floats, sizes: Floats) -> None:
        """Keep the sizes (..., n) at times (...) that are larger than all before."""
        if t.size:
            sizes = sizes.reshape(t.size, self.n)
            self.least = np.minimum(self.least, sizes.min(axis=0))
            for i, k in enumerate(sizes.argmax(axis=0)):
                self.take_one(i, float(t.flat[k]), float(sizes[k, i]))

    def take_one(self, i: int, t: float, size: float, just_before: bool = False) -> None:
        """Keep a force of one joint if it is larger than all before."""
        if size > self.best[i]:
            self.best[i], self.when[i], self.before[i] = size, t, just_before

    def look(self, low: Floats, high: Floats) -> None:
        """Search pieces (m,) from ``low`` up to ``high``, where a law may change."""
        bits = LAST_BITS * np.spacing(np.maximum(np.abs(low), np.abs(high)))
        has_inside = np.abs(high - low) > 4 * bits
        if not has_inside.all():
            self.take(low, self.sizes(low))
            low, high, bits = low[has_inside], high[has_inside], bits[has_inside]
        if not len(low):
            return
        length = high - low
        share = np.arange(IN_A_PIECE) / IN_A_PIECE
        short = np.clip(bits / np.abs(length), BEFORE_THE_END, 0.25 / IN_A_PIECE) * length
        t = low[:, None] + length[:, None] * share
        ends = np.stack([high - 2 * short, high - short, high], axis=1)
        grid, at_ends = self.sizes(t), self.sizes(ends)
        self.take(t, grid)
        last = self._limits(ends, at_ends)
        times = np.concatenate([t, ends[:, 1:2]], axis=1)
        self._polish(times, np.concatenate([grid, last[:, None]], axis=1))

    def _limits(self, t: Floats, sizes: Floats) -> Floats:
        """Return the limits of sizes (m, 3, n) at the last of times (m, 3), before a jump there."""
        before, near, after = np.moveaxis(sizes, 1, 0)
        ratio = ((t[:, 2] - t[:, 1]) / (t[:, 1] - t[:, 0]))[:, None]
        with np.errstate(invalid="ignore"):
            limit = np.where(np.isfinite(before + near), near + (near - before) * ratio, near)
            jumps = np.abs(limit - after) > JUMP * np.maximum(limit, after)
        for i in range(self.n):
            k = int(np.where(jumps[:, i], limit[:, i], -inf).argmax())
            if jumps[k, i]:
                self.take_one(i, float(t[k, 2]), float(limit[k, i]), just_before=True)
        return np.asarray(np.where(jumps, limit, after))

    def _polish(self, times: Floats, grid: Floats) -> None:
        """Refine the peaks of a grid of times (m, k) and sizes (m, k, n)."""
        of, joint = np.divmod(np.arange(len(times) * self.n), self.n)
        t, sizes = times[of], grid.transpose(0, 2, 1).reshape(len(of), -1)
        share = np.arange(IN_A_PIECE + 1) / IN_A_PIECE
        for _ in range(ROUNDS):
            row, k = np.nonzero(_may_exceed(sizes, self.best[joint]))
            if not len(row):
                return
            joint = joint[row]
            low, high = t[row, np.maximum(k - 1, 0)], t[row, np.minimum(k + 1, IN_A_PIECE)]
            t = low[:, None] + (high - low)[:, None] * share
            sizes = np.take_along_axis(self.sizes(t), joint[:, None, None], axis=2)[..., 0]
            highest = sizes.argmax(axis=1)
            tops = sizes[np.arange(len(sizes)), highest]
            for i in np.unique(joint):
                best = int(np.where(joint == i, tops, -inf).argmax())
                self.take_one(int(i), float(t[best, highest[best]]), float(tops[best]))


def _may_exceed(sizes: Floats, best: Floats) -> npt.NDArray[np.bool_]:
    """Return at which peaks of rows of sizes (m, k) the curve may exceed ``best``, (m,).

    A smooth curve rises above a sample by less than the sample is above its neighbours.
    """
    around = np.pad(sizes, ((0, 0), (2, 2)), constant_values=inf)
    least = sliding_window_view(around, 5, axis=1).min(axis=-1)
    beside = np.pad(sizes, ((0, 0), (1, 1)), constant_values=-inf)
    is_peak = (sizes >= beside[:, :-2]) & (sizes >= beside[:, 2:]) & np.isfinite(sizes)
    rise = np.where(is_peak, sizes - least, 0.0)
    return np.asarray((rise > ROUNDING * sizes) & (sizes + rise > best[:, None]))
