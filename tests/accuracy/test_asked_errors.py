"""simulate(error=...) keeps the error, verifies it, and tells what it took.

The errors are measured against another method's most accurate run; the work is counted, not timed.
docs/generators/asked_errors.py has the same with times.
"""

from __future__ import annotations

import json
import pickle
import sys
import time
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore._accuracy.position_error import times_within_steps
from pendcore._accuracy.trials import Trials
from pendcore.cli import main
from regular_scenes import regular

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
import asked_errors

E = pc.effects
BOOK = pc.Scene.textbook()
ROD = pc.Link(mass=1.0, length=1.0)
STUCK = pc.Scene(links=[ROD], effects=[E.DryJointFriction(1, coulomb=25.0, static=25.0)])
DRAGGED = BOOK.replace(effects=[E.RodDrag(link=1, drag_coefficient=1.2, diameter=0.02)])
SHORT, SHORTER = (
    pc.Scene(links=[pc.Link.point_mass(mass=m, length=x) for m, x in ((1, 1), last)])
    for last in ((3, 0.05), (2, 0.03))
)
START = ((0, 5), [np.pi / 4, np.pi / 3])
ENDS = pc.events.LinkAngle(1, 1.0, terminal=True)
KEPT_TIMES = [{}, {"store": "steps"}, {"store": "end"}, {"t_eval": [1.0, 2.0, 5.0]}]


@pytest.fixture(scope="module")
def outcomes():
    return [asked_errors.outcome(regular(seed)) for seed in asked_errors.SCENES]


@pytest.mark.unsanitized
def test_on_200_scenes_no_error_exceeds_the_asked_or_the_told_one(outcomes):
    assert len(outcomes) == 200
    firsts = {one["method"].partition("-")[0] for one in outcomes}
    assert firsts == {"dop853", "taylor"}
    assert max(one["error"] for one in outcomes) <= 1
    assert max(one["told"] for one in outcomes) <= 1
    shares = [one["error"] / one["told"] for one in outcomes]
    assert max(shares) <= 1
    assert np.median(shares) > 0.7


@pytest.mark.unsanitized
@pytest.mark.parametrize("seed", [1000, 1001])  # the error at times, and second runs
def test_every_row_of_the_page_has_a_number(seed, monkeypatch):
    monkeypatch.setattr(asked_errors, "ROUNDS", 1)
    one = regular(seed)
    found = asked_errors.outcome(one) | asked_errors.times(one)
    for _, key, _ in asked_errors.ROWS:
        assert np.isfinite(found[key])


@pytest.mark.unsanitized
def test_the_run_takes_hardly_more_work_than_the_best_of_a_sweep(outcomes):
    verified = np.array([one["verified"] for one in outcomes])
    assert np.mean(verified <= 3.5) >= 0.88
    assert np.mean(verified <= 6) >= 0.99
    assert np.median([one["run"] for one in outcomes]) < 1.2
    assert np.median([one["all"] for one in outcomes]) < 4


@pytest.mark.parametrize("options", KEPT_TIMES, ids=str)
@pytest.mark.parametrize("error", [1e-3, 1e-7, 1e-9])
def test_all_that_is_said_of_an_error_is_one_estimate_of_that_very_run(options, error):
    sol = pc.simulate(BOOK, *START, error=error, **options)
    assert sol.estimate_error().largest == sol.accuracy.achieved <= error
    assert sol.valid_until(error, of="position") == sol.accuracy.until == 5.0
    assert sol.accuracy.everywhere == (not options)
    assert sol.accuracy.times == len(sol.estimate_error().t)
    again = sol.case().simulate()
    assert again.accuracy is None
    assert np.array_equal(again.y, sol.y)
    assert (again.method, again.store) == (sol.method, sol.store)


def test_what_was_asked_reached_and_paid_is_told():
    found = pc.simulate(BOOK, *START, error=1e-6).accuracy
    assert (found.asked, found.reached) == (1e-6, True)
    assert found.times > 200
    last = {p.purpose: p for p in found.paid}
    assert found.work("run") == last["run"].work
    assert sum(found.work(x) for x in ("choose", "run", "verify")) == pytest.approx(found.work())
    assert last["verify"].method == f"defect of {last['run'].method}"
    assert last["verify"].rtol == last["run"].rtol
    assert found.verified_by == f"the {last['verify'].method} at rtol {last['verify'].rtol:g}"
    assert "asked 1.0e-06, achieved" in str(found)
    assert type(found).from_dict(found.to_dict()) == found


def test_it_is_kept_by_pickle_copy_and_archive_and_not_by_what_goes_on(tmp_path):
    sol = pc.simulate(BOOK, *START, error=1e-6)
    sol.save(tmp_path / "run.npz")
    for kept in (pickle.loads(pickle.dumps(sol)), pc.load(tmp_path / "run.npz")):
        assert kept.accuracy == sol.accuracy
        assert np.array_equal(kept.estimate_error().position, sol.estimate_error().position)
        assert str(kept.estimate_error()) == str(sol.estimate_error())
    assert sol.resume(6.0).accuracy is None


