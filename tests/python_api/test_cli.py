"""`pendcore run` and `pendcore plot` do what --help says, and end with the right status."""

from __future__ import annotations

import json
import os
import re
import signal
import threading
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest

CASE = pc.Case.textbook().to_toml()
FILES = ["angles.png", "solution.npz", "summary.json", "summary.txt"]


def listed(folder="."):
    return sorted(os.listdir(folder))


def is_png(path):
    return Path(path).read_bytes().startswith(b"\x89PNG")


def test_run_without_a_case_runs_the_textbooks_and_writes_where_it_is_told_to(pendcore):
    told = pendcore("run")
    assert told == (0, Path("out/textbook/summary.txt").read_text(), "written to out/textbook\n")
    assert np.array_equal(pc.load("out/textbook/solution.npz").y, pc.Case.textbook().simulate().y)
    assert is_png("out/textbook/angles.png")
    Path("swing.toml").write_text(CASE)
    assert pendcore("run swing.toml").status == pendcore("run swing.toml -o a/b").status == 0
    assert listed("out/textbook") == listed("out/swing") == listed("a/b") == FILES


FACTS = [
    r"^double pendulum, section 2\.1$",
    r"1 +1 +1 +0\.5 +0\.0833333$",
    r"gravity +9\.807 m/s\^2",
    r"mobility .*= 3\*2 - 2\*2 - 0 = 2$",
    r"start +t = 0 s, q = \(0\.785398, 1\.0472\) rad = \(45, 60\) deg, qd =",
    r"method +dopri5, rtol 1e-09, atol 1e-12$",
    r"not simulated +viscous joint, dry joint friction, ",
    r"status +finished",
    r"end +t = 5 s, q = \(1\.08307, 0\.53846",
    r"steps +\d+ accepted, \d+ rejected$",
    r"energy drift +\d\.\de-\d\d J, \d\.\de-\d\d of the largest kinetic energy$",
    r"largest reaction +joint 1: 31\.9307 N at t = 0\.643519 s$",
]


def test_the_summary_and_json_tell_what_was_simulated_and_what_came_of_it(pendcore):
    text = pendcore("run").out
    for fact in FACTS:
        assert re.search(fact, text, re.MULTILINE), fact
    assert "kept time" not in text
    assert "too large to trust" not in text
    found = json.loads(pendcore("run --json").out)
    assert found == json.loads(Path("out/textbook/summary.json").read_text())
    solution = pc.Case.textbook().simulate()
    drift = np.abs(solution.energy().total - solution.energy().total[0]).max()
    assert {
        "status": "finished",
        "success": True,
        "start": {"t": 0.0, "q": [np.pi / 4, np.pi / 3], "qd": [0.0, 0.0]},
        "run": {"t_end": 5.0, "method": "dopri5", "rtol": 1e-9, "atol": 1e-12},
        "end": {"t": 5.0, "q": [*solution.q[-1]], "qd": [*solution.qd[-1]]},
        "statistics": solution.stats._asdict(),
        "version": pc.__version__,
    }.items() <= found.items()
    assert found["links"][1]["inertia"] == 1 / 12
    assert found["mobility"]["degrees_of_freedom"] == 2
    assert found["energy"]["largest_drift"] == drift
    assert found["largest_reactions"][0]["force"] == pytest.approx(31.9307278, rel=1e-8)


@pytest.mark.parametrize("asked", ["", 'on_failure = "raise"\n', 'on_failure = "ignore"\n'])
def test_a_failed_run_writes_what_it_has_says_it_once_and_ends_with_1(asked, pendcore):
    Path("short.toml").write_text(CASE + "max_steps = 5\n" + asked)
    status, out, err = pendcore("run short.toml --json")
    assert (status, json.loads(out)["status"], listed("out/short")) == (1, "max_steps", FILES)
    assert err.count("the cap on steps was reached") == 1
    assert "the run is not complete: " in err
    assert "warning" not in err
    assert "to go on, in Python: pc.load('out/short/solution.npz').resume(5.0)" in err
    assert 0 < pc.load("out/short/solution.npz").t[-1] < 5


def test_ctrl_c_writes_what_there_is_and_ends_with_1(pendcore):
    endless = CASE.replace("t_end = 5.0", 't_end = 1e9\nstore = "end"\ntime_limit = 10.0')
    Path("long.toml").write_text(endless)
    threading.Timer(0.3, signal.raise_signal, [signal.SIGINT]).start()
    status, out, err = pendcore("run long.toml")
    assert (status, listed("out/long")) == (1, FILES)
    assert "interrupted" in err
    assert "interrupted: interrupted" not in out + err
    (again,) = re.findall(r"to go on, in Python: (.*)\.resume\(1000000000\.0\)", err)
    assert eval(again, {"pc": pc}).status == "interrupted"


def test_ctrl_c_outside_the_run_is_told_in_a_line(pendcore, monkeypatch):
    def stop(*_, **__):
        raise KeyboardInterrupt

    monkeypatch.setattr("pendcore._api.simulate.simulate", stop)
    assert pendcore("run") == (1, "", "pendcore run: interrupted\n")
    assert listed() == []


