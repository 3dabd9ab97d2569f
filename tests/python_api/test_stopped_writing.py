"""What stops a command while it writes leaves no partial file, and the missing ones are named."""

from __future__ import annotations

import errno
import gc
import json
import os
import signal
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from matplotlib.figure import Figure
from pendcore._cases.whole_file import whole_file
from pendcore.cli import run
from test_cli_streams import MAP

pytestmark = pytest.mark.usefixtures("folder")
TEXTS = ["summary.txt", "summary.json"]
FILES = sorted([*TEXTS, "solution.npz", "angles.png"])
BOOK = pc.Case.textbook()
STOPS = {
    "interrupted": KeyboardInterrupt(),
    "No space left on device": OSError(errno.ENOSPC, os.strerror(errno.ENOSPC)),
    "RuntimeError: latex could not be found": RuntimeError("latex could not be found"),
}
FULL = STOPS["No space left on device"]


def listed(folder="."):
    return sorted(os.listdir(folder))


def stop_at(monkeypatch, place, stop, after=0, most=np.inf):
    """Let the disk be full, or a user lose patience, after some calls of a function."""
    call, left = getattr(*place), after

    def stopped(*args, **named):
        nonlocal left
        left -= 1
        if -most <= left < 0:
            raise stop
        return call(*args, **named)

    monkeypatch.setattr(*place, stopped)


ARRAYS = (np.lib.format, "write_array")
FIGURES = (Figure, "savefig")
# For each the command, what stops after how many calls, the missing files, and the others.
STOPPED = [
    ("run short.toml --csv", ARRAYS, 3, ["solution.npz"], [*TEXTS, "angles.png", "states.csv"]),
    ("run --csv", FIGURES, 0, ["angles.png"], [*TEXTS, "solution.npz", "states.csv"]),
    ("run", (run, "facts"), 0, TEXTS, ["solution.npz", "angles.png"]),
    ("run", (run, "text"), 0, TEXTS[:1], ["summary.json", "solution.npz", "angles.png"]),
    ("map case.toml", FIGURES, 0, ["map.png"], ["summary.txt", "map.npz"]),
    ("cost --methods dopri5 --repeats 1", FIGURES, 0, ["cost.png"], ["cost.txt", "cost.json"]),
]


@pytest.mark.few_cases
@pytest.mark.every_value("row")
@pytest.mark.parametrize("row", STOPPED, ids=lambda row: f"{row[0]}: {row[3][0]}")
@pytest.mark.parametrize("why", STOPS)
def test_what_stops_a_file_is_named_and_leaves_the_others(row, why, monkeypatch, pendcore):
    """A function of the command is stopped once: it is called again for what is printed."""
    line, place, after, missing, others = row
    Path("case.toml").write_text(BOOK.to_toml() + MAP)
    Path("short.toml").write_text(BOOK.to_toml() + "max_steps = 5\n")
    stop_at(monkeypatch, place, STOPS[why], after, most=1 if place[0] is run else np.inf)
    status, out, err = pendcore(f"{line} -o o")
    assert (status, listed("o")) == (1, sorted(others))
    for name in missing:
        assert f"o/{name}: not written: {why}\n" in err
    assert f"written to o: {', '.join(others)}\n" in err
    assert ("the run is not complete: " in err) == ("short" in line)
    assert "pc.load(" not in err  # what is missing is not offered
    if "summary.txt" in others and line.startswith("run"):
        assert out == Path("o/summary.txt").read_text()


def test_a_report_is_written_without_the_figures_that_cannot_be_drawn(monkeypatch, pendcore):
    stop_at(monkeypatch, FIGURES, STOPS["RuntimeError: latex could not be found"])
    monkeypatch.setattr("shutil.which", lambda command: None)
    rod = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)])
    Path("rod.toml").write_text(pc.Case(scene=rod, q0=1.0, t_span=(0, 1)).to_toml())
    status, _, err = pendcore("derive rod.toml --to report -o o")
    assert (status, listed("o")) == (1, ["report.md"])
    assert "mechanism.png is not written: latex could not be found" in err
    assert "these need pandoc" in err


