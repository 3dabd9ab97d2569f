"""A run that does not get to its end warns, raises or is silent, as it is asked to."""

from __future__ import annotations

import pickle
import re
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main

BOOK = pc.Scene.textbook()
START: dict[str, Any] = {"q0": [np.pi / 4, np.pi / 3], "t_span": (0, 5)}
ROD = pc.Scene(links=BOOK.links[:1], gravity=0.0)
OVER = [pc.events.LinkAngle(1, 0.0, every_turn=True)]


def undefined(t: float, q: Any, qd: Any) -> Any:
    return np.full(2, np.nan if t > 1 else 0.0)


UNFINISHED: dict[str, Any] = {
    "max_steps": {"scene": BOOK, **START, "max_steps": 5},
    "time_limit": {"scene": BOOK, **START, "t_span": (0, 1e9), "store": "end", "time_limit": 0.01},
    "max_turns": {
        "scene": ROD, "q0": 0.5, "qd0": 1e300, "t_span": (0, 1), "step": 1.0, "events": OVER,
    },
    "step_too_small": {"scene": BOOK, "q0": 0.3, "t_span": (1e17, 1e17 + 1000)},
    "not_converged": {
        "scene": BOOK, "q0": (2.0, 2.5), "qd0": (0, 8), "t_span": (0, 99), "method": "radau5",
        "step": 50.0,
    },
    "non_finite": {"scene": BOOK.replace(effects=[pc.effects.User(undefined)]), **START},
}  # fmt: skip


@pytest.mark.parametrize("status", UNFINISHED)
def test_a_run_that_does_not_get_to_its_end_warns_of_status_time_and_remedy(status: str) -> None:
    run = UNFINISHED[status]
    with pytest.warns(pc.PendcoreWarning) as told:
        sol = pc.simulate(**run)
    (warning,) = told
    said = str(warning.message)
    t_end = run["t_span"][1]
    assert sol.status == status
    assert said.startswith(f"the run ended before t_end = {t_end:.6g} s, with status {status}: ")
    assert f"t = {sol._run.t_reached!r} s" in said
    assert sol.message.removeprefix(f"{status}: ") in said
    assert ("resume" in said) == (status in ("max_steps", "time_limit", "max_turns"))
    assert 'on_failure="raise"' in said
    assert warning.filename == __file__  # the user's own line


@pytest.mark.parametrize("status", UNFINISHED)
def test_a_failure_that_raises_has_the_run_so_far(status: str) -> None:
    with pytest.raises(pc.RunError, match=f"with status {status}: ") as end:
        pc.simulate(**UNFINISHED[status], on_failure="raise")
    assert end.value.solution.status == status
    assert "on_failure" not in str(end.value)


@pytest.mark.parametrize("status", UNFINISHED)
def test_a_failure_that_is_ignored_says_nothing(status: str) -> None:
    assert pc.simulate(**UNFINISHED[status], on_failure="ignore").status == status


@pytest.mark.parametrize("what", ["warn", "raise", "ignore"])
def test_a_run_that_gets_to_its_end_is_returned(what: Any) -> None:
    sol = pc.simulate(BOOK, **START, on_failure=what)
    assert sol.success
    assert sol.resume(6, on_failure=what).success
    ends = [pc.events.LinkAngle(1, 1.0, terminal=True)]
    assert pc.simulate(BOOK, **START, events=ends, on_failure=what).status == "event"


def test_a_fit_does_not_take_a_shorter_run_for_the_whole() -> None:
    """One kept time broadcasts against any data."""
    data = np.zeros((101, 2))
    how: dict[str, Any] = START | {"t_eval": np.linspace(0, 5, 101), "max_steps": 1}
    how["method"] = "dopri5"
    silent = pc.simulate(BOOK, **how, on_failure="ignore")
    assert (silent.q - data).shape == (101, 2)
    with pytest.warns(pc.PendcoreWarning, match="with status max_steps"):
        pc.simulate(BOOK, **how)


def test_a_resumed_run_is_checked_by_what_resume_is_told() -> None:
    begun = pc.simulate(BOOK, q0=START["q0"], t_span=(0, 1), on_failure="raise")
    with pytest.warns(pc.PendcoreWarning, match=r"before t_end = 3 s, with status max_steps"):
        begun.resume(3, max_steps=2)
    with pytest.raises(pc.RunError) as end:
        begun.resume(3, max_steps=2, on_failure="raise")
    assert end.value.solution.resume(3).success
    assert begun.resume(3, max_steps=2, on_failure="ignore").status == "max_steps"


