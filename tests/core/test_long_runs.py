"""What docs/background/long_runs.md says, in fewer steps: `make long` has all ten million."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.unsanitized
DOCS = Path(__file__).parents[2] / "docs"
sys.path.append(str(DOCS / "generators"))
import long_runs  # noqa: E402


@pytest.fixture(scope="module")
def kept() -> dict:
    """Return the record that the last `make long` wrote."""
    return json.loads((DOCS / "records/long_runs.json").read_text())


def test_over_half_a_million_steps_the_energy_keeps_to_the_methods_own_error():
    rounded, compensated = (long_runs.drift(500_000, c) for c in (False, True))
    assert compensated["of_kinetic"] < 5e-14  # a twentieth of 1e-12, for a twentieth of 1e7 steps
    assert rounded["of_kinetic"] > 1.2 * compensated["of_kinetic"]


def test_roundings_that_are_carried_on_walk_a_hundred_times_less_far():
    counts = [1_000, 10_000, 100_000]
    rounded, compensated = (
        (long_runs.walks(counts, 6, c) ** 2).mean(axis=0) ** 0.5 for c in (False, True)
    )
    assert (compensated < rounded / 100).all()
    # a bias would grow with the number of steps, here by 100
    assert compensated[-1] < 30 * compensated[0]


def test_time_is_the_sum_of_its_steps():
    time = long_runs.time_kept(1_000_000)
    assert time["steps"] == 1_000_000
    assert time["two_doubles"] < 1e-25
    assert time["one_double"] > 1e-10


def test_the_full_form_kept_what_the_page_promises(kept):
    assert kept["compensated"]["drift"]["steps"] >= 10_000_000
    assert kept["compensated"]["drift"]["of_kinetic"] < 1e-12
    assert kept["rounded"]["drift"]["of_kinetic"] > kept["compensated"]["drift"]["of_kinetic"]
    assert 0.4 < kept["compensated"]["slope"] < 0.65
    assert kept["steps"][-1] == 10_000_000
    assert kept["rounded"]["rms"][-1] > 500 * kept["compensated"]["rms"][-1]
    assert kept["time"]["two_doubles"] < 1e-25


def test_the_pages_tables_are_those_of_the_record(kept):
    assert long_runs.tables(kept) in (DOCS / "background/long_runs.md").read_text()
