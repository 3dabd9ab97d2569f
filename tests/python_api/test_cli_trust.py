"""`pendcore run` and `pendcore trust` say until when a run is right, or why that is not known."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pendcore as pc
import pytest
from pendcore._accuracy.estimate import error_estimate

ROD = "[[link]]\nmass = 1.0\nlength = 1.0\n"
CHAOS = f"{ROD}{ROD}[start]\nq_deg = [-85, -80]\n[run]\n"
LONG = f"{CHAOS}t_end = 40.0\n"
EVEN = "t_eval = {start = 0.0, stop = 30.0, count = 301}\n"


def until(found):
    """Return what the JSON of a run says, after a look that the summary says it as well."""
    told = " ".join(Path("a/summary.txt").read_text().split())
    assert f"right to 0.1 rad {found['horizon']}" in told
    return found["valid_until"], found["horizon"]


@pytest.mark.parametrize(
    ("run", "t", "sentence"),
    [
        (f"t_end = 40.0\n{EVEN}", 19.3, "until t = 19.3 s, and lost after that"),
        ('t_end = 40.0\nstore = "steps"\n', None, "until t = 1"),
        ("t_end = 40.0\nt_eval = [1.0, 2.0]\n", 2.0, "until t = 2 s, the last time that was kept"),
        ("t_end = 2.0\n", 2.0, "until its end"),
        ('t_end = 2.0\nstore = "end"\n', 2.0, "until its end"),
        ('t_end = 40.0\nstore = "end"\n', None, "not known: wrong at its end, and no other time"),
        ("t_end = 2.0\nt_eval = [2.0]\nmax_steps = 3\n", None, "not known: error: the run ended"),
    ],
)
def test_every_summary_says_until_when_or_why_not(run, t, sentence, pendcore):
    Path("case.toml").write_text(f"{CHAOS}{run}")
    valid_until, horizon = until(json.loads(pendcore("run case.toml -o a --json").out))
    assert horizon.startswith(sentence)
    assert t is None or valid_until == pytest.approx(t, rel=1e-12)


def test_a_chaotic_run_is_drawn_pale_where_it_is_lost_unless_nobody_asks(pendcore):
    Path("case.toml").write_text(LONG)
    valid_until, _ = until(json.loads(pendcore("run case.toml -o a --json").out))
    assert valid_until == pc.load("a/solution.npz").valid_until(0.1) < 40.0
    pendcore("run case.toml -o b --no-horizon")
    assert "right to" not in Path("b/summary.txt").read_text()
    assert Path("a/angles.png").read_bytes() != Path("b/angles.png").read_bytes()


@pytest.mark.parametrize("compared", [5.0, 20.0])
def test_second_runs_that_nobody_asked_for_are_stopped(compared, monkeypatch, pendcore):
    limits = []

    def stopped(*args, time_limit=None, **named):
        limits.append(time_limit)
        whole = error_estimate(*args, **named)
        so_far = {x: getattr(whole, x)[whole.t < compared] for x in ("t", "angle", "position")}
        return replace(whole, **so_far, is_lost=False, is_complete=False)

    monkeypatch.setattr("pendcore._accuracy.estimate.error_estimate", stopped)
    Path("case.toml").write_text(LONG)
    valid_until, horizon = until(json.loads(pendcore("run case.toml -o a --json").out))
    assert limits == [10.0], "the figure estimates it no second time, without end"
    if compared == 20.0:
        assert horizon.startswith("until t = 19.2923 s, and lost")
    else:
        assert valid_until is None
        assert horizon.startswith("at least until t = 4.9")
        assert "`pendcore trust` tells how much longer" in horizon


def test_without_second_runs_a_run_says_why(monkeypatch, pendcore):
    def fails(*_, **__):
        raise MemoryError("no memory")

    monkeypatch.setattr(pc.Solution, "estimate_error", fails)
    assert "not known: no memory" in pendcore("run").out
    monkeypatch.setattr("pendcore.cli.horizon.MOST_WORK", 10)
    told = " ".join(pendcore("run").out.split())
    assert "not known: second runs take a while; `pendcore trust` tells" in told
    assert pc.load("out/textbook/solution.npz").success


def test_trust_tells_horizon_exponent_and_defect(pendcore):
    Path("case.toml").write_text(LONG)
    sol = pc.read_case("case.toml").simulate()
    sol.save("run.npz")
    for what in ("case.toml", "run.npz"):
        told = json.loads(pendcore(f"trust {what} --limit 0.01 --json").out)
        assert told["valid_until"] == sol.valid_until(0.01)
        assert told["lyapunov_exponent"] == pytest.approx(sol.lyapunov().largest)
        assert told["defect"] == sol.defect().largest
    assert "right to 0.1 rad until t = " in pendcore("trust case.toml").out


def test_trust_tells_of_the_best_run_where_an_error_was_refused(pendcore):
    Path("case.toml").write_text(f"{LONG}error = 1e-6\n")
    status, out, err = pendcore("trust case.toml")
    assert (status, "not reached" in err, "and lost after that" in out) == (0, True, True)
    assert "not reached" in pendcore("show case.toml -o chaos.png").err
    assert Path("chaos.png").exists()


def test_trust_says_what_it_has_not(pendcore):
    Path("case.toml").write_text(f'{LONG}store = "end"\n')
    status, out, _ = pendcore("trust case.toml")
    assert status == 0
    for words in (
        "right to 0.1 rad not known: wrong at its end",
        "at 1 time from",
        "no defect: this solution keeps no dense output",
    ):
        assert words in out
