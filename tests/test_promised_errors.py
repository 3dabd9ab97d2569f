"""What broke the promise of simulate(error=...) once, and holds now."""

from __future__ import annotations

import math
from typing import Any

import mpmath
import numpy as np
import pendcore as pc
import pytest
from pendcore.accuracy.trials import Trials

BOOK = pc.Scene.textbook()
START = ([np.pi / 4, np.pi / 3], 0, (0, 5))


@pytest.mark.parametrize(
    "options", [{}, {"store": "steps"}, {"store": "end"}, {"t_eval": [1.0, 2.0, 5.0]}], ids=str
)
@pytest.mark.parametrize("error", [1e-3, 1e-9])
def test_all_that_is_said_of_an_error_is_one_estimate(options, error):
    sol = pc.simulate(BOOK, *START, error=error, **options)
    assert sol.error().largest == sol.accuracy.achieved <= error
    assert sol.valid_until(error, of="position") == sol.accuracy.until == 5.0
    assert sol.accuracy.everywhere == (not options)
    assert sol.accuracy.times == len(sol.error().t)


def test_an_error_in_step_with_a_grid_of_times_is_seen():
    """A swing over 50 whole periods: at 101 even times the error of its phase hardly shows."""
    period = 4 * float(mpmath.ellipk(math.sin(0.5) ** 2)) / math.sqrt(9.807)
    rod = pc.Scene(links=[pc.Link.point_mass(mass=1.0, length=1.0)])
    span = (0, 50 * period)
    sol = pc.simulate(rod, np.pi / 2 - 1, 0, span, error=1e-6)
    t = np.linspace(*span, 4001)
    exact = pc.simulate(rod, np.pi / 2 - 1, 0, span, t_eval=t, method="taylor", rtol=1e-14)
    apart = 2 * abs(np.sin((sol(t)[0] - exact.q[:, 0]) / 2)).max()
    on_the_grid = 2 * abs(np.sin((sol(t)[0] - exact.q[:, 0]) / 2))[::40].max()
    assert on_the_grid < apart / 5
    assert 0.5 * sol.accuracy.achieved < apart <= sol.accuracy.achieved <= 1e-6


@pytest.mark.parametrize(
    ("q0", "t_end", "error"),
    [([1.84, 0.78], 100.0, 1e-4), ([2.96, 2.39], 100.0, 1e-3), ([-3.0, 2.7], 60.0, 1e-3)],
)
def test_what_ended_in_a_recursion_error_is_kept(q0, t_end, error):
    assert pc.simulate(BOOK, q0, t_span=(0, t_end), error=error).accuracy.outcome == "kept"


@pytest.mark.parametrize(
    ("error", "t_end", "q0"),
    [
        (3.96e-5, 18.096875125011646, [-1.5560011051224152, 1.9295018595652618]),
        (2.84e-6, 20.010522923234713, [-2.3258576190935196, -1.805487084809313]),
        (3.3e-9, 12.468814787417225, [-1.3412366120866033, 2.2737309006312136]),
    ],
)
def test_near_the_end_of_double_precision_rounded_constants_are_seen(error, t_end, q0):
    """Runs that share them agree with each other and are 10 to 136 times as far from the truth."""
    with pytest.raises(pc.AccuracyError, match="not reached") as caught:
        pc.simulate(BOOK, q0, 0, (0, t_end), error=error)
    assert caught.value.least > error
    assert caught.value.solution.accuracy.until < t_end


@pytest.mark.parametrize(
    ("q0", "t_end", "true"),
    [((-1.2, -0.6), 8, 5.303e-10), ((-1.2599042254758888, -1.2119615135616397), 7, 3.92e-10)],
)
def test_second_runs_that_share_the_truncation_of_a_tight_trial_do_not_verify_it(
    q0: tuple[float, float], t_end: float, true: float
) -> None:
    """The runs at rtol 1e-14 agree to 1e-10; a solution in 34 digits says how far off they are."""
    with pytest.raises(pc.AccuracyError) as refusal:
        pc.simulate(BOOK, q0, t_span=(0, t_end), error=0.75 * true)
    assert refusal.value.least > true


def test_a_trial_is_handed_over_if_the_interrupt_falls_while_runs_are_compared(
    monkeypatch: Any,
) -> None:
    def interrupted(*_: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr("pendcore.accuracy.trials.estimate", interrupted)
    with pytest.raises(KeyboardInterrupt) as stop:
        pc.simulate(BOOK, [0.7, 1.2], t_span=(0, 10), error=1e-6)
    sol = stop.value.solution  # type: ignore[attr-defined]
    assert sol.success
    assert sol.accuracy.outcome == "ended early"


def test_when_the_time_is_up_a_whole_trial_is_returned_and_called_unverified(
    monkeypatch: Any,
) -> None:
    def up_after_the_first(runs: Trials) -> float | None:
        return 1e-6 if runs.trials else None

    monkeypatch.setattr(Trials, "_time_left", up_after_the_first)
    with pytest.warns(pc.PendcoreWarning, match="got to its end, but .* not verified"):
        sol = pc.simulate(BOOK, [-1.5, -1.4], t_span=(0, 30), error=1e-3)
    assert sol.t[-1] == 30
    assert sol.accuracy.outcome == "ended early"
