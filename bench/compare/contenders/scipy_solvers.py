"""SciPy's solve_ivp: right-hand side, and Jacobian where there is one, in Python or by numba."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numba
import numpy as np
import scipy
from cases import Array, Case
from scipy.integrate import solve_ivp

from contenders.contender import Contender, Outcome, PythonRun, once
from contenders.equations import fill, jacobian, rates

METHODS = ("RK45", "DOP853", "LSODA", "Radau")
IMPLICIT = ("LSODA", "Radau")
# Radau also calls with columns of a matrix, whose numbers are not contiguous.
TYPES = [numba.void(numba.float64[::1], y) for y in (numba.float64[::1], numba.float64[:])]
Rates = Callable[[float, Array], Any]


def in_python(case: Case) -> tuple[Rates, Any, None]:
    return rates(case), jacobian(case), None


def by_numba(case: Case) -> tuple[Rates, Any, float]:
    """Compile the functions of the case once, and measure the seconds that this takes."""

    def build() -> tuple[Any, Any]:
        filled = numba.njit(TYPES)(fill(case, numba.njit))
        derivatives: Any = jacobian(case, numba.njit)
        if derivatives is not None:
            derivatives = numba.njit(derivatives)
            derivatives(0.0, case.start)
        return filled, derivatives

    (filled, derivatives), seconds = once("SciPy", case, build)
    size = 2 * case.n

    def rates_of(t: float, y: Array) -> Array:
        out = np.empty(size)
        filled(out, y)
        return out

    return rates_of, derivatives, seconds


def prepare(method: str, of_case: Any, case: Case, tolerance: float) -> PythonRun[Any]:
    function, derivatives, seconds = of_case(case)
    settings: dict[str, Any] = {"method": method, "rtol": tolerance, "atol": tolerance}
    if method in IMPLICIT and derivatives is not None:
        settings["jac"] = derivatives
    span = (case.times[0], case.times[-1])

    def solve(times: Array | None) -> Any:
        return solve_ivp(function, span, case.start, t_eval=times, **settings)

    def read(answer: Any) -> Outcome:
        if not answer.success:
            raise RuntimeError(answer.message)
        every_step = solve(None).t if method in IMPLICIT else ()
        return Outcome(answer.y.T, answer.nfev, len(every_step) - 1 if len(every_step) else None)

    return PythonRun(lambda: solve(case.times), read, seconds)


VERSION = f"SciPy {scipy.__version__} solve_ivp, method"
CONTENDERS = [
    Contender(
        name=f"scipy_{method.lower()}_{language.lower()}",
        label=f"SciPy {method}, {language} rhs",
        about=f"{VERSION} {method}, {how}",
        prepare=partial(prepare, method, of_case),
        slow=True,
    )
    for language, of_case, how in (
        ("numba", by_numba, f"right-hand side compiled by numba {numba.__version__}, types given"),
        ("Python", in_python, "right-hand side in Python on floats (quicker than NumPy's numbers)"),
    )
    for method in METHODS
]
