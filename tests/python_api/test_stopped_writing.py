"""A command stopped while it writes leaves no partial file, and says which files are missing."""

from __future__ import annotations

import errno
import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore.cli import main

SMALL = ["angles.png", "summary.json", "summary.txt"]
FILES = [*SMALL[:1], "solution.npz", *SMALL[1:]]
STOPS = {
    "interrupted": KeyboardInterrupt(),
    "No space left on device": OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
    "RuntimeError: out of order": RuntimeError("out of order"),
}


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: Any) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


def names(folder: str) -> list[str]:
    return sorted(path.name for path in Path(folder).iterdir())


def stop_after(monkeypatch: Any, pieces: int, stop: BaseException) -> None:
    """Let the disk be full, or a user lose patience, after some arrays of an archive."""
    write = np.lib.format.write_array

    def write_some(*args: Any, **named: Any) -> None:
        nonlocal pieces
        pieces -= 1
        if pieces < 0:
            raise stop
        write(*args, **named)

    monkeypatch.setattr(np.lib.format, "write_array", write_some)


@pytest.mark.parametrize("why", STOPS)
def test_what_stops_the_archive_leaves_the_rest(why: str, monkeypatch: Any, capsys: Any) -> None:
    stop_after(monkeypatch, 3, STOPS[why])
    assert main(["run"]) == 1
    out, err = capsys.readouterr()
    assert names("out/textbook") == SMALL
    assert err.splitlines() == [
        f"out/textbook/solution.npz: not written: {why}",
        "written to out/textbook: summary.txt, summary.json, angles.png",
    ]
    assert out == Path("out/textbook/summary.txt").read_text()


def test_an_earlier_file_stays_whole_and_is_said_to_be_there(monkeypatch: Any, capsys: Any) -> None:
    assert main(["run"]) == 0
    earlier = Path("out/textbook/solution.npz").read_bytes()
    stop_after(monkeypatch, 3, KeyboardInterrupt())
    assert main(["run"]) == 1
    said = "out/textbook/solution.npz: not written: interrupted; the earlier one is still there"
    assert said in capsys.readouterr().err
    assert Path("out/textbook/solution.npz").read_bytes() == earlier
    assert names("out/textbook") == FILES


@pytest.mark.parametrize(
    ("stage", "missing"),
    [
        ("facts", ["summary.json", "summary.txt"]),
        ("text", ["summary.txt"]),
        ("save_figure", ["angles.png"]),
    ],
)
@pytest.mark.parametrize("why", STOPS)
def test_what_stops_another_file_leaves_the_archive(
    stage: str, missing: list[str], why: str, monkeypatch: Any, capsys: Any
) -> None:
    def stopped(*_: Any, **__: Any) -> None:
        monkeypatch.undo()
        monkeypatch.chdir(here)
        raise STOPS[why]

    here = Path.cwd()
    monkeypatch.setattr(f"pendcore.cli.run.{stage}", stopped)
    assert main(["run"]) == 1
    assert names("out/textbook") == [name for name in FILES if name not in missing]
    err = capsys.readouterr().err
    for name in missing:
        assert f"out/textbook/{name}: not written: {why}\n" in err


def test_where_nothing_can_be_written_no_folder_is_left(monkeypatch: Any, capsys: Any) -> None:
    full = STOPS["No space left on device"]

    def stopped(*_: Any, **__: Any) -> None:
        raise full

    stop_after(monkeypatch, 0, full)
    monkeypatch.setattr(Path, "write_text", stopped)
    monkeypatch.setattr("pendcore.cli.run.save_figure", stopped)
    assert main(["run"]) == 1
    out, err = capsys.readouterr()
    assert "largest reaction" in out  # the facts are told where they can be
    assert "written to out/textbook: nothing\n" in err
    assert names(".") == []


def test_a_run_that_was_capped_does_not_offer_an_archive_that_is_missing(
    monkeypatch: Any, capsys: Any
) -> None:
    Path("short.toml").write_text(pc.Case.textbook().to_toml() + "max_steps = 5\n")
    stop_after(monkeypatch, 3, KeyboardInterrupt())
    assert main(["run", "short.toml"]) == 1
    err = capsys.readouterr().err
    assert "the run is not complete: " in err
    assert "pc.load(" not in err


