"""Every step of radau5 agrees with the method written out in Python, including step control.

Two programs of one method differ by rounding. If their Newton iterations stopped at different
points, they would differ by the tolerance of the iteration; both take the same number of
iterations, so this does not happen. As in test_trajectories.py the runs are loose and not long.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from reference import chain, radau_steps
from reference.trajectories import Trajectory

ReferenceCase = Callable[[str], Trajectory]

STIFF = {"strong": 1e6 / 3, "medium": 2e3, "weak": 20.0}
"""Damping of the second joint, N m s/rad: its rate dies out within 1e-7 s to 1e-2 s."""


def solve(case: Any, t_end: float, **options: Any) -> pc.Solution:
    links = [pc.Link(mass=body.mass, length=body.length) for body in case.bodies]
    dampers = [
        pc.effects.ViscousJoint(joint=joint, damping=b)
        for joint, b in enumerate(case.damping, start=1)
        if b != 0
    ]
    scene = pc.Scene(links=links, gravity=case.gravity, effects=dampers)
    sol = pc.simulate(
        scene, q0=case.q0, qd0=case.qd0, t_span=(0.0, t_end), method="radau5", **options
    )
    assert sol.success
    return sol


def written_out(case: Any, t_end: float, **options: Any) -> radau_steps.Run:
    return chain.simulate_implicitly(
        case.bodies, case.gravity, case.q0, case.qd0, (0.0, t_end), damping=case.damping, **options
    )


def damped_rods(damping: float) -> Trajectory:
    at_rest = np.zeros(2)
    return Trajectory(
        masses=np.ones(2), lengths=np.ones(2), gravity=9.81, damping=np.array([0.0, damping]),
        q0=np.array([0.8, 1.0]), qd0=at_rest, t=at_rest, q=at_rest, qd=at_rest,
    )  # fmt: skip


def check(sol: pc.Solution, run: radau_steps.Run) -> None:
    assert (sol.stats.accepted, sol.stats.rejected) == (len(run.h), run.rejected)
    # if stages are not found, one more evaluation asks whether something was not finite
    assert sol.stats.nfev == run.evaluations + run.not_solved
    assert sol.stats.njev == len(run.h)
    assert sol.stats.nlu == 2 * (len(run.h) + run.rejected)
    np.testing.assert_allclose(np.diff(sol.t), run.h, rtol=1e-6)
    np.testing.assert_allclose(sol.y.T, run.y, rtol=0, atol=1e-6)


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("direction", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize("name", ["textbook", "horizontal_rest", "heavy_tip", "single_rod"])
def test_smooth_motions_take_the_steps_of_the_method_written_out_in_python(
    name: str, direction: int, tolerance: float, reference_case: ReferenceCase
) -> None:
    case = reference_case(name)
    t_end = direction * min(5.0, float(case.t[-1]))
    how = {"rtol": tolerance, "atol": tolerance}
    check(solve(case, t_end, **how), written_out(case, t_end, **how))


@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("damping", STIFF)
def test_dampers_take_the_steps_of_the_method_written_out_in_python(
    damping: str, tolerance: float
) -> None:
    case = damped_rods(STIFF[damping])
    how = {"rtol": tolerance, "atol": tolerance}
    check(solve(case, 5.0, **how), written_out(case, 5.0, **how))


@pytest.mark.parametrize("damping", STIFF)
def test_what_becomes_of_a_first_step_far_too_long(damping: str) -> None:
    case, how = damped_rods(STIFF[damping]), {"rtol": 1e-4, "atol": 1e-4, "first_step": 0.5}
    check(solve(case, 5.0, **how), written_out(case, 5.0, **how))


@pytest.mark.parametrize("tolerance", [1e-2, 1e-4, 1e-6])
@pytest.mark.parametrize("rate", [2.0, 12.0])
def test_steps_whose_stages_are_not_found_are_halved(rate: float, tolerance: float) -> None:
    case = replace(damped_rods(0.0), qd0=rate * np.array([1.0, -0.7]))
    how = {"rtol": tolerance, "atol": tolerance, "first_step": 0.5}
    run = written_out(case, 1.0, **how)
    assert run.not_solved > 0 or rate == 2.0
    check(solve(case, 1.0, **how), run)


@pytest.mark.parametrize("steps", [1, 2, 5, 13])
def test_errors_are_those_of_the_method_written_out_in_python(
    steps: int, reference_case: ReferenceCase
) -> None:
    """The state for resuming a run holds the last error, or 1e-4 if the error is less."""
    case = reference_case("textbook")
    how = {"rtol": 1e-4, "atol": 1e-4}
    run = written_out(case, 2.0, **how)
    # one step more is begun, and cut: what is kept is from before it
    sol = solve(case, 0.5 * (run.t[steps] + run.t[steps + 1]), **how)
    found = 2.0 ** sol._run.__getstate__()["position_log2_error_before"]
    assert found == pytest.approx(max(run.errors[steps - 1], 1e-4), rel=1e-6)
