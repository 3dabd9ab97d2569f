"""Whatever the method, the motion is the same, whether stops end a phase or not."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from drawn_motions import stopped_motions
from fuzz.drawn_run import Drawn
from hypothesis import assume, given, settings
from pendcore import _core

METHODS = [method["name"] for method in _core.methods() if method["error_order"]]

pytestmark = pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")


def at_five_times(run: Drawn, **changes: object) -> np.ndarray:
    sol = run.simulate(**changes)
    assert sol.success, sol.message
    return sol(np.linspace(*run.t_span, 6))


@settings(max_examples=150)
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
