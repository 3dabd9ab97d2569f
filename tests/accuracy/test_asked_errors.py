"""simulate(error=...) keeps the error, verifies it, tells what it took, and refuses what it cannot.

The errors are measured against another method's most accurate run, or in multiple precision; the
work is counted, not timed. docs/generators/asked_errors.py has the same with times.
"""

from __future__ import annotations

import json
import math
import pickle
import re
import sys
import time
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main
from regular_scenes import regular

DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS / "generators"))
import asked_errors  # noqa: E402

BOOK = pc.Scene.textbook()
ROD = pc.Link(mass=1.0, length=1.0)
START = ((0, 5), [np.pi / 4, np.pi / 3])
CHAOTIC = ((0, 100), [-1.5, -1.4])


@pytest.fixture(scope="module")
def outcomes():
    return [asked_errors.outcome(regular(seed)) for seed in asked_errors.SCENES]


def share(outcomes, key, at_most):
    return np.mean([one[key] <= at_most for one in outcomes])


@pytest.mark.unsanitized
def test_on_200_scenes_no_error_exceeds_the_asked_one(outcomes):
    assert len(outcomes) == 200
    firsts = {one["method"].partition("-")[0] for one in outcomes}
    assert firsts == {"dop853", "taylor"}
    assert max(one["error"] for one in outcomes) <= 1
    assert max(one["told"] for one in outcomes) <= 1


@pytest.mark.unsanitized
def test_what_is_told_is_the_error_and_never_less(outcomes):
    shares = [one["error"] / one["told"] for one in outcomes]
    assert max(shares) <= 1
    assert np.median(shares) > 0.7


@pytest.mark.unsanitized
def test_the_run_takes_hardly_more_work_than_the_best_of_a_sweep(outcomes):
    assert share(outcomes, "verified", 3.5) >= 0.88
    assert share(outcomes, "verified", 6) >= 0.99
    assert np.median([one["run"] for one in outcomes]) < 1.2
    assert np.median([one["all"] for one in outcomes]) < 4


@pytest.fixture(scope="module")
def record():
    return json.loads((DOCS / "records/asked_errors.json").read_text())


def test_the_record_keeps_the_goals(record):
    for _, key, goal in asked_errors.ROWS:
        assert goal is None or share(record, key, goal[0]) >= goal[1]


def test_the_pages_table_is_that_of_the_record(record):
    assert len(record) == len(asked_errors.SCENES)
    assert asked_errors.table(record) in (DOCS / "background/accuracy_cost.md").read_text()


@pytest.mark.parametrize("name", ["textbook", "unequal", "fast_spin", "three_links", "single_rod"])
@pytest.mark.parametrize("error", [1e-3, 1e-6, 1e-9])
def test_the_error_is_kept_against_multiple_precision(reference_case, name, error):
    known = reference_case(name)
    links = [pc.Link(mass=m, length=x) for m, x in zip(known.masses, known.lengths, strict=True)]
    scene = pc.Scene(links=links, gravity=known.gravity)
    span = (known.t[0], known.t[-1])
    sol = pc.simulate(scene, q0=known.q0, qd0=known.qd0, t_span=span, t_eval=known.t, error=error)
    tips = [known.lengths * np.exp(1j * q) for q in (sol.q, known.q)]
    apart = abs(np.cumsum(tips[0] - tips[1], axis=1)).max() / known.lengths.sum()
    assert apart <= sol.accuracy.achieved <= error


@pytest.mark.parametrize(
    "options", [{}, {"store": "steps"}, {"store": "end"}, {"t_eval": [1.0, 2.0, 5.0]}], ids=str
)
def test_the_run_is_the_one_that_was_chosen_to_the_last_bit(options):
    sol = pc.simulate(BOOK, *START, error=1e-7, **options)
    again = sol.case().simulate()
    assert again.accuracy is None
    assert np.array_equal(again.y, sol.y)
    assert (again.method, again.store) == (sol.method, sol.store)


def test_what_was_asked_reached_and_paid_is_told():
    found = pc.simulate(BOOK, *START, error=1e-6).accuracy
    assert found.asked == 1e-6
    assert found.reached
    assert found.until == 5.0
    assert found.everywhere
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


