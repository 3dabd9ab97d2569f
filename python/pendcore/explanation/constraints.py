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
    locked, n = locks(scene), len(scene.links)
    rows = np.zeros((2 * n + len(locked), n, 3))
    for i, link in enumerate(scene.links):
        hinge = [(i, 1.0, -link.center)]
        if i > 0:
            before = scene.links[i - 1]
            hinge.append((i - 1, -1.0, before.length - before.center))
        for k, sign, distance in hinge:  # of the hinge from the mass centre of link k
            around = sign * distance * np.array([-np.sin(q[k]), np.cos(q[k])])
            rows[2 * i : 2 * i + 2, k] = np.column_stack([sign * np.eye(2), around])
    for row, joint in zip(rows[2 * n :], locked, strict=True):
        row[joint - 1, 2] = 1.0
        if joint > 1:
            row[joint - 2, 2] = -1.0
    return rows.reshape(len(rows), 3 * n)


def constraint_rank(scene: Scene) -> int:
    """Return the rank of the Jacobian in a pose where nothing lines up, by singular values.

    Lengths are measured in that of their link, so that a short one counts as much as a long one.
    """
    q = 0.3 + 0.7 * np.arange(len(scene.links), dtype=np.float64)
    jacobian = constraint_jacobian(scene, q)
    scale = np.ones(3 * len(scene.links))
    scale[2::3] = [1.0 / max(link.length, 1e-300) for link in scene.links]
    return int(np.linalg.matrix_rank(jacobian * scale))
