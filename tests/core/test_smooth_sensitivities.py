"""Derivatives of smooth runs, by all that their ends depend on, are those of many digits."""

from __future__ import annotations

import numpy as np
import pytest
from derivatives import campaign
from derivatives.campaign import ALLOWED_IF_SMOOTH, judged_smooth
from derivatives.hybrid_runs import by_complex_numbers
from derivatives.random_run import RandomRun, by_pendcore
from derivatives.smooth_runs import by_differences
from reference.newton_euler import Body, uniform_rod

SEEDS = [*range(0, 20, 2), 42, *range(22, 42, 2), 20, *range(44, 60, 2), 1, 5, 7]
"""A reduced sweep takes 0, 22, 20 and 7: short ones with two, three, four and six links."""


@pytest.mark.few_cases
@pytest.mark.parametrize("seed", SEEDS)
def test_a_random_run_has_its_derivatives(seed: int) -> None:
    """`make campaign OF=derivatives RUNS=smooth` has as many as are asked for."""
    verdict = judged_smooth(seed)
    assert (verdict.kind, verdict.names) == ("right", 0), verdict


@pytest.mark.parametrize(("column", "looks"), [(0, 2), (5, 1), (-1, 1)])
def test_a_wrong_derivative_is_seen(
    column: int, looks: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A share of 3e-12 in any column is too much."""

    def spoilt(case: RandomRun, **how: float) -> tuple[np.ndarray, np.ndarray, str]:
        end, columns, why = by_pendcore(case, **how)
        size = max(np.abs(columns[:, column]).max(), np.abs(columns[:, : len(columns)]).max())
        columns[0, column] += 3 * ALLOWED_IF_SMOOTH * size
        return end, columns, why

    monkeypatch.setattr(campaign, "by_pendcore", spoilt)
    monkeypatch.setattr(campaign, "LOOKS", campaign.LOOKS[:looks])
    assert judged_smooth(28).kind == "wrong"


def drag_in(wind: tuple[float, float], t_end: float) -> RandomRun:
    """Where an end of the rod turns into the wind, the motion and its changes have a kink."""
    names = ["q0[1]", "qd0[2]", "gravity", "effect[1].diameter", "effect[1].wind.x"]
    drag = {"link": 2, "drag_coefficient": 1.5, "diameter": 0.3, "air_density": 4.0, "wind": wind}
    return RandomRun(
        bodies=[uniform_rod(1.0, 1.0), uniform_rod(0.5, 0.8)], gravity=9.8,
        described=[("rod_drag", drag)], q0=[0.3, 1.0], qd0=[4.0, -6.0], t_end=t_end,
        changes=dict.fromkeys(names, 1.0),
    )  # fmt: skip


WAVE = {"amplitude": 3.0, "angular_frequency": 9.0, "phase": np.pi - 0.2}
BEND_PASSED_TWICE = RandomRun(
    bodies=[uniform_rod(1.0, 1.0)], gravity=0.0, q0=[0.0], qd0=[-0.0196385], t_end=0.05,
    described=[("motor", {"joint": 1, "sinusoid": WAVE}),
               ("viscous_joint", {"joint": 1, "damping": 0.0, "damping2": 1.0})],
    changes={"q0[1]": 1.0, "qd0[1]": 1.0, "effect[2].damping2": 1.0},
)  # fmt: skip
"""The rate rises to 3e-4 rad/s above zero, where quadratic friction has a kink, and falls."""
KINKS: dict[str, tuple[RandomRun, float, float, float]] = {
    "drag in a wind along x": (drag_in((2.0, 0.0), 0.3), 0.01, 2e-13, 4e-13),
    "drag in a wind along y": (drag_in((0.0, 3.0), 0.5), 0.01, 2e-13, 4e-13),
    "drag in a slanting wind": (drag_in((5.0, -4.0), 0.3), 0.01, 2e-13, 4e-13),
    "a bend, in long steps": (BEND_PASSED_TWICE, 0.03, 1e-14, 1e-13),
    "a bend, in short steps": (BEND_PASSED_TWICE, 5e-4, 1e-14, 1e-13),
}  # fmt: skip
"""Each with the longest step of the reference, s, and the errors of its end and of its changes."""


@pytest.mark.parametrize("name", KINKS)
def test_kinks_spoil_no_derivative(name: str) -> None:
    case, longest, end_off, changes_off = KINKS[name]
    end, found, _ = by_pendcore(case, rtol=1e-14, atol=1e-17)
    right_end, right = by_differences(case, case.changes, 1e-17, longest)
    np.testing.assert_allclose(end, right_end, rtol=0, atol=end_off)
    assert np.abs(found.sum(axis=1) - right).max() <= changes_off * np.abs(found).max()


@pytest.mark.parametrize("name", ["effect[1].damping", "effect[1].damping3"])
@pytest.mark.parametrize("method", ["taylor", "dop853"])
def test_a_change_that_begins_slowly_is_that_of_complex_numbers(method: str, name: str) -> None:
    """From rest, a change by damping is zero at the start, and so is its rate."""
    damper = {"joint": 1, "damping": 0.1, "damping3": 0.02}
    case = RandomRun(
        bodies=[Body(1.0, 0.9, 0.4, 0.09), Body(0.7, 1.1, 0.6, 0.08)], gravity=9.807,
        described=[("viscous_joint", damper)], q0=[0.4, -0.9], qd0=[0.0, 0.0], t_end=0.4,
        changes={name: 1.0},
    )  # fmt: skip
    _, found, _ = by_pendcore(case, rtol=1e-13, atol=1e-16, method=method)
    _, right, _ = by_complex_numbers(case, case.changes, 0.02)
    np.testing.assert_allclose(found[:, 0], right, rtol=0, atol=1e-11)
