"""The command does what --help says, tells mistakes in a line, and ends with the right status."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
import threading
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main

PNG = b"\x89PNG"
CASE = pc.Case.textbook().to_toml()


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def written(folder):
    return sorted(path.name for path in Path(folder).iterdir())


FILES = ["angles.png", "solution.npz", "summary.json", "summary.txt"]


def test_run_without_a_case_runs_the_textbooks(capsys):
    assert main(["run"]) == 0
    out, err = capsys.readouterr()
    assert written("out/textbook") == FILES
    assert out == Path("out/textbook/summary.txt").read_text()
    assert err == "written to out/textbook\n"
    solution = pc.load("out/textbook/solution.npz")
    assert np.array_equal(solution.y, pc.Case.textbook().simulate().y)
    assert Path("out/textbook/angles.png").read_bytes().startswith(PNG)


def test_run_writes_where_it_is_told_to():
    Path("swing.toml").write_text(CASE)
    assert main(["run", "swing.toml"]) == 0
    assert main(["run", "swing.toml", "-o", "a/b"]) == 0
    assert written("out/swing") == written("a/b") == FILES


def test_the_summary_tells_what_was_simulated_and_what_came_of_it(capsys):
    assert main(["run"]) == 0
    text = capsys.readouterr().out
    for fact in (
        "double pendulum, section 2.1",
        r"1 +1 +1 +0\.5 +0\.0833333",
        r"gravity +9\.807 m/s\^2",
        r"mobility +M = 3 n - 2 c5 - c4 = 3\*2 - 2\*2 - 0 = 2",
        r"start +t = 0 s, q = \(0\.785398, 1\.0472\) rad = \(45, 60\) deg, qd =",
        r"method +dopri5, rtol 1e-09, atol 1e-12",
        r"not simulated +viscous joint, dry joint friction, ",
        r"status +finished",
        r"end +t = 5 s, q = \(1\.08307, 0\.53846",
        r"steps +\d+ accepted, \d+ rejected",
        r"energy drift +\d\.\de-\d\d J, \d\.\de-\d\d of the largest kinetic energy",
        r"largest reaction +joint 1: 31\.9307 N at t = 0\.643519 s",
    ):
        assert re.search(fact, text), fact
    assert "kept time" not in text
    assert "too large to trust" not in text


def test_json_has_the_same_facts(capsys):
    assert main(["run", "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed == json.loads(Path("out/textbook/summary.json").read_text())
    solution = pc.Case.textbook().simulate()
    assert printed["status"] == "finished"
    assert printed["success"] is True
    assert printed["links"][1]["inertia"] == 1 / 12
    assert printed["mobility"]["degrees_of_freedom"] == 2
    assert printed["start"] == {"t": 0.0, "q": [np.pi / 4, np.pi / 3], "qd": [0.0, 0.0]}
    assert printed["run"] == {"t_end": 5.0, "method": "dopri5", "rtol": 1e-9, "atol": 1e-12}
    assert printed["end"]["q"] == solution.q[-1].tolist()
    assert printed["statistics"] == solution.stats._asdict()
    total = solution.energy().total
    assert printed["energy"]["largest_drift"] == np.abs(total - total[0]).max()
    assert printed["largest_reactions"][0]["force"] == pytest.approx(31.9307278, rel=1e-8)
    assert printed["version"] == pc.__version__


def test_a_failed_run_writes_what_it_has_and_ends_with_1(capsys):
    Path("short.toml").write_text(CASE + "max_steps = 5\n")
    assert main(["run", "short.toml", "--json"]) == 1
    out, err = capsys.readouterr()
    assert written("out/short") == FILES
    assert json.loads(out)["status"] == "max_steps"
    assert "the run is not complete: " in err
    assert "to go on, in Python: pc.load('out/short/solution.npz').resume(5.0)" in err
    assert 0 < pc.load("out/short/solution.npz").t[-1] < 5


def test_ctrl_c_writes_what_there_is_and_ends_with_1(capsys):
    endless = CASE.replace("t_end = 5.0", 't_end = 1e9\nstore = "end"\ntime_limit = 10.0')
    Path("long.toml").write_text(endless)
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    assert main(["run", "long.toml"]) == 1
    out, err = capsys.readouterr()
    assert written("out/long") == FILES
    assert "interrupted" in err
    assert "interrupted: interrupted" not in out + err
    (again,) = re.findall(r"to go on, in Python: (.*)\.resume\(1000000000\.0\)", err)
    assert eval(again, {"pc": pc}).status == "interrupted"


def test_ctrl_c_outside_the_run_is_told_in_a_line(monkeypatch, capsys):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("pendcore._api.simulate.simulate", stop)
    assert main(["run"]) == 1
    assert capsys.readouterr() == ("", "pendcore run: interrupted\n")
    assert written(".") == []


@pytest.mark.parametrize(
    ("asked", "among"),
    [
        ('store = "steps"', "among the 508 kept times\n"),
        ('store = "end"', "among the 1 kept time\n"),
        ("t_eval = [1.0, 2.0]", "among the 2 kept times\n"),
        ('t_eval = [1.0, 2.0]\nstore = "dense"', None),
    ],
)
def test_whatever_is_kept_start_end_and_drift_are_the_runs(asked, among, capsys):
    Path("swing.toml").write_text(f"{CASE}{asked}\n")
    assert main(["run", "swing.toml"]) == 0
    found = json.loads(Path("out/swing/summary.json").read_text())
    whole = pc.Case.textbook().simulate()
    assert found["end"] == {"t": 5.0, "q": [*whole.q[-1]], "qd": [*whole.qd[-1]]}
    total = whole.energy().total
    assert (found["energy"]["start"], found["energy"]["end"]) == (total[0], total[-1])
    assert 0 < found["energy"]["largest_drift"] < 1e-7
    said = capsys.readouterr().out
    assert (among or "joint 2") in said
    assert ("kept time" in said) == (among is not None)


def test_a_run_that_ended_before_the_first_time_asked_for_is_summed_up(capsys):
    Path("short.toml").write_text(f"{CASE}t_eval = [4.0]\nmax_steps = 5\n")
    assert main(["run", "short.toml"]) == 1
    out = capsys.readouterr().out
    assert re.search(r"largest reaction +among the 0 kept times", out)
    assert re.search(r"\n  end +t = 0\.\d+ s, q = \(0\.7", out)


def test_a_fixed_step_takes_the_place_of_the_tolerances(capsys):
    Path("fixed.toml").write_text(CASE + "step = 0.01\nrtol = 1e-6\n")
    assert main(["run", "fixed.toml"]) == 0
    out = capsys.readouterr().out
    assert "  method            dopri5, step 0.01\n" in out
    assert "tol" not in json.loads(Path("out/fixed/summary.json").read_text())["run"]


def test_a_drift_that_is_too_large_is_called_out(capsys):
    Path("coarse.toml").write_text(CASE + "rtol = 0.1\natol = 0.1\n")
    assert main(["run", "coarse.toml"]) == 0
    assert "too large to trust this run: tighten rtol and atol" in capsys.readouterr().out
    assert json.loads(Path("out/coarse/summary.json").read_text())["energy"]["too_large"] is True


def test_earlier_files_are_replaced_and_it_says_so(capsys):
    said = []
    for argv in 2 * [["run"]] + 2 * [["plot", "out/textbook/solution.npz", "-o", "a.png"]]:
        assert main(argv) == 0
        said.append(capsys.readouterr().err)
    assert ["replaced" in err for err in said] == [False, True, False, True]


def test_a_refused_case_leaves_no_folder_behind():
    Path("bad.toml").write_text(CASE + "rtol = -1.0\n")
    Path("there").mkdir()
    for out in ("a/b/c", "there/d", "there"):
        assert main(["run", "bad.toml", "-o", out]) == 2
    assert written(".") == ["bad.toml", "there"]
    assert written("there") == []


def test_an_implausible_scene_is_run_with_a_warning(capsys):
    Path("odd.toml").write_text(CASE.replace("length = 1.0\n", "length = 1.0\ninertia = 9.0\n", 1))
    assert main(["run", "odd.toml"]) == 0
    assert "pendcore: warning: link 1: inertia = 9" in capsys.readouterr().err


MISTAKES = {
    "no such file": (["run", "nothing.toml"], "nothing.toml: No such file or directory"),
    "a folder": (["run", "."], "Is a directory"),
    "unknown key": (["run", "key.toml"], "key.toml, line 2: unknown key 'gravty'"),
    "bad tolerance": (["run", "rtol.toml"], "rtol.toml, line 20: rtol = -1"),
    "unknown method": (["run", "method.toml"], 'method.toml, line 19: method = "euler"'),
    "times not sorted": (["run", "t_eval.toml"], "t_eval.toml, line 21: t_eval[1] = 1.0: must"),
    "too few angles": (["run", "links.toml"], "links.toml, line 16: q: shape (2,): must be (3,)"),
    "a file for a folder": (["run", "-o", "key.toml"], "key.toml: File exists"),
    "unknown command": (["jump"], "invalid choice: 'jump'"),
    "no command": ([], "COMMAND"),
    "unknown option": (["run", "--fast"], "--fast"),
    "no solution": (["plot", "a.npz"], "a.npz: is not a solution that pendcore saved"),
    "a case": (["plot", "key.toml"], "key.toml: is a case, not a solution: `pendcore run`"),
    "no such solution": (["plot", "x.npz"], "x.npz: No such file or directory"),
    "unknown kind of figure": (["plot", "run.npz", "-o", "a.doc"], "doc"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_wrong_usage_is_told_in_a_line_and_ends_with_2(mistake, capsys):
    Path("key.toml").write_text(CASE.replace("gravity", "gravty"))
    Path("a.npz").write_text("no archive")
    Path("rtol.toml").write_text(CASE + "rtol = -1.0\n")
    Path("method.toml").write_text(CASE.replace("ode45", "euler"))
    Path("t_eval.toml").write_text(CASE + "\nt_eval = [2.0, 1.0]\n")
    three = CASE.replace("[start]", "[[link]]\nmass = 1\nlength = 1\n[start]")
    Path("links.toml").write_text(three)
    pc.simulate(pc.Scene.textbook(), q0=1, t_span=(0, 1)).save("run.npz")
    argv, message = MISTAKES[mistake]
    assert main(argv) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert message in err
    assert "Traceback" not in err


@pytest.mark.parametrize("suffix", ["png", "pdf", "svg"])
def test_plot_draws_a_saved_solution(suffix, capsys):
    pc.Case.textbook().simulate().save("run.npz")
    assert main(["plot", "run.npz", "-o", f"figure.{suffix}", "--json"]) == 0
    out, err = capsys.readouterr()
    assert json.loads(out) == {"figure": f"figure.{suffix}", "status": "finished"}
    assert err == f"written to figure.{suffix}\n"
    assert Path(f"figure.{suffix}").stat().st_size > 1000


def test_plot_draws_what_matplotlib_would_where_no_suffix_tells(capsys):
    pc.Case.textbook().simulate().save("run.npz")
    assert main(["plot", "run.npz", "-o", "figure"]) == 0
    assert capsys.readouterr().err == "written to figure.png\n"
    assert Path("figure.png").read_bytes().startswith(PNG)


def test_plot_puts_the_figure_beside_the_solution():
    pc.Case.textbook().simulate().save("run.npz")
    assert main(["plot", "run.npz"]) == 0
    assert Path("run.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize(
    ("argv", "said"),
    [
        (["--help"], "pendcore run swing.toml"),
        (["run", "--help"], "[[link]]"),
        (["plot", "--help"], "pendcore plot out/textbook/solution.npz"),
        (["--version"], f"pendcore {pc.__version__} ({pc._core.instruction_set()}, "),
        (["--version"], pc._core.compiler),
    ],
)
def test_help_and_version_are_printed(argv, said, capsys):
    assert main(argv) == 0
    assert said in capsys.readouterr().out


def test_a_wrong_instruction_set_does_not_hide_behind_the_version(monkeypatch, capsys):
    monkeypatch.setattr("pendcore.build.instruction_set", lambda: int("x86-64-v9"))
    assert main(["--version"]) == 2
    assert "x86-64-v9" in capsys.readouterr().err


def test_a_csv_file_has_every_digit_of_the_states(capsys):
    assert main(["run", "--csv", "--no-horizon"]) == 0
    assert written("out/textbook") == sorted([*FILES, "states.csv"])
    head, *rows = Path("out/textbook/states.csv").read_text(encoding="utf-8").splitlines()
    assert head == "t (s),q_1 (rad),q_2 (rad),qd_1 (rad/s),qd_2 (rad/s)"
    sol = pc.load("out/textbook/solution.npz")
    numbers = np.array([[float(x) for x in row.split(",")] for row in rows])
    assert np.array_equal(numbers, np.column_stack([sol.t, sol.y.T]))


def test_the_case_in_the_help_is_one(capsys):
    main(["run", "--help"])
    lines = capsys.readouterr().out.partition("a case:\n")[2]
    assert pc.read_case(lines).simulate().success


@pytest.mark.outside_build
def test_it_runs_as_a_module_of_python():
    command = [sys.executable, "-m", "pendcore", "run", "--json", "-o", "here"]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    assert json.loads(done.stdout)["success"]
    assert done.stderr == "written to here\n"


@pytest.mark.outside_build
@pytest.mark.parametrize("argv", [["run"], ["run", "--json"]], ids=" ".join)
def test_nobody_reading_is_no_failure_of_the_run(argv):
    command = [sys.executable, "-m", "pendcore", *argv]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.close()
    err = process.stderr.read()
    process.stderr.close()
    assert process.wait() == 141
    assert err == "written to out/textbook\n"
    assert written("out/textbook") == FILES


def test_parameters_replace_numbers_of_the_case(tmp_path, capsys):
    given = ["--parameters", "gravity=1.62", "link[2].mass=0.5"]
    given += ["--parameters", "q0[1]=0.1", "qd0[2]=2"]
    assert main(["run", "-o", str(tmp_path), "--no-horizon", *given]) == 0
    sol = pc.load(tmp_path / "solution.npz")
    assert (sol.scene.gravity, sol.scene.links[1].mass) == (1.62, 0.5)
    assert (sol.q[0, 0], sol.qd[0, 1]) == (0.1, 2.0)
    assert sol.scene.links[1].inertia == pytest.approx(0.5 / 12)
    capsys.readouterr()
    for wrong, told in [
        ("gravityy=1", "gravity"),
        ("gravity", "must be NAME=VALUE"),
        ("gravity=x", "must be NAME=VALUE"),
        ("q0[3]=1", "the scene has 2 links, counted from 1"),
        ("q0=1", "must say of which link, such as q0[1]"),
        ("link[2].mass=-1", "must be finite and > 0"),
    ]:
        assert main(["run", "-o", str(tmp_path / "none"), "--parameters", wrong]) == 2
        assert told in capsys.readouterr().err
    twice = ["--parameters", "gravity=1", "--parameters", "gravity=2"]
    assert main(["run", "-o", str(tmp_path / "none"), *twice]) == 2
    assert "gravity is given twice" in capsys.readouterr().err
