"""Derivatives of smooth runs, by all that their ends depend on, are those of many digits."""

from __future__ import annotations

import numpy as np
import pytest
from derivatives import smooth_runs
from derivatives.campaign import ALLOWED_IF_SMOOTH, judged_smooth

LONG_SWEEP = [*range(0, 60, 2), 1, 5, 7]


@pytest.mark.few_cases
@pytest.mark.parametrize("seed", LONG_SWEEP)
def test_a_random_run_has_its_derivatives(seed: int) -> None:
    """`make campaign OF=derivatives RUNS=smooth` has a thousand."""
    verdict = judged_smooth(seed)
    assert (verdict.kind, verdict.names) == ("right", 0), verdict


@pytest.mark.parametrize("column", [0, 5, -1])
def test_a_wrong_derivative_is_seen(column: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """A share of 3e-12 in any column is too much."""
    by_pendcore = smooth_runs.by_pendcore

    def spoilt(case: smooth_runs.SmoothCase) -> tuple[np.ndarray, np.ndarray, str]:
        end, columns, why = by_pendcore(case)
        size = max(np.abs(columns[:, column]).max(), np.abs(columns[:, : len(columns)]).max())
        columns[0, column] += 3 * ALLOWED_IF_SMOOTH * size
        return end, columns, why

    monkeypatch.setattr(smooth_runs, "by_pendcore", spoilt)
    assert judged_smooth(28).kind == "wrong"
