"""THE list: a case is a file and a line here."""

from __future__ import annotations

from hard_cases import (
    blow_up,
    bounces,
    held_rod,
    late_start,
    not_a_number,
    separatrix,
    stick_slip,
    stiff_damper,
    two_joints,
    two_roots,
    upright,
)
from hard_cases.case import HardCase

CASES: tuple[HardCase, ...] = (
    held_rod.CASE,
    stick_slip.CASE,
    two_joints.CASE,
    bounces.CASE,
    two_roots.CASE,
    not_a_number.CASE,
    blow_up.CASE,
    late_start.CASE,
    stiff_damper.CASE,
    upright.CASE,
    separatrix.CASE,
)
PROGRAMS = {
    "pendcore": "pendcore",
    "scipy": "SciPy",
    "mujoco": "MuJoCo",
    "odeint": "Boost.odeint",
}
