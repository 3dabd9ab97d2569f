"""Mistakes that newcomers made, and the messages that they get now."""

from __future__ import annotations

import json
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore._accuracy.estimate import error_estimate
from pendcore.cli import main
from pendcore.derive.report import conversion

ROD = "[[link]]\nmass = 1.0\nlength = 1.0\n"
RUN = pc.simulate(pc.Scene.textbook(), q0=1.0, t_span=(0, 0.01))
CHAOS = f"{ROD}{ROD}[start]\nq_deg = [-85, -80]\n[run]\nt_end = 40.0\n"


def test_what_is_printed_of_a_result_fits_on_a_screen() -> None:
    sol = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 20))
    for result in (sol.defect(), sol.lyapunov(), sol.estimate_error()):
        assert len(repr(result)) < 600
        assert repr(result) == str(result)


def test_found_events_are_a_list_that_has_arrays() -> None:
    event = pc.events.RateZero(link=1)
    sol = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 5), events=[event])
    found = sol.events[0]
    assert len(found) > 2
    assert found.t.tolist() == [one.t for one in found]
    assert found.q.shape == found.qd.shape == (len(found), 2)
    assert np.array_equal(found.y, [one.y for one in found])
    assert found.direction.tolist() == [one.direction for one in found]
    assert np.array_equal(found[1:].q, found.q[1:])
    assert found[::-1][0] is found[-1]
    assert np.array_equal(pickle.loads(pickle.dumps(found))[:1].y, found.y[:1])
    short = pc.simulate(pc.Scene.textbook(), q0=[0.8, 1.0], t_span=(0, 1e-3), events=[event])
    none = short.events[0]
    assert none.q.shape == (0, 2)


