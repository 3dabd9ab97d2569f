"""Every step of radau5 agrees with the method written out in Python, including step control.

Two programs of one method differ by rounding. If their Newton iterations stopped at different
points, they would differ by the tolerance of the iteration; both take the same number of
iterations, so this does not happen. As in test_trajectories.py the runs are loose and not long.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from reference.chain import simulate_implicitly
from reference.trajectories import Trajectory, trajectory


def solve(case, t_end, **options):
    sol = pc.simulate(case.scene, (0.0, t_end), case.q0, case.qd0, method="radau5", **options)
    assert sol.success
    return sol


def rods(damping, rate=0.0):
    """Two rods; the rate of the second joint dies out within 1e-7 s to 1e-2 s by these dampers."""
    none, rates = np.zeros(2), rate * np.array([1.0, -0.7])
    return Trajectory(
        masses=np.ones(2), lengths=np.ones(2), gravity=9.81, damping=np.array([0.0, damping]),
        q0=np.array([0.8, 1.0]), qd0=rates, t=none, q=none, qd=none,
    )  # fmt: skip


STIFF = {"strong": 1e6 / 3, "medium": 2e3, "weak": 20.0}
SMOOTH = ["textbook", "horizontal_rest", "heavy_tip", "single_rod"]
RUNS = {  # the case, end, tolerances, first step
    **{
        f"{name}, {way}": (trajectory(name), sense, [1e-4, 1e-6], None)
        for name in SMOOTH
        for way, sense in (("forward", 1), ("backward", -1))
    },
    **{f"{name} damper": (rods(b), 5.0, [1e-4, 1e-6], None) for name, b in STIFF.items()},
    **{f"{name} damper, first step too long": (rods(b), 5.0, [1e-4], 0.5)
       for name, b in STIFF.items()},
    # steps whose stages are not found are halved
    "slow, first step too long": (rods(0.0, 2.0), 1.0, [1e-2, 1e-4, 1e-6], 0.5),
    "fast, first step too long": (rods(0.0, 12.0), 1.0, [1e-2, 1e-4, 1e-6], 0.5),
}  # fmt: skip


@pytest.mark.few_cases
@pytest.mark.parametrize("name", RUNS)
def test_runs_take_the_steps_of_the_method_written_out_in_python(name):
    case, t_end, tolerances, first_step = RUNS[name]
    if len(case.t) > 2:
        t_end *= min(5.0, float(case.t[-1]))
    for tolerance in tolerances:
        how = {"rtol": tolerance, "atol": tolerance}
        how |= {"first_step": first_step} if first_step else {}
        sol, run = solve(case, t_end, **how), simulate_implicitly(case, t_end, **how)
        assert run.not_solved > 0 or not name.startswith("fast")
        assert (sol.stats.accepted, sol.stats.rejected) == (len(run.h), run.rejected)
        # if stages are not found, one more evaluation asks whether something was not finite
        assert sol.stats.nfev == run.evaluations + run.not_solved
        assert sol.stats.njev == len(run.h)
        assert sol.stats.nlu == 2 * (len(run.h) + run.rejected)
        np.testing.assert_allclose(np.diff(sol.t), run.h, rtol=1e-6)
        np.testing.assert_allclose(sol.y.T, run.y, rtol=0, atol=1e-6)


@pytest.mark.parametrize("steps", [1, 2, 5, 13])
def test_errors_are_those_of_the_method_written_out_in_python(steps):
    """The state for resuming a run holds the last error, or 1e-4 if the error is less."""
    case, how = trajectory("textbook"), {"rtol": 1e-4, "atol": 1e-4}
    run = simulate_implicitly(case, 2.0, **how)
    # one step more is begun, and cut: what is kept is from before it
    sol = solve(case, 0.5 * (run.t[steps] + run.t[steps + 1]), **how)
    found = 2.0 ** sol._run.__getstate__()["position_log2_error_before"]
    assert found == pytest.approx(max(run.errors[steps - 1], 1e-4), rel=1e-6)