E = pc.effects
HARD = {
    "stiff": [E.ViscousJoint(joint=2, damping=1e7)],
    "rubbed": [E.DryJointFriction(joint=j, coulomb=c) for j, c in ((1, 2.0), (2, 1.0))],
    "stopped": [E.JointStop(joint=2, range=(-0.5, 0.5), restitution=0.5)],
}


@pytest.mark.parametrize("kind", HARD)
@pytest.mark.parametrize("error", [1e-3, 1e-8])
def test_stiff_and_piecewise_scenes_keep_it_too(kind, error):
    scene = BOOK.replace(effects=HARD[kind])
    start = ((0, 3), [0.7, 1.0])
    times = np.linspace(0, 3, 101)
    sol = pc.simulate(scene, *start, t_eval=times, error=error)
    method = "radau5" if kind == "stiff" else "dop853"
    known = pc.simulate(scene, *start, t_eval=times, method=method, rtol=1e-13, atol=1e-16)
    apart = abs(np.cumsum(np.exp(1j * sol.q) - np.exp(1j * known.q), axis=1)).max() / 2
    assert apart <= error
    assert (sol.stats.stiff or sol.method == "radau5") == (kind == "stiff")


def test_a_terminal_event_ends_the_run_and_what_verifies_it():
    ends = pc.events.LinkAngle(1, 1.0, terminal=True)
    sol = pc.simulate(BOOK, *START, events=[ends], error=1e-8)
    assert sol.status == "event"
    known = pc.simulate(BOOK, *START, events=[ends], method="dop853", rtol=1e-13, atol=1e-15)
    assert sol.t[-1] == pytest.approx(known.t[-1], abs=1e-7)
    assert sol.accuracy.until <= sol.t[-1] + 1e-6


def test_beyond_rounding_it_is_refused_with_what_was_reached():
    with pytest.raises(
        pc.AccuracyError, match=r"error = 1e-16: not reached: .* rounding"
    ) as caught:
        pc.simulate(BOOK, *START, error=1e-16)
    found = caught.value.solution.accuracy
    assert not found.reached
    assert 1e-16 < found.achieved < 1e-13
    assert caught.value.solution.success
    kept = pickle.loads(pickle.dumps(caught.value))
    assert kept.solution.accuracy == found


def test_a_chaotic_span_is_refused_and_told_until_when_it_holds():
    says = r"part too fast .* the error is kept until t = [\d.]+ s: end t_span well before that$"
    with pytest.raises(pc.AccuracyError, match=says) as caught:
        pc.simulate(BOOK, *CHAOTIC, error=1e-3)
    until = caught.value.solution.accuracy.until
    assert 10 < until < 40
    assert pc.simulate(BOOK, (0, 0.6 * until), CHAOTIC[1], error=1e-3).accuracy.reached


def test_the_page_says_until_when_it_holds(capsys):
    page = (DOCS / "background/accuracy_cost.md").read_text()
    (code,) = [x for x in re.findall(r"```python\n(.*?)```", page, re.DOTALL) if "refusal" in x]
    (told,) = re.findall(r"print\(refusal\)  # \.\.\. (.*)", code)
    exec(code, {})
    refusal, until = capsys.readouterr().out.splitlines()
    assert refusal.endswith(told)
    (held,) = re.findall(r"until t = ([\d.]+) s: end t_span well before that", told)
    assert float(until) - 1e-5 < float(held) <= float(until)


def test_the_rounding_of_a_late_start_is_told():
    """Near t = 1e6 s a time in doubles is off by up to 6e-11 s, which no tolerance mends."""
    with pytest.raises(pc.AccuracyError, match="to 1e-10 s; begin nearer to 0") as caught:
        pc.simulate(BOOK, q0=START[1], t_span=(1e6, 1e6 + 5), error=1e-10)
    assert 1e-10 < caught.value.least < 1e-9


def test_it_is_refused_as_well_when_no_round_is_left(monkeypatch):
    monkeypatch.setattr("pendcore._accuracy.target_error.MOST_RUNS", 2)
    with pytest.raises(pc.AccuracyError, match="the search ended after 2 runs") as caught:
        pc.simulate(BOOK, (0, 10), CHAOTIC[1], error=1e-3)
    assert not caught.value.solution.accuracy.reached


