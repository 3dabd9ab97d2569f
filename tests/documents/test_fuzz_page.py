"""The page of the random cases is what a full campaign left, and nothing in it failed."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest
from fuzz import campaign, claims, kept

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "background/fuzz.md"


@pytest.fixture(scope="module")
def record() -> dict[str, Any]:
    found: dict[str, Any] = json.loads((DOCS / "records/fuzz.json").read_text(encoding="utf-8"))
    return found


def test_a_hundred_thousand_cases_ran_and_none_failed(record: dict[str, Any]) -> None:
    assert record["cases"] >= 100_000
    assert sum(record["outcomes"].values()) == record["cases"]
    assert not {"crash", "hang", "broke"} & set(record["outcomes"])
    assert record["failed"] == len(record["failures"]) == 0
    assert 0 < record["longest"]["seconds"] < 20


def test_the_page_has_what_the_campaign_left(record: dict[str, Any]) -> None:
    text = PAGE.read_text(encoding="utf-8")
    assert kept.page_of(text, record) == text


def test_the_page_names_every_claim() -> None:
    text = PAGE.read_text(encoding="utf-8")
    always, sometimes = text.split("In every other case one of these")
    for told, listed in ((always, claims.ALWAYS), (sometimes, claims.SOMETIMES)):
        named = re.findall(r"^\| `(\w+)` \| [a-z]", told, re.MULTILINE)
        assert [claim.__name__ for claim in listed] == named


def test_a_campaign_writes_the_page_when_it_is_a_full_one(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    page, file = tmp_path / "page.md", tmp_path / "record.json"
    page.write_text(f"before\n{kept.BEGIN}old\n{kept.END}\nafter\n")
    asked = ["--cases", "6", "--seed", "page", "--output", str(tmp_path / "report.txt")]
    asked += ["--page", str(page), "--record", str(file)]
    assert campaign.main(asked) == 0
    assert "old" in page.read_text()
    assert not file.exists()
    monkeypatch.setattr(kept, "FULL", 6)
    assert campaign.main(asked) == 0
    text = page.read_text()
    assert "| cases | 6 |\n| failed | 0 |\n" in text
    assert text.startswith("before\n")
    assert text.endswith("after\n")
    assert json.loads(file.read_text())["seed"] == "page"


def test_failures_and_kinds_of_refusal_are_told() -> None:
    outcomes = {"finished": 5, "refused: a": 2, "refused: b": 1, "crash": 1}
    told = kept.tables(
        {
            "seed": "1", "cases": 9, "failed": 1, "failures": [7], "outcomes": outcomes,
            "longest": {"seconds": 1.25, "case": 3}, "seconds": 2.0, "workers": 1,
            "pendcore": "0", "date": "today",
        }
    )  # fmt: skip
    assert "| crashed or hung | 1 |" in told
    assert "| refused, with the reason (2 kinds) | 3 |" in told
    assert "Failed: cases 7." in told