@pytest.mark.parametrize("line", ["plot run.npz", "show run.npz -o run.png"])
def test_a_lone_figure_that_cannot_be_drawn_is_named(line, monkeypatch, pendcore):
    BOOK.simulate().save("run.npz")
    stop_at(monkeypatch, FIGURES, STOPS["RuntimeError: latex could not be found"])
    why = "run.png: not written: RuntimeError: latex could not be found\n"
    assert pendcore(line) == (1, "", f"pendcore {line[:4]}: {why}")
    assert listed() == ["run.npz"]


def test_an_earlier_file_stays_whole_and_is_said_to_be_there(monkeypatch, pendcore):
    assert pendcore("run -o o").status == 0
    earlier = Path("o/solution.npz").read_bytes()
    with monkeypatch.context() as once:
        stop_at(once, ARRAYS, KeyboardInterrupt(), 3)
        status, _, err = pendcore("run -o o")
    said = "o/solution.npz: not written: interrupted; the earlier one is still there"
    assert (status, said in err, listed("o")) == (1, True, FILES)
    stop_at(monkeypatch, ARRAYS, FULL, 3)
    with pytest.raises(OSError, match=r"No space left on device: 'o/solution\.npz'"):
        BOOK.simulate().save("o/solution.npz")
    assert listed("o") == FILES
    assert Path("o/solution.npz").read_bytes() == earlier


NOTHING_WRITTEN = {  # what is told all the same
    "run -o o": "largest reaction",
    "cost --methods dopri5 --repeats 1 --time-limit 2 -o o": "dopri5",
    "map case.toml --no-trust -o o": "q[1]",
}


@pytest.mark.parametrize("line", NOTHING_WRITTEN)
def test_where_nothing_can_be_written_no_folder_is_left(line, monkeypatch, pendcore):
    Path("case.toml").write_text(BOOK.to_toml() + MAP)
    for place in ARRAYS, (Path, "write_text"), FIGURES:
        stop_at(monkeypatch, place, FULL)
    status, out, err = pendcore(line)
    assert (status, listed()) == (1, ["case.toml"])
    assert NOTHING_WRITTEN[line] in out
    assert "written to o: nothing\n" in err


LIMITED = """
import resource, sys
from pendcore.cli import main
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv[1]), int(sys.argv[1])))
sys.exit(main(sys.argv[2:]))
"""


@pytest.mark.outside_build
@pytest.mark.parametrize(
    ("line", "limit", "lost", "left"),
    [
        ("run -o here", 150_000, "here/solution.npz", ["here", "run.npz"]),
        ("plot run.npz -o a.pdf", 5_000, "a.pdf", ["run.npz"]),
        ("plot run.npz -o a.svg", 5_000, "a.svg", ["run.npz"]),
    ],
)
def test_a_file_that_the_system_cuts_short_is_named_and_gone(line, limit, lost, left):
    BOOK.simulate().save("run.npz")
    command = [sys.executable, "-c", LIMITED, str(limit), *line.split()]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (done.returncode, listed()) == (1, left)
    assert f"{lost}: not written: {os.strerror(errno.EFBIG)}\n" in done.stderr
    assert left == ["run.npz"] or listed("here") == sorted([*TEXTS, "angles.png"])


def test_progress_of_a_save_goes_up_to_the_end():
    told = []
    pc.simulate(BOOK.scene, q0=[1, 2], t_span=(0, 50)).save("run.npz", progress=told.append)
    assert told == sorted(told)
    assert (told[0] < 0.1, told[-1]) == (True, 1.0)


def test_much_to_write_is_told_beforehand(monkeypatch, pendcore):
    monkeypatch.setattr(run, "_MANY_STEPS", 100)
    _, out, err = pendcore("run --json")
    steps = json.loads(out)["statistics"]["accepted"]
    assert err.splitlines()[0] == f"writing {steps} steps to out/textbook"


def test_a_file_behind_a_link_and_a_pipe_are_written_where_they_are():
    solution = BOOK.simulate()
    Path("there").mkdir()
    Path("link.npz").symlink_to("there/run.npz")
    solution.save("link.npz")
    assert Path("link.npz").is_symlink()
    assert pc.load("there/run.npz").y.shape == solution.y.shape
    solution.save("/dev/null")
    assert not Path("/dev/null").is_file()


