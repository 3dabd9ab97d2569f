"""What simulate() takes, what it keeps, and what becomes of a run that is broken off."""

from __future__ import annotations

import pickle
import signal
import sys
import threading
import time
from inspect import signature
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore._messages.progress import ProgressBar
from pendcore.options import RUN_DEFAULTS

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
import write_options

BOOK = pc.Scene.textbook()
Q0 = (np.pi / 4, np.pi / 3)


def textbook(**changes):
    return pc.simulate(BOOK, **{"t_span": (0, 5), "q0": Q0} | changes)


def endless(**options):
    """A run that would take hours."""
    return textbook(t_span=(0, 1e9), store="end", on_failure="ignore", **options)


def same_bits(a, b):
    return np.array_equal(a.t, b.t) and np.array_equal(a.y, b.y)


def test_options_have_the_documented_defaults_and_are_written_where_type_checkers_look():
    parameters = signature(pc.simulate).parameters
    assert [*parameters] == ["scene", "t_span", "q0", "qd0", *RUN_DEFAULTS]
    assert {name: parameters[name].default for name in RUN_DEFAULTS} == RUN_DEFAULTS
    assert [*signature(pc.Link).parameters] == ["mass", "length", "center", "inertia"]
    defaults = [parameters[name].default for name in ("method", "rtol", "atol")]
    assert defaults == ["auto", 1e-9, 1e-12]
    for path, text in write_options.written().items():
        found = path.read_text()
        assert found == text, f"{path.name}: run: python docs/generators/write_options.py"


# Starts of all links that are the same; test_array_input.py has arrays of any make.
FORMS = {
    (1.0, 2.0): [[1, 2], np.array([1, 2]), np.array([1, 2], dtype=np.float32)],
    (1.0, 1.0): [1, 1.0, np.float64(1.0), np.int32(1), np.array(1.0)],
}


@pytest.mark.parametrize("start", FORMS)
def test_the_same_start_in_any_form_gives_the_same_bits(start):
    run = textbook(q0=start, qd0=start, t_span=(0, 1))
    for form in FORMS[start]:
        assert same_bits(run, textbook(q0=form, qd0=form, t_span=(0, 1)))


# Options that ask for the same run.
SAME = {
    "a list": ({"t_span": [0, 5]}, {}),
    "an array": ({"t_span": np.array([0, 5])}, {}),
    "NumPy's numbers": ({"t_span": (np.float64(0), np.int64(5))}, {}),
    "a tolerance for each": (
        {"rtol": np.full(4, 1e-8), "atol": [1e-10] * 4}, {"rtol": 1e-8, "atol": 1e-10}
    ),
    "RK45": ({"method": "RK45"}, {"method": "dopri5"}),
    "ode45": ({"method": "ode45"}, {"method": "dopri5"}),
}  # fmt: skip


@pytest.mark.parametrize("case", SAME)
def test_options_may_be_said_in_several_ways(case):
    one, other = (textbook(**options) for options in SAME[case])
    assert same_bits(one, other)
    assert one.method == other.method


def test_tolerances_hold_for_their_component_and_a_fixed_step_but_for_the_last():
    tight_rates = textbook(rtol=[1e-3, 1e-3, 1e-9, 1e-9])
    assert tight_rates.stats.accepted > textbook(rtol=1e-3).stats.accepted
    run = textbook(step=0.15)
    np.testing.assert_allclose(np.diff(run.t)[:-1], 0.15, rtol=1e-12)
    assert run.t[-1] == 5.0


def test_the_result_has_the_times_asked_for_and_dense_output_beside_them():
    t = np.linspace(0, 5, 101)
    run, whole = textbook(t_eval=t), textbook()
    assert run.store == "times"
    assert np.array_equal(run.t, t)
    assert run.q.shape == (101, 2)
    assert np.array_equal(run.y, whole(t))
    both = textbook(t_eval=[1.0, 2.0], store="dense")
    assert both.t.tolist() == [1.0, 2.0]
    assert np.array_equal(both(4.5), whole(4.5))


