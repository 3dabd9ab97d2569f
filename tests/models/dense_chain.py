"""Chains of uniform rods as dense matrices in NumPy, with the laws of contact by trial.

Nothing here is shared with the core. The equations are those of docs/reference/conventions.md,
written down once more; the contacts that act are found by trying all that could.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class DenseChain:
    masses: Array
    lengths: Array
    gravity: float

    @property
    def n(self) -> int:
        return len(self.masses)

    @property
    def moments(self) -> Array:
        """a_i = m_i L_i/2 + L_i (m_{i+1} + ... + m_n)."""
        beyond = np.append(np.cumsum(self.masses[::-1])[::-1][1:], 0.0)
        return self.masses * self.lengths / 2 + self.lengths * beyond

    @property
    def couplings(self) -> Array:
        """A_ij = L_min a_max; A_ii = m_i L_i^2/3 + L_i^2 S_i."""
        a, lengths = self.moments, self.lengths
        i, j = np.indices((self.n, self.n))
        coupled = lengths[np.minimum(i, j)] * a[np.maximum(i, j)]
        beyond = np.append(np.cumsum(self.masses[::-1])[::-1][1:], 0.0)
        np.fill_diagonal(coupled, self.masses * lengths**2 / 3 + lengths**2 * beyond)
        return coupled

    def mass_matrix(self, q: Array) -> Array:
        return self.couplings * np.cos(q[:, None] - q)

    def forces(self, q: Array, qd: Array, torques: Array) -> Array:
        """Return M qdd under these torques at the joints, without the torques that hold joints."""
        spun = (self.couplings * np.sin(q[:, None] - q)) @ qd**2
        return self.moments * self.gravity * np.cos(q) - spun + joints(self.n).T @ torques


def joints(n: int) -> Array:
    """The matrix that makes relative angles of absolute ones."""
    return np.eye(n) - np.eye(n, k=-1)


def resting(
    m: Array, forces: Array, ranges: dict[int, tuple[float, float]]
) -> tuple[Array, dict[int, int]]:
    """Accelerations, and what joints (from 0) at rest do whose supports have ranges of torque.

    A joint at 0 sticks; a joint at 1 or -1 begins to slide that way. `forces` includes the friction
    of joints that slide already. It tries every pattern; the one without contradiction is the
    answer.
    """
    d = joints(len(m))
    best: tuple[float, Any, Any] = (np.inf, None, None)
    for signs in itertools.product((0, 1, -1), repeat=len(ranges)):
        pattern = dict(zip(ranges, signs, strict=True))
        # the support is at its least where the joint sets out upward, at its most downward
        ends = [(j, ranges[j][0 if sign > 0 else 1]) for j, sign in pattern.items() if sign]
        if not all(np.isfinite(torque) for _, torque in ends):
            continue
        stuck = [j for j, sign in pattern.items() if sign == 0]
        rows = d[stuck]
        k = len(stuck)
        saddle = np.block([[m, -rows.T], [rows, np.zeros((k, k))]])
        slid = sum((torque * d[j] for j, torque in ends), np.zeros(len(m)))
        found = np.linalg.solve(saddle, np.append(forces + slid, np.zeros(k)))
        qdd, holding = found[: len(m)], found[len(m) :]
        pairs = list(zip(stuck, holding, strict=True))
        over = [max(ranges[j][0] - torque, torque - ranges[j][1]) for j, torque in pairs]
        against = [-sign * (d[j] @ qdd) for j, sign in pattern.items() if sign]
        contradiction = max([*over, *against, -np.inf])
        if contradiction < best[0]:
            best = (contradiction, qdd, pattern)
    assert best[0] <= 1e-9, "no pattern is free of contradiction"
    return best[1], best[2]


def held_accelerations(
    m: Array, forces: Array, limits: dict[int, float]
) -> tuple[Array, frozenset[int]]:
    """Accelerations, and the joints that stick, where friction has these limits."""
    qdd, pattern = resting(m, forces, {j: (-limit, limit) for j, limit in limits.items()})
    return qdd, frozenset(j for j, sign in pattern.items() if sign == 0)


def rates_after_impact(
    m: Array, qd: Array, normals: Array, restitution: Sequence[float]
) -> tuple[Array, Array]:
    """Rates after all of these contacts close at once, and their impulses; normals point away.

    The gap of contact c closes at the rate normals[c] . qd < 0. As long as any gap closes, there is
    an impact of all contacts that do not open.
    """
    e, impulses = np.asarray(restitution), np.zeros(len(normals))
    rounding = 1e-14 * np.abs(qd).max()
    for _ in range(10_000):
        gaps = normals @ qd
        if (gaps >= -rounding).all():
            return qd, impulses
        taking_part = gaps <= rounding
        qd, found = rates_after_one_impact(m, qd, normals[taking_part], e[taking_part])
        impulses[taking_part] += found
    raise AssertionError("impacts without end")


def rates_after_one_impact(
    m: Array, qd: Array, normals: Array, restitution: Array
) -> tuple[Array, Array]:
    """Solve 0 <= Lam against J v+ >= -e J v-, by trying every set of contacts that act."""
    wanted = -restitution * (normals @ qd)
    mobility = np.linalg.solve(m, normals.T)
    best: tuple[float, Any, Any] = (np.inf, None, None)
    contacts = range(len(normals))
    for size in range(len(normals) + 1):
        for acting in itertools.combinations(contacts, size):
            chosen = list(acting)
            impulses = np.zeros(len(normals))
            delassus = normals[chosen] @ mobility[:, chosen]
            short = wanted[chosen] - normals[chosen] @ qd
            impulses[chosen] = np.linalg.solve(delassus, short)
            after = qd + mobility @ impulses
            slack = normals @ after - wanted
            wrong = max(-impulses.min(), -slack.min())
            if wrong < best[0]:
                best = (wrong, after, impulses)
    assert best[0] <= 1e-9, "no set of contacts is free of contradiction"
    return best[1], best[2]