@pytest.mark.parametrize(
    ("asked", "among"),
    [
        ('store = "steps"', "among the 508 kept times\n"),
        ('store = "end"', "among the 1 kept time\n"),
        ("t_eval = [1.0, 2.0]", "among the 2 kept times\n"),
        ('t_eval = [1.0, 2.0]\nstore = "dense"', None),
    ],
)
def test_whatever_is_kept_start_end_and_drift_are_the_runs(asked, among, pendcore):
    Path("swing.toml").write_text(f"{CASE}{asked}\n")
    status, out, _ = pendcore("run swing.toml")
    found = json.loads(Path("out/swing/summary.json").read_text())
    whole = pc.Case.textbook().simulate()
    assert (status, found["end"]["q"], found["end"]["qd"]) == (0, [*whole.q[-1]], [*whole.qd[-1]])
    energies = found["energy"]["start"], found["energy"]["end"]
    assert energies == (whole.energy().total[0], whole.energy().total[-1])
    assert 0 < found["energy"]["largest_drift"] < 1e-7
    assert (among or "joint 2") in out
    assert ("kept time" in out) == (among is not None)


SAID = [
    ("step = 0.01\nrtol = 1e-6\n", 0, r"  method            dopri5, step 0\.01\n"),
    ("rtol = 0.1\natol = 0.1\n", 0, "too large to trust this run: tighten rtol and atol"),
    ('sensitivities = ["gravity", "q0[1]"]\n', 0, r"  derivatives +by gravity, q0\[1\]\n"),
    ("t_eval = [4.0]\nmax_steps = 5\n", 1, "largest reaction +among the 0 kept times"),
    ("t_eval = [4.0]\nmax_steps = 5\n", 1, r"\n  end +t = 0\.\d+ s, q = \(0\.7"),
]


@pytest.mark.parametrize(("asked", "status", "words"), SAID)
def test_the_summary_says_what_was_asked_for_and_what_is_wrong(asked, status, words, pendcore):
    Path("a.toml").write_text(CASE + asked)
    told = pendcore("run a.toml")
    assert told.status == status
    assert re.search(words, told.out)
    found = json.loads(Path("out/a/summary.json").read_text())
    assert ("rtol" in found["run"]) == ("step = " not in asked)
    assert found["energy"]["too_large"] == asked.startswith("rtol")


def test_earlier_files_are_replaced_and_it_says_so(pendcore):
    lines = 2 * ["run"] + 2 * ["plot out/textbook/solution.npz -o a.png"]
    assert ["replaced" in pendcore(x).err for x in lines] == [False, True, False, True]


DRAWN = [("-o a.png", "a.png"), ("-o a.pdf", "a.pdf"), ("-o a.svg", "a.svg")]
DRAWN += [("-o a", "a.png"), ("", "run.png")]


@pytest.mark.parametrize(("asked", "figure"), DRAWN)
def test_plot_draws_a_saved_solution(asked, figure, pendcore):
    pc.Case.textbook().simulate().save("run.npz")
    status, out, err = pendcore(f"plot run.npz --json {asked}")
    assert (status, err) == (0, f"written to {figure}\n")
    assert json.loads(out) == {"figure": figure, "status": "finished"}
    assert Path(figure).stat().st_size > 1000
    assert is_png(figure) == figure.endswith("png")


def test_a_csv_file_has_every_digit_of_the_states_and_parameters_replace_numbers(pendcore):
    given = "gravity=1.62 link[2].mass=0.5 --parameters q0[1]=0.1 qd0[2]=2"
    assert pendcore(f"run -o a --csv --no-horizon --parameters {given}").status == 0
    assert listed("a") == sorted([*FILES, "states.csv"])
    head, *rows = Path("a/states.csv").read_text(encoding="utf-8").splitlines()
    assert head == "t (s),q_1 (rad),q_2 (rad),qd_1 (rad/s),qd_2 (rad/s)"
    sol = pc.load("a/solution.npz")
    numbers = np.array([[float(x) for x in row.split(",")] for row in rows])
    assert np.array_equal(numbers, np.column_stack([sol.t, sol.y.T]))
    assert (sol.scene.gravity, sol.scene.links[1].mass) == (1.62, 0.5)
    assert (sol.q[0, 0], sol.qd[0, 1]) == (0.1, 2.0)
    assert sol.scene.links[1].inertia == pytest.approx(0.5 / 12)


@pytest.mark.parametrize(
    ("of_the_case", "given", "kept"),
    [
        ("", {"rtol": 1e-5}, {"method": "ode45"}),
        ("", {"method": "rk4", "step": 0.01}, {}),
        ("step = 0.01\n", {"rtol": 1e-5, "atol": 1e-7}, {"method": "ode45"}),
        ("step = 0.01\n", {"method": "rk4"}, {"step": 0.01}),
        ("max_steps = 4000\n", {"step": 0.02}, {"method": "ode45", "max_steps": 4000}),
        ("error = 1e-6\n", {"rtol": 1e-7}, {}),
    ],
    ids=str,
)
def test_options_of_the_command_take_the_place_of_those_of_the_case(
    of_the_case, given, kept, pendcore
):
    book = pc.Case.textbook()
    text = CASE.replace('method = "ode45"\n', "") if "error" in of_the_case else CASE
    Path("case.toml").write_text(text + of_the_case)
    options = " ".join(f"--{name} {value}" for name, value in given.items())
    assert pendcore(f"run case.toml -o o --no-horizon {options}").status == 0
    sol = pc.load("o/solution.npz")
    same = pc.simulate(book.scene, q0=book.q0, t_span=book.t_span, **given, **kept)
    assert np.array_equal(sol.y, same.y)
    assert sol.accuracy is None


def test_an_implausible_scene_is_run_with_a_warning(pendcore):
    odd = CASE.replace("length = 1.0\n", "length = 1.0\ninertia = 9.0\n", 1)
    Path("odd.toml").write_text(odd)
    told = pendcore("run odd.toml")
    assert told.status == 0
    assert "pendcore: warning: link 1: inertia = 9" in told.err
