"""SciPy's solve_ivp, method RK45: right-hand side in Python, and compiled by numba."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
import scipy
from cases import Array, Case
from scipy.integrate import solve_ivp

from contenders.contender import Contender, Outcome, PythonRun, compiled
from contenders.equations import fill, rates, require_unit_rods

compiled_fill, compile_seconds = compiled(
    lambda: numba.njit(numba.void(numba.float64[::1], numba.float64[::1]))(fill)
)


def rates_by_numba(t: float, y: Array) -> Array:
    out = np.empty(4)
    compiled_fill(out, y)
    return out


def preparing(function: Callable[[float, Array], Any]) -> Callable[[Case, float], PythonRun[Any]]:
    def prepare(case: Case, tolerance: float) -> PythonRun[Any]:
        require_unit_rods(case)
        span = (case.times[0], case.times[-1])
        settings = {"method": "RK45", "t_eval": case.times, "rtol": tolerance, "atol": tolerance}
        return PythonRun(
            solve=lambda: solve_ivp(function, span, case.start, **settings),
            read=lambda answer: Outcome(answer.y.T, answer.nfev),
        )

    return prepare


VERSION = f"SciPy {scipy.__version__} solve_ivp, method RK45"
CONTENDERS = [
    Contender(
        name="scipy_numba",
        label="SciPy RK45, numba rhs",
        about=f"{VERSION}, right-hand side compiled by numba {numba.__version__} with types given",
        prepare=preparing(rates_by_numba),
        compile_seconds=compile_seconds,
    ),
    Contender(
        name="scipy_python",
        label="SciPy RK45, Python rhs",
        about=f"{VERSION}, right-hand side in Python on floats (quicker than on NumPy numbers)",
        prepare=preparing(rates),
    ),
]
