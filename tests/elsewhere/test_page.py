"""The page of other machines shows the recorded hashes, and that every machine has them."""

from __future__ import annotations

import re
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_the_page_has_the_recorded_hashes_and_no_other() -> None:
    recorded = [line.rsplit(" ", 1) for line in
                (ROOT / "tests/cpp/trajectory_hash.txt").read_text().splitlines()]  # fmt: skip
    page = (ROOT / "docs/background/elsewhere.md").read_text()
    rows = re.findall(r"^\| (.+?) \| `(\w{16})` \| (.*) \|$", page, re.MULTILINE)
    assert [[name, value] for name, value, _ in rows] == recorded
    assert {cell for _, _, cells in rows for cell in cells.split(" | ")} == {"the same"}