KEPT = {
    "deep recursion once": (BOOK, [1.84, 0.78], 100.0, 1e-4, {}),
    "deep recursion twice": (BOOK, [2.96, 2.39], 100.0, 1e-3, {}),
    "deep recursion thrice": (BOOK, [-3.0, 2.7], 60.0, 1e-3, {}),
    "a loose trial fails": (SHORTER, (0.3, 2.0), 30.0, 0.08, {}),
    "a loose trial fails for a heavier tip": (SHORT, (0.5, 2.5), 20.0, 0.12, {}),
    "a trial fails": (SHORTER, (0.3, 2.0), 30.0, 0.01, {}),
    "a short span": (BOOK, START[1], 0.02, 1e-10, {}),
    "one step": (BOOK, START[1], 0.02, 1e-10, {"first_step": 0.02}),
}


@pytest.mark.parametrize("name", KEPT)
def test_scenes_on_which_a_search_once_failed_are_kept(name):
    scene, q0, t_end, error, options = KEPT[name]
    sol = pc.simulate(scene, (0, t_end), q0, error=error, **options)
    assert sol.accuracy.outcome == "kept"
    assert 0 < sol.accuracy.achieved <= error
    assert sol.accuracy.until == sol.t[-1] == t_end


@pytest.mark.parametrize("options", [{}, {"store": "end"}, {"t_eval": [1.0, 2.0]}], ids=str)
def test_what_rests_from_the_start_takes_no_steps_and_has_no_error(options):
    sol = pc.simulate(STUCK, q0=0.3, t_span=(0, 3), error=1e-7, **options)
    assert sol.status == "at_rest"
    assert sol.accuracy.reached


@pytest.mark.parametrize("times", [None, [3.0, 4.0], [0.2, 4.0]], ids=str)
def test_a_terminal_event_ends_the_run_and_what_verifies_it(times):
    """Where it comes before the times, the ends are compared, and no more states are kept."""
    sol = pc.simulate(BOOK, *START, events=[ENDS], t_eval=times, error=1e-8)
    known = pc.simulate(BOOK, *START, events=[ENDS], method="dop853", rtol=1e-13, atol=1e-15)
    end = sol.events[0][0].t
    assert sol.status == "event"
    assert sol.accuracy.reached
    assert end == pytest.approx(known.t[-1], abs=1e-7)
    assert sol.accuracy.until <= end + 1e-6
    if times:
        assert list(sol.t) == [t for t in times if t < end]
        assert sol.accuracy.times == 1


def test_a_run_is_verified_to_the_event_that_ends_it():
    """The event may come later in a looser trial than in the one that has a second run."""

    def stop(t, q, qd):
        return [-208.01800826101422 * max(q[0] + 0.47352738352278734, 0.0)]

    rod = pc.Link(mass=1.723859270359083, length=1.9252206858708738)
    damper = E.ViscousJoint(1, 0.9215352565494289)
    scene = pc.Scene(links=[rod], effects=[E.User(stop), damper], gravity=9.807)
    end = pc.events.LinkAngle(1, 1.2904680194292113, terminal=True)
    for error in np.geomspace(1e-11, 1e-9, 9):
        sol = pc.simulate(
            scene, q0=1.5105808821167965, qd0=2.312735409753138, t_span=(-3.7, -2.7), error=error,
            store="steps", events=[end],
        )  # fmt: skip
        assert sol.estimate_error().t[-1] == sol.t[-1]


def test_steps_that_are_cut_often_enough_are_cut_no_further():
    """A second run of ten million steps would otherwise be compared at sixty million times."""
    coarse = pc.simulate(BOOK, *START, rtol=1e-6)
    fine = pc.simulate(BOOK, *START, method="dopri5", step=1e-5)
    steps = coarse.stats.accepted + fine.stats.accepted
    assert len(times_within_steps([coarse, fine])) <= steps + 1
    assert len(times_within_steps([fine, coarse])) >= 6 * fine.stats.accepted


def test_a_law_that_is_not_smooth_is_never_called_kept():
    """For noise every step is too long, however short, and no second run is like the first."""
    noise = np.random.default_rng(5)
    scene = BOOK.replace(effects=[E.User(lambda t, q, qd: 1e-6 * noise.normal(size=2))])
    is_refused = False
    try:
        how = {"error": 1e-9, "max_steps": 500, "on_failure": "ignore"}
        sol = pc.simulate(scene, q0=[0.7, 1.0], t_span=(0, 0.5), **how)
    except pc.AccuracyError as refusal:
        sol, is_refused = refusal.solution, True
    assert sol.accuracy.outcome in ("refused", "ended early")
    assert sol.success or not is_refused


# Runs that end early ---------------------------------------------------------------------------


