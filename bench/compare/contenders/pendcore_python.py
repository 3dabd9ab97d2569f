"""pendcore as a Python user calls it: `pc.simulate`, including the result object and its states."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pendcore as pc
from cases import Case
from pendcore import _core

from contenders.contender import Contender, Outcome, PythonRun, fixed_steps, tolerances

FIXED = {method["name"] for method in _core.methods() if method["error_order"] == 0}
FINEST = {"dop853": 15, "taylor": 16}  # where smaller tolerances still bring smaller errors


def settings_of(method: str) -> Callable[[int], list[float]]:
    """Map the number of settings per decade to the settings: tolerances, or fixed steps."""
    if method in FIXED:
        return lambda per_decade: fixed_steps(0.1, 1e-4, 2 * per_decade)
    return lambda per_decade: tolerances(FINEST.get(method, 13), per_decade)


def scene_of(case: Case) -> pc.Scene:
    effects: list[Any] = []
    for j, (k, b, rest) in enumerate(zip(case.stiffness, case.damping, case.rest, strict=True), 1):
        if case.controller and (k or b):
            pd = pc.effects.PD(kp=k, kd=b, reference=rest)
            effects.append(pc.effects.Motor(joint=j, pd=pd))
            continue
        if k:
            effects.append(pc.effects.TorsionalSpring(joint=j, stiffness=k, rest_angle=rest))
        if b:
            effects.append(pc.effects.ViscousJoint(joint=j, damping=b))
    rods = zip(case.masses, case.lengths, strict=True)
    links = [pc.Link(mass=mass, length=length) for mass, length in rods]
    return pc.Scene(links=links, gravity=case.gravity, effects=effects)


def preparing(method: str) -> Callable[[Case, float], PythonRun[pc.Solution]]:
    def prepare(case: Case, setting: float) -> PythonRun[pc.Solution]:
        scene = scene_of(case)
        q0, qd0 = case.start[: case.n].copy(), case.start[case.n :].copy()
        span = (float(case.times[0]), float(case.times[-1]))
        how: dict[str, Any] = {"step": setting}
        if method not in FIXED:
            how = {"rtol": setting, "atol": setting}

        def solve() -> pc.Solution:
            solution = pc.simulate(
                scene, q0=q0, qd0=qd0, t_span=span, method=method, t_eval=case.times,
                max_steps=2_000_000, on_failure="ignore", **how,
            )  # fmt: skip
            solution.y  # noqa: B018  the states in hand, as every contender's call ends
            return solution

        return PythonRun(solve, read)

    return prepare


def read(solution: pc.Solution) -> Outcome:
    stats = solution.stats
    if not solution.success:
        raise RuntimeError(solution.message)
    said = solution.message if stats.stiff else ""
    return Outcome(solution.y.T, stats.nfev, stats.accepted + stats.rejected, said)


CONTENDERS = [
    Contender(
        name=f"pendcore_{method}",
        label=f"pendcore {method}, Python",
        about=f"pendcore {pc.__version__} simulate, method {method}",
        prepare=preparing(method),
        ours=True,
        setting="step" if method in FIXED else "tolerance",
        settings=settings_of(method),
    )
    for method in (known["name"] for known in _core.methods())
]
