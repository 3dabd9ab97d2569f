"""What simulate() takes, what it keeps, and what becomes of a run that is broken off."""

from __future__ import annotations

import re
import signal
import sys
import threading
import time
from functools import partial
from inspect import signature
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore._messages.progress import ProgressBar
from pendcore._run.options import OPTIONS, RUN_DEFAULTS

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
import write_options

Q0 = (np.pi / 4, np.pi / 3)
textbook = partial(pc.simulate, pc.Scene.textbook(), (0, 5), Q0)
endless = partial(pc.simulate, pc.Scene.textbook(), (0, 1e9), Q0, store="end", on_failure="ignore")
"""Would take hours."""


def test_the_signature_of_simulate_has_every_option_and_its_default():
    parameters = signature(pc.simulate).parameters.values()
    keywords = [(one.name, one.default) for one in parameters if one.kind is one.KEYWORD_ONLY]
    assert keywords == list(RUN_DEFAULTS.items())
    assert keywords[:3] == [("method", "auto"), ("rtol", 1e-9), ("atol", 1e-12)]


def test_the_docstring_of_simulate_describes_every_option():
    for name, option in OPTIONS.items():
        line, text = re.search(rf"^ *{name} : (.*)\n +(.*)", pc.simulate.__doc__, re.M).groups()
        assert line
        about = ", ".join(filter(None, (option.unit, option.range)))
        assert f"{about}. {option.sentence}".removeprefix(". ").startswith(text[:40])
        assert len(option.sentence) > 15


@pytest.mark.parametrize("name", [one.name for one in OPTIONS.values() if one.range])
def test_a_number_out_of_the_range_of_its_option_is_refused_in_its_words(name):
    option = OPTIONS[name]
    least = re.search(r"\d+", option.range)
    value = int(least[0]) - 1
    with pytest.raises(ValueError, match=rf"^{name} = {value}(\.0)?: must be {option.range}"):
        textbook(**{name: value})


def test_what_is_written_from_the_descriptors_of_options_is_what_is_there():
    for path, text in write_options.written().items():
        found = path.read_text()
        assert found == text, f"{path.name}: run: python docs/generators/write_options.py"


def same_bits(a, b):
    return np.array_equal(a.t, b.t) and np.array_equal(a.y, b.y)


def read_only():
    array = np.array(Q0)
    array.flags.writeable = False
    return array


@pytest.mark.parametrize(
    "q0",
    [
        list(Q0),
        np.array(Q0),
        read_only(),
        np.array([Q0[0], 9.0, Q0[1], 9.0])[::2],
        np.array(Q0[::-1])[::-1],
        np.array(Q0, dtype=">f8"),
        np.array(Q0, dtype=np.longdouble),
    ],
    ids=["list", "array", "read-only", "strided", "reversed", "big-endian", "long double"],
)
def test_the_same_start_in_any_form_gives_the_same_bits(q0):
    assert same_bits(pc.simulate(pc.Scene.textbook(), q0=q0, t_span=(0, 5)), textbook())


@pytest.mark.parametrize("start", [[1, 2], np.array([1, 2]), np.array([1, 2], dtype=np.float32)])
def test_integers_and_single_precision_are_taken_for_what_they_are(start):
    scene = pc.Scene.textbook()
    assert same_bits(
        pc.simulate(scene, q0=start, qd0=start, t_span=(0, 1)),
        pc.simulate(scene, q0=[1.0, 2.0], qd0=[1.0, 2.0], t_span=(0, 1)),
    )


@pytest.mark.parametrize("start", [1, 1.0, np.float64(1.0), np.int32(1), np.array(1.0)])
def test_scalars_hold_for_every_link(start):
    scene = pc.Scene.textbook()
    assert same_bits(
        pc.simulate(scene, q0=start, qd0=start, t_span=(0, 1)),
        pc.simulate(scene, q0=[1, 1], qd0=[1, 1], t_span=(0, 1)),
    )


@pytest.mark.parametrize("t_span", [[0, 5], np.array([0, 5]), (np.float64(0), np.int64(5))])
def test_t_span_may_be_any_pair(t_span):
    assert same_bits(pc.simulate(pc.Scene.textbook(), q0=Q0, t_span=t_span), textbook())


def test_tolerances_may_be_given_for_every_component():
    scene = pc.Scene.textbook()
    assert same_bits(
        textbook(rtol=1e-8, atol=1e-10), textbook(rtol=np.full(4, 1e-8), atol=[1e-10] * 4)
    )
    tight_rates = pc.simulate(scene, q0=Q0, t_span=(0, 5), rtol=[1e-3, 1e-3, 1e-9, 1e-9])
    assert tight_rates.stats.accepted > textbook(rtol=1e-3).stats.accepted


def test_other_names_of_a_method_are_the_same_method():
    for name in ("RK45", "ode45"):
        run = textbook(method=name)
        assert run.method == "dopri5"
        assert same_bits(run, textbook(method="dopri5"))


