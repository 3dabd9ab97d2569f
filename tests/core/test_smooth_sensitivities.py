"""Derivatives of smooth runs, by all that their ends depend on, are those of many digits."""

from __future__ import annotations

import numpy as np
import pytest
from derivatives import campaign
from derivatives.campaign import ALLOWED_IF_SMOOTH, judged_smooth
from derivatives.random_run import RandomRun, by_pendcore
from derivatives.smooth_runs import by_differences
from reference.newton_euler import uniform_rod

SEEDS = [*range(0, 60, 2), 1, 5, 7]


@pytest.mark.few_cases
@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_run_has_its_derivatives(seed: int) -> None:
    """`make campaign OF=derivatives RUNS=smooth` has as many as are asked for."""
    verdict = judged_smooth(seed)
    assert (verdict.kind, verdict.names) == ("right", 0), verdict


@pytest.mark.parametrize("column", [0, 5, -1])
def test_a_wrong_derivative_is_seen(column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A share of 3e-12 in any column is too much."""

    def spoilt(case: RandomRun, **how: float) -> tuple[np.ndarray, np.ndarray, str]:
        end, columns, why = by_pendcore(case, **how)
        size = max(np.abs(columns[:, column]).max(), np.abs(columns[:, : len(columns)]).max())
        columns[0, column] += 3 * ALLOWED_IF_SMOOTH * size
        return end, columns, why

    monkeypatch.setattr(campaign, "by_pendcore", spoilt)
    assert judged_smooth(28).kind == "wrong"


@pytest.mark.parametrize(
    ("wind", "t_end"), [((2.0, 0.0), 0.3), ((0.0, 3.0), 0.5), ((5.0, -4.0), 0.3)]
)
def test_drag_turns_round_in_a_step(wind: tuple[float, float], t_end: float) -> None:
    """Where an end of the rod turns into the wind, the motion and its changes have a kink."""
    names = ["q0[1]", "qd0[2]", "gravity", "effect[1].diameter", "effect[1].wind.x"]
    drag = {"link": 2, "drag_coefficient": 1.5, "diameter": 0.3, "air_density": 4.0, "wind": wind}
    case = RandomRun(
        bodies=[uniform_rod(1.0, 1.0), uniform_rod(0.5, 0.8)], gravity=9.8,
        described=[("rod_drag", drag)], q0=[0.3, 1.0], qd0=[4.0, -6.0], t_end=t_end,
        changes=dict.fromkeys(names, 1.0),
    )  # fmt: skip
    end, found, _ = by_pendcore(case, rtol=1e-14, atol=1e-17)
    right_end, right = by_differences(case, case.changes, 1e-17, 0.01)
    np.testing.assert_allclose(end, right_end, rtol=0, atol=2e-13)
    assert np.abs(found.sum(axis=1) - right).max() <= 4e-13 * np.abs(found).max()


def test_a_bend_is_passed_twice_in_milliseconds() -> None:
    """The rate rises to 3e-4 rad/s above zero, where quadratic friction has a kink, and falls."""
    wave = {"amplitude": 3.0, "angular_frequency": 9.0, "phase": np.pi - 0.2}
    names = {"q0[1]": 1.0, "qd0[1]": 1.0, "effect[2].damping2": 1.0}
    case = RandomRun(
        bodies=[uniform_rod(1.0, 1.0)], gravity=0.0, q0=[0.0], qd0=[-0.0196385], t_end=0.05,
        described=[("motor", {"joint": 1, "sinusoid": wave}),
                   ("viscous_joint", {"joint": 1, "damping": 0.0, "damping2": 1.0})],
        changes=names,
    )  # fmt: skip
    end, found, _ = by_pendcore(case, rtol=1e-14, atol=1e-17)
    for longest in (0.03, 5e-4):
        right_end, right = by_differences(case, names, 1e-17, longest)
        np.testing.assert_allclose(end, right_end, rtol=0, atol=1e-14)
        np.testing.assert_allclose(found.sum(axis=1), right, rtol=0, atol=1e-13)
