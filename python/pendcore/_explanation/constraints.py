"""How many constraints the hinges and locks of a chain are: the rank of their Jacobian.

Each link has three coordinates, (x, y) of its mass centre and q. A hinge says that two points have
the same x and the same y: two rows. A lock says that q_j - q_{j-1} stays: one row.
"""

from __future__ import annotations

import numpy as np

from pendcore._messages.arguments import Floats
from pendcore._scene.scene import Scene


def locks(scene: Scene) -> dict[int, float | None]:
    """Return the locked joints and their angles, rad; None: where they start."""
    return {
        getattr(effect, "joint"): getattr(effect, "angle")  # noqa: B009
        for effect in scene.effects
        if effect.kind == "lock"
    }


def constraint_jacobian(scene: Scene, q: Floats) -> Floats:
    """Return the derivatives of the constraints by (x_1, y_1, q_1, x_2, ...), (rows, 3 n)."""
    rows = []
    for joint, link in enumerate(scene.links, start=1):
        both = np.zeros((2, 3 * len(scene.links)))
        _add_point(both, joint, q[joint - 1], -link.center)
        if joint > 1:
            before = scene.links[joint - 2]
            _add_point(both, joint - 1, q[joint - 2], before.length - before.center, -1.0)
        rows += [*both]
    for joint in locks(scene):
        row = np.zeros(3 * len(scene.links))
        row[3 * joint - 1] = 1.0
        if joint > 1:
            row[3 * joint - 4] = -1.0
        rows.append(row)
    return np.array(rows)


def constraint_rank(scene: Scene) -> int:
    """Return the rank of the Jacobian in a pose where nothing lines up, by singular values.

    Lengths are measured in that of their link, so that a short one counts as much as a long one.
    """
    q = 0.3 + 0.7 * np.arange(len(scene.links), dtype=np.float64)
    jacobian = constraint_jacobian(scene, q)
    scale = np.ones(3 * len(scene.links))
    scale[2::3] = [1.0 / max(link.length, 1e-300) for link in scene.links]
    return int(np.linalg.matrix_rank(jacobian * scale))


def _add_point(rows: Floats, link: int, q: float, distance: float, sign: float = 1.0) -> None:
    """Add the derivatives of the point of a link at a distance from its mass centre."""
    x, y, angle = 3 * link - 3, 3 * link - 2, 3 * link - 1
    rows[0, x] = rows[1, y] = sign
    rows[0, angle] = -sign * distance * np.sin(q)
    rows[1, angle] = sign * distance * np.cos(q)
