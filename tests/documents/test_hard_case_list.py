"""The hard cases that every release passes have tests, and their page has its record."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "bench" / "compare"))

import compare  # noqa: E402
import hard_case_figures  # noqa: E402
import hard_case_tables  # noqa: E402
import hard_cases  # noqa: E402
import pages  # noqa: E402
from hard_case_tables import PROGRAMS, missing  # noqa: E402
from hard_cases.outcome import Absent, run_bounded  # noqa: E402
from record import Record  # noqa: E402

RECORD = Record.read(ROOT / "docs/records/hard_cases.json")
TEMPLATE = pages.TEMPLATES / "hard_cases.md"


def test_every_listed_case_has_its_tests(tmp_path):
    assert missing(TEMPLATE, ROOT / "tests") == []
    assert len(missing(TEMPLATE, tmp_path)) > 60


def test_the_record_has_every_contender_of_every_case():
    assert [*RECORD.cases] == [*hard_cases.CASES]
    for name, case in hard_cases.CASES.items():
        rows = {(who, row["setting"]) for who in PROGRAMS for row in RECORD.points(who, name)}
        assert rows == {(program, how) for program, how, _ in case["contenders"]}
        assert ("figure" in case) == (name in hard_case_figures.FIGURES)


RIGHT, WRONG = (1e-12, True), (1e-3, False)
ALONE = {"title": "One case", "scene": "a", "answer": "b", "unit": "rad", "allowed": 1e-9}
ALONE |= {"figure": "", "loop_not_run": ()}


@pytest.mark.parametrize(
    ("own", "peer", "told"),
    [
        (WRONG, RIGHT, "* One case: c."),
        ((1e-10, True), RIGHT, "* One case: 1e-10 rad here, 1e-12 rad in SciPy (so)."),
        (RIGHT, (2e-13, True), "* Nowhere."),
        ((None, True), RIGHT, "* One case: no answer here (c), 1e-12 rad in SciPy (so)."),
    ],
)
def test_losses_are_told(own, peer, told):
    of_all = {"case": "one", "setting": "so", "said": "c", "own_loop": False}
    both = [("pendcore", *own), ("scipy", *peer)]
    rows = [of_all | {"contender": name, "error": x, "right": ok} for name, x, ok in both]
    assert told in hard_case_tables.losses(Record.of({}, {}, {"one": ALONE}, rows))


def endless():
    while True:
        pass


def wrong():
    raise ArithmeticError("of the test")


def absent():
    raise ImportError("nothing there")


def test_who_does_not_return_is_ended_and_who_fails_is_quoted():
    ended = run_bounded(endless, 1)
    assert ended.said.startswith("does not return")
    assert ended.right is False
    assert run_bounded(wrong).said == "ArithmeticError: of the test"
    with pytest.raises(Absent, match="nothing there"):
        run_bounded(absent)


@pytest.mark.outside_build
def test_a_case_is_run_and_written_beside_those_that_are_recorded(tmp_path):
    RECORD.write(tmp_path / "records/hard_cases.json")
    assert compare.main(["--only", "separatrix", "--output", str(tmp_path)]) == 0
    found = Record.read(tmp_path / "records/hard_cases.json")
    assert [*found.cases] == [*RECORD.cases]
    own = found.points("pendcore", "separatrix")
    assert len(own) == 2
    assert all(row["right"] for row in own)
    assert found.points("scipy", "drift") == RECORD.points("scipy", "drift")
    page = (tmp_path / "background/hard_cases.md").read_text(encoding="utf-8")
    assert page == pages.page("hard_cases", found)
    assert len(list((tmp_path / "figures").glob("*.png"))) == len(hard_case_figures.FIGURES)
