"""A run that does not get to its end warns, raises or is silent, as it is asked to."""

from __future__ import annotations

import pickle
import re
import warnings

import numpy as np
import pendcore as pc
import pytest

BOOK = pc.Scene.textbook()
START = {"q0": [np.pi / 4, np.pi / 3], "t_span": (0, 5)}
ROD = pc.Scene(links=BOOK.links[:1], gravity=0.0)
OVER = [pc.events.LinkAngle(1, 0.0, every_turn=True)]


def undefined(t, q, qd):
    return np.full(2, np.nan if t > 1 else 0.0)


UNFINISHED = {
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


@pytest.mark.every_value("status")
@pytest.mark.parametrize("status", UNFINISHED)
def test_a_run_that_does_not_get_to_its_end_warns_raises_or_says_nothing(status):
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
    with pytest.raises(pc.RunError, match=f"with status {status}: ") as end:
        pc.simulate(**run, on_failure="raise")
    assert end.value.solution.status == status
    assert "on_failure" not in str(end.value)
    assert pc.simulate(**run, on_failure="ignore").status == status


@pytest.mark.parametrize("what", ["warn", "raise", "ignore"])
def test_a_run_that_gets_to_its_end_is_returned(what):
    sol = pc.simulate(BOOK, **START, on_failure=what)
    assert sol.success
    assert sol.resume(6, on_failure=what).success
    ends = [pc.events.LinkAngle(1, 1.0, terminal=True)]
    assert pc.simulate(BOOK, **START, events=ends, on_failure=what).status == "event"


def test_a_resumed_run_is_checked_by_what_resume_is_told():
    begun = pc.simulate(BOOK, q0=START["q0"], t_span=(0, 1), on_failure="raise")
    with pytest.warns(pc.PendcoreWarning, match=r"before t_end = 3 s, with status max_steps"):
        begun.resume(3, max_steps=2)
    with pytest.raises(pc.RunError) as end:
        begun.resume(3, max_steps=2, on_failure="raise")
    assert end.value.solution.resume(3).success
    assert begun.resume(3, max_steps=2, on_failure="ignore").status == "max_steps"


@pytest.mark.parametrize("options", [{"max_steps": 30}, {"time_limit": 1e-6}])
def test_a_run_for_an_error_is_checked_as_well(options):
    how = START | {"error": 1e-6} | options
    (status,) = options
    with pytest.warns(pc.PendcoreWarning, match=f"{status}: .*; its error: asked"):
        pc.simulate(BOOK, **how)
    with pytest.raises(pc.RunError, match=status) as end:
        pc.simulate(BOOK, **how, on_failure="raise")
    assert end.value.solution.accuracy is not None
    assert not end.value.solution.accuracy.reached
    assert pc.simulate(BOOK, **how, on_failure="ignore").status == status


def short(**options):
    return pc.Case(scene=BOOK, **START, name="short", options={"max_steps": 5, **options})


def test_where_failures_are_errors_the_run_is_not_lost():
    with pytest.raises(pc.PendcoreWarning, match="with status max_steps") as warned:
        short().simulate()
    with pytest.raises(pc.RunError) as raised:
        short(on_failure="raise").simulate()
    again = pickle.loads(pickle.dumps(raised.value))
    assert str(again) == str(raised.value)
    assert np.array_equal(again.solution.y, raised.value.solution.y)
    for error in (warned.value, raised.value):
        assert (error.solution.status, error.solution.name) == ("max_steps", "short")


def test_a_case_says_what_failure_does_and_whoever_runs_it_another():
    case = short(on_failure="raise")
    assert pc.read_case(case.to_toml()) == case
    sol = case.simulate(on_failure="ignore")
    assert sol.status == "max_steps"
    assert sol.case().options["max_steps"] == 5
    assert "on_failure" not in sol.case().options
    with pytest.raises(pc.RunError):
        short().simulate(on_failure="raise")


@pytest.mark.parametrize("wrong", ["yes", True, None, np.nan])
def test_a_wrong_on_failure_is_refused_before_anything_is_run(wrong):
    endless = {"q0": 0.3, "t_span": (0, 1e12)}
    calls = [
        lambda: pc.simulate(BOOK, **endless, store="end", on_failure=wrong),
        lambda: pc.simulate(BOOK, (0, 1), 0.3).resume(1e12, on_failure=wrong),
    ]
    if wrong is not None:
        case = pc.Case(scene=BOOK, **endless, options={"on_failure": wrong})
        calls += [case.simulate, lambda: case.simulate(on_failure="ignore")]
    words = re.escape(f'on_failure = {wrong!r}: must be "warn", "raise" or "ignore"')
    for call in calls:
        with pytest.raises(ValueError, match=f"^{words}$"):
            call()


def test_of_a_run_that_kept_no_time_the_way_that_it_went_is_drawn():
    how = START | {"max_steps": 3, "on_failure": "ignore"}
    none = pc.simulate(BOOK, **how, t_eval=[4.0], store="times")
    assert len(none.t) == 0
    line = none.plot(what="path")[0]
    tip = pc.simulate(BOOK, **how).positions()[-1, -1]
    np.testing.assert_allclose([line.get_xdata()[-1], line.get_ydata()[-1]], tip, atol=1e-12)


def test_what_is_run_on_the_way_to_an_answer_says_nothing():
    """Second runs that time cuts short, and contenders that do not get there."""
    sol = pc.simulate(BOOK, **START)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        sol.estimate_error(time_limit=1e-3)
        pc.accuracy_cost(BOOK, q0=START["q0"], t_span=(0, 50), time_limit=0.2)
