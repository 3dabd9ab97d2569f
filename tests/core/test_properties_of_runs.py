"""Any run at all is bounded, what it reached is finite, and it says how it ended.

The claims are those of `fuzz.claims`. Here hypothesis looks for a run that breaks one, and makes it
small. It tries the same runs each time, because `make campaign OF=fuzz` looks further and survives
a crash.
"""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np
import pendcore as pc
import pytest
from drawn_motions import any_runs, motions, stopped_motions
from fuzz.choices import FromHypothesis
from fuzz.claims import ALWAYS, SOMETIMES, Claim
from fuzz.drawn_run import Drawn
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st
from pendcore import _core
from sweeps import random_examples

METHODS = [method["name"] for method in _core.methods() if method["error_order"]]

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")


@pytest.mark.few_cases
@pytest.mark.parametrize("claim", [*ALWAYS, *SOMETIMES], ids=lambda claim: claim.__name__)
@settings(derandomize=True, max_examples=random_examples(60))
@given(run=any_runs(), data=st.data())
def test_any_run_keeps_the_claims(claim: Claim, run: Drawn, data: st.DataObject) -> None:
    """A user's function may raise; the exception then brings the solution so far."""
    try:
        sol = run.simulate()
    except Exception as raised:
        if not hasattr(raised, "solution"):
            reject()
        sol = raised.solution
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        try:
            breaches = list(claim(run, sol, FromHypothesis(data.draw)))
        except Exception as raised:
            if not hasattr(raised, "solution"):
                raise
            breaches = []
    assert not breaches


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


def at_five_times(run: Drawn, **changes: object) -> np.ndarray:
    sol = run.simulate(**changes)
    assert sol.success, sol.message
    return sol(np.linspace(*run.t_span, 6))


@settings(max_examples=random_examples(150))
@given(run=stopped_motions())
def test_all_methods_agree_on_motions_with_stops(run: Drawn) -> None:
    """The motions are regular: started 1e-8 aside, they stay near, as none grazing a stop does."""
    wanted = at_five_times(run)
    for beside in (1e-8, -1e-8):
        moved = replace(run, qd0=[qd + beside for qd in run.qd0])
        assume(np.abs(at_five_times(moved) - wanted).max() < 1e-6)
    for method in METHODS:
        found = at_five_times(run, method=method)
        np.testing.assert_allclose(found, wanted, rtol=0, atol=1e-6, err_msg=method)
