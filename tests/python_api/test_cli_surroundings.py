"""The command works in any shell: whatever backend, encoding or closed stream it finds there."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import pendcore as pc
import pytest
from matplotlib.figure import Figure
from pendcore.cli import main

NAME = "θ sweep"
CASE = pc.Case.textbook().to_toml().replace("double pendulum, section 2.1", NAME)
MAP = """
[map]
show = "q[1]"
x = {name = "q0[1]", start = 0, stop = 1, count = 2}
y = {name = "q0[2]", start = 0, stop = 1, count = 2}
"""
QUICK = ["--methods", "dopri5", "--repeats", "1"]


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("PATH", "")  # no converters and no ffmpeg: what is written is the same
    Path("case.toml").write_text(CASE + MAP, encoding="utf-8")
    return tmp_path


def names(folder: str) -> list[str]:
    return sorted(path.name for path in Path(folder).iterdir())


def command(*argv: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command in a process of its own."""
    return subprocess.run(
        [sys.executable, "-m", "pendcore", *argv], env={**os.environ, **environment},
        capture_output=True, encoding="utf-8", check=False,
    )  # fmt: skip


@pytest.mark.outside_build
@pytest.mark.parametrize(
    ("argv", "written"),
    [
        (["run", "--csv", "-o", "o"], "angles.png"),
        (["map", "case.toml", "-o", "o"], "map.png"),
        (["cost", "case.toml", "-o", "o", *QUICK], "cost.png"),
        (["show", "case.toml", "-o", "o/film.gif", "--fps", "2"], "film.gif"),
    ],
    ids=lambda x: x[0] if isinstance(x, list) else "",
)
def test_it_draws_whatever_backend_is_set(argv: list[str], written: str) -> None:
    done = command(*argv, MPLBACKEND="of_another_environment")
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    assert written in names("o")


def test_it_draws_without_pyplot(monkeypatch: pytest.MonkeyPatch) -> None:
    def shown(*_: Any, **__: Any) -> None:
        raise AssertionError("pyplot asks for a backend")

    monkeypatch.setattr("matplotlib.pyplot.figure", shown)
    for argv in (["run"], ["map", "case.toml"], ["cost", *QUICK], ["show", "-o", "a.gif"]):
        assert main(argv) == 0


@pytest.mark.parametrize(
    ("argv", "there"),
    [
        (
            ["run", "--csv", "-o", "o"],
            ["solution.npz", "states.csv", "summary.json", "summary.txt"],
        ),
        (["map", "case.toml", "-o", "o"], ["map.npz", "summary.txt"]),
        (["cost", "-o", "o", *QUICK], ["cost.json", "cost.txt"]),
        (["derive", "--to", "report", "-o", "o"], ["report.md"]),
    ],
    ids=lambda x: x[0] if x[0] in ("run", "map", "cost", "derive") else "",
)
def test_a_figure_that_cannot_be_drawn_leaves_the_rest(
    argv: list[str], there: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise RuntimeError("latex could not be found")

    monkeypatch.setattr(Figure, "savefig", fail)
    assert main(argv) == 1
    assert names("o") == there
    told = capsys.readouterr().err
    assert ".png" in told
    assert "not written" in told
    assert "latex could not be found" in told


@pytest.mark.parametrize("argv", [["plot", "run.npz"], ["show", "run.npz", "-o", "run.png"]])
def test_a_lone_figure_that_cannot_be_drawn_is_named(
    argv: list[str], monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise RuntimeError("latex could not be found")

    pc.Case.textbook().simulate().save("run.npz")
    monkeypatch.setattr(Figure, "savefig", fail)
    assert main(argv) == 1
    why = "run.png: not written: RuntimeError: latex could not be found\n"
    assert capsys.readouterr().err == f"pendcore {argv[0]}: {why}"
    assert names(".") == ["case.toml", "run.npz"]


def test_second_runs_that_fail_take_nothing_from_the_first(monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_: Any, **__: Any) -> None:
        raise MemoryError("no memory for a second run")

    monkeypatch.setattr(pc.Solution, "estimate_error", fail)
    assert main(["run", "-o", "o"]) == 0
    assert "not known: no memory for a second run" in Path("o/summary.txt").read_text()
    assert pc.load("o/solution.npz").success


@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "utf-8"])
@pytest.mark.parametrize("argv", [["run"], ["cost", *QUICK], ["derive"], ["explain"]], ids="-".join)
def test_what_a_stream_cannot_hold_is_printed_escaped(
    argv: list[str], encoding: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stdout", stream)
    assert main([argv[0], "case.toml", *argv[1:]]) == 0
    stream.flush()
    printed = stream.buffer.getvalue().decode(encoding)  # type: ignore[attr-defined]
    if argv[0] == "run":
        assert printed.startswith(NAME if encoding == "utf-8" else "\\u03b8 sweep")
        assert Path("out/case/summary.txt").read_text(encoding="utf-8").startswith(NAME)
        assert pc.load("out/case/solution.npz").name == NAME


@pytest.mark.outside_build
@pytest.mark.parametrize("closed", ["stdout", "stderr"])
def test_a_closed_stream_is_no_failure_of_the_run(closed: str) -> None:
    descriptor = 1 if closed == "stdout" else 2
    program = f"import os, sys; os.close({descriptor}); os.execv(sys.executable, sys.argv[1:])"
    argv = [sys.executable, "-m", "pendcore", "run", "case.toml", "--json"]
    done = subprocess.run(
        [sys.executable, "-c", program, *argv], capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stderr
    if closed == "stdout":
        assert done.stderr == "written to out/case\n"
    else:  # and nothing that belongs there stands between the numbers
        assert json.loads(done.stdout)["name"] == NAME
