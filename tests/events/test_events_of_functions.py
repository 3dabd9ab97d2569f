"""Python functions may be events: what they see, what they may return, how they fail."""

from __future__ import annotations

import pickle
import re

import numpy as np
import pendcore as pc
import pytest
from pendcore import events as ev
from turning_rod import times

BOOK = pc.Scene.textbook()


def run(*events, **options):
    return pc.simulate(BOOK, (0, 3.0), [0.8, 1.0], events=events, **options)


def height(t, q, qd):
    return float(np.sin(q).sum() - 1.7)


def test_a_function_sees_states_of_the_run_in_arrays_of_its_own():
    seen = []

    def look(t, q, qd):
        seen.append((t, q.copy(), qd.copy()))
        q[:] = qd[:] = np.nan  # the run keeps arrays of its own
        return 1.0

    sol = run(ev.Function(look, samples=4))
    assert np.array_equal(sol.y, run().y)
    for t, q, qd in seen:
        assert np.concatenate([q, qd]) == pytest.approx(sol(t), abs=1e-13)
    moves = 5  # at the start, each argument is moved by its rounding
    assert len(seen) == 4 * (len(sol.t) - 1) + 1 + moves  # each end of a step is sampled once


@pytest.mark.parametrize("max_step", [0.001, 0.1])
def test_samples_lie_as_close_as_asked_and_change_no_step(max_step):
    seen = []
    watch = ev.Function(lambda t, q, qd: seen.append(t) or 1.0, samples=1, max_step=max_step)
    sol = run(watch, rtol=1e-3)
    assert sol.stats == run(rtol=1e-3).stats
    assert max(np.diff(np.sort(seen))) <= max_step * (1 + 1e-9)
    assert len(seen) < 3 / max_step + len(sol.t) + 1


@pytest.mark.parametrize(
    ("how", "roots"),
    [
        ({"samples": 3}, []),
        ({"samples": 101}, [0.49, 0.51]),
        ({"max_step": 0.01}, [0.49, 0.51]),
        ({"samples": 2}, [0.49, 0.51]),
    ],
)
def test_more_samples_see_what_comes_and_goes_between_fewer(how, roots):
    narrow = ev.Function(lambda t, q, qd: (t - 0.5) ** 2 - 0.01**2, **how)
    still = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=0)
    found = pc.simulate(still, (0, 1), 0, step=1.0, events=[narrow]).events[0]
    assert times(found) == pytest.approx(roots, abs=1e-15)


class Broken(Exception):
    pass


@pytest.mark.parametrize("at", [-1.0, 1.0])
def test_an_exception_ends_the_run_and_passes_through(at):
    def f(t, q, qd):
        if t > at:
            raise Broken("no more")
        return t - 0.5

    with pytest.raises(Broken, match="no more") as caught:
        run(ev.LinkAngle(1, 1.0), ev.Function(f))
    sol = caught.value.solution
    assert sol.status == "callback_error"
    assert not sol.success
    assert sol.t[-1] <= max(at, 0.0)
    assert times(sol.events[1]) == pytest.approx([0.5] if at > 0 else [], abs=1e-12)
    assert sol.stats.accepted == len(sol.t) - 1
    at = 5.0
    longer, whole = sol.resume(3.0), run()
    assert np.array_equal(longer.t, whole.t)
    assert np.array_equal(longer.y, whole.y)
    assert longer.stats == whole.stats
    assert len(longer.events[1]) == 1


@pytest.mark.parametrize(
    ("value", "error", "message"),
    [
        (np.nan, ValueError, "event 1 (function, 'mine'): is NaN at t = "),
        ("up", TypeError, "f(t, q, qd) = 'up': must be a real number"),
        (None, TypeError, "f(t, q, qd) = None: must be a real number"),
        (np.array([1.0]), TypeError, "must be a real number"),
        (1j, TypeError, "must be a real number"),
        (True, TypeError, "must be a real number"),
        (KeyboardInterrupt, KeyboardInterrupt, None),
    ],
)
def test_what_is_no_number_ends_the_run(value, error, message):
    def f(t, q, qd):
        if t > 1 and value is KeyboardInterrupt:
            raise value
        return value if t > 1 else 1.0

    with pytest.raises(error, match=message and re.escape(message)) as caught:
        run(ev.Function(f, name="mine"))
    sol = caught.value.solution
    ended = "interrupted" if value is KeyboardInterrupt else "callback_error"
    assert sol.status == ended
    assert 0 < sol.t[-1] <= 1


@pytest.mark.parametrize("value", [1, np.float32(1), np.int64(3), np.array(2.0), np.inf])
def test_any_kind_of_number_is_accepted(value):
    (found,) = run(ev.Function(lambda t, q, qd: value if t < 1 else -value)).events
    assert times(found) == pytest.approx([1.0], abs=1e-15)


def test_a_function_goes_on_when_the_run_does():
    whole = run(ev.Function(height))
    sol = run(ev.Function(height, terminal=True))
    while sol.status == "event":
        sol = sol.resume(3.0)
    assert times(sol.events[0]) == times(whole.events[0])
    assert sol.case().simulate().events[0][0].t == whole.events[0][0].t


def test_a_function_lives_in_one_process(tmp_path):
    sol = run(ev.Function(height))
    for kept in (sol, ev.Function(height)):
        with pytest.raises(TypeError, match=r"function.*cannot be pickled"):
            pickle.dumps(kept)
    with pytest.raises(TypeError, match=r"Function\(f=<.*cannot be saved: .*sol.to_pandas"):
        sol.save(tmp_path / "run.npz")
    assert not (tmp_path / "run.npz").exists()
    with pytest.raises(TypeError, match="cannot be written as TOML"):
        sol.case().to_toml()
    assert "case" not in sol.to_pandas().attrs
