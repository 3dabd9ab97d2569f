"""A run whose energy drifts too far says so, and one at rest is not blamed for its last bits."""

from __future__ import annotations

from math import pi

import numpy as np
import pendcore as pc
import pytest
from pendcore._views.energy_drift import energy_drift

SCENE = pc.Scene.textbook()
ROD = pc.Scene(links=[pc.Link(mass=1, length=1)])
SAID = "too large to trust this run: tighten rtol and atol (or the step)"
COARSE = {"q0": 1, "t_span": (0, 5), "rtol": 1e-1, "atol": 1e-1}
LOOSE = {"q0": 1, "t_span": (0, 5), "method": "dopri5", "step": 0.3, "on_failure": "ignore"}
RUNS = {
    "coarse": (True, COARSE),
    "only the start was kept": (True, COARSE | {"t_eval": [0.0]}),  # the end that was reached tells
    "some of many times": (True, LOOSE | {"t_eval": np.linspace(0, 5, 10_001)}),
    "textbook": (False, {"q0": [pi / 4, pi / 3], "t_span": (0, 5)}),
    "rest": (False, {"q0": pi / 2, "t_span": (0, 1)}),
    "rest, upright": (False, {"q0": -pi / 2, "t_span": (0, 1)}),
    "rest, folded": (False, {"q0": [pi / 2, -pi / 2], "t_span": (0, 1)}),
    "next to rest": (False, {"q0": pi / 2 + 1e-7, "t_span": (0, 1)}),
}


@pytest.mark.every_value("case")
@pytest.mark.parametrize("case", RUNS)
def test_a_drift_of_the_energy_that_is_too_large_is_called_out_and_no_other(case):
    too_large, how = RUNS[case]
    run = pc.simulate(SCENE, **how)
    assert (SAID in repr(run)) == (SAID in run._repr_html_()) == too_large


def test_a_repr_says_when_it_looks_at_some_of_many_times():
    run = pc.simulate(SCENE, q0=0.3, t_span=(0, 1), t_eval=np.linspace(0, 1, 4001))
    assert "(of one time in 2)" in repr(run)


def test_a_run_of_which_only_moments_of_rest_were_kept_is_not_blamed():
    swing = pc.simulate(ROD, q0=0.3, t_span=(0, 5))
    t = np.linspace(1, 5, 200_001)
    back = t[np.abs(swing(t)[1]).argmin()]
    end = pc.simulate(ROD, q0=0.3, t_span=(0, back), store="end")
    assert abs(end.qd[-1, 0]) < 1e-4
    assert "too large" not in repr(end)


@pytest.mark.parametrize("gravity", [9.807, -9.807, 0.0])
def test_where_only_the_end_was_kept_the_total_energy_bounds_the_motion(gravity):
    scene = SCENE.replace(gravity=gravity)
    start = {"q0": [1, 2], "qd0": [3, 4], "t_span": (0, 50)}
    every = energy_drift(pc.simulate(scene, **start))
    bound = energy_drift(pc.simulate(scene, **start, store="end")).largest_kinetic
    assert every.largest_kinetic <= bound * (1 + 1e-6)
    assert bound < 2 * every.largest_kinetic
