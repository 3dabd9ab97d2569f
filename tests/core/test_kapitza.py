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


def multipliers(eps: float, w: float) -> NDArray[np.float64]:
    """Return the eigenvalues' magnitudes of the map over one period, by central differences."""
    shaking = pc.effects.Sinusoid(amplitude=eps, angular_frequency=w, phase=np.pi / 2)
    scene = pc.Scene(
        links=[pc.Link(mass=1.0, length=1.0)] * 2,
        gravity=1.0,
        effects=[pc.effects.DrivenPivot(y=shaking)],
    )
    period, small = 2 * np.pi / w, 1e-5
    # Angles of size 1 go with rates of size w; scaled in this way, the columns are of one size.
    scale = np.array([1.0, 1.0, w, w])

    def after(start: NDArray[np.float64]) -> NDArray[np.float64]:
        sol = pc.simulate(
            scene,
            q0=UPRIGHT + start[:2],
            qd0=start[2:],
            t_span=(0.0, period),
            rtol=1e-13,
            atol=1e-17 * scale,
            store="end",
        )
        return np.asarray(sol.y[:, -1])

    columns = [(after(d) - after(-d)) / (2 * small * scale) for d in np.diag(small * scale)]
    return np.sort(np.abs(np.linalg.eigvals(np.array(columns).T)))


@pytest.mark.parametrize(
    ("eps", "w", "inside"),
    [
        (0.02, 82.6393, (1.0, 1.001)),
        (0.05, 33.0639, (1.0, 1.001)),
        (0.08636, 100.0, (0.999, 1.0)),
        (0.08686, 50.0, (0.999, 1.0)),
        (0.09037, 20.0, (0.999, 1.0)),
    ],
    ids=[
        "lower, eps = 0.02",
        "lower, eps = 0.05",
        "upper, w = 100",
        "upper, w = 50",
        "upper, w = 20",
    ],
)
def test_the_border_of_stability_is_where_floquet_says(
    eps: float, w: float, inside: tuple[float, float]
) -> None:
    """The rods stay up a thousandth to one side of the border, and fall a thousandth to the other.

    At the lower border the frequency is varied, at the upper one the amplitude.
    """
    lower = inside[0] == 1.0
    stable, unstable = (
        multipliers(eps * (1 if lower else share), w * (share if lower else 1))
        for share in ((1.001, 0.999) if lower else (0.999, 1.001))
    )
    np.testing.assert_allclose(stable, 1, atol=2e-6)
    assert unstable[-1] > 1.001


def test_far_inside_it_stands_for_a_long_time_and_outside_it_falls_at_once() -> None:
    for w, falls in ((60.0, False), (20.0, True)):
        shaking = pc.effects.Sinusoid(amplitude=0.05, angular_frequency=w, phase=np.pi / 2)
        scene = pc.Scene(
            links=[pc.Link(mass=1.0, length=1.0)] * 2,
            gravity=1.0,
            effects=[pc.effects.DrivenPivot(y=shaking)],
        )
        sol = pc.simulate(
            scene, q0=[UPRIGHT + 0.01, UPRIGHT - 0.01], qd0=0.0, t_span=(0.0, 50.0), store="steps"
        )
        assert (np.abs(sol.q - UPRIGHT).max() > 1.0) == falls