def test_a_law_that_is_not_smooth_is_never_called_kept():
    """For noise every step is too long, however short, and no second run is like the first."""
    noise = np.random.default_rng(5)
    scene = BOOK.replace(effects=[E.User(lambda t, q, qd: 1e-6 * noise.normal(size=2))])
    is_refused = False
    try:
        how = {"error": 1e-9, "max_steps": 2000, "on_failure": "ignore"}
        sol = pc.simulate(scene, q0=[0.7, 1.0], t_span=(0, 0.5), **how)
    except pc.AccuracyError as refusal:
        sol, is_refused = refusal.solution, True
    assert sol.accuracy.outcome in ("refused", "ended early")
    assert sol.success or not is_refused


def test_a_run_that_fails_is_returned_as_ever():
    scene = pc.Scene.textbook().replace(effects=[E.User(lambda t, q, qd: [np.nan, 0.0])])
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
    assert "rtol" not in sol.message


@pytest.mark.parametrize("max_step", [0.1, 0.02, 0.01])
def test_steps_that_are_not_set_by_the_tolerance_are_verified_by_other_steps(max_step):
    """A tighter run of the same method would take the same steps and report no error."""
    start = ((0, 5), [-0.6, -0.4])
    times = np.linspace(0, 5, 101)
    sol = pc.simulate(BOOK, *start, t_eval=times, error=1e-6, max_step=max_step)
    truth = pc.simulate(BOOK, *start, t_eval=times, method="dop853", rtol=1e-13, atol=1e-15)
    apart = np.linalg.norm(sol.positions() - truth.positions(), axis=-1).max() / 2
    assert sol.accuracy.reached
    assert apart <= sol.accuracy.achieved <= 1e-6


def test_a_stiff_run_in_steps_of_max_step_is_verified_by_shorter_ones():
    """No other method gets through, so the method verifies itself."""
    stiff = pc.Scene(links=[ROD, ROD], effects=[E.ViscousJoint(2, damping=1e5)])
    start, times = ((0, 2), [0.7, 1.0]), np.linspace(0, 2, 41)
    sol = pc.simulate(stiff, *start, t_eval=times, error=1e-6, max_step=0.05)
    truth = pc.simulate(stiff, *start, t_eval=times, method="radau5", rtol=1e-13, atol=1e-15)
    apart = np.linalg.norm(sol.positions() - truth.positions(), axis=-1).max() / 2
    assert sol.stats.stiff
    assert sol.stats.limited_by_max_step > 10
    assert apart <= sol.accuracy.achieved


def test_a_short_span_is_verified_by_other_steps():
    sol = pc.simulate(BOOK, (0, 0.02), START[1], error=1e-10)
    assert sol.accuracy.achieved > 0


@pytest.mark.parametrize("options", [{}, {"store": "end"}, {"t_eval": [1.0, 2.0]}], ids=str)
def test_what_rests_from_the_start_takes_no_steps_and_has_no_error(options):
    stuck = pc.Scene(links=[ROD], effects=[E.DryJointFriction(1, coulomb=25.0, static=25.0)])
    sol = pc.simulate(stuck, q0=0.3, t_span=(0, 3), error=1e-7, **options)
    assert sol.status == "at_rest"
    assert sol.accuracy.reached


@pytest.mark.parametrize(("static", "rate"), [(15.0, 1.0), (30.0, 2.0)])
def test_a_run_that_rests_after_two_steps_is_verified(static, rate):
    friction = E.DryJointFriction(1, coulomb=10.0, static=static, stribeck_velocity=1.0)
    scene = pc.Scene(links=[ROD], gravity=0.0, effects=[friction])
    sol = pc.simulate(scene, q0=0.3, qd0=rate, t_span=(0, 10), error=1e-5, store="end")
    fine = {"method": "dop853", "rtol": 1e-13, "atol": 1e-15, "max_step": 1e-3}
    truth = pc.simulate(scene, q0=0.3, qd0=rate, t_span=(0, 10), store="end", **fine)
    apart = 2 * abs(math.sin((sol.q - truth.q).item() / 2))
    assert sol.accuracy.reached
    assert apart <= sol.accuracy.achieved <= 1e-5


def test_a_first_step_of_the_whole_span_is_made_shorter_by_tighter_tolerances():
    sol = pc.simulate(BOOK, (0, 0.02), START[1], error=1e-10, first_step=0.02)
    assert sol.accuracy.reached


