"""Whole motions agree with multiple precision, Octave, and the method written out in Python."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from reference import chain
from reference.dormand_prince import Run
from reference.trajectories import Trajectory

ReferenceCase = Callable[[str], Trajectory]

# The largest error of an angle, rad, that rtol = atol = 1e-12 may leave.
BOUNDS = {
    "textbook": 2e-10,
    "textbook_long": 2e-8,
    "horizontal_rest": 3e-9,
    "high_energy": 1e-3,  # chaotic: an error of 1e-16 at the start is 1e-8 at the end
    "unequal": 5e-8,
    "heavy_tip": 1e-8,
    "light_tip": 1e-8,
    "fast_spin": 2e-7,
    "no_gravity": 1e-8,
    "single_rod": 1e-8,
}


simulate = partial(pc.simulate, method="dopri5")


def solve(case: Trajectory, t_end: float, tolerance: float, **options: Any) -> pc.Solution:
    rods = zip(case.masses, case.lengths, strict=True)
    scene = pc.Scene(links=[pc.Link(mass=m, length=L) for m, L in rods], gravity=case.gravity)
    sol = simulate(
        scene, (0.0, t_end), case.q0, case.qd0, rtol=tolerance, atol=tolerance, **options
    )
    assert sol.success
    return sol


def written_out(case: Trajectory, t_end: float, tolerance: float, **options: Any) -> Run:
    """Return the same run by the method written out in Python."""
    start, span = (case.q0, case.qd0), (0.0, t_end)
    return chain.simulate(
        case.bodies, case.gravity, *start, span, rtol=tolerance, atol=tolerance, **options
    )


@pytest.mark.parametrize("name", BOUNDS)
def test_angles_follow_the_multiple_precision_ones(
    name: str, reference_case: ReferenceCase
) -> None:
    case = reference_case(name)
    sol = solve(case, float(case.t[-1]), 1e-12)
    n = len(case.q0)
    assert np.abs(sol(case.t)[:n].T - case.q).max() < BOUNDS[name]


@pytest.mark.parametrize("name", ["textbook", "heavy_tip", "single_rod"])
def test_rates_follow_the_multiple_precision_ones(name: str, reference_case: ReferenceCase) -> None:
    case = reference_case(name)
    sol = solve(case, float(case.t[-1]), 1e-12, t_eval=case.t)
    assert np.abs(sol.qd - case.qd).max() < 5 * BOUNDS[name]


def test_the_textbooks_program_ends_where_octaves_ode45_does() -> None:
    sol = simulate(pc.Scene.textbook(), (0, 5), [np.pi / 4, np.pi / 3], rtol=1e-12, atol=1e-12)
    octave = [1.08306667066, 0.538460698019, 1.00038020349, 0.393589065863]  # RelTol 1e-10
    np.testing.assert_allclose(sol(5.0), octave, rtol=0, atol=2e-9)


# Two programs of one method differ by rounding, which the step size feels most: a rounding of
# 1e-16 is 1e-10 of an error of 1e-6, and the motion magnifies it. So the runs are loose and not
# long, and the method itself errs by far more than the bounds.
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("direction", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize(
    "name", ["textbook", "horizontal_rest", "unequal", "heavy_tip", "no_gravity", "single_rod"]
)
def test_steps_and_states_are_those_of_the_method_written_out_in_python(
    name: str, direction: int, tolerance: float, reference_case: ReferenceCase
) -> None:
    case = reference_case(name)
    t_end = direction * min(5.0, float(case.t[-1]))
    sol = solve(case, t_end, tolerance)
    run = written_out(case, t_end, tolerance)
    assert sol.stats.accepted == run.accepted
    assert sol.stats.rejected == run.rejected
    assert sol.stats.nfev == run.evaluations
    np.testing.assert_allclose(np.diff(sol.t), run.h, rtol=1e-6)
    np.testing.assert_allclose(sol.y.T, run.y, rtol=0, atol=1e-6)
    times = np.linspace(0.0, t_end, 137)
    np.testing.assert_allclose(sol(times).T, [run(t) for t in times], rtol=0, atol=1e-7)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9, 1e-12])
def test_the_starting_step_is_hairers(tolerance: float, reference_case: ReferenceCase) -> None:
    case = reference_case("unequal")
    sol, run = (simulate(case, 1.0, tolerance) for simulate in (solve, written_out))
    assert sol.t[1] == pytest.approx(run.t[1], rel=1e-9)


def test_a_first_step_far_too_long_is_cut_to_a_fifth_at_a_time(
    reference_case: ReferenceCase,
) -> None:
    case = reference_case("textbook")
    sol = solve(case, 5.0, 1e-6, first_step=4.0)
    run = written_out(case, 5.0, 1e-6, first_step=4.0)
    assert sol.stats.rejected == run.rejected
    assert sol.t[1] == pytest.approx(run.t[1], rel=1e-9)


@pytest.mark.parametrize(("reach", "steps"), [(0.999, 1), (1.009, 1), (1.011, 2)])
def test_the_last_step_is_stretched_by_a_hundredth_at_most(
    reach: float, steps: int, reference_case: ReferenceCase
) -> None:
    case = reference_case("textbook")
    t = solve(case, 5.0, 1e-6).t
    assert solve(case, t[50] + reach * (t[51] - t[50]), 1e-6).stats.accepted == 50 + steps