def test_a_chaotic_run_says_until_when_it_is_right(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "chaos.toml"
    case.write_text(CHAOS)
    assert main(["run", str(case), "-o", str(tmp_path / "a"), "--json"]) == 0
    until = json.loads(capsys.readouterr().out)["valid_until"]
    sol = pc.load(tmp_path / "a/solution.npz")
    assert until == sol.valid_until(0.1) < 40.0
    assert f"until t = {until:.6g} s, and lost" in (tmp_path / "a/summary.txt").read_text()
    assert main(["run", str(case), "-o", str(tmp_path / "b"), "--no-horizon"]) == 0
    assert "right to" not in (tmp_path / "b/summary.txt").read_text()
    drawn, plain = ((tmp_path / name / "angles.png").read_bytes() for name in "ab")
    assert drawn != plain


EVEN = "t_eval = {start = 0.0, stop = 30.0, count = 301}\n"


@pytest.mark.parametrize(
    ("run", "until", "sentence"),
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
def test_every_summary_says_until_when_or_why_not(
    run: str, until: float | None, sentence: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "chaos.toml"
    case.write_text(CHAOS.replace("t_end = 40.0\n", run))
    main(["run", str(case), "-o", str(tmp_path / "out"), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert found["horizon"].startswith(sentence)
    assert until is None or found["valid_until"] == pytest.approx(until, rel=1e-12)
    assert found["horizon"] in " ".join((tmp_path / "out/summary.txt").read_text().split())


@pytest.mark.parametrize("compared", [5.0, 20.0])
def test_second_runs_that_nobody_asked_for_are_stopped(
    compared: float,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    limits = []

    def stopped(*args: Any, time_limit: float | None = None, **named: Any) -> Any:
        limits.append(time_limit)
        whole = error_estimate(*args, **named)
        so_far = {name: getattr(whole, name)[whole.t < compared] for name in ("angle", "position")}
        t = whole.t[whole.t < compared]
        return replace(whole, t=t, **so_far, is_lost=False, is_complete=False)

    monkeypatch.setattr("pendcore._accuracy.estimate.error_estimate", stopped)
    case = tmp_path / "chaos.toml"
    case.write_text(CHAOS)
    main(["run", str(case), "-o", str(tmp_path), "--json"])
    found = json.loads(capsys.readouterr().out)
    assert limits == [10.0], "the figure estimates it no second time, without end"
    if compared == 20.0:
        assert found["horizon"].startswith("until t = 19.2923 s, and lost")
    else:
        assert found["valid_until"] is None
        assert found["horizon"].startswith("at least until t = 4.9")
        assert "`pendcore trust` tells how much longer" in found["horizon"]


def test_a_run_of_many_steps_gets_no_second_runs_unasked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("pendcore.cli.horizon.MOST_WORK", 10)
    assert main(["run", "-o", str(tmp_path)]) == 0
    told = " ".join(capsys.readouterr().out.split())
    assert "not known: second runs take a while; `pendcore trust` tells" in told


def test_trust_tells_horizon_exponent_and_defect(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "chaos.toml"
    case.write_text(CHAOS)
    sol = pc.read_case(case).simulate()
    sol.save(tmp_path / "run.npz")
    for what in (case, tmp_path / "run.npz"):
        assert main(["trust", str(what), "--limit", "0.01", "--json"]) == 0
        told = json.loads(capsys.readouterr().out)
        assert told["valid_until"] == sol.valid_until(0.01)
        assert told["lyapunov_exponent"] == pytest.approx(sol.lyapunov().largest)
        assert told["defect"] == sol.defect().largest
    assert main(["trust", str(case)]) == 0
    assert "right to 0.1 rad until t = " in capsys.readouterr().out


def test_trust_tells_of_the_best_run_where_an_error_was_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "chaos.toml"
    case.write_text(f"{CHAOS}error = 1e-6\n")
    assert main(["trust", str(case)]) == 0
    told = capsys.readouterr()
    assert "not reached" in told.err
    assert "and lost after that" in told.out
    assert main(["show", str(case), "-o", str(tmp_path / "chaos.png")]) == 0
    assert "not reached" in capsys.readouterr().err
    assert (tmp_path / "chaos.png").exists()


def test_trust_names_its_options_and_says_once_what_it_has_not(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for command, option in (("trust", "--limit"), ("trust", "--time-limit"), ("cost", "--repeats")):
        assert main([command, option, "0"]) == 2
        assert f"pendcore {command}: {option} = 0" in capsys.readouterr().err
    case = tmp_path / "chaos.toml"
    case.write_text(f'{CHAOS}store = "end"\n')
    assert main(["trust", str(case)]) == 0
    told = capsys.readouterr().out
    assert "right to 0.1 rad not known: wrong at its end" in told
    assert "at 1 time from" in told
    assert "no defect: this solution keeps no dense output" in told


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
def test_a_full_disk_names_what_is_printed() -> None:
    with Path("/dev/full").open("w") as full:
        made = subprocess.run(
            [sys.executable, "-m", "pendcore", "explain"],
            stdout=full, stderr=subprocess.PIPE, text=True, check=False,
        )  # fmt: skip
    assert made.returncode == 1
    assert made.stderr == "pendcore explain: standard output: No space left on device\n"


def test_an_error_of_the_command_line_is_not_blamed_on_the_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    case = tmp_path / "chaos.toml"
    case.write_text(CHAOS)
    assert main(["run", str(case), "--error", "0", "-o", str(tmp_path / "out")]) == 2
    told = capsys.readouterr().err
    assert "--error = 0" in told
    assert "line" not in told


def test_explain_takes_the_textbooks_case(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["explain"]) == 0
    assert "2 links" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("links", "remedy"),
    [
        ("[link]\nmass = 1.0\nlength = 1.0\n", r"write \[\[link\]\]"),
        ("[link]\nmass = 1.0\n[link]\nmass = 1.0\n", r"\[\[link\]\], in two brackets"),
    ],
)
def test_single_brackets_hint_at_double_ones(links: str, remedy: str) -> None:
    with pytest.raises(ValueError, match=remedy):
        pc.read_case(f"{links}[start]\nq = [0.0]\n[run]\nt_end = 1.0\n")


def test_even_times_need_not_be_listed() -> None:
    begin = f"{ROD}[start]\nq = [0.5]\n[run]\nt_end = 2.0\n"
    case = pc.read_case(f"{begin}t_eval = {{start = 0.0, stop = 2.0, count = 5}}\n")
    assert [*case.options["t_eval"]] == [0.0, 0.5, 1.0, 1.5, 2.0]
    assert pc.read_case(case.to_toml()) == case
    with pytest.raises(ValueError, match=r"count = 1: must be a whole number from 2"):
        pc.read_case(f"{begin}t_eval = {{start = 0.0, stop = 2.0, count = 1}}\n")
    with pytest.raises(ValueError, match="a table with start, stop"):
        pc.read_case(f"{begin}t_eval = {{begin = 0.0, stop = 2.0}}\n")


def test_degrees_are_told_without_noise() -> None:
    with pytest.warns(pc.PendcoreWarning, match=r"that is 2578 degrees"):
        pc.simulate(pc.Scene.textbook(), q0=[45.0, 60.0], t_span=(0, 0.01))


def test_without_pandoc_the_report_says_why_there_is_no_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(conversion, "has_pandoc", lambda: False)
    main(["derive", "--to", "report", "-o", str(tmp_path)])
    assert "these need pandoc" in capsys.readouterr().err


@pytest.mark.parametrize("n", [1, 2, 5])
def test_one_state_has_the_accelerations_of_a_row_of_many(n: int) -> None:
    link = pc.Link(mass=1.0, length=0.5)
    rub = [pc.effects.DryJointFriction(joint=1, coulomb=0.1), pc.effects.ViscousJoint(n, 0.2)]
    scene = pc.Scene(links=[link] * n, effects=rub)
    q, qd = np.linspace(0.3, 1.0, n), np.linspace(-1.0, 2.0, n)
    alone = scene.accelerations(0.5, q, qd)
    assert alone.shape == (n,)
    assert np.array_equal(alone, scene.accelerations([0.5], [q], [qd])[0])
    with pytest.raises(ValueError, match=r"qd\[0\] = nan: must be finite"):
        scene.accelerations(0.5, q, np.full(n, np.nan))


@pytest.mark.parametrize("n", [1, 2, 5])
def test_one_state_of_plain_numbers_makes_no_arrays_of_rows(
    n: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)] * n)
    q, qd = np.linspace(0.3, 1.0, n), np.linspace(-1.0, 2.0, n)
    row = scene.accelerations([2.0], [q], [qd])
    assert row.shape == scene.accelerations([2.0], q, qd).shape == (1, n)
    backward = np.stack([q, qd])[:, ::-1][:, ::-1]  # neither is contiguous to look at
    assert np.array_equal(scene.accelerations(2.0, *backward), row[0])
    with pytest.raises(ValueError, match="must be finite"):
        scene.accelerations(float("inf"), q, qd)
    with pytest.raises(ValueError, match="is too large"):
        scene.accelerations(0.0, [10**400] * n, qd)
    with pytest.raises(TypeError, match="holds truth values"):
        scene.accelerations(0.0, [True] * n, qd)
    with pytest.raises(ValueError, match=r"q: shape \(\): must be"):
        scene.accelerations(0.0, 0.5, 0.0)

    def no_conversion(*_: object) -> None:
        raise AssertionError("one state went through the checks of many")

    monkeypatch.setattr("pendcore._scene.scene.finite_array", no_conversion)
    for t in (2.0, 2, np.float64(2.0)):
        for of in (np.array, list, tuple):
            one = scene.accelerations(t, of(q), of(qd))
            assert one.shape == (n,)
            assert np.array_equal(one, row[0])
