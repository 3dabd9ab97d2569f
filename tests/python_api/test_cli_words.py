"""The command says in a line what to write in place of what it cannot take, and ends with 2."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pendcore as pc
import pytest

CASE = pc.Case.textbook().to_toml()
FILES = {
    "case.toml": CASE,
    "step.toml": CASE + "step = -1.0\n",
    "key.toml": CASE.replace("gravity", "gravty"),
    "rtol.toml": CASE + "rtol = -1.0\n",
    "method.toml": CASE.replace("ode45", "euler"),
    "map.toml": f"""{CASE}
[map]
show = "q[1]"
x = {{name = "q0[1]", start = 0, stop = 1, count = 20_000}}
y = {{name = "q0[2]", start = 0, stop = 1, count = 20_000}}
""",
    "a.npz": "no archive",
    "there": None,
}
WORDS = {
    "": "COMMAND",
    "rnu": "invalid choice: 'rnu': did you mean 'run'?",
    "wxyz": "invalid choice: 'wxyz': known are run, explain, plot, ",
    "case.toml": "did you mean `pendcore run case.toml`?",
    "--nothing": "unrecognized arguments: --nothing\n",
    "--json run case.toml": "--json: write it after `pendcore run`\n",
    "--rtol=1e-5 run case.toml": "--rtol=1e-5: write it after `pendcore run`\n",
    "--rtol 1e-5 run case.toml": "--rtol: write it after `pendcore run`\n",
    "run --fast": "--fast",
    "run nothing.toml": "nothing.toml: No such file or directory",
    "run .": "Is a directory",
    "run -o key.toml": "key.toml: File exists",
    "run key.toml": "key.toml, line 2: unknown key 'gravty'",
    "run rtol.toml": "rtol.toml, line 20: rtol = -1",
    "run rtol.toml -o a/b/c": "rtol.toml, line 20: rtol = -1",
    "run rtol.toml -o there/d": "rtol.toml, line 20: rtol = -1",
    "run method.toml": 'method.toml, line 19: method = "euler"',
    "run case.toml case.toml": "unrecognized arguments: case.toml\n",
    "run case.toml --metod rk4": "--metod rk4: did you mean '--method'?",
    "run case.toml --max-step 1": "max_step is an option of the run: write max_step = ... below",
    "run case.toml --t_end 3": "t_end is an option of the run: write t_end = ... below [run]",
    "run case.toml --gravity 3": "write gravity = ... into the case or give --parameters gravity=",
    "run case.toml --method rk4": '--step: none given: method "rk4" estimates no error',
    "run case.toml --method euler": '--method = "euler": must be one of auto, dopri5',
    "run case.toml --rtol -1": "run: --rtol = -1.0: must be finite and > 0",
    "run case.toml --error 0": "run: --error = 0",
    "run case.toml --rtol 1e-5 --error 1e-6": "--rtol = 1e-05: is chosen for the error: leave out",
    "run step.toml --method rk4": "step.toml, line 20: step = -1.0: must be",
    "run case.toml --parameters rtol=1e-5": "rtol is an option of the run: write rtol = 1e-5 below"
    " [run] in the case, or give --rtol 1e-5\n",
    "run case.toml --parameters method=rk4": "or give --method rk4\n",
    "run case.toml --parameters t_end=3": "write t_end = 3 below [run] in the case\n",
    "run --parameters gravityy=1": "gravity",
    "run --parameters gravity": "must be NAME=VALUE",
    "run --parameters gravity=x": "must be NAME=VALUE",
    "run --parameters q0[3]=1": "the scene has 2 links, counted from 1",
    "run --parameters q0=1": "must say of which link, such as q0[1]",
    "run --parameters link[2].mass=-1": "must be finite and > 0",
    "run --parameters gravity=1 --parameters gravity=2": "gravity is given twice",
    "show case.toml --rtol 1": "rtol is an option of the run: write rtol = ... below [run] in the",
    "show case.toml --csv": "--csv: --csv is an option of `pendcore run`\n",
    "show case.toml --gravity 3": "--gravity 3: write gravity = ... into the case\n",
    "map map.toml -o o": "20,000 x 20,000 pixels: must be at most 100,000,000",
    "map map.toml --count 1000000000": "must be",
    "plot a.npz": "a.npz: is not a solution that pendcore saved",
    "plot key.toml": "key.toml: is a case, not a solution: `pendcore run`",
    "plot run.npz -o a.doc": "doc",
    "trust --limit 0": "pendcore trust: --limit = 0",
    "trust --time-limit 0": "pendcore trust: --time-limit = 0",
    "cost --repeats 0": "pendcore cost: --repeats = 0",
}


@pytest.mark.parametrize("line", WORDS)
def test_the_remedy_is_told_and_nothing_is_written(line, pendcore):
    for name, text in FILES.items():
        Path(name).mkdir() if text is None else Path(name).write_text(text)
    pc.simulate(pc.Scene.textbook(), q0=1, t_span=(0, 0.1)).save("run.npz")
    status, out, err = pendcore(line)
    assert (status, out) == (2, "")
    assert WORDS[line] in err
    assert "Traceback" not in err
    assert sorted(os.listdir()) == sorted([*FILES, "run.npz"])
    assert os.listdir("there") == []


PRINTED = {
    "--help": "pendcore run swing.toml",
    "run --help": "[[link]]",
    "plot --help": "pendcore plot out/textbook/solution.npz",
    "--version": f"pendcore {pc.__version__} ({pc._core.instruction_set()}, {pc._core.compiler})",
    "explain": "2 links",
    "completion bash": "_ARGCOMPLETE",
    "completion zsh": "_ARGCOMPLETE",
    "completion fish": "_ARGCOMPLETE",
}


@pytest.mark.parametrize("line", PRINTED)
def test_what_is_asked_for_is_printed(line, pendcore):
    if line.startswith("completion"):
        pytest.importorskip("argcomplete")
    status, out, err = pendcore(line)
    assert (status, err) == (0, "")
    assert PRINTED[line] in out
    assert "pendcore" in out or line == "explain"


def test_the_case_in_the_help_is_one(pendcore):
    assert pc.read_case(pendcore("run --help").out.partition("a case:\n")[2]).simulate().success


def test_a_wrong_instruction_set_does_not_hide_behind_the_version(monkeypatch, pendcore):
    monkeypatch.setattr("pendcore.build.instruction_set", lambda: int("x86-64-v9"))
    status, _, err = pendcore("--version")
    assert (status, "x86-64-v9" in err) == (2, True)


def test_without_its_library_completion_names_the_remedy(monkeypatch, pendcore):
    monkeypatch.setitem(sys.modules, "argcomplete", None)
    status, _, err = pendcore("completion bash")
    assert (status, "pip install argcomplete" in err) == (2, True)


COMMANDS = {"run", "explain", "plot", "trust", "cost", "derive", "completion"}
COMPLETED = {
    "pendcore ": COMMANDS,
    "pendcore co": {"cost", "completion"},
    "pendcore run --no": {"--no-horizon"},
    "pendcore completion ": {"bash", "zsh", "fish"},
}


@pytest.mark.outside_build
@pytest.mark.parametrize("line", COMPLETED)
def test_a_shell_completes_a_line(line, tmp_path):
    pytest.importorskip("argcomplete")
    asked = {
        "_ARGCOMPLETE": "1", "_ARGCOMPLETE_IFS": "\n", "COMP_TYPE": "9", "COMP_LINE": line,
        "COMP_POINT": str(len(line)), "_ARGCOMPLETE_STDOUT_FILENAME": str(tmp_path / "told"),
    }  # fmt: skip
    subprocess.run([sys.executable, "-m", "pendcore"], env=os.environ | asked, check=True)
    words = {word.strip() for word in (tmp_path / "told").read_text().split("\n")}
    assert words >= COMPLETED[line]
