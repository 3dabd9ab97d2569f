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
        r"start +t = 0 s, q = \(0\.785398, 1\.0472\) rad, qd = \(0, 0\) rad/s",
        r"method +dopri5, rtol 1e-09, atol 1e-12",
        r"not simulated +friction",
        r"status +finished",
        r"end +t = 5 s, q = \(1\.08307, 0\.53846",
        r"steps +\d+ accepted, \d+ rejected",
        r"energy drift +\d\.\de-\d\d J, \d\.\de-\d\d of the largest kinetic energy",
        r"largest reaction +joint 1: 31\.9\d+ N at t = 0\.6",
    ):
        assert re.search(fact, text), fact


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
    assert printed["largest_reactions"][0]["force"] == pytest.approx(31.9, abs=0.1)
    assert printed["version"] == pc.__version__


def test_a_failed_run_writes_what_it_has_and_ends_with_1(capsys):
    Path("short.toml").write_text(CASE + "max_steps = 5\n")
    assert main(["run", "short.toml", "--json"]) == 1
    out, err = capsys.readouterr()
    assert written("out/short") == FILES
    assert json.loads(out)["status"] == "max_steps"
    assert "the run failed: " in err
    assert 0 < pc.load("out/short/solution.npz").t[-1] < 5


def test_ctrl_c_writes_what_there_is_and_ends_with_1(capsys):
    endless = CASE.replace("t_end = 5.0", 't_end = 1e9\nstore = "end"\ntime_limit = 10.0')
    Path("long.toml").write_text(endless)
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    assert main(["run", "long.toml"]) == 1
    assert "interrupted" in capsys.readouterr().err
    assert written("out/long") == FILES


@pytest.mark.parametrize("store", ["steps", "end", "times"])
def test_whatever_is_stored_can_be_summed_up(store):
    asked = f'store = "{store}"\n' + "t_eval = [1.0, 2.0]\n" * (store == "times")
    Path("swing.toml").write_text(CASE + asked)
    assert main(["run", "swing.toml"]) == 0
    energy = json.loads(Path("out/swing/summary.json").read_text())["energy"]
    assert (energy is None) == (store == "end")


def test_an_implausible_scene_is_run_with_a_warning(capsys):
    Path("odd.toml").write_text(CASE.replace("length = 1.0\n", "length = 1.0\ninertia = 9.0\n", 1))
    assert main(["run", "odd.toml"]) == 0
    assert "pendcore: warning: link 1: inertia = 9" in capsys.readouterr().err


MISTAKES = {
    "no such file": (["run", "nothing.toml"], "nothing.toml: No such file or directory"),
    "a folder": (["run", "."], "Is a directory"),
    "unknown key": (["run", "key.toml"], "key.toml, line 2: unknown key 'gravty'"),
    "bad tolerance": (["run", "rtol.toml"], "rtol.toml: rtol = -1"),
    "unknown method": (["run", "method.toml"], 'method.toml: method = "euler"'),
    "a file for a folder": (["run", "-o", "key.toml"], "key.toml: File exists"),
    "unknown command": (["jump"], "invalid choice: 'jump'"),
    "no command": ([], "COMMAND"),
    "unknown option": (["run", "--fast"], "--fast"),
    "no solution": (["plot", "key.toml"], "key.toml: is not a solution that pendcore saved"),
    "no such solution": (["plot", "x.npz"], "x.npz: No such file or directory"),
    "unknown kind of figure": (["plot", "run.npz", "-o", "a.doc"], "doc"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_wrong_usage_is_told_in_a_line_and_ends_with_2(mistake, capsys):
    Path("key.toml").write_text(CASE.replace("gravity", "gravty"))
    Path("rtol.toml").write_text(CASE + "rtol = -1.0\n")
    Path("method.toml").write_text(CASE + 'method = "euler"\n')
    pc.simulate(pc.Scene.textbook(), 1, t_span=(0, 1)).save("run.npz")
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
        (["--version"], f"pendcore {pc.__version__}"),
    ],
)
def test_help_and_version_are_printed(argv, said, capsys):
    assert main(argv) == 0
    assert said in capsys.readouterr().out


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
