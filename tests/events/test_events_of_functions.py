"""Python functions may be events: what they see, what they may return, how they fail."""

from __future__ import annotations

import pickle
import re
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import events as ev

BOOK = pc.Scene.textbook()


def run(*events: ev.Event, t_end: float = 3.0, **options: Any) -> pc.Solution:
    return pc.simulate(BOOK, q0=[0.8, 1.0], qd0=0, t_span=(0, t_end), events=events, **options)


def height(t: float, q: Any, qd: Any) -> float:
    return float(np.sin(q).sum() - 1.7)


def test_a_function_finds_what_the_kinds_of_the_core_find() -> None:
    kinds = [ev.LinkAngle(2, 1.5), ev.RateZero(joint=2), ev.TipLine((0, 1.7), (0, 1))]
    own = [
        ev.Function(lambda t, q, qd: q[1] - 1.5),
        ev.Function(lambda t, q, qd: qd[1] - qd[0]),
        ev.Function(height),
    ]
    sol = run(*kinds, *own)
    for k, f in zip(sol.events[:3], sol.events[3:], strict=True):
        assert [one.t for one in k] == pytest.approx([one.t for one in f], abs=1e-14)
        assert [one.direction for one in k] == [one.direction for one in f]
    assert sum(map(len, sol.events)) > 12


def test_a_function_sees_states_of_the_run_in_arrays_of_its_own() -> None:
    seen: list[tuple[float, Any, Any]] = []

    def look(t: float, q: Any, qd: Any) -> float:
        seen.append((t, q.copy(), qd.copy()))
        q[:] = qd[:] = np.nan  # the run keeps arrays of its own
        return 1.0

    sol = run(ev.Function(look, samples=4))
    assert np.array_equal(sol.y, run().y)
    for t, q, qd in seen:
        assert np.concatenate([q, qd]) == pytest.approx(sol(t), abs=1e-13)
    steps = len(sol.t) - 1
    moves = 5  # at the start, each argument is moved by its rounding
    assert len(seen) == 4 * steps + 1 + moves  # each end of a step is sampled once


@pytest.mark.parametrize("max_step", [0.001, 0.1])
def test_samples_lie_as_close_as_asked_and_change_no_step(max_step: float) -> None:
    times: list[float] = []
    watch = ev.Function(lambda t, q, qd: times.append(t) or 1.0, samples=1, max_step=max_step)
    sol = run(watch, rtol=1e-3)
    assert sol.stats == run(rtol=1e-3).stats
    assert max(np.diff(np.sort(times))) <= max_step * (1 + 1e-9)
    assert len(times) < 3 / max_step + len(sol.t) + 1


def test_more_samples_see_what_comes_and_goes_between_fewer() -> None:
    def narrow(t: float, q: Any, qd: Any) -> float:
        return (t - 0.5) ** 2 - 0.01**2

    still = pc.Scene(links=[pc.Link(mass=1, length=1)], gravity=0)
    found = [
        pc.simulate(
            still, q0=0, qd0=0, t_span=(0, 1), step=1.0, events=[ev.Function(narrow, **how)]
        ).events[0]
        for how in ({"samples": 3}, {"samples": 101}, {"max_step": 0.01}, {"samples": 2})
    ]
    assert [len(each) for each in found] == [0, 2, 2, 2]
    for each in found[1:]:
        assert [one.t for one in each] == pytest.approx([0.49, 0.51], abs=1e-15)


class Broken(Exception):
    pass


@pytest.mark.parametrize("at", [-1.0, 1.0])
def test_an_exception_ends_the_run_and_passes_through(at: float) -> None:
    def f(t: float, q: Any, qd: Any) -> float:
        if t > at:
            raise Broken("no more")
        return t - 0.5

    with pytest.raises(Broken, match="no more") as caught:
        run(ev.LinkAngle(1, 1.0), ev.Function(f))
    sol = caught.value.solution  # type: ignore[attr-defined]
    assert sol.status == "callback_error"
    assert not sol.success
    assert sol.t[-1] <= max(at, 0.0)
    assert [round(one.t, 12) for one in sol.events[1]] == ([0.5] if at > 0 else [])
    accepted = len(sol.t) - 1
    assert sol.stats.accepted == accepted
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
    ],
)
def test_what_is_no_number_is_told(value: Any, error: type[Exception], message: str) -> None:
    def f(t: float, q: Any, qd: Any) -> Any:
        return value if t > 1 else 1.0

    with pytest.raises(error, match=re.escape(message)) as caught:
        run(ev.Function(f, name="mine"))
    sol = caught.value.solution  # type: ignore[attr-defined]
    assert sol.status == "callback_error"
    assert 0 < sol.t[-1] <= 1


@pytest.mark.parametrize("value", [1, True, np.float32(1), np.int64(3), np.array(2.0), np.inf])
def test_any_kind_of_number_is_accepted(value: Any) -> None:
    if value is True:
        with pytest.raises(TypeError, match="must be a real number"):
            run(ev.Function(lambda t, q, qd: value))
    else:
        (found,) = run(ev.Function(lambda t, q, qd: value if t < 1 else -value)).events
        assert [one.t for one in found] == pytest.approx([1.0], abs=1e-15)


def test_ctrl_c_in_a_function_is_ctrl_c() -> None:
    def f(t: float, q: Any, qd: Any) -> float:
        if t > 1:
            raise KeyboardInterrupt
        return 1.0

    with pytest.raises(KeyboardInterrupt) as caught:
        run(ev.Function(f))
    assert caught.value.solution.status == "interrupted"  # type: ignore[attr-defined]


def test_a_function_goes_on_when_the_run_does() -> None:
    whole = run(ev.Function(height))
    sol = run(ev.Function(height, terminal=True))
    while sol.status == "event":
        sol = sol.resume(3.0)
    assert [one.t for one in sol.events[0]] == [one.t for one in whole.events[0]]
    assert sol.case().simulate().events[0][0].t == whole.events[0][0].t


def test_a_function_lives_in_one_process(tmp_path: Path) -> None:
    sol = run(ev.Function(height))
    for attempt in (lambda: pickle.dumps(sol), lambda: pickle.dumps(ev.Function(height))):
        with pytest.raises(TypeError, match=r"function.*cannot be pickled"):
            attempt()
    with pytest.raises(TypeError, match=r"Function\(f=<.*cannot be saved: .*sol.to_pandas"):
        sol.save(tmp_path / "run.npz")
    assert not (tmp_path / "run.npz").exists()
    with pytest.raises(TypeError, match="cannot be written as TOML"):
        sol.case().to_toml()
    assert "case" not in sol.to_pandas().attrs
