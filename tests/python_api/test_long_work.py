"""The search for joints of a long chain that hold takes long in one step; it can be stopped."""

from __future__ import annotations

import numpy as np
import pendcore as pc
from pendcore import effects as fx


def rubbed_chain(n: int) -> pc.Scene:
    rub = [fx.DryJointFriction(joint=j, coulomb=1.0) for j in range(1, n + 1)]
    return pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * n, effects=rub)


def test_a_run_is_broken_off_where_it_finds_out_which_joints_begin_to_slide():
    sol = pc.simulate(
        rubbed_chain(300), q0=0.3, t_span=(0, 1), time_limit=0.01, on_failure="ignore"
    )
    assert sol.status == "time_limit"
    assert sol.stats.nfev == 0  # no right-hand side of a step: the laws come first
    assert sol.t.tolist() == [0.0]
    assert np.isfinite(sol.y).all()


def test_a_run_that_is_broken_off_anywhere_goes_on_to_the_same_bits():
    scene, span = rubbed_chain(150), (0.0, 0.02)
    whole = pc.simulate(scene, q0=0.3, t_span=span)
    assert whole.status == "finished"
    limit = 2e-4
    sol = pc.simulate(scene, q0=0.3, t_span=span, time_limit=limit, on_failure="ignore")
    stops = 0
    while sol.status != "finished":
        assert sol.status == "time_limit"
        stops += 1
        limit *= 1.3  # what begins anew each time is to get through in the end
        sol = sol.resume(span[1], time_limit=limit, on_failure="ignore")
    assert stops > 3
    assert np.array_equal(sol.t, whole.t)
    assert np.array_equal(sol.y, whole.y)