def test_a_run_that_fails_is_returned_as_ever():
    scene = BOOK.replace(effects=[E.User(lambda t, q, qd: [np.nan, 0.0])])
    with pytest.warns(pc.PendcoreWarning, match=r"status non_finite: .*; its error: asked"):
        sol = pc.simulate(scene, *START, error=1e-3)
    assert sol.status == "non_finite"
    assert sol.accuracy.outcome == "ended early"
    assert sol.accuracy.until == 0.0


def test_a_run_that_the_cap_on_steps_ends_is_labelled():
    with pytest.raises(pc.RunError, match=r"status max_steps: .*; its error: asked") as end:
        pc.simulate(BOOK, *START, error=1e-6, max_steps=30, on_failure="raise")
    sol = end.value.solution
    assert sol.status == "max_steps"
    assert sol.accuracy.outcome == "ended early"
    assert 0 < sol.accuracy.achieved < 1e-4
    assert "as far as it is known (kept until t = " in str(sol.accuracy)


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")
def test_what_is_told_of_a_run_that_ended_early_is_one_estimate():
    scene = BOOK.replace(effects=[E.ViscousJoint(joint=1, damping=0, damping3=-1.0)])
    sol = pc.simulate(scene, q0=[0.7, 1.0], t_span=(0, 5), error=1e-6)
    assert sol.accuracy.outcome == "ended early"
    assert sol.accuracy.achieved == sol.estimate_error().largest
    assert sol.accuracy.until == sol.valid_until(1e-6, of="position")


def test_time_is_limited_for_all_runs_together():
    how = {"error": 1e-3, "time_limit": 0.2, "on_failure": "ignore"}
    sol = pc.simulate(BOOK, (0, 1e6), [-1.5, -1.4], **how)
    assert sol.status == "time_limit"
    assert not sol.accuracy.reached
    assert "not verified: the run ended early: time_limit" in str(sol.accuracy)


def test_when_the_time_is_up_a_whole_trial_is_returned_and_called_unverified(monkeypatch):
    monkeypatch.setattr(Trials, "_time_left", lambda runs: 1e-6 if runs.trials else None)
    with pytest.warns(pc.PendcoreWarning, match="finished, but not verified: the time limit"):
        sol = pc.simulate(BOOK, q0=[-1.5, -1.4], t_span=(0, 30), error=1e-3)
    assert sol.t[-1] == 30
    assert sol.accuracy.outcome == "ended early"


@pytest.mark.parametrize(
    ("at", "status", "told"),
    [(0.06, "interrupted", "the run"), (0.5, "finished", "while it was verified")],
)
def test_an_interrupt_hands_over_the_best_run_so_far_and_says_what_it_is(at, status, told):
    seen = []

    def report(fraction):
        seen.append(fraction)
        if fraction > at:
            raise KeyboardInterrupt

    def law(t, q, qd):
        time.sleep(2e-5)  # so that every run reports often, on any machine
        return 0 * q

    slow = pc.Scene(links=[ROD], effects=[E.User(law)])
    with pytest.raises(KeyboardInterrupt) as caught:
        pc.simulate(slow, q0=1.2, t_span=(0, 50), error=1e-6, progress=report)
    assert seen == sorted(seen)
    best = caught.value.solution
    assert best.status == status
    assert (best.t[-1] == 50) == best.success
    assert not best.accuracy.reached
    assert "not verified: interrupted" in str(best.accuracy)
    assert told in best.accuracy.verified_by
    as_json = json.loads(json.dumps(best.accuracy.to_dict()))
    assert type(best.accuracy).from_dict(as_json) == best.accuracy


@pytest.mark.parametrize(
    ("scene", "estimate"),
    [(BOOK, "defect_correction.error_over"), (DRAGGED, "trials.estimate")],
    ids=["defect", "second"],
)
def test_a_trial_is_handed_over_if_the_interrupt_falls_while_runs_are_compared(
    monkeypatch, scene, estimate
):
    def interrupted(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(f"pendcore._accuracy.{estimate}", interrupted)
    with pytest.raises(KeyboardInterrupt) as stop:
        pc.simulate(scene, q0=[0.7, 1.2], t_span=(0, 10), error=1e-6)
    assert stop.value.solution.success
    assert stop.value.solution.accuracy.outcome == "ended early"


def test_a_case_and_the_command_know_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = pc.Case.textbook().to_toml().replace('method = "ode45"', "error = 1e-5")
    assert pc.read_case(text).simulate().accuracy.asked == 1e-5
    Path("swing.toml").write_text(text)
    for given, asked in (([], "1.0e-05"), (["--error", "1e-7"], "1.0e-07")):
        assert main(["run", "swing.toml", *given]) == 0
        assert f"asked {asked}, achieved" in capsys.readouterr().out
        assert f"asked {asked}, achieved" in Path("out/swing/summary.txt").read_text()
    assert main(["run", "swing.toml", "--error", "7"]) == 2