@pytest.mark.parametrize("times", [[3.0, 4.0], [0.2, 4.0]], ids=str)
def test_a_terminal_event_may_come_before_the_times(times):
    """Then the ends of the runs are compared; no more states are kept than without `error`."""
    ends = pc.events.LinkAngle(1, 1.0, terminal=True)
    sol = pc.simulate(BOOK, *START, events=[ends], t_eval=times, error=1e-8)
    assert sol.status == "event"
    assert list(sol.t) == [t for t in times if t < sol.events[0][0].t]
    assert sol.accuracy.reached
    assert sol.accuracy.times == 1
    known = pc.simulate(BOOK, *START, events=[ends], method="dop853", rtol=1e-13, atol=1e-15)
    assert sol.events[0][0].t == pytest.approx(known.t[-1], abs=1e-7)


def test_time_is_limited_for_all_runs_together():
    sol = pc.simulate(
        BOOK, q0=[-1.5, -1.4], t_span=(0, 1e6), error=1e-3, time_limit=0.2, on_failure="ignore"
    )
    assert sol.status == "time_limit"
    assert not sol.accuracy.reached
    assert "not verified: the run ended early: time_limit" in str(sol.accuracy)


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
    assert type(best.accuracy).from_dict(json.loads(json.dumps(best.accuracy.to_dict()))) == (
        best.accuracy
    )


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        ({"error": 0}, "error = 0: must be > 0 and < 1"),
        ({"error": 1.5}, "error = 1.5: must be"),
        ({"error": float("nan")}, "error = nan: must be"),
        ({"error": "small"}, "error = 'small': must be a real number"),
        ({"error": 1e-6, "rtol": 1e-3}, "rtol = 0.001: is chosen for the error"),
        ({"error": 1e-6, "atol": [1e-3] * 4}, "atol = .*: is chosen for the error"),
        ({"error": 1e-6, "step": 0.01}, "step = 0.01: is chosen"),
        ({"error": 1e-6, "method": "radau5"}, "method = 'radau5': is chosen"),
        ({"error": 1e-6, "time_limit": -1}, r"time_limit = -1.0: must be > 0 \(s\)"),
        ({"error": 1e-6, "time_limit": float("nan")}, "time_limit = nan: must be > 0"),
        ({"error": 1e-6, "time_limit": "long"}, "time_limit = 'long': must be a real number"),
        ({"error": 1e-6, "time_limit": True}, "time_limit = True: must be a real number"),
        ({"error": 1e-6, "t_span": (0, np.inf)}, r"t_span\[1\] = inf: must be finite \(s\)"),
        ({"error": 1e-6, "t_span": ("a", 1)}, "t_span.*: must "),
    ],
)
def test_what_cannot_be_asked_is_named(options, complaint):
    with pytest.raises((ValueError, TypeError), match=complaint):
        pc.simulate(BOOK, q0=START[1], **({"t_span": START[0]} | options))


def test_a_case_and_the_command_know_it(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    text = pc.Case.textbook().to_toml().replace('method = "ode45"', "error = 1e-5")
    assert pc.read_case(text).simulate().accuracy.asked == 1e-5
    Path("swing.toml").write_text(text)
    assert main(["run", "swing.toml"]) == 0
    assert "asked 1.0e-05, achieved" in capsys.readouterr().out
    assert main(["run", "swing.toml", "--error", "1e-7"]) == 0
    assert "asked 1.0e-07, achieved" in Path("out/swing/summary.txt").read_text()
    assert main(["run", "swing.toml", "--error", "1e-17"]) == 1
    refusal = capsys.readouterr().err.splitlines()[-1]
    assert re.fullmatch("error = 1e-17: not reached: .* ask for error = .* or more", refusal)
    summary = " ".join(Path("out/swing/summary.txt").read_text().split())
    assert f"refused {refusal} end t = 5 s" in summary
    assert json.loads(Path("out/swing/summary.json").read_text())["refusal"] == refusal
    Path("chaotic.toml").write_text(
        pc.Case(scene=BOOK, q0=CHAOTIC[1], t_span=(0, 100), options={"error": 1e-3}).to_toml()
    )
    assert main(["run", "chaotic.toml"]) == 1
    summary = " ".join(Path("out/chaotic/summary.txt").read_text().split())
    assert re.search(
        r"refused error = 0.001: not reached: .* the error is kept until t = [\d.]+ s: end", summary
    )
    assert main(["run", "swing.toml", "--error", "7"]) == 2
