"""THE list of hard cases: each case is a file, and a line here."""

from __future__ import annotations

from hard_cases import (
    blow_up,
    bounces,
    drift,
    held_rod,
    late_start,
    let_go,
    not_a_number,
    payload,
    separatrix,
    shaken_pivot,
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
    payload.CASE,
    let_go.CASE,
    drift.CASE,
    shaken_pivot.CASE,
    upright.CASE,
    separatrix.CASE,
)
PROGRAMS = {
    "pendcore": "pendcore",
    "scipy": "SciPy",
    "mujoco": "MuJoCo",
    "odeint": "Boost.odeint",
}
