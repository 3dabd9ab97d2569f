"""A chain and a method together: what `pendcore.simulate` does, in the reference."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from reference import dormand_prince, radau_steps
from reference.arithmetic import COMPLEX, DOUBLE, Arithmetic
from reference.dormand_prince import Array
from reference.effects import ViscousJoint
from reference.rig import Rig
from reference.trajectories import Trajectory


def right_hand_side(
    case: Trajectory, arithmetic: Arithmetic = DOUBLE
) -> Callable[[float, Any], Any]:
    """Return dy/dt of the state q_1..q_n, qd_1..qd_n."""
    dampers = [ViscousJoint(joint=j, damping=b) for j, b in enumerate(case.damping, start=1) if b]
    rig = Rig(bodies=case.bodies, gravity=case.gravity, effects=dampers, arithmetic=arithmetic)

    def rates(t: float, y: Any) -> Any:
        q, qd = np.split(y, 2)
        return np.concatenate([qd, rig.motion(t, q.tolist(), qd.tolist()).accelerations])

    return rates


def simulate(case: Trajectory, t_end: float, **options: Any) -> dormand_prince.Run:
    """Integrate a chain with dopri5, from its start at time 0."""
    y0 = np.concatenate([case.q0, case.qd0])
    return dormand_prince.integrate(right_hand_side(case), y0, (0.0, t_end), **options)


def simulate_implicitly(case: Trajectory, t_end: float, **options: Any) -> radau_steps.Run:
    """Integrate a chain with radau5, whose Jacobian is exact but for rounding."""
    complex_f = right_hand_side(case, COMPLEX)

    def jacobian(t: float, y: Array) -> Array:
        columns = [complex_f(t, y + 1e-30j * unit).imag / 1e-30 for unit in np.eye(len(y))]
        return np.array(columns).T

    y0 = np.concatenate([case.q0, case.qd0])
    return radau_steps.integrate(right_hand_side(case), jacobian, y0, (0.0, t_end), **options)
