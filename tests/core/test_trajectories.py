"""Whole motions agree with multiple precision and the method written out in Python."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from reference import chain
from reference.trajectories import Trajectory, trajectory

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
    "damped_textbook": 1e-9,
    "three_links": 1e-9,
    "ten_links": 1e-9,
}


def solve(
    case: Trajectory, t_end: float, tolerance: float, method: str = "dopri5", **options: Any
) -> pc.Solution:
    options |= {"method": method, "rtol": tolerance, "atol": tolerance}
    sol = pc.simulate(case.scene, (0.0, t_end), case.q0, case.qd0, **options)
    assert sol.success
    return sol


def written_out(case: Trajectory, t_end: float, tolerance: float, **options: Any) -> Any:
    """Return the same run by the method written out in Python."""
    return chain.simulate(case, t_end, rtol=tolerance, atol=tolerance, **options)


@pytest.mark.parametrize("method", ["dopri5", "auto"])
@pytest.mark.parametrize("name", BOUNDS)
def test_angles_and_rates_follow_the_multiple_precision_ones(name: str, method: str) -> None:
    case = trajectory(name)
    q, qd = np.split(solve(case, float(case.t[-1]), 1e-12, method)(case.t).T, 2, axis=1)
    assert np.abs(q - case.q).max() < BOUNDS[name]
    assert np.abs(qd - case.qd).max() < 5 * BOUNDS[name]


# Two programs of one method differ by rounding, which the step size feels most: a rounding of
# 1e-16 is 1e-10 of an error of 1e-6, and the motion magnifies it. So the runs are loose and not
# long, and the method itself errs by far more than the bounds.
@pytest.mark.few_cases
@pytest.mark.parametrize("tolerance", [1e-4, 1e-6])
@pytest.mark.parametrize("direction", [1, -1], ids=["forward", "backward"])
@pytest.mark.parametrize(
    "name", ["textbook", "horizontal_rest", "unequal", "heavy_tip", "no_gravity", "single_rod"]
)
def test_steps_and_states_are_those_of_the_method_written_out_in_python(name, direction, tolerance):
    case = trajectory(name)
    t_end = direction * min(5.0, float(case.t[-1]))
    sol, run = (simulate(case, t_end, tolerance) for simulate in (solve, written_out))
    counts = sol.stats.accepted, sol.stats.rejected, sol.stats.nfev
    assert counts == (run.accepted, run.rejected, run.evaluations)
    np.testing.assert_allclose(np.diff(sol.t), run.h, rtol=1e-6)
    np.testing.assert_allclose(sol.y.T, run.y, rtol=0, atol=1e-6)
    times = np.linspace(0.0, t_end, 137)
    np.testing.assert_allclose(sol(times).T, [run(t) for t in times], rtol=0, atol=1e-7)


@pytest.mark.parametrize(
    ("name", "t_end", "tolerance", "options"),
    [
        *[("unequal", 1.0, tolerance, {}) for tolerance in (1e-3, 1e-6, 1e-9, 1e-12)],
        ("textbook", 5.0, 1e-6, {"first_step": 4.0}),
    ],
    ids=["1e-3", "1e-6", "1e-9", "1e-12", "given, far too long"],
)
def test_the_starting_step_is_hairers_and_too_long_a_one_is_cut_to_a_fifth_at_a_time(
    name: str, t_end: float, tolerance: float, options: dict[str, float]
) -> None:
    case = trajectory(name)
    sol, run = (f(case, t_end, tolerance, **options) for f in (solve, written_out))
    assert sol.t[1] == pytest.approx(run.t[1], rel=1e-9)
    assert sol.stats.rejected == run.rejected


@pytest.mark.parametrize(("reach", "steps"), [(0.999, 1), (1.009, 1), (1.011, 2)])
def test_the_last_step_is_stretched_by_a_hundredth_at_most(reach: float, steps: int) -> None:
    case = trajectory("textbook")
    t = solve(case, 5.0, 1e-6).t
    assert solve(case, t[50] + reach * (t[51] - t[50]), 1e-6).stats.accepted == 50 + steps
