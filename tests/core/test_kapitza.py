"""Two rods upright on a pivot that shakes up and down are stable between two borders.

The borders are those of the linear equations, in units where the rods' mass, their length and
gravity are 1; w is the angular frequency of the shaking, eps its amplitude. Whether a drive is
stable is read from the Floquet multipliers: what one period of the drive makes of small starts.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from numpy.typing import NDArray

UPRIGHT = -np.pi / 2


def shaken(eps: float, w: float) -> pc.Scene:
    shaking = pc.effects.Sinusoid(amplitude=eps, angular_frequency=w, phase=np.pi / 2)
    pivot = pc.effects.DrivenPivot(y=shaking)
    return pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * 2, gravity=1.0, effects=[pivot])


def multipliers(eps: float, w: float) -> NDArray[np.float64]:
    """Return the eigenvalues' magnitudes of the map over one period, by central differences."""
    scene, span, small = shaken(eps, w), (0.0, 2 * np.pi / w), 1e-5
    # Angles of size 1 go with rates of size w; scaled in this way, the columns are of one size.
    scale = np.array([1.0, 1.0, w, w])
    how = {"rtol": 1e-13, "atol": 1e-17 * scale, "store": "end"}

    def after(start: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(pc.simulate(scene, span, UPRIGHT + start[:2], start[2:], **how).y[:, -1])

    columns = [(after(d) - after(-d)) / (2 * small * scale) for d in np.diag(small * scale)]
    return np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))


@pytest.mark.parametrize(
    ("border", "eps", "w"),
    [
        ("lower", 0.02, 82.6393), ("lower", 0.05, 33.0639),
        ("upper", 0.08636, 100.0), ("upper", 0.08686, 50.0), ("upper", 0.09037, 20.0),
    ],
)  # fmt: skip
def test_the_border_of_stability_is_where_floquet_says(border: str, eps: float, w: float) -> None:
    """The rods stay up a thousandth to one side of the border, and fall a thousandth to the other.

    At the lower border the frequency is varied, at the upper one the amplitude.
    """
    if border == "lower":
        stable, unstable = (multipliers(eps, w * share) for share in (1.001, 0.999))
    else:
        stable, unstable = (multipliers(eps * share, w) for share in (0.999, 1.001))
    np.testing.assert_allclose(stable, 1, atol=2e-6)
    assert unstable[-1] > 1.001


@pytest.mark.parametrize(("w", "falls"), [(60.0, False), (20.0, True)])
def test_far_inside_it_stands_for_a_long_time_and_outside_it_falls_at_once(w, falls) -> None:
    sol = pc.simulate(shaken(0.05, w), (0.0, 50.0), [UPRIGHT + 0.01, UPRIGHT - 0.01], store="steps")
    assert (np.abs(sol.q - UPRIGHT).max() > 1.0) == falls