# Threads that write to one path ------------------------------------------------------------------


def short(**options):
    return pc.simulate(BOOK.scene, q0=BOOK.q0, t_span=(0, 0.5), **options)


def cost():
    how = {"methods": "dopri5", "rtol": [1e-3], "repeats": 1}
    return pc.accuracy_cost(BOOK.scene, q0=BOOK.q0, t_span=(0, 0.1), **how)


WRITERS = {
    "a.npz": lambda pendcore: short().save("a.npz"),
    "a.html": lambda pendcore: short().to_html("a.html"),
    "a.gif": lambda pendcore: short().to_video("a.gif", fps=4, size=(160, 90)),
    "a.json": lambda pendcore: cost().to_json("a.json"),
    "all.npz": lambda pendcore: pc.ensemble(BOOK.scene, q0=[BOOK.q0] * 2, t_span=(0, 0.1)).save(
        "all.npz"
    ),
    "a.png": lambda pendcore: pendcore("show -o a.png").status,
    "RR.m": lambda pendcore: pendcore("derive --to octave -o RR.m").status,
}


@pytest.mark.few_cases
@pytest.mark.parametrize("name", WRITERS)
def test_whatever_is_written_has_a_name_of_its_own_until_it_is_whole(name, monkeypatch, pendcore):
    under = []
    replace = Path.replace

    def watched(self, target):
        under.append(self.name)
        if len(under) == 3:
            raise KeyboardInterrupt
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", watched)
    for _ in range(2):
        WRITERS[name](pendcore)
    assert len({*under}) == len(under) == 2
    assert listed() == [name]
    Path(name).unlink()
    try:
        ended = WRITERS[name](pendcore)
    except KeyboardInterrupt:
        ended = 1
    assert (ended, listed()) == (1, [])  # Ctrl-C leaves nothing behind


def test_two_writers_of_one_path_do_not_meet():
    with whole_file("a.txt") as first:
        first.write_text("first")
        with whole_file("a.txt") as second:
            second.write_text("second")
        assert Path("a.txt").read_text() == "second"
        assert first.read_text() == "first"
    assert Path("a.txt").read_text() == "first"
    assert listed() == ["a.txt"]


def test_threads_that_save_to_one_path_always_leave_a_whole_file():
    runs = [BOOK.simulate(), pc.simulate(BOOK.scene, (0, 20), [-1, -1])]
    runs[0].save("a.npz")

    def save_and_load(i):
        runs[i % 2].save("a.npz")
        return pc.load("a.npz").fingerprint

    with ThreadPoolExecutor(4) as threads:
        assert {*threads.map(save_and_load, range(40))} == {run.fingerprint for run in runs}
    assert listed() == ["a.npz"]


def test_ctrl_c_while_the_archive_is_written_keeps_the_other_files(monkeypatch, pendcore):
    monkeypatch.setattr(
        "numpy.lib.format.write_array", lambda *_, **__: signal.raise_signal(signal.SIGINT)
    )
    assert pendcore("run -o o").status == 1
    assert listed("o") == sorted({*FILES} - {"solution.npz"})


class Litter:
    """What the collector finds, and whose end lets other threads go on."""

    def __init__(self):
        self.me = self

    def __del__(self):
        for _ in range(50):
            pass


def load_and_litter(path):
    Litter()
    return pc.load(path)


def test_threads_that_load_at_once_read_whole_files():
    """CPython before 3.11.8 counts the depth of `ast`, which reads heads, for all threads."""
    pc.simulate(BOOK.scene, (0, 0.5), BOOK.q0).save("a.npz")
    before = sys.getswitchinterval(), gc.get_threshold()
    sys.setswitchinterval(1e-6)
    gc.set_threshold(7)
    try:
        with ThreadPoolExecutor(4) as threads:
            loaded = [*threads.map(load_and_litter, ["a.npz"] * 200)]
    finally:
        sys.setswitchinterval(before[0])
        gc.set_threshold(*before[1])
    assert len({one.fingerprint for one in loaded}) == 1
