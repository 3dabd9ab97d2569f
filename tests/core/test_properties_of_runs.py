"""Ordinary runs, drawn by hypothesis: watched or not they are the same, by any method alike.

What any run at all keeps, python_api/test_fuzz.py has.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_motions import at_fifths, motions, stopped_motions
from fuzz.drawn_run import Drawn
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from pendcore import _core
from sweeps import random_examples

METHODS = [method["name"] for method in _core.methods() if method["error_order"]]

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")


@given(
    run=motions(),
    method=st.sampled_from(METHODS),
    shares=st.lists(st.floats(0, 1), min_size=1, max_size=8, unique=True).map(sorted),
    ledger=st.booleans(),
)
def test_being_watched_changes_no_bit(run, method, shares, ledger) -> None:
    """A run takes the same steps sampled, stored in any form, with a ledger or a progress bar."""
    run.options |= {"method": method}
    times = np.unique(np.array(shares) * run.t_span[1])
    plain, end = run.simulate(store="steps"), run.simulate(store="end")
    seen: list[float] = []
    sampled = run.simulate(t_eval=times, ledger=ledger, progress=seen.append)
    both = run.simulate(t_eval=times, store="dense")
    dense = run.simulate(ledger=not ledger)
    assert np.array_equal(dense.t, plain.t)
    assert np.array_equal(dense.y, plain.y)
    assert np.array_equal(sampled.t, times)
    assert np.array_equal(sampled.y, dense(times))
    assert np.array_equal(both.y, sampled.y)
    for other in (sampled, end):
        assert np.array_equal(other._run.y_reached, plain.y[:, -1])
    for other in (sampled, end, dense):
        assert other.stats.accepted == plain.stats.accepted
        assert other.stats.rejected == plain.stats.rejected
    if "dop853" not in plain.method:  # its dense output asks for right-hand sides of its own
        assert end.stats == both.stats == plain.stats


@settings(max_examples=random_examples(150))
@given(run=stopped_motions())
def test_all_methods_agree_on_motions_with_stops(run: Drawn) -> None:
    """The motions are regular: started 1e-8 aside, they stay near, as none grazing a stop does."""
    wanted = at_fifths(run)
    for beside in (1e-8, -1e-8):
        moved = replace(run, qd0=[qd + beside for qd in run.qd0])
        assume(np.abs(at_fifths(moved) - wanted).max() < 1e-6)
    for method in METHODS:
        found = at_fifths(run, method=method)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6, err_msg=method)
