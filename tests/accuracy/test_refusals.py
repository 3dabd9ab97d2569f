"""What a refused error is told: the cause, and a least error that is kept when it is asked for."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as E
from pendcore.cli import main

BOOK = pc.Scene.textbook()
CHAOTIC = ([-1.5, -1.4], 0, (0, 100))


def damped(damping: float) -> pc.Scene:
    return BOOK.replace(effects=[E.ViscousJoint(joint=2, damping=damping)])


def test_the_rounding_of_large_angles_is_told() -> None:
    with pytest.raises(pc.AccuracyError, match="to 1e-10 rad; begin with fewer turns") as caught:
        pc.simulate(BOOK, q0=[1e6, 1e6 + 0.5], qd0=0, t_span=(0, 5), error=1e-9)
    turns = 2 * np.pi * round(1e6 / (2 * np.pi))
    fewer = pc.simulate(BOOK, q0=[1e6 - turns, 1e6 - turns + 0.5], qd0=0, t_span=(0, 5), error=1e-9)
    assert fewer.accuracy is not None
    assert fewer.accuracy.reached
    assert caught.value.least > 1e-9


def test_turns_are_not_to_blame_for_chaos() -> None:
    q0, qd0, span = CHAOTIC
    with pytest.raises(pc.AccuracyError, match="neighbouring motions part too fast"):
        pc.simulate(BOOK, q0=np.array(q0) + 34 * np.pi, qd0=qd0, t_span=span, error=1e-3)


@pytest.mark.parametrize(
    ("scene", "q0", "t_end", "error"),
    [
        (BOOK, [-1.2, -0.6], 12, 1e-9),
        (BOOK.replace(gravity=0.0), [1, 2], 30, 1e-15),
        (BOOK, [np.pi / 2] * 2, 30, 1e-14),
        (damped(300.0), [0.8, 1.0], 2, 1e-13),
        (damped(1e7), [0.7, 1.0], 3, 3e-13),  # stiff: no trial is looser than the tightest
    ],
)
def test_the_least_error_is_kept(
    scene: pc.Scene, q0: list[float], t_end: float, error: float
) -> None:
    with pytest.raises(pc.AccuracyError) as caught:
        pc.simulate(scene, q0=q0, qd0=0, t_span=(0, t_end), error=error)
    least = caught.value.least
    assert f"ask for error = {least:.1e} or more" in str(caught.value)
    told = pc.simulate(scene, q0=q0, qd0=0, t_span=(0, t_end), error=least).accuracy
    assert told is not None
    assert told.reached


def test_no_least_error_is_told_that_no_search_kept(monkeypatch: pytest.MonkeyPatch) -> None:
    """The first search for a least error of this scene is refused, too."""
    how: dict[str, Any] = {"q0": [-1.2, -0.6], "t_span": (0, 12), "error": 1e-9}
    monkeypatch.setattr("pendcore._accuracy.target_error.MOST_SEARCHES", 1)
    with pytest.raises(pc.AccuracyError, match="reached, but no search kept an error so") as caught:
        pc.simulate(BOOK, **how)
    assert caught.value.least == np.inf
    assert caught.value.solution.accuracy.achieved < 1e-4


def test_the_search_for_the_least_error_gives_no_warning_again() -> None:
    with warnings.catch_warnings(record=True) as given:
        warnings.simplefilter("always")
        with pytest.raises(pc.AccuracyError):
            pc.simulate(BOOK, q0=[90, 30], qd0=0, t_span=(0, 5), error=1e-15)  # degrees, by mistake
    assert len([one for one in given if "rad" in str(one.message)]) == 1


def test_what_breaks_off_the_search_for_the_least_error_leaves_the_refused_run(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    class Stop(Exception):
        pass

    def searched(*_: Any) -> None:
        raise Stop

    monkeypatch.setattr("pendcore._accuracy.trials.Trials.for_least", searched)
    with pytest.raises(Stop) as caught:
        pc.simulate(BOOK, q0=[0.7, 1.0], qd0=0, t_span=(0, 5), error=1e-16)
    accuracy = caught.value.solution.accuracy  # type: ignore[attr-defined]
    assert accuracy.outcome == "refused"
    assert 1e-16 < accuracy.achieved < 1e-12


def test_the_search_for_the_least_error_ends_with_the_time(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(
        "pendcore._accuracy.trials.Trials._time_left",
        lambda runs: np.inf if runs.tries_the_least else 1e-6,
    )
    with pytest.raises(pc.AccuracyError, match="no search kept an error so small") as caught:
        pc.simulate(BOOK, q0=[0.7, 1.0], qd0=0, t_span=(0, 5), error=1e-16)
    assert caught.value.least == np.inf


def test_progress_goes_on_in_the_search_for_the_least_error() -> None:
    fractions: list[float] = []
    with pytest.raises(pc.AccuracyError) as caught:
        pc.simulate(
            BOOK, q0=[0.7, 1.0], qd0=0, t_span=(0, 2000), error=1e-16, progress=fractions.append
        )
    assert len(fractions) > 1
    assert fractions == sorted(fractions)
    assert sum(paid.purpose == "choose" for paid in caught.value.solution.accuracy.paid) > 1


def test_the_command_says_that_a_finished_run_was_not_verified(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        "pendcore._accuracy.trials.Trials._time_left", lambda runs: 1e-6 if runs.paid else np.inf
    )
    stick = pc.Case(
        scene=BOOK.replace(effects=[E.DryJointFriction(joint=1, coulomb=0.01)]), q0=[0.7, 1.0],
        t_span=(0, 1), options={"error": 1e-6, "time_limit": 60.0},
    )  # fmt: skip
    Path("stick.toml").write_text(stick.to_toml())
    assert main(["run", "stick.toml", "--no-horizon"]) == 1
    assert "finished, but not verified: the time limit was reached" in capsys.readouterr().err
