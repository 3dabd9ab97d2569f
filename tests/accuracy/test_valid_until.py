"""A run is never trusted for longer than it is right; references in many digits show this."""

from __future__ import annotations

import pickle
from fractions import Fraction
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from chaotic_starts import EACH, GRAVITY, T_END, ChaoticStart, chaotic_starts, times
from pendcore._accuracy import estimate
from reference.taylor_series import RodChain, motion
from reference.trajectories import trajectory

E = pc.effects
BOOK = pc.Scene.textbook()
LIMIT = 0.1
METHODS = [m["name"] for m in pc._core.methods() if m["name"] in ("dopri5", "dop853", "taylor")]


def solved(case: ChaoticStart, **options: Any) -> pc.Solution:
    if "rtol" in options:
        options["atol"] = 1e-3 * options["rtol"]
    return pc.simulate(case.scene, (0, T_END), case.q0, case.qd0, **options)


def trusted_and_right(limit: float, each: int, **options: Any) -> Any:
    """Return until when runs from every so many starts are trusted and are right, s."""
    cases = chaotic_starts()[::each]
    runs = [solved(case, **options) for case in cases]
    valid = np.array([run.valid_until(limit) for run in runs])
    right = np.array([case.last_right(run, limit) for case, run in zip(cases, runs, strict=True)])
    assert (valid < right + 1 / EACH).all()  # the next known state is already wrong
    return valid, right


def test_by_default_fifty_chaotic_runs_are_never_trusted_too_long() -> None:
    valid, right = trusted_and_right(LIMIT, 1)
    assert len(valid) == 50
    assert (right < T_END).all()  # every run is wrong in the end
    assert np.median(valid / right) >= 0.7
    assert (valid / right).min() >= 0.5


@pytest.mark.few_cases
@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-8, 1e-11, 1e-13, 1e-15])
def test_at_any_tolerance_runs_are_never_trusted_too_long(method: str, rtol: float) -> None:
    each = 1 if rtol > 1e-7 else 5 if rtol > 1e-14 else 10
    valid, right = trusted_and_right(LIMIT, each, method=method, rtol=rtol)
    assert np.median(valid / right) >= 0.7


@pytest.mark.parametrize("limit", [1e-6, 1e-3, 1.0])
def test_to_any_limit_runs_are_never_trusted_too_long(limit: float) -> None:
    trusted_and_right(limit, 5, method="dopri5", rtol=1e-9)


@pytest.mark.parametrize("case", chaotic_starts()[1:16:7], ids=lambda case: str(case.q0))
def test_the_record_is_what_its_script_makes(case: ChaoticStart) -> None:
    """The first three seconds come out alike with other digits, hence other orders and steps."""
    chain = RodChain(case.masses, case.lengths, GRAVITY)
    grid = [Fraction(k, EACH) for k in range(0, 3 * EACH + 1, EACH)]
    made = motion(chain, case.q0, case.qd0, grid, digits=30)
    n = len(case.q0)
    exact = np.array([[float(x) for x in row[:n]] for row in made])
    assert np.array(case.q)[: 3 * EACH + 1 : EACH] == pytest.approx(exact, abs=1e-9)


@pytest.mark.parametrize("name", ["textbook", "damped_textbook", "three_links", "fast_spin"])
def test_the_series_agree_with_the_trajectories_of_another_program(name: str) -> None:
    known = trajectory(name)
    chain = RodChain(
        known.masses.tolist(), known.lengths.tolist(), known.gravity, known.damping.tolist()
    )
    few = known.t[:27:13]
    made = motion(chain, known.q0.tolist(), known.qd0.tolist(), few.tolist(), digits=24)
    n = len(known.q0)
    states = np.array([[float(x) for x in row] for row in made])
    assert states[:, :n] == pytest.approx(known.q[:27:13], rel=4e-16)
    assert states[:, n:] == pytest.approx(known.qd[:27:13], rel=4e-16)


