"""Threads that write to one path leave a whole file there: each writes under a name of its own."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pendcore as pc
import pytest
from pendcore._cases.whole_file import whole_file
from pendcore.cli import main

BOOK = pc.Case.textbook()


@pytest.fixture(autouse=True)
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture(scope="module")
def sol() -> pc.Solution:
    return pc.simulate(BOOK.scene, q0=BOOK.q0, t_span=(0, 0.5))


@pytest.fixture(scope="module")
def cost() -> pc.AccuracyCost:
    return pc.accuracy_cost(
        BOOK.scene, q0=BOOK.q0, t_span=(0, 0.1), methods="dopri5", rtol=[1e-3], repeats=1
    )


WRITERS: dict[str, Callable[[pc.Solution, pc.AccuracyCost], object]] = {
    "a.npz": lambda sol, cost: sol.save("a.npz"),
    "a.html": lambda sol, cost: sol.to_html("a.html"),
    "a.gif": lambda sol, cost: sol.to_video("a.gif", fps=4),
    "a.json": lambda sol, cost: cost.to_json("a.json"),
    "all.npz": lambda sol, cost: pc.ensemble(BOOK.scene, q0=[BOOK.q0] * 2, t_span=(0, 0.1)).save(
        "all.npz"
    ),
    "a.png": lambda sol, cost: main(["show", "-o", "a.png"]),
    "RR.m": lambda sol, cost: main(["derive", "--to", "octave", "-o", "RR.m"]),
}


@pytest.mark.parametrize("name", WRITERS)
def test_whatever_is_written_has_a_name_of_its_own_until_it_is_whole(
    name: str, sol: pc.Solution, cost: pc.AccuracyCost, monkeypatch: pytest.MonkeyPatch
) -> None:
    under: list[str] = []
    replace = Path.replace

    def watched(self: Path, target: Path) -> Path:
        under.append(self.name)
        return replace(self, target)

    monkeypatch.setattr(Path, "replace", watched)
    for _ in range(2):
        WRITERS[name](sol, cost)
    assert len({*under}) == len(under) == 2
    assert [path.name for path in Path().iterdir()] == [name]


@pytest.mark.parametrize("name", WRITERS)
def test_ctrl_c_leaves_nothing_behind(
    name: str, sol: pc.Solution, cost: pc.AccuracyCost, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stopped(*_: object) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr(Path, "replace", stopped)
    try:
        ended = WRITERS[name](sol, cost)
    except KeyboardInterrupt:
        ended = 1
    assert ended == 1
    assert [*Path().iterdir()] == []


def test_two_writers_of_one_path_do_not_meet() -> None:
    with whole_file("a.txt") as first:
        first.write_text("first")
        with whole_file("a.txt") as second:
            second.write_text("second")
        assert Path("a.txt").read_text() == "second"
        assert first.read_text() == "first"
    assert Path("a.txt").read_text() == "first"
    assert [path.name for path in Path().iterdir()] == ["a.txt"]


def test_threads_that_save_to_one_path_always_leave_a_whole_file(sol: pc.Solution) -> None:
    other = pc.simulate(BOOK.scene, q0=[-1, -1], t_span=(0, 20))
    lengths = {len(sol.t), len(other.t)}
    sol.save("a.npz")
    failures: list[BaseException] = []
    begin = threading.Barrier(4)

    def save_and_load(one: pc.Solution) -> None:
        try:
            begin.wait()
            for _ in range(10):
                one.save("a.npz")
                assert len(pc.load("a.npz").t) in lengths
        except BaseException as failure:
            failures.append(failure)

    threads = [threading.Thread(target=save_and_load, args=[x]) for x in 2 * [sol, other]]
    for one in threads:
        one.start()
    for one in threads:
        one.join()
    assert failures == []
    assert [path.name for path in Path().iterdir()] == ["a.npz"]


@pytest.mark.parametrize("stem", ["a" * 246, "é" * 123, "摆" * 82], ids=["1", "2", "3"])
def test_a_name_as_long_as_the_system_takes_can_be_written(stem: str, sol: pc.Solution) -> None:
    sol.save(f"{stem}.npz")
    assert np.array_equal(pc.load(f"{stem}.npz").y, sol.y)
