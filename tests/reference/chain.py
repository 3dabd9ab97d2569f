"""A chain and the method together: what `pendcore.simulate` does, in the reference."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from reference import radau_steps
from reference.arithmetic import COMPLEX, DOUBLE, Arithmetic
from reference.dormand_prince import Array, Run, integrate
from reference.newton_euler import Body, newton_euler


def right_hand_side(
    bodies: Sequence[Body],
    gravity: float,
    damping: Sequence[float] | Array | None,
    arithmetic: Arithmetic = DOUBLE,
) -> Callable[[float, Any], Any]:
    """Return dy/dt of the state q_1..q_n, qd_1..qd_n; ``damping`` resists at each joint."""
    n = len(bodies)
    b = np.zeros(n) if damping is None else np.asarray(damping)

    def rates(_: float, y: Any) -> Any:
        qd = y[n:]
        couples = -b * np.diff(qd, prepend=0.0)
        motion = newton_euler(
            bodies, gravity, y[:n].tolist(), qd.tolist(),
            couples=couples.tolist(), arithmetic=arithmetic,
        )  # fmt: skip
        return np.concatenate([qd, motion.accelerations])

    return rates


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
    """Integrate a chain with dopri5."""
    f = right_hand_side(bodies, gravity, damping)
    y0 = np.concatenate([q0, qd0])
    return integrate(f, y0, t_span, rtol=rtol, atol=atol, first_step=first_step)


def simulate_implicitly(
    bodies: Sequence[Body],
    gravity: float,
    q0: Sequence[float] | Array,
    qd0: Sequence[float] | Array,
    t_span: tuple[float, float],
    *,
    damping: Sequence[float] | Array | None = None,
    **options: Any,
) -> radau_steps.Run:
    """Integrate a chain with radau5, whose Jacobian is exact but for rounding."""
    f = right_hand_side(bodies, gravity, damping)
    complex_f = right_hand_side(bodies, gravity, damping, COMPLEX)

    def jacobian(t: float, y: Array) -> Array:
        columns = [complex_f(t, y + 1e-30j * unit).imag / 1e-30 for unit in np.eye(len(y))]
        return np.array(columns).T

    return radau_steps.integrate(f, jacobian, np.concatenate([q0, qd0]), t_span, **options)
