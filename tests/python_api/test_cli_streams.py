"""The command works in any shell: whatever backend, encoding or closed stream it finds there."""

from __future__ import annotations

import io
import json
import os
import subprocess
import sys
from pathlib import Path

import pendcore as pc
import pytest
from pendcore.cli import main

NAME = "θ sweep"
CASE = pc.Case.textbook().to_toml().replace("double pendulum, section 2.1", NAME)
MAP = """
[map]
show = "q[1]"
x = {name = "q0[1]", start = 0, stop = 1, count = 2}
y = {name = "q0[2]", start = 0, stop = 1, count = 2}
"""
QUICK = "--methods dopri5 --repeats 1"


@pytest.fixture(autouse=True)
def _case(folder, monkeypatch):
    monkeypatch.setenv("PATH", "")  # no converters and no ffmpeg: what is written is the same
    Path("case.toml").write_text(CASE + MAP, encoding="utf-8")


def run(line, **given):
    """Run the command in a process of its own."""
    command = [sys.executable, "-m", "pendcore", *line.split()]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "check": False}
    return subprocess.run(command, encoding="utf-8", **pipes | given)


DRAWN = {
    "run --csv -o o": "angles.png",
    "map case.toml -o o": "map.png",
    f"cost case.toml -o o {QUICK}": "cost.png",
    "show case.toml -o o/film.gif --fps 2 --speed 5": "film.gif",
}


@pytest.mark.outside_build
@pytest.mark.parametrize("line", DRAWN)
def test_it_draws_whatever_backend_is_set(line):
    done = run(line, env=os.environ | {"MPLBACKEND": "of_another_environment"})
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    assert DRAWN[line] in os.listdir("o")


@pytest.mark.few_cases
@pytest.mark.parametrize("encoding", ["cp1252", "ascii", "utf-8"])
@pytest.mark.parametrize("command", ["run", "cost", "derive", "explain"])
def test_what_a_stream_cannot_hold_is_printed_escaped(command, encoding, monkeypatch):
    stream = io.TextIOWrapper(io.BytesIO(), encoding=encoding)
    monkeypatch.setattr(sys, "stdout", stream)
    assert main([command, "case.toml", *(QUICK.split() if command == "cost" else [])]) == 0
    stream.flush()
    printed = stream.buffer.getvalue().decode(encoding)
    if command == "run":
        assert printed.startswith(NAME if encoding == "utf-8" else "\\u03b8 sweep")
        assert Path("out/case/summary.txt").read_text(encoding="utf-8").startswith(NAME)
        assert pc.load("out/case/solution.npz").name == NAME


@pytest.mark.outside_build
@pytest.mark.parametrize("closed", [1, 2])
def test_a_closed_stream_is_no_failure_of_the_run(closed):
    program = f"import os, sys; os.close({closed}); os.execv(sys.executable, sys.argv[1:])"
    argv = [sys.executable, "-m", "pendcore", "run", "case.toml", "--json"]
    done = subprocess.run(
        [sys.executable, "-c", program, *argv], capture_output=True, encoding="utf-8", check=False
    )
    assert done.returncode == 0, done.stderr
    if closed == 1:
        assert done.stderr == "written to out/case\n"
    else:  # and nothing that belongs there stands between the numbers
        assert json.loads(done.stdout)["name"] == NAME


@pytest.mark.outside_build
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="needs a device that is always full")
@pytest.mark.parametrize("line", ["run -o here --json", "explain"])
def test_nobody_reading_is_no_failure_of_the_run_and_a_full_disk_is_named(line):
    read, write = os.pipe()
    os.close(read)
    done = run(line, stdout=write)
    os.close(write)
    told = "" if line == "explain" else "written to here\n"
    assert (done.returncode, done.stderr) == (141, told)
    assert line == "explain" or len(os.listdir("here")) == 4
    with Path("/dev/full").open("w") as full:
        done = run(line, stdout=full)
    assert done.returncode == 1
    why = f"pendcore {line.split()[0]}: standard output: No space left on device\n"
    assert done.stderr.endswith(why)
