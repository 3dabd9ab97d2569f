"""Any run at all is bounded, what it reached is finite, and it says how it ended.

The claims are those of `fuzz.claims`. Here hypothesis looks for a run that breaks one, and makes it
small. It tries the same runs each time, because `make fuzz` looks further and survives a crash.
"""

from __future__ import annotations

import warnings

import numpy as np
import pendcore as pc
import pytest
from drawn_motions import any_runs, motions
from fuzz.choices import FromHypothesis
from fuzz.claims import ALWAYS, SOMETIMES, Claim
from fuzz.drawn_run import Drawn
from hypothesis import given, reject, settings
from hypothesis import strategies as st

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")


def solution(run: Drawn) -> pc.Solution:
    """Return the run's solution, or the one that an exception of the user's function brings."""
    try:
        return run.simulate()
    except Exception as raised:
        if not hasattr(raised, "solution"):
            reject()
        return raised.solution


@pytest.mark.parametrize("claim", [*ALWAYS, *SOMETIMES], ids=lambda claim: claim.__name__)
@settings(derandomize=True, max_examples=60)
@given(run=any_runs(), data=st.data())
def test_any_run_keeps_the_claims(claim: Claim, run: Drawn, data: st.DataObject) -> None:
    sol = solution(run)
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
    shares=st.lists(st.floats(0, 1), min_size=1, max_size=8, unique=True).map(sorted),
    ledger=st.booleans(),
)
def test_being_watched_changes_no_bit(run: Drawn, shares: list[float], ledger: bool) -> None:
    """A run takes the same steps sampled, stored in any form, with a ledger or a progress bar."""
    times = np.unique(np.array(shares) * run.t_span[1])
    plain = run.simulate(store="steps")
    seen: list[float] = []
    sampled = run.simulate(t_eval=times, ledger=ledger, progress=seen.append)
    dense = run.simulate(ledger=not ledger)
    assert np.array_equal(dense.t, plain.t)
    assert np.array_equal(dense.y, plain.y)
    assert np.array_equal(sampled.t, times)
    assert np.array_equal(sampled.y, dense(times))
    assert np.array_equal(sampled._run.y_reached, plain.y[:, -1])