def test_a_run_of_no_length_is_its_start(method):
    run = textbook(qd0=0.5, t_span=(2, 2), method=method)
    assert run.success
    assert np.array_equal(run.y[:, -1], [*Q0, 0.5, 0.5])
    assert np.array_equal(run(2.0), run.y[:, -1])


@pytest.mark.parametrize("t_end", [5.0, -5.0])
def test_the_first_step_is_as_asked_and_none_is_longer_than_max_step(t_end, method):
    run = textbook(t_span=(0.0, t_end), max_step=0.003, method=method, rtol=1e-6)
    assert run.t[-1] == t_end
    assert np.abs(np.diff(run.t)).max() <= 0.003 * (1 + 1e-12)
    assert run.stats.limited_by_max_step > 1000
    assert (np.sign(np.diff(run.t)) == np.sign(t_end)).all()
    run = textbook(t_span=(0.0, t_end), first_step=1e-4, method=method)
    assert run.t[1] == np.copysign(1e-4, t_end)
    assert np.array_equal(run(t_end), run.y[:, -1])


def test_a_run_ends_at_its_limits_and_keeps_what_it_has():
    run = textbook(max_steps=10, on_failure="ignore")
    assert (run.success, run.status) == (False, "max_steps")
    assert "max_steps" in run.message
    assert run.stats.accepted + run.stats.rejected == 10
    assert 0 < run.t[-1] < 5
    assert np.array_equal(run.t, textbook().t[: len(run.t)])
    began = time.monotonic()
    assert endless(time_limit=0.1).status == "time_limit"
    assert 0.1 <= time.monotonic() - began < 1.0


def enough(fraction):
    raise LookupError("enough")


def goes_on(run, compensated):
    """Compare a run that was stopped, pickled and resumed with one that never stopped."""
    t_end = run.t[-1] + 1
    again = pickle.loads(pickle.dumps(run)).resume(t_end)
    whole = textbook(t_span=(0, t_end), store="end", compensated=compensated)
    assert same_bits(again, whole)
    assert again.stats == whole.stats


@pytest.mark.few_cases
@pytest.mark.parametrize("bar", [False, True])
@pytest.mark.parametrize("compensated", [False, True])
def test_what_breaks_a_run_off_passes_through_with_the_run_so_far(bar, compensated, capsys):
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt) as stop:
        endless(time_limit=10, progress=bar, compensated=compensated)
    assert capsys.readouterr().err.endswith("\n" * bar)  # a bar ends its line
    with pytest.raises(LookupError, match="enough") as error:
        endless(time_limit=10, progress=enough, compensated=compensated)
    for exception, status in ((stop, "interrupted"), (error, "callback_error")):
        run = exception.value.solution
        assert (run.status, run.t[-1] > 0) == (status, True)
        goes_on(run, compensated)
    goes_on(endless(time_limit=0.1, compensated=compensated), compensated)


def test_a_progress_function_gets_growing_fractions():
    fractions = []
    endless(time_limit=0.4, progress=fractions.append)
    assert len(fractions) >= 3
    assert fractions == sorted(fractions)
    assert 0 <= fractions[0] <= fractions[-1] <= 1


@pytest.mark.parametrize("progress", [None, False, True])
def test_a_bar_is_drawn_where_there_is_a_terminal_or_where_it_is_asked_for(progress, capsys):
    endless(progress=progress, time_limit=1.2)
    out, err = capsys.readouterr()
    assert out == ""
    assert ("simulating" in err, err.endswith("\n")) == (progress is True, progress is True)
    assert progress or err == ""


def test_on_a_terminal_a_bar_comes_after_a_second(capsys, monkeypatch):
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True)
    clock = iter([10.0, 10.9, 11.1])  # when the bar is first called, then as it looks again
    monkeypatch.setattr("pendcore._messages.progress.monotonic", lambda: next(clock))
    bar = ProgressBar()
    bar(0.2)
    assert capsys.readouterr().err == ""
    bar(0.5)
    bar.close()
    assert "50 %" in capsys.readouterr().err
