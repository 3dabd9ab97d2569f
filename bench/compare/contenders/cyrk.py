"""CyRK's RK45, by two of its doors.

pysolve_ivp calls a function that numba compiled and that fills its output. nbsolve2_ivp, newer and
called experimental, is itself called from compiled code with the address of a compiled function:
no Python runs during a solve.
"""

from __future__ import annotations

from typing import Any

import CyRK
import numba
import numpy as np
from cases import Array, Case
from CyRK import PySolver, cyjit, nbsolve2_ivp, pysolve_ivp

from contenders.contender import Contender, Outcome, PythonRun, compiled
from contenders.equations import fill, require_unit_rods

TYPES = numba.void(numba.float64[::1], numba.float64, numba.float64[::1])
fill_any = numba.njit(fill)
fill_arrays, pysolve_seconds = compiled(
    lambda: numba.njit(TYPES)(lambda out, t, y: fill_any(out, y))  # the order that CyRK asks for
)
address, address_seconds = compiled(
    lambda: cyjit(lambda out, t, y, parameters: fill_any(out, y)).address
)


def solve_by_address(
    t0: float, t_end: float, start: Array, times: Array, tolerance: float
) -> Array:
    answer = nbsolve2_ivp(address, (t0, t_end), start, t_eval=times, rtol=tolerance, atol=tolerance)
    states = np.empty((times.size, start.size))
    if answer.success:
        states[:] = answer.y.T
    else:
        states[:] = np.nan
    answer.free()
    return states


compiled_solve: Any = numba.njit(solve_by_address)
_, nbsolve_seconds = compiled(
    lambda: compiled_solve(0.0, 1.0, np.array([1.0, 1.0, 0.0, 0.0]), np.array([0.0, 1.0]), 1e-3)
)


def prepare_pysolve(case: Case, tolerance: float) -> PythonRun[Any]:
    require_unit_rods(case)
    span = (float(case.times[0]), float(case.times[-1]))
    storage = PySolver()
    evaluations = 0

    def counted(out: Array, t: float, y: Array) -> None:
        nonlocal evaluations
        evaluations += 1
        fill_arrays(out, t, y)

    def solve(rates: Any = fill_arrays, reuse: Any = storage) -> Any:
        return pysolve_ivp(
            rates,
            span,
            case.start,
            method="RK45",
            t_eval=case.times,
            rtol=tolerance,
            atol=tolerance,
            pass_dy_as_arg=True,
            solution_reuse=reuse,
        ).y

    def read(states: Array) -> Outcome:
        nonlocal evaluations
        evaluations = 0
        solve(counted, PySolver())
        return Outcome(states.T.copy(), evaluations)

    return PythonRun(solve, read)


def prepare_nbsolve(case: Case, tolerance: float) -> PythonRun[Any]:
    require_unit_rods(case)
    t0, t_end = float(case.times[0]), float(case.times[-1])
    return PythonRun(
        solve=lambda: compiled_solve(t0, t_end, case.start, case.times, tolerance),
        read=lambda states: Outcome(states, None),
    )


VERSION, NUMBA = f"CyRK {CyRK.__version__}", f"numba {numba.__version__}"
CONTENDERS = [
    Contender(
        name="cyrk_pysolve",
        label="CyRK pysolve_ivp",
        about=f"{VERSION} pysolve_ivp, method RK45, right-hand side compiled by {NUMBA} with types "
        "given and written into the output; storage reused",
        prepare=prepare_pysolve,
        compile_seconds=pysolve_seconds,
    ),
    Contender(
        name="cyrk_nbsolve2",
        label="CyRK nbsolve2_ivp",
        about=f"{VERSION} nbsolve2_ivp (experimental), method RK45, called from code compiled by "
        f"{NUMBA} with the address of a compiled right-hand side",
        prepare=prepare_nbsolve,
        compile_seconds=address_seconds + nbsolve_seconds,
    ),
]
