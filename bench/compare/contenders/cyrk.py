"""CyRK, called in two ways.

pysolve_ivp calls a function that numba compiled and that fills its output. nbsolve2_ivp, newer and
called experimental, is itself called from compiled code with the address of a compiled function:
no Python runs during a solve.
"""

from __future__ import annotations

from functools import partial
from typing import Any

import CyRK
import numba
import numpy as np
from cases import Array, Case
from CyRK import PySolver, cyjit, nbsolve2_ivp, pysolve_ivp

from contenders.contender import Contender, Outcome, PythonRun, once
from contenders.equations import fill

# Each of these, among nine methods, is the best somewhere. The last three are for stiff scenes.
BY_ADDRESS = ("RK45", "DOP853", "Vern7", "LSODA", "RADAU", "BDF")
BY_FUNCTION = ("RK45", "DOP853")
TYPES = numba.void(numba.float64[::1], numba.float64, numba.float64[::1])


def prepare_pysolve(method: str, case: Case, tolerance: float) -> PythonRun[Any]:
    def build() -> Any:
        of_case = numba.njit(fill(case, numba.njit))
        return numba.njit(TYPES)(lambda out, t, y: of_case(out, y))  # the order that CyRK asks for

    filled, seconds = once("arrays", case, build)
    span = (float(case.times[0]), float(case.times[-1]))
    storage = PySolver()
    evaluations = 0

    def counted(out: Array, t: float, y: Array) -> None:
        nonlocal evaluations
        evaluations += 1
        filled(out, t, y)

    def solve(rates: Any = filled, reuse: Any = storage) -> Any:
        return pysolve_ivp(
            rates,
            span,
            case.start,
            method=method,
            t_eval=case.times,
            rtol=tolerance,
            atol=tolerance,
            pass_dy_as_arg=True,
            solution_reuse=reuse,
        ).y

    def read(states: Array) -> Outcome:
        nonlocal evaluations
        evaluations = 0
        found = states.T.copy()
        solve(counted, PySolver())
        return Outcome(found, evaluations)

    return PythonRun(solve, read, seconds)


def solve_by_address(
    address: int, method: str, t0: float, t_end: float, start: Array, times: Array, tolerance: float
) -> Array:
    answer = nbsolve2_ivp(
        address, (t0, t_end), start, method=method, t_eval=times, rtol=tolerance, atol=tolerance
    )
    states = np.empty((times.size, start.size))
    if answer.success:
        states[:] = answer.y.T
    else:
        states[:] = np.nan
    answer.free()
    return states


compiled_solve: Any = numba.njit(solve_by_address)


def prepare_nbsolve(method: str, case: Case, tolerance: float) -> PythonRun[Any]:
    t0, t_end = float(case.times[0]), float(case.times[-1])

    def build() -> Any:
        of_case = numba.njit(fill(case, numba.njit))
        address = cyjit(lambda out, t, y, parameters: of_case(out, y)).address
        compiled_solve(address, "RK45", 0.0, 1e-3, case.start, np.array([0.0, 1e-3]), 1e-3)
        return address

    address, seconds = once("address", case, build)
    return PythonRun(
        lambda: compiled_solve(address, method, t0, t_end, case.start, case.times, tolerance),
        lambda states: Outcome(states),
        seconds,
    )


VERSION, NUMBA = f"CyRK {CyRK.__version__}", f"numba {numba.__version__}"
CONTENDERS = [
    Contender(
        name=f"cyrk_{door}_{method.lower()}",
        label=f"CyRK {door} {method}",
        about=f"{VERSION} {door}_ivp, method {method}, {how}",
        prepare=partial(prepare, method),
    )
    for door, methods, prepare, how in (
        (
            "nbsolve2",
            BY_ADDRESS,
            prepare_nbsolve,
            f"called from code compiled by {NUMBA} with the address of a compiled right-hand side",
        ),
        (
            "pysolve",
            BY_FUNCTION,
            prepare_pysolve,
            f"right-hand side compiled by {NUMBA} with types given and written into the output; "
            "storage reused",
        ),
    )
    for method in methods
]
