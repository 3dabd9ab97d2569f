"""What docs/background/long_runs.md says, in fewer steps than `make write PAGE=long_runs` takes."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

sys.path.append(str(Path(__file__).parents[2] / "docs/generators"))
import long_runs

pytestmark = pytest.mark.unsanitized


def test_over_half_a_million_steps_the_energy_keeps_to_the_methods_own_error():
    rounded, compensated = (long_runs.drift(500_000, c)["of_kinetic"] for c in (False, True))
    assert compensated < 5e-14  # a twentieth of 1e-12, for a twentieth of 1e7 steps
    assert rounded > 1.2 * compensated


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
