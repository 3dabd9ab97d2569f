"""The hard cases that every release passes have tests, and their page has its record."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import matplotlib.image
import pytest

ROOT = Path(__file__).parents[2]
sys.path.append(str(ROOT / "bench" / "compare"))

import compare_hard_cases  # noqa: E402
from hard_cases import figures, page  # noqa: E402
from hard_cases.case import Absent, Outcome, run_bounded  # noqa: E402
from hard_cases.cases import CASES, PROGRAMS  # noqa: E402
from hard_cases.listed import LISTED, missing  # noqa: E402

RECORD = ROOT / "docs/records/hard_cases.json"


def test_every_listed_case_has_its_tests() -> None:
    assert len(LISTED) > 25
    assert missing(ROOT) == []


def test_a_test_that_is_not_there_is_missed(tmp_path: Path) -> None:
    assert len(missing(tmp_path)) == len([test for tests in LISTED.values() for test in tests])


def test_the_written_page_is_what_the_record_says() -> None:
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    assert page.page(record) == (ROOT / "docs/background/hard_cases.md").read_text(encoding="utf-8")
    assert [case["name"] for case in record["cases"]] == [case.name for case in CASES]


def test_the_record_is_of_the_contenders_that_there_are() -> None:
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    recorded = {
        (case["name"], one["program"], one["how"])
        for case in record["cases"]
        for one in case["contenders"]
    }
    assert recorded == {
        (case.name, one.program, one.how) for case in CASES for one in case.contenders
    }


def test_the_figures_are_drawn_from_the_record_alone(tmp_path: Path) -> None:
    record = json.loads(RECORD.read_text(encoding="utf-8"))
    assert {case.name for case in CASES if case.figure} == set(figures.FIGURES)
    figures.draw(record, tmp_path)
    for name in figures.FIGURES:
        file = f"hard_cases_{name}.png"
        drawn, kept = (
            matplotlib.image.imread(folder / file) for folder in (tmp_path, ROOT / "docs/figures")
        )
        assert drawn.shape == kept.shape
        assert abs(drawn - kept).mean() < 0.01, name  # another font changes less than that


def case(**outcomes: tuple[float | None, bool]) -> dict[str, Any]:
    return {
        "name": "one", "title": "One case", "scene": "a", "answer": "b", "unit": "rad",
        "allowed": 1e-9,
        "contenders": [
            {
                "program": name, "how": "so", "own_loop": False, "said": "c", "error": error,
                "right": right,
            }
            for name, (error, right) in outcomes.items()
        ],
    }  # fmt: skip


def test_who_does_best_is_shown_and_who_is_right_is_bold() -> None:
    record = {"cases": [case(pendcore=(1e-12, True), scipy=(1e-3, False), mujoco=(None, False))]}
    (row,) = [line for line in page.glance(record).splitlines() if "One case" in line]
    assert row.split(" | ")[1:] == ["**1e-12 rad**", "1e-3 rad", "c", "not there |"]
    assert "pendcore 1, SciPy 0" in page.summary(record)
    record["cases"][0]["contenders"][0]["own_loop"] = True
    assert "**1e-12 rad** (own loop)" in page.glance(record)
    assert "pendcore 1 (1 by a loop of one's own)" in page.summary(record)
    assert "in pendcore alone: one case" in page.summary(record)


def test_whose_loop_was_not_run_is_told_in_the_table() -> None:
    one = case(pendcore=(1e-12, True), scipy=(1e-3, False)) | {"loop_not_run": ["scipy", "odeint"]}
    record = {"cases": [one]}
    (row,) = [line for line in page.glance(record).splitlines() if "One case" in line]
    assert row.split(" | ")[2:] == [
        "1e-3 rad (own loop: not run)", "not there", "not there (own loop: not run) |"
    ]  # fmt: skip
    unasked = "one case (no loop of one's own was run around SciPy and Boost.odeint)."
    assert f"in pendcore alone: {unasked}" in page.summary(record)
    one["contenders"][1]["right"] = True
    assert "**1e-3 rad** |" in page.glance(record)


def test_losses_are_told() -> None:
    wrong = {"cases": [case(pendcore=(1e-3, False), scipy=(1e-12, True))]}
    closer = {"cases": [case(pendcore=(1e-10, True), scipy=(1e-12, True))]}
    even = {"cases": [case(pendcore=(1e-12, True), scipy=(2e-13, True))]}
    assert "* One case: c." in page.losses(wrong)
    assert page.losses(closer) == ["* One case: 1e-10 rad here, 1e-12 rad in SciPy (so)."]
    assert page.losses(even) == ["* Nowhere."]
    said = {"cases": [case(pendcore=(None, True), scipy=(1e-12, True), mujoco=(None, True))]}
    assert page.losses(said) == ["* One case: no answer here (c), 1e-12 rad in SciPy (so)."]


def endless() -> Outcome:
    while True:
        pass


def wrong() -> Outcome:
    raise ArithmeticError("of the test")


def absent() -> Outcome:
    raise ImportError("nothing there")


def test_who_does_not_return_is_ended_and_who_fails_is_quoted() -> None:
    ended = run_bounded(endless, 1)
    assert ended.said.startswith("does not return")
    assert ended.right is False
    assert run_bounded(wrong).said == "ArithmeticError: of the test"
    with pytest.raises(Absent, match="nothing there"):
        run_bounded(absent)


@pytest.mark.outside_build
def test_a_case_is_run_written_and_drawn_again(tmp_path: Path) -> None:
    assert compare_hard_cases.main(["--only", "separatrix", "--output", str(tmp_path)]) == 0
    record = json.loads((tmp_path / "records/hard_cases.json").read_text(encoding="utf-8"))
    (found,) = record["cases"]
    own = [one for one in found["contenders"] if one["program"] == "pendcore"]
    assert own
    assert all(one["right"] for one in own)
    assert {one["program"] for one in found["contenders"]} <= set(PROGRAMS)
    written = tmp_path / "background/hard_cases.md"
    text = written.read_text(encoding="utf-8")
    assert "A swing next to the separatrix" in text
    written.unlink()
    assert compare_hard_cases.main(["--redraw", "--output", str(tmp_path)]) == 0
    assert written.read_text(encoding="utf-8") == text
