"""A run whose energy drifts too far says so, and one at rest is not blamed for its last bits."""

from __future__ import annotations

from math import pi

import numpy as np
import pendcore as pc
import pytest
from pendcore._views.energy_drift import energy_drift

SCENE = pc.Scene.textbook()


def test_a_drift_of_the_energy_that_is_too_large_is_called_out():
    said = "too large to trust this run: tighten rtol and atol (or the step)"
    coarse = pc.simulate(pc.Scene.textbook(), q0=1, t_span=(0, 5), rtol=1e-1, atol=1e-1)
    assert said in repr(coarse)
    assert said in coarse._repr_html_()
    assert said not in repr(pc.Case.textbook().simulate())


@pytest.mark.parametrize("q0", [pi / 2, -pi / 2, [pi / 2, -pi / 2], pi / 2 + 1e-7])
def test_rest_is_trusted_to_its_last_bits(q0):
    assert "too large" not in repr(pc.simulate(SCENE, q0=q0, t_span=(0, 1)))


def test_a_drift_between_what_was_kept_is_called_out():
    """Only the start was kept of what was asked for: the end that was reached tells."""
    coarse = {"rtol": 1e-1, "atol": 1e-1}
    run = pc.simulate(pc.Scene.textbook(), q0=1, t_span=(0, 5), t_eval=[0.0], **coarse)
    assert "too large to trust this run" in repr(run)


def test_of_many_times_a_repr_looks_at_some():
    run = pc.simulate(SCENE, q0=0.3, t_span=(0, 1), t_eval=np.linspace(0, 1, 4001))
    assert "(of one time in 2)" in repr(run)
    kept = np.linspace(0, 5, 10_001)
    how = {"method": "dopri5", "step": 0.3, "t_eval": kept}
    loose = pc.simulate(pc.Scene.textbook(), q0=1, t_span=(0, 5), on_failure="ignore", **how)
    assert "too large to trust this run" in repr(loose)


def test_a_run_of_which_only_moments_of_rest_were_kept_is_not_blamed():
    rod = pc.Scene(links=[pc.Link(mass=1, length=1)])
    swing = pc.simulate(rod, q0=0.3, t_span=(0, 5))
    t = np.linspace(1, 5, 200_001)
    back = t[np.abs(swing(t)[1]).argmin()]
    end = pc.simulate(rod, q0=0.3, t_span=(0, back), store="end")
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
