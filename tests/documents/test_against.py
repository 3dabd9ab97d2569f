"""What says whether a commit is slower: ratios of times, and which calls there still are."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).parents[2] / "bench"))

import against
import timed_calls
from against import Build, Comparison, Worker

NEVER_CALLED = Path("the folder of no build")


def test_the_ratios_are_those_of_the_least_times_and_of_the_medians_of_processes():
    """By hand: 2 / 1 and 6 / 2; half of 2 / 4, 6 / 1 and 6 / 2 lie between 1.75 and 4.5."""
    compared = Comparison("one step", old=[4.0, 1.0, 2.0], new=[2.0, 6.0, 6.0])
    assert (compared.ratio, compared.median) == (2.0, 3.0)
    assert str(compared).endswith("2.000   3.000  1.750 to 4.500 slower")


@pytest.mark.parametrize(
    ("old", "new", "slower"),
    [
        ([1.0, 1.0, 1.0], [1.06, 1.06, 1.06], True),
        ([1.0, 1.0, 1.0], [1.04, 1.04, 1.04], False),
        ([1.0, 1.0, 1.0], [1.00, 1.10, 1.10], False),  # by the median alone
        ([1.0, 1.0, 1.0], [1.06, 9.00, 1.06], True),
        ([0.9, 1.0, 1.0], [1.0, 1.0, 1.0], False),  # a lucky process of the old commit
        ([], [1.5], False),  # a call that a commit lacks
    ],
)
def test_a_call_is_slower_when_both_ratios_say_so(old, new, slower):
    compared = Comparison("one step", old=old, new=new)
    assert compared.is_slower is slower
    assert str(compared).endswith(" slower") is slower


class Recorded(Worker):
    """Gives one answer after the other, and writes down that it was asked."""

    def __init__(self, name, asked, *answers):
        self.name, self.asked, self.answers = name, asked, iter(answers)

    def microseconds(self, name, seconds):
        self.asked.append(self.name)
        return next(self.answers)

    def close(self):
        pass


def test_each_commit_is_first_in_every_other_turn_and_a_process_gives_its_least_time():
    asked = []
    one = Comparison("one step", [7.0], [8.0])
    old, new = Recorded("old", asked, 3, 1, 2, 4), Recorded("new", asked, 9, 3, 4, 2)
    against.in_turns(one, old, new, rounds=4, seconds=math.inf)
    assert asked == ["new", "old", "old", "new"] * 2
    assert (one.old, one.new) == ([7, 1], [8, 2])


def test_each_pair_of_processes_is_fresh_and_leaves_out_what_the_first_lacked(monkeypatch):
    asked = []
    begun = []

    def fresh(built):
        begun.append(built.commit)
        return Recorded(built.commit, asked, *(None if built.commit == "old" else 1.0,) * 2)

    monkeypatch.setattr(against, "Worker", fresh)
    builds = [Build(commit, NEVER_CALLED, 0.0) for commit in ("old", "new")]
    (one,) = against.in_pairs_of_processes(["one step"], *builds, 3, 30, 300.0)
    assert (begun, asked) == (["old", "new"] * 3, ["new", "old"])
    assert (one.old, one.new) == ([], [1.0])


@pytest.mark.parametrize("prepare", timed_calls.prepared_calls().values())
@pytest.mark.filterwarnings("ignore")
def test_this_build_has_every_call(prepare):
    prepare()()


def test_the_worker_answers_with_seconds_or_with_what_is_lacking():
    asked = '["one step", 0]\n["no such call", 0]\n'
    answers = subprocess.run(
        [sys.executable, timed_calls.__file__], input=asked, capture_output=True, text=True
    ).stdout.splitlines()
    assert Path(answers[0]).name == "__init__.py"
    assert 0 < float(answers[1]) < 1
    assert answers[2] == "- KeyError: 'no such call'"


def test_a_worker_that_loads_another_build_is_not_believed():
    with pytest.raises(SystemExit, match=r"0123456: the worker loads .*pendcore"):
        Worker(Build("0123456", NEVER_CALLED, 0.0))
