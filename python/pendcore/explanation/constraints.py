"""How many constraints the hinges and locks of a chain are: the rank of their Jacobian.

Each link has three coordinates, (x, y) of its mass centre and q. A hinge says that two points have
the same x and the same y: two rows. A lock says that q_j - q_{j-1} stays: one row.
"""

from __future__ import annotations

import numpy as np

from pendcore import Scene, effects
from pendcore.messages import Floats


def locks(scene: Scene) -> dict[int, float | None]:
    """Return the locked joints and their angles, rad; None: where they start."""
    return {one.joint: one.angle for one in scene.effects if isinstance(one, effects.Lock)}


def constraint_jacobian(scene: Scene, q: Floats) -> Floats:
    """Return the derivatives of the constraints by (x_1, y_1, q_1, x_2, ...), (rows, 3 n)."""
    locked, n = [joint - 1 for joint in locks(scene)], len(scene.links)
    hinges, locking = np.zeros((n + 1, 2, n, 3)), np.zeros((len(locked), n, 3))
    for i, link in enumerate(scene.links):
        around = np.array([[-np.sin(q[i])], [np.cos(q[i])]])
        hinges[i, :, i] = np.hstack([np.eye(2), -link.center * around])
        hinges[i + 1, :, i] = -np.hstack([np.eye(2), (link.length - link.center) * around])
    locking[:, :, 2] = (np.eye(n) - np.eye(n, k=-1))[locked]
    both = hinges[:n].reshape(2 * n, 3 * n), locking.reshape(-1, 3 * n)  # nothing is at the tip
    return np.concatenate(both)


def constraint_rank(scene: Scene) -> int:
    """Return the rank of the Jacobian in a pose where nothing lines up, by singular values.

    Lengths are measured in that of their link, so that a short one counts as much as a long one.
    """
    q = 0.3 + 0.7 * np.arange(len(scene.links), dtype=np.float64)
    jacobian = constraint_jacobian(scene, q)
    scale = np.ones(3 * len(scene.links))
    scale[2::3] = [1.0 / max(link.length, 1e-300) for link in scene.links]
    return int(np.linalg.matrix_rank(jacobian * scale))
