"""How fast a chain moves at its start: what a family scales spans and stiffnesses by."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pendcore as pc

from true_error.arrays import Floats
from true_error.constants import inertia, smooth_torques


def mass_matrix(scene: pc.Scene, q: tuple[float, ...]) -> Floats:
    """Return the mass matrix of the joints' angles (n, n), kg m^2."""
    n = len(q)
    values = {name: float(value) for name, value in inertia(scene).items()}
    K = np.array([[values[f"K{min(i, j)}{max(i, j)}"] for j in range(n)] for i in range(n)])
    M = K * np.cos(np.subtract.outer(q, q))
    R = np.cumsum(np.cumsum(M[::-1, ::-1], axis=0), axis=1)[::-1, ::-1]
    return R + np.diag([values[f"J{j}"] for j in range(n)])


@dataclass(frozen=True)
class Rates:
    """The fastest rates of what a start sets going.

    Attributes
    ----------
    motion : float
        The fastest of its linear motion, its drives and its rates, rad/s.
    decay : float
        The fastest decay by dampers, 1/s.
    """

    motion: float
    decay: float

    @property
    def fastest(self) -> float:
        return max(self.motion, self.decay)


def rates(scene: pc.Scene, q0: tuple[float, ...], qd0: tuple[float, ...]) -> Rates:
    """Return how fast a scene moves at its start."""
    n = len(q0)
    R = mass_matrix(scene, q0)
    values = {name: float(value) for name, value in smooth_torques(scene).items()}
    constants = inertia(scene)
    weights = [float(constants["g"] * constants[f"h{i}"]) for i in range(n)]
    fall = np.array([[sum(weights[max(i, j) :]) for i in range(n)] for j in range(n)])
    stiff = fall + np.diag([values[f"k{j}"] for j in range(n)])
    w = np.diff([0.0, *qd0])
    damping = [values[f"b{j}"] + 3 * values[f"b3{j}"] * w[j] ** 2 for j in range(n)]
    frequency = np.sqrt(np.abs(np.linalg.eigvals(np.linalg.solve(R, stiff))).max())
    decay = np.abs(np.linalg.eigvals(np.linalg.solve(R, np.diag(damping)))).max()
    driven = max(abs(values[name]) for name in values if name.endswith("o") or name[0] == "o")
    motion = max(frequency, driven, np.abs(qd0).max(), np.abs(w).max(), 1e-3)
    return Rates(float(motion), float(decay))