SLOWLY = """
import sys, time
import numpy as np
from pendcore.cli import main
write = np.lib.format.write_array
def slowly(*args, **named):
    time.sleep(0.1)
    write(*args, **named)
np.lib.format.write_array = slowly
sys.exit(main(["run", "-o", "here"]))
"""


@pytest.mark.outside_build
def test_ctrl_c_while_the_archive_is_written_keeps_the_small_files() -> None:
    with subprocess.Popen(
        [sys.executable, "-c", SLOWLY], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        while not [*Path().glob("here/solution*")]:
            assert process.poll() is None
            time.sleep(0.01)
        process.send_signal(signal.SIGINT)
        out, err = process.communicate(timeout=60)
    assert process.returncode == 1
    assert names("here") == SMALL
    assert err.splitlines() == [
        "here/solution.npz: not written: interrupted",
        "written to here: summary.txt, summary.json, angles.png",
    ]
    assert out == Path("here/summary.txt").read_text()


TOO_LARGE = """
import resource, sys
from pendcore.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (150_000, 150_000))
sys.exit(main(sys.argv[1:]))
"""


@pytest.mark.outside_build
def test_a_file_that_the_system_cuts_short_is_named_and_gone() -> None:
    command = [sys.executable, "-c", TOO_LARGE, "run", "-o", "here"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert names("here") == SMALL
    assert f"here/solution.npz: not written: {os.strerror(errno.EFBIG)}\n" in done.stderr


@pytest.mark.outside_build
@pytest.mark.parametrize("suffix", ["pdf", "svg"])
def test_a_figure_that_the_system_cuts_short_is_named_and_gone(suffix: str) -> None:
    pc.Case.textbook().simulate().save("run.npz")
    program = TOO_LARGE.replace("150_000", "5_000")
    command = [sys.executable, "-c", program, "plot", "run.npz", "-o", f"figure.{suffix}"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert f"figure.{suffix}: not written: {os.strerror(errno.EFBIG)}\n" in done.stderr
    assert names(".") == ["run.npz"]


def test_a_save_that_fails_names_its_file_and_leaves_the_earlier_one(monkeypatch: Any) -> None:
    solution = pc.Case.textbook().simulate()
    solution.save("run.npz")
    earlier = Path("run.npz").read_bytes()
    stop_after(monkeypatch, 3, STOPS["No space left on device"])
    with pytest.raises(OSError, match=r"No space left on device: 'run\.npz'"):
        solution.save("run.npz")
    assert names(".") == ["run.npz"]
    assert Path("run.npz").read_bytes() == earlier


def test_progress_of_a_save_goes_up_to_the_end() -> None:
    told: list[float] = []
    solution = pc.simulate(pc.Scene.textbook(), q0=[1, 2], t_span=(0, 50))
    solution.save("run.npz", progress=told.append)
    assert told == sorted(told)
    assert told[0] < 0.1
    assert told[-1] == 1.0


def test_an_archive_is_what_numpy_would_write() -> None:
    solution = pc.Case.textbook().simulate()
    solution.save("run.npz")
    with np.load("run.npz") as file:
        np.savez("numpy.npz", **dict(file))
    assert Path("run.npz").stat().st_size == Path("numpy.npz").stat().st_size


def test_a_file_behind_a_link_and_a_pipe_are_written_where_they_are() -> None:
    solution = pc.Case.textbook().simulate()
    Path("there").mkdir()
    Path("link.npz").symlink_to("there/run.npz")
    solution.save("link.npz")
    assert Path("link.npz").is_symlink()
    assert pc.load("there/run.npz").y.shape == solution.y.shape
    solution.save("/dev/null")
    assert not Path("/dev/null").is_file()


def test_much_to_write_is_told_beforehand(monkeypatch: Any, capsys: Any) -> None:
    monkeypatch.setattr("pendcore.cli.run._MANY_STEPS", 100)
    assert main(["run", "--json"]) == 0
    out, err = capsys.readouterr()
    steps = json.loads(out)["statistics"]["accepted"]
    assert err.splitlines()[0] == f"writing {steps} steps to out/textbook"