def test_the_result_has_the_times_asked_for():
    t = np.linspace(0, 5, 101)
    run = textbook(t_eval=t)
    assert run.store == "times"
    assert np.array_equal(run.t, t)
    assert run.q.shape == (101, 2)
    assert np.array_equal(run.y, textbook()(t))


def test_dense_output_may_be_kept_beside_the_times_asked_for():
    run = textbook(t_eval=[1.0, 2.0], store="dense")
    assert run.t.tolist() == [1.0, 2.0]
    assert np.array_equal(run(4.5), textbook()(4.5))


def test_a_run_may_go_backward_and_comes_back_to_its_start():
    there = textbook(rtol=1e-12)
    back = pc.simulate(
        pc.Scene.textbook(), q0=there.q[-1], qd0=there.qd[-1], t_span=(5, 0), rtol=1e-12
    )
    assert np.all(np.diff(back.t) < 0)
    np.testing.assert_allclose(back.y[:, -1], there.y[:, 0], rtol=0, atol=1e-9)
    assert np.array_equal(back(5.0), there.y[:, -1])


def test_a_run_of_no_length_is_its_start(method):
    run = pc.simulate(pc.Scene.textbook(), q0=Q0, qd0=0.5, t_span=(2, 2), method=method)
    assert run.success
    assert np.array_equal(run.y[:, -1], [*Q0, 0.5, 0.5])
    assert np.array_equal(run(2.0), run.y[:, -1])


def test_a_fixed_step_is_kept_but_for_the_last():
    run = textbook(step=0.15)
    np.testing.assert_allclose(np.diff(run.t)[:-1], 0.15, rtol=1e-12)
    assert run.t[-1] == 5.0


@pytest.mark.parametrize("t_end", [5.0, -5.0])
def test_steps_are_no_longer_than_max_step(t_end, method):
    run = pc.simulate(
        pc.Scene.textbook(), q0=Q0, t_span=(0.0, t_end), max_step=0.003, method=method, rtol=1e-6
    )
    assert run.t[-1] == t_end
    assert np.abs(np.diff(run.t)).max() <= 0.003 * (1 + 1e-12)
    assert run.stats.limited_by_max_step > 1000
    assert (np.sign(np.diff(run.t)) == np.sign(t_end)).all()


@pytest.mark.parametrize("t_end", [5.0, -5.0])
def test_the_first_step_is_as_asked(t_end, method):
    run = pc.simulate(
        pc.Scene.textbook(), q0=Q0, t_span=(0.0, t_end), first_step=1e-4, method=method
    )
    assert run.t[1] == np.copysign(1e-4, t_end)


def test_a_capped_run_keeps_what_it_has():
    run = textbook(max_steps=10, on_failure="ignore")
    assert not run.success
    assert run.status == "max_steps"
    assert "max_steps" in run.message
    assert run.stats.accepted + run.stats.rejected == 10
    assert 0 < run.t[-1] < 5
    assert np.array_equal(run.t, textbook().t[: len(run.t)])


def test_a_run_ends_at_its_time_limit():
    began = time.monotonic()
    run = endless(time_limit=0.1)
    assert run.status == "time_limit"
    assert 0.1 <= time.monotonic() - began < 1.0


def test_ctrl_c_raises_keyboard_interrupt_with_the_run_so_far():
    timer = threading.Timer(0.3, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt) as stop:
        endless(time_limit=10)
    run = stop.value.solution
    assert run.status == "interrupted"
    assert run.t[-1] > 0


def test_an_exception_of_the_progress_function_passes_through_with_the_run_so_far():
    def break_off(fraction):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough") as stop:
        endless(progress=break_off, time_limit=10)
    run = stop.value.solution
    assert run.status == "callback_error"
    assert run.t[-1] > 0


def test_a_progress_function_gets_growing_fractions():
    fractions = []
    scene = pc.Scene.textbook()
    how = {"store": "end", "time_limit": 0.4, "on_failure": "ignore"}
    pc.simulate(scene, q0=Q0, t_span=(0, 1e9), **how, progress=fractions.append)
    assert len(fractions) >= 3
    assert fractions == sorted(fractions)
    assert 0 <= fractions[0] <= fractions[-1] <= 1


def test_progress_true_draws_a_bar_on_standard_error(capsys):
    endless(progress=True, time_limit=0.2)
    out, err = capsys.readouterr()
    assert out == ""
    assert "simulating" in err
    assert err.endswith("\n")


def test_a_bar_ends_its_line_when_the_run_is_broken_off(capsys):
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    with pytest.raises(KeyboardInterrupt):
        endless(progress=True, time_limit=10)
    assert capsys.readouterr().err.endswith("\n")


@pytest.mark.parametrize("progress", [None, False])
def test_nothing_is_drawn_where_there_is_no_terminal(progress, capsys):
    endless(progress=progress, time_limit=1.2)
    assert capsys.readouterr() == ("", "")


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


def test_the_interpreter_is_free_while_a_run_goes_on():
    run = threading.Thread(target=endless, kwargs={"time_limit": 0.5})
    run.start()
    turns = 0
    while run.is_alive():
        turns += 1
        time.sleep(0.001)
    assert turns > 50