@pytest.mark.parametrize("options", [{"max_steps": 30}, {"time_limit": 1e-6}])
def test_a_run_for_an_error_is_checked_as_well(options: Any) -> None:
    how = START | {"error": 1e-6} | options
    (status,) = options
    with pytest.warns(pc.PendcoreWarning, match=f"{status}: .*; its error: asked"):
        pc.simulate(BOOK, **how)
    with pytest.raises(pc.RunError, match=status) as end:
        pc.simulate(BOOK, **how, on_failure="raise")
    assert end.value.solution.accuracy is not None
    assert not end.value.solution.accuracy.reached
    assert pc.simulate(BOOK, **how, on_failure="ignore").status == status


def test_where_warnings_are_errors_the_run_is_not_lost() -> None:
    with pytest.raises(pc.PendcoreWarning, match="with status max_steps") as end:
        pc.Case(scene=BOOK, **START, name="short", options={"max_steps": 5}).simulate()
    assert end.value.solution.status == "max_steps"  # type: ignore[attr-defined]
    assert end.value.solution.name == "short"  # type: ignore[attr-defined]


def test_an_error_of_a_run_pickles_with_the_run() -> None:
    with pytest.raises(pc.RunError) as end:
        pc.simulate(**UNFINISHED["max_steps"], on_failure="raise")
    again = pickle.loads(pickle.dumps(end.value))
    assert str(again) == str(end.value)
    assert np.array_equal(again.solution.y, end.value.solution.y)


def test_a_case_says_what_failure_does_and_whoever_runs_it_another() -> None:
    options = {"max_steps": 5, "on_failure": "raise"}
    case = pc.Case(scene=BOOK, **START, name="short", options=options)
    assert pc.read_case(case.to_toml()) == case
    with pytest.raises(pc.RunError) as end:
        case.simulate()
    assert end.value.solution.name == "short"
    assert case.simulate(on_failure="ignore").status == "max_steps"
    warned = pc.Case(scene=BOOK, **START, options={"max_steps": 5})
    with pytest.warns(pc.PendcoreWarning, match="with status max_steps"):
        again = warned.simulate().case()
    assert again.options["max_steps"] == 5
    assert "on_failure" not in again.options
    with pytest.raises(pc.RunError):
        warned.simulate(on_failure="raise")


@pytest.mark.parametrize("wrong", ["yes", True, None, np.nan])
def test_a_wrong_on_failure_is_refused_before_anything_is_run(wrong: Any) -> None:
    message = rf'^on_failure = {re.escape(repr(wrong))}: must be "warn", "raise" or "ignore"$'
    endless = {"t_span": (0, 1e12), "store": "end"}
    with pytest.raises(ValueError, match=message):
        pc.simulate(BOOK, q0=0.3, **endless, on_failure=wrong)
    with pytest.raises(ValueError, match=message):
        pc.simulate(BOOK, (0, 1), 0.3).resume(1e12, on_failure=wrong)
    if wrong is not None:
        case = pc.Case(scene=BOOK, q0=0.3, t_span=(0, 1e12), options={"on_failure": wrong})
        for asked in (None, "ignore"):
            with pytest.raises(ValueError, match=message):
                case.simulate(on_failure=asked)


@pytest.mark.parametrize("asked", ["", 'on_failure = "raise"\n', 'on_failure = "ignore"\n'])
def test_the_command_says_it_once_and_writes_what_there_is(
    asked: str, tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("short.toml").write_text(pc.Case.textbook().to_toml() + "max_steps = 5\n" + asked)
    assert main(["run", "short.toml"]) == 1
    err = capsys.readouterr().err
    assert err.count("the cap on steps was reached") == 1
    assert "warning" not in err
    assert pc.load("out/short/solution.npz").status == "max_steps"


def test_a_wrong_on_failure_in_a_case_file_is_told_with_its_line(
    tmp_path: Path, monkeypatch: Any, capsys: Any
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("odd.toml").write_text(pc.Case.textbook().to_toml() + 'on_failure = "yes"\n')
    assert main(["run", "odd.toml"]) == 2
    assert re.search(r"odd\.toml, line \d+: on_failure = 'yes': must be", capsys.readouterr().err)


def test_of_a_run_that_kept_no_time_the_way_that_it_went_is_drawn() -> None:
    how: dict[str, Any] = START | {"max_steps": 3, "on_failure": "ignore"}
    none = pc.simulate(BOOK, **how, t_eval=[4.0], store="times")
    assert len(none.t) == 0
    line = none.plot(what="path")[0]
    tip = pc.simulate(BOOK, **how).positions()[-1, -1]
    np.testing.assert_allclose([line.get_xdata()[-1], line.get_ydata()[-1]], tip, atol=1e-12)


def test_what_is_run_on_the_way_to_an_answer_says_nothing() -> None:
    """Second runs that time cuts short, and contenders that do not get there."""
    sol = pc.simulate(BOOK, **START)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sol.estimate_error(time_limit=1e-3)
        pc.accuracy_cost(BOOK, q0=START["q0"], t_span=(0, 50), time_limit=0.2)
