"""pendcore as a Python user calls it: `pc.simulate`, result object and its states included."""

from __future__ import annotations

import pendcore as pc
from cases import Case

from contenders.contender import Contender, Outcome, PythonRun


def prepare(case: Case, tolerance: float) -> PythonRun[pc.Solution]:
    links = [
        pc.Link(mass=m, length=length) for m, length in zip(case.masses, case.lengths, strict=True)
    ]
    scene = pc.Scene(links=links, gravity=case.gravity)
    q0, qd0 = case.start[: case.n].copy(), case.start[case.n :].copy()
    span = (float(case.times[0]), float(case.times[-1]))

    def solve() -> pc.Solution:
        solution = pc.simulate(
            scene, q0, qd0, span, method="dopri5", rtol=tolerance, atol=tolerance, t_eval=case.times
        )
        solution.y  # noqa: B018  the states in hand, as every contender's call ends
        return solution

    return PythonRun(solve, read=lambda solution: Outcome(solution.y.T, solution.stats.nfev))


CONTENDERS = [
    Contender(
        name="pendcore_python",
        label="pendcore dopri5, Python",
        about=f"pendcore {pc.__version__} simulate, method dopri5",
        prepare=prepare,
    )
]
