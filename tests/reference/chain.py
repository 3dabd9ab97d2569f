"""A chain and the method together: what `pendcore.simulate` does, in the reference."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from reference.dormand_prince import Array, Run, integrate
from reference.newton_euler import Body, newton_euler


def simulate(
    bodies: Sequence[Body],
    gravity: float,
    q0: Sequence[float] | Array,
    qd0: Sequence[float] | Array,
    t_span: tuple[float, float],
    *,
    rtol: float,
    atol: float,
    damping: Sequence[float] | Array | None = None,
    first_step: float | None = None,
) -> Run:
    """Integrate a chain with state q_1..q_n, qd_1..qd_n; ``damping`` resists at each joint."""
    n = len(bodies)
    b = np.zeros(n) if damping is None else np.asarray(damping)

    def right_hand_side(_: float, y: Array) -> Array:
        qd = y[n:]
        couples = -b * np.diff(qd, prepend=0.0)
        motion = newton_euler(
            bodies, gravity, y[:n].tolist(), qd.tolist(), couples=couples.tolist()
        )
        return np.concatenate([qd, motion.accelerations])

    y0 = np.concatenate([q0, qd0])
    return integrate(right_hand_side, y0, t_span, rtol=rtol, atol=atol, first_step=first_step)
