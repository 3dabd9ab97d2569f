"""What docs/background/book_speed.md compares solves one case, and what it says is recorded."""

from __future__ import annotations

import json
import shutil
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
import pytest

DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS / "generators"))
import book_speed  # noqa: E402
from page_part import with_part  # noqa: E402

octave = pytest.mark.skipif(
    not shutil.which("octave-cli"),
    reason="Octave is not installed: sh setup/debian_packages.sh octave",
)


@pytest.fixture(scope="module")
def kept() -> dict[str, Any]:
    """Return the record that the last `make write PAGE=book_speed` wrote."""
    return json.loads((DOCS / "records/book_speed.json").read_text())


@octave
@pytest.mark.outside_build
def test_all_ways_solve_the_book_s_case(tmp_path: Path) -> None:
    pytest.importorskip("scipy")
    program = book_speed.begin_octave(tmp_path)
    try:
        looked = book_speed.looked_at(program, book_speed.solvers(book_speed.numpy_module()))
        for way in ("inline", "file", "shared"):
            assert float(program.ask(f"solve {way} 1e-3 1e-6")) > 0.0
            assert float(program.ask(f"call {way} 3")) > 0.0
    finally:
        program.close()
    assert {way for way, _ in looked} == {*book_speed.WAYS}
    for (_, tolerance), facts in looked.items():
        assert facts["error"] < 30 * float(tolerance)
        assert facts["right_hand_sides"] > 30
    for tolerance in book_speed.TOLERANCES:  # three forms of a function take the same steps
        counts = {
            looked[way, tolerance]["right_hand_sides"] for way in ("inline", "file", "shared")
        }
        assert len(counts) == 1


@pytest.mark.skipif(not shutil.which("g++"), reason="there is no g++")
@pytest.mark.outside_build
def test_the_program_of_the_header_answers(tmp_path: Path) -> None:
    program = book_speed.begin_cpp(tmp_path)
    try:
        assert float(program.ask("call 1000")) > 0.0
    finally:
        program.close()


def test_numpy_s_module_is_the_core_s_right_hand_side() -> None:
    q, qd = np.array([0.3, 0.9]), np.array([1.0, -2.0])
    core = pc.Scene.textbook().accelerations(0.0, q, qd)
    found = book_speed.numpy_module()["accelerations"](0.0, q, qd)
    np.testing.assert_allclose(found, core, rtol=1e-13)


@pytest.mark.parametrize("name", book_speed.TABLES)
def test_the_page_has_the_tables_of_the_record(name: str, kept: dict[str, Any]) -> None:
    page = (DOCS / "background/book_speed.md").read_text()
    assert with_part(page, f"book speed: {name}", book_speed.TABLES[name](kept)) == page
