"""The command says what to write in place of a word that it does not know or that needs another."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main

CASE = pc.Case.textbook().to_toml()


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    Path("case.toml").write_text(CASE)
    Path("step.toml").write_text(CASE + "step = -1.0\n")
    return tmp_path


WORDS = {
    "rnu": "invalid choice: 'rnu': did you mean 'run'?",
    "wxyz": "invalid choice: 'wxyz': known are run, explain, plot, ",
    "case.toml": "did you mean `pendcore run case.toml`?",
    "run case.toml --metod rk4": "--metod rk4: did you mean '--method'?",
    "run case.toml --max-step 1": "max_step is an option of the run: write max_step = ... below",
    "run case.toml --t_end 3": "t_end is an option of the run: write t_end = ... below [run]",
    "show case.toml --rtol 1": "rtol is an option of the run: write rtol = ... below [run] in the",
    "show case.toml --csv": "--csv: --csv is an option of `pendcore run`\n",
    "run case.toml --gravity 3": "write gravity = ... into the case or give --parameters gravity=",
    "show case.toml --gravity 3": "--gravity 3: write gravity = ... into the case\n",
    "--json run case.toml": "--json: write it after `pendcore run`\n",
    "--rtol=1e-5 run case.toml": "--rtol=1e-5: write it after `pendcore run`\n",
    "--rtol 1e-5 run case.toml": "--rtol: write it after `pendcore run`\n",
    "--nothing": "unrecognized arguments: --nothing\n",
    "run case.toml case.toml": "unrecognized arguments: case.toml\n",
    "run case.toml --method rk4": '--step: none given: method "rk4" estimates no error',
    "run case.toml --method euler": '--method = "euler": must be one of auto, dopri5',
    "run case.toml --rtol -1": "run: --rtol = -1.0: must be finite and > 0",
    "run case.toml --rtol 1e-5 --error 1e-6": "--rtol = 1e-05: is chosen for the error: leave out",
    "run case.toml --parameters rtol=1e-5": "rtol is an option of the run: write rtol = 1e-5 below"
    " [run] in the case, or give --rtol 1e-5\n",
    "run case.toml --parameters method=rk4": "or give --method rk4\n",
    "run step.toml --method rk4": "step.toml, line 20: step = -1.0: must be",
    "run case.toml --parameters t_end=3": "write t_end = 3 below [run] in the case\n",
}


@pytest.mark.parametrize("line", WORDS)
def test_the_remedy_is_told(line: str, capsys: Any) -> None:
    assert main(line.split()) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert WORDS[line] in err
    assert sorted(path.name for path in Path().iterdir()) == ["case.toml", "step.toml"]


@pytest.mark.parametrize(
    ("of_the_case", "given", "kept"),
    [
        ("", {"rtol": 1e-5}, {"method": "ode45"}),
        ("", {"method": "rk4", "step": 0.01}, {}),
        ("step = 0.01\n", {"rtol": 1e-5, "atol": 1e-7}, {"method": "ode45"}),
        ("step = 0.01\n", {"method": "rk4"}, {"step": 0.01}),
        ("max_steps = 4000\n", {"step": 0.02}, {"method": "ode45", "max_steps": 4000}),
    ],
    ids=str,
)
def test_options_of_the_command_take_the_place_of_those_of_the_case(
    of_the_case: str, given: dict[str, Any], kept: dict[str, Any]
) -> None:
    Path("case.toml").write_text(CASE + of_the_case)
    options = [word for name, value in given.items() for word in (f"--{name}", str(value))]
    assert main(["run", "case.toml", "-o", "o", "--no-horizon", *options]) == 0
    book = pc.Case.textbook()
    same = pc.simulate(book.scene, q0=book.q0, t_span=book.t_span, **given, **kept)
    assert np.array_equal(pc.load("o/solution.npz").y, same.y)


def test_an_error_of_the_case_gives_way_to_a_tolerance_of_the_command() -> None:
    Path("case.toml").write_text(CASE.replace('method = "ode45"', "error = 1e-6"))
    assert main(["run", "case.toml", "-o", "o", "--rtol", "1e-7"]) == 0
    found = json.loads(Path("o/summary.json").read_text())
    assert (found["run"]["rtol"], found["accuracy"]) == (1e-7, None)
