"""Two rods of which one is next to nothing: in mass, in length; the slow motion's own period.

The limits follow from M x'' = -K x about where they hang, in terms of the first rod:
M = [[1/3 + m, mL/2], [mL/2, mL^2/3]] and K = g [[1/2 + m, 0], [0, mL/2]].
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain
from hybrid_chain import extrapolated_step
from mpmath import ellipk, sin

G = 9.807


def two(mass: float = 1.0, length: float = 1.0) -> pc.Scene:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=[pc.Link(mass=1, length=1), pc.Link(mass=mass, length=length)])


@pytest.mark.parametrize("ratio", [1e-12, 1e-6, 1e6, 1e12])
def test_extreme_ratios_of_mass_keep_energy_and_motion(ratio: float, fine: Any) -> None:
    """Large swings over the period of a slow small one, beside a dense matrix in NumPy."""
    chain = DenseChain(masses=np.array([1.0, ratio]), lengths=np.ones(2), gravity=G)

    def rates(_: float, y: Any) -> Any:
        forces = chain.forces(y[:2], y[2:], np.zeros(2))
        return np.append(y[2:], np.linalg.solve(chain.mass_matrix(y[:2]), forces))

    period = 2 * np.pi / np.sqrt((5 - np.sqrt(19)) * G)
    y, h = np.array([0.5, 1.2, 0, 0]), period / 100
    for _ in range(100):
        y = extrapolated_step(rates, 0.0, y, h)
    sol = pc.simulate(two(mass=ratio), q0=[0.5, 1.2], qd0=0, t_span=(0, period), **fine)
    np.testing.assert_allclose(sol.y[:, -1], y, atol=1e-9)
    energy = sol.energy()
    assert np.ptp(energy.total) < 1e-10 * energy.kinetic.max()


@pytest.mark.parametrize("sign", [1, -1])
def test_below_a_rod_without_mass_the_modes_are_five_more_or_less_the_root_of_19(
    sign: int, fine: Any
) -> None:
    """(1 - s)(1/2 - s/3) = s^2/4, or s^2 - 10 s + 6 = 0, for w^2 = s g/L."""
    s = 5 + sign * np.sqrt(19)
    amplitude, w = 1e-5, np.sqrt(s * G)
    shape = np.array([1.0, 2 * (1 - s) / s])
    times = np.linspace(0, 2 * np.pi / np.sqrt((5 - np.sqrt(19)) * G), 9)
    sol = pc.simulate(
        two(mass=1e12),
        q0=np.pi / 2 + amplitude * shape,
        qd0=0,
        t_span=(0, times[-1]),
        **fine | {"atol": 1e-16},
    )
    moved, rates = np.split(sol(times) / amplitude, 2)
    exact = shape[:, None] * np.cos(w * times)
    np.testing.assert_allclose(moved - np.pi / 2 / amplitude, exact, atol=1e-8)
    np.testing.assert_allclose(rates, -w * shape[:, None] * np.sin(w * times), atol=1e-7)


def test_a_rod_that_bears_next_to_nothing_swings_as_if_alone(fine: Any) -> None:
    amplitude = 2.0
    period = 4 * float(ellipk(sin(amplitude / 2) ** 2)) * np.sqrt(2 / (3 * G))
    sol = pc.simulate(
        two(mass=1e-12), q0=[np.pi / 2 - amplitude, 0.3], qd0=0, t_span=(0, period), **fine
    )
    assert sol.q[-1, 0] == pytest.approx(np.pi / 2 - amplitude, abs=1e-9)
    assert sol.qd[-1, 0] == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("length", "methods"),
    [
        (1e-12, ["radau5"]),  # the fast mode is 1e6 times as fast: steps for it are too many
        (1e-6, ["dopri5", "radau5", "dop853-radau5", "taylor-radau5"]),
        (1e6, ["dopri5", "radau5", "dop853-radau5", "taylor-radau5"]),
        pytest.param(1e12, ["radau5"], marks=pytest.mark.unsanitized),
    ],
)
def test_two_rods_of_which_one_is_next_to_a_point_swing_as_one(
    length: float, methods: list[str]
) -> None:
    """A short second one is a mass at the tip of the first, s = 9/8, along the force there.

    A short first one is a hinge of the second, s = 3/2, and hangs along half the force of it.
    """
    shape, s = ((1.0, 9 / 8), 9 / 8) if length < 1 else ((0.5, 1.0), 1.5 / length)
    amplitude, w = 1e-4, np.sqrt(s * G)
    times = np.linspace(0, 2 * np.pi / w, 9)
    for method in methods:
        sol = pc.simulate(
            two(length=length), q0=np.pi / 2 + amplitude * np.array(shape), qd0=0,
            t_span=(0, times[-1]), method=method, rtol=1e-10, atol=[1e-12] * 2 + [1e-12 * w] * 2,
        )  # fmt: skip
        moved = (sol(times)[:2] - np.pi / 2) / amplitude
        within = 3e-7 + 3 * min(length, 1 / length)
        np.testing.assert_allclose(moved, np.outer(shape, np.cos(w * times)), atol=within)