def test_the_error_over_time_is_what_the_reference_says() -> None:
    known = trajectory("textbook")
    run = pc.simulate(BOOK, (0, 5), known.q0, known.qd0, rtol=1e-6, atol=1e-9)
    found = run.estimate_error()
    true = np.abs(run(known.t)[:2].T - known.q).max(axis=1)
    near = np.interp(known.t, found.t, found.angle)
    # The estimate is a little above the truth: it includes the times in between and the second
    # runs' own errors.
    assert (true[1:] <= near[1:]).all()
    assert near[1:] == pytest.approx(1.2 * true[1:], rel=0.1, abs=2e-9)
    assert (found.t[0], found.t[-1]) == (0.0, 5.0)
    assert found.is_complete
    assert not found.is_lost
    assert run.valid_until(0.1) == 5.0
    assert 0 < found.position.max() < found.angle.max()


def test_position_limits_are_shares_of_the_length() -> None:
    case = chaotic_starts()[1]
    run = solved(case, method="dopri5", rtol=1e-7)
    found = run.estimate_error()
    assert found.verified_by == "taylor at rtol 1e-09 and tighter"
    at = run.valid_until(0.05, of="position")
    k = int(np.searchsorted(found.t, at))
    assert found.position[: k + 1].max() <= 0.05
    assert found.position[k + 1] > 0.05
    assert found.position.max() <= 2.0 + 1e-6  # no two points are farther apart


def test_past_the_horizon_nothing_is_estimated() -> None:
    case = chaotic_starts()[0]
    found = solved(case, method="dopri5", rtol=1e-4).estimate_error()
    assert found.is_lost
    assert found.is_complete
    assert found.t[-1] < T_END
    assert found.angle[-1] >= estimate.LOST > found.angle[:-1].max()
    assert found.valid_until(1e9) == found.t[-2]
    assert str(found).endswith("; past that nothing of it is known any more")


def test_both_second_runs_together_are_never_fooled_by_one() -> None:
    """Errors may cancel: a second run that makes the first one's very error estimates none."""
    case = chaotic_starts()[1]
    run = solved(case, method="dopri5", rtol=1e-13)
    t, q = times(), np.array(case.q)
    true = np.maximum.accumulate(np.abs(run(t)[: q.shape[1]].T - q).max(axis=1))
    found = run.estimate_error()
    estimated = np.interp(t, found.t, np.maximum.accumulate(found.angle))
    known = (true > 1e-8) & (true < LIMIT)
    assert known.any()
    assert (true <= estimated)[known].all()


def test_what_is_kept_decides_at_what_times() -> None:
    def kept(t_end: float = 20, **options: Any) -> pc.Solution:
        return pc.simulate(BOOK, (0, t_end), [-2.0, -1.0], rtol=1e-6, **options)

    dense = kept()
    exact = dense.valid_until(LIMIT)
    assert 1 < exact < 20
    times = np.arange(0, 20.5, 0.5)
    few = kept(t_eval=times)
    compared = few.estimate_error().t
    assert compared.tolist() == times[: len(compared)].tolist()
    assert exact - 0.5 <= few.valid_until(LIMIT) <= exact + 0.02
    assert kept(store="steps").valid_until(LIMIT) == pytest.approx(exact, abs=dense.stats.max_step)
    assert kept(store="end").estimate_error().t.tolist() == [20.0]
    assert kept(1, store="end").valid_until(LIMIT) == 1.0


JUMPS = {
    "stop": [E.JointStop(joint=2, range=(-1.0, 1.0), restitution=0.5)],
    "friction": [E.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 0.3), (2, 0.2))],
    "lock": [E.Lock(joint=2)],
    "user": [E.User(lambda t, q, qd: [-0.1 * qd[0], -0.1 * qd[1]])],
    "stiff": [E.Motor(joint=2, pd=E.PD(kp=3e5, kd=3e3, reference=0.5))],
}


