"""heyoka's Taylor method, compiled for a case and a tolerance by LLVM.

These settings are the best, by experiment: `fast_math` saves a fifth and costs no accuracy here;
compact_mode is twice as slow; slp_vectorize, force_avx512 and high_accuracy bring nothing for so
small a state. A tolerance decides the order and nothing else, so there is one setting for each
order. The time is that of the call from Python, which spends a few microseconds outside compiled
code (the fixed cost of a call says how many); heyoka offers no other interface here.
"""

from __future__ import annotations

import math
from typing import Any

import heyoka
import numpy as np
from cases import Case

from contenders.contender import COMPILED, PYTHON, Contender, Outcome, PythonRun, compiled
from contenders.equations import accelerations

ORDERS = range(3, 23)


def tolerance_of(order: int) -> float:
    """Return the smallest tolerance of an order: heyoka takes the next above 1 - log(tol) / 2."""
    return math.exp(-2.0 * (order - 1)) * (1 + 1e-9)


def system(case: Case, drive: Any = 0.0) -> list[tuple[Any, Any]]:
    """Return the equations; `drive` is a torque in joint 1 of two rods, N m."""
    names = [f"{kind}{i}" for kind in ("q", "w") for i in range(case.n)]
    variables = [heyoka.expression(name) for name in names]
    found = accelerations(case, heyoka.sin, heyoka.cos, drive)(*variables)
    return list(zip(variables, [*variables[case.n :], *found], strict=True))


def prepare(case: Case, tolerance: float) -> PythonRun[Any]:
    equations, start, times = system(case), case.start, case.times
    taylor, seconds = compiled(
        lambda: heyoka.taylor_adaptive(equations, start, tol=tolerance, fast_math=True)
    )
    state, begin = taylor.state, float(times[0])

    def solve() -> Any:
        taylor.time = begin
        state[:] = start
        return taylor.propagate_grid(times)

    def read(answer: Any) -> Outcome:
        states = np.array(answer[-1])
        if answer[0] != heyoka.taylor_outcome.time_limit:
            raise RuntimeError(str(answer[0]))
        return Outcome(states, steps=int(answer[3]))

    return PythonRun(solve, read, seconds)


CONTENDERS = [
    Contender(
        name="heyoka",
        label="heyoka Taylor",
        about=f"heyoka {heyoka.__version__} taylor_adaptive with fast_math, propagate_grid, "
        "called from Python; a setting for each order, compiled or read from its cache on disk",
        prepare=prepare,
        sides=(COMPILED, PYTHON),
        settings=lambda per_decade: [
            tolerance_of(order) for order in (ORDERS if per_decade > 1 else ORDERS[::4])
        ],
    )
]