@pytest.mark.parametrize("kind", JUMPS)
def test_scenes_with_jumps_have_an_estimate_too(kind: str) -> None:
    run = pc.simulate(BOOK.replace(effects=JUMPS[kind]), (0, 2), [0.5, 0.5], rtol=1e-7)
    found = run.estimate_error()
    assert found.is_complete
    assert not found.is_lost
    assert 0 < found.angle.max() < 1e-3
    assert run.valid_until(LIMIT) == 2.0


def test_runs_backward_and_of_no_length() -> None:
    case = chaotic_starts()[3]
    back = pc.simulate(case.scene, (0, -T_END), case.q0, case.qd0, rtol=1e-6)
    assert -T_END < back.valid_until(LIMIT) < -1
    assert (np.diff(back.estimate_error().t) < 0).all()
    assert pc.simulate(case.scene, (2, 2), case.q0, case.qd0).valid_until(LIMIT) == 2.0


@pytest.mark.parametrize("kept", [{"store": "end"}, {"t_eval": [90.0, 95.0, 100.0]}])
def test_a_run_that_is_wrong_at_the_first_time_it_kept_is_trusted_to_its_start(kept):
    chaotic = (BOOK, (3, 103), [-1.0, -1.5])
    assert pc.simulate(*chaotic, **kept).valid_until(LIMIT) == 3.0
    with pytest.raises(pc.AccuracyError) as refusal:
        pc.simulate(*chaotic, error=1e-3, **kept)
    assert refusal.value.solution.accuracy.until == 3.0


def test_a_run_that_kept_no_time_says_so():
    few = {"t_eval": [10.0, 20.0], "max_steps": 8, "on_failure": "ignore"}
    run = pc.simulate(BOOK, (0, 20), [1.5, 1.6], **few)
    with pytest.raises(ValueError, match="error: the run ended before the first of its t_eval"):
        run.valid_until(LIMIT)


def test_second_runs_may_take_more_steps_than_the_first_was_allowed():
    how = {"method": "dop853", "rtol": 1e-2, "atol": 1e-5, "store": "end"}
    steps = pc.simulate(BOOK, (0, 200), [1.5, 1.6], **how).stats
    capped = how | {"max_steps": steps.accepted + steps.rejected}
    run = pc.simulate(BOOK, (0, 200), [1.5, 1.6], **capped)
    assert run.success
    assert run.estimate_error().is_complete


def test_the_second_runs_are_made_once(monkeypatch: pytest.MonkeyPatch) -> None:
    run = pc.simulate(BOOK, q0=[1.0, 1.0], t_span=(0, 2))
    first = run.estimate_error()
    monkeypatch.setattr("pendcore._accuracy.estimate.error_estimate", None)
    assert run.estimate_error() is first
    assert run.valid_until(0.1) == 2.0
    monkeypatch.undo()
    copied = pickle.loads(pickle.dumps(run))  # the copy is made without the estimate
    assert copied.estimate_error().angle.tolist() == first.angle.tolist()


def test_an_estimate_that_takes_too_long_ends_where_it_is_and_is_completed_later() -> None:
    """Legs shorter than the least time of a leg once went on to the end, whatever the limit."""
    run = pc.simulate(BOOK, q0=[1.0, 1.0], t_span=(0, 600), max_step=0.05)
    for limit, reached in ((1e-9, 600 / 16), (0.01, 600)):
        some = run.estimate_error(time_limit=limit)
        assert not some.is_complete
        assert 0 < some.t[-1] < reached
        assert some.valid_until(LIMIT) <= some.t[-1]
        assert str(some).endswith("; the run goes on past that: it is not known there yet")
    assert run.estimate_error().is_complete


def test_an_estimate_that_is_interrupted_hands_over_what_it_has() -> None:
    def stop(fraction: float) -> None:
        if fraction > 0.6:  # by then the other second run is under way
            raise KeyboardInterrupt

    run = pc.simulate(BOOK, q0=[1.0, 1.0], t_span=(0, 2000), rtol=1e-9)
    with pytest.raises(KeyboardInterrupt) as raised:
        run.estimate_error(progress=stop)
    assert not raised.value.estimate.is_complete  # type: ignore[attr-defined]
