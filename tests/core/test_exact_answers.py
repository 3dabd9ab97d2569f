"""The core agrees with the exact answers for one rod and two.

Two equal uniform rods of mass M and length L hang on a fixed pivot, unless a test says otherwise.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from numpy.testing import assert_allclose
from numpy.typing import ArrayLike, NDArray
from reference.newton_euler import uniform_rod
from reference.rig import Rig
from swings import time_to

TRUST = Path(__file__).parents[2] / "docs/background/trust.md"
M, L, G = 1.7, 0.6, 9.81
RIGHT, DOWN, UPRIGHT, LEFT = 0.0, np.pi / 2, -np.pi / 2, np.pi
SLOW, FAST = 3 - 6 / np.sqrt(7), 3 + 6 / np.sqrt(7)  # squared frequencies in g/L


def rods(*masses: float) -> pc.Scene:
    return pc.Scene(links=[pc.Link(mass=mass, length=L) for mass in masses], gravity=G)


TWO, ONE = rods(M, M), rods(M)
PASSES_DOWN = [pc.events.LinkAngle(link, DOWN) for link in (1, 2)]


def solve(
    scene: pc.Scene,
    q: ArrayLike,
    qd: ArrayLike,
    t_end: float,
    tolerance: float = 1e-13,
    **more: Any,
) -> pc.Solution:
    sol = pc.simulate(scene, (0.0, t_end), q, qd, rtol=tolerance, atol=1e-2 * tolerance, **more)
    assert sol.success
    return sol


def reactions(scene: pc.Scene, q: ArrayLike, qd: ArrayLike = 0.0) -> NDArray[np.float64]:
    """Return the forces on the links at one instant, in weights of a rod."""
    now = pc.simulate(scene, (0.0, 0.0), q, qd, store="steps")
    return np.asarray(now.reactions()[0] / (M * G))


# Two rods ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(("square", "known"), [(SLOW, 0.732213), (FAST, 5.267787)])
def test_modes_have_their_frequencies_hanging_and_as_growth_rates_upright(square, known) -> None:
    assert square == pytest.approx(known, abs=5e-7)
    w, amplitude = np.sqrt(square * G / L), 1e-5
    shape = np.array([1.0, 3 / square - 8 / 3])  # (K - w^2 M) x = 0 with w^2 = square g/L
    t = np.linspace(0, 20 / w, 200)
    sol = solve(TWO, DOWN + amplitude * shape, 0.0, t[-1], events=PASSES_DOWN)
    swing = sol(t)[:2] - DOWN
    # The linear answer leaves out the square of the amplitude, times the twenty radians.
    assert_allclose(swing / amplitude, np.outer(shape, np.cos(w * t)), rtol=0, atol=1e-7)
    for found in sol.events:  # the angles pass the vertical at the frequency
        times = w * np.array([one.t for one in found])
        assert_allclose(times, np.pi * (np.arange(6) + 0.5), rtol=0, atol=1e-7)
    t, start = np.linspace(0, 4 / w, 50), amplitude * shape
    fall = solve(TWO, UPRIGHT + start, w * start, t[-1])(t)[:2] - UPRIGHT
    assert_allclose(fall / np.outer(start, np.exp(w * t)), 1, rtol=0, atol=1e-5)


@pytest.mark.parametrize(
    ("q", "qdd", "forces"),
    [
        ([RIGHT, RIGHT], [9 / 7, -3 / 7], [(0, -2 / 7), (0, 1 / 14)]),
        ([RIGHT, LEFT], [9 / 7, 3 / 7], None),
        ([DOWN, DOWN], [0, 0], [(0, -2), (0, -1)]),  # each joint carries what hangs below
    ],
    ids=["horizontal", "folded", "hanging"],
)
def test_released_from_rest(q, qdd, forces) -> None:
    """Accelerations are in units of g/L, forces on the links in weights of a rod."""
    found = TWO.accelerations(0, q, [0, 0]) * L / G
    assert_allclose(found, qdd, rtol=1e-14, atol=1e-15)
    if forces:
        assert_allclose(reactions(TWO, q), forces, atol=1e-14)


def test_hanging_at_rest_it_stays() -> None:
    sol = solve(TWO, [DOWN, DOWN], 0.0, 10.0)
    assert np.abs(sol.q - DOWN).max() < 1e-13  # pi/2 is no double: the rods swing by its rounding


@pytest.mark.parametrize("tolerance", [1e-12, 1e-13])
def test_upright_at_rest_it_falls_from_where_the_start_rounds_to(tolerance: float) -> None:
    """The double next to -pi/2 is 6e-17 rad off, which takes 37/sqrt(3g/2L) to grow to 1 rad.

    The first steps round the angle to 2e-16 rad; this alone is a factor of e or so, or 0.2 s.
    """
    with mpmath.mp.workdps(40):
        off = mpmath.mpf(UPRIGHT) + mpmath.pi / 2
        theory = float(time_to(mpmath.pi - off - 1, mpmath.pi - off, G, L))
    marks = [pc.events.LinkAngle(1, UPRIGHT + side, terminal=True) for side in (1, -1)]
    how = {"rtol": tolerance, "atol": 1e-3 * tolerance, "events": marks}
    sol = pc.simulate(ONE, (0.0, 40.0), UPRIGHT, **how)
    assert sol.status == "event"
    assert sol.t[-1] == pytest.approx(theory, abs=0.5)


def test_upright_at_rest_it_stands_in_steps_too_short_for_any_push() -> None:
    """A step would move the rod by less than half a last bit; carried on, the pushes add up."""
    how = {"method": "dopri5", "rtol": 1e-13, "atol": 1e-20, "max_steps": 100_000}
    stands, falls = (
        pc.simulate(ONE, (0.0, 20.0), UPRIGHT, **how, compensated=carried).q[:, 0]
        for carried in (False, True)
    )
    assert set(stands) == {UPRIGHT}
    assert np.abs(falls - UPRIGHT).max() > 1
    assert "it stands for ever" in " ".join(TRUST.read_text().split())  # a known limit


@pytest.mark.parametrize("seed", range(20))
def test_a_start_too_low_never_flips(seed: int) -> None:
    random = np.random.default_rng(seed)
    height = 0.0
    while not 2 < height < 2.2:  # just below the limit, where a careless integrator would flip
        q = random.uniform(UPRIGHT, UPRIGHT + 2 * np.pi, 2)
        height = 3 * np.sin(q[0]) + np.sin(q[1])
    sol = solve(TWO, q, 0.0, 20.0, tolerance=1e-9)
    assert sol.q.min() > UPRIGHT
    assert sol.q.max() < UPRIGHT + 2 * np.pi


@pytest.mark.parametrize(("speed", "flips"), [(1.01, True), (0.99, False)])
def test_the_second_link_flips_just_over_the_pass_and_not_just_short_of_it(speed, flips) -> None:
    """At the pass, 3 sin q_1 + sin q_2 = 2, the second link stands on the hanging first one.

    There 7 x^2 - 6 x - 27 = 0 gives the squared growth rate in g/L; with the matching speed the
    links just come to rest.
    """
    square = (6 + np.sqrt(792)) / 14
    rate = np.sqrt(square * G / L)
    start = 1e-3 * np.array([square / 2 / (3 / 2 + 4 / 3 * square), 1])
    sol = solve(TWO, [DOWN, UPRIGHT] - start, speed * rate * start, 6 / rate)
    assert (sol.q[-1, 1] > UPRIGHT) == flips


def test_without_gravity_energy_and_angular_momentum_stay() -> None:
    bodies = [uniform_rod(1.0, 1.0), uniform_rod(2.0, 0.5)]
    scene = pc.Scene(links=[pc.Link(mass=b.mass, length=b.length) for b in bodies], gravity=0.0)
    sol = solve(scene, [0.0, 1.0], [3.0, -4.0], 10.0)
    states = list(zip(sol.q.tolist(), sol.qd.tolist(), strict=True))
    rig = Rig(bodies=bodies, gravity=0.0)
    kinetic = [rig.energy(0.0, q, qd).kinetic for q, qd in states]
    momentum = [rig.angular_momentum(q, qd) for q, qd in states]
    assert_allclose(kinetic, kinetic[0], rtol=1e-11)
    assert_allclose(momentum, momentum[0], rtol=1e-11)
    by_core = np.einsum("tij,tj->t", scene.mass_matrix(sol.q), sol.qd)
    assert_allclose(by_core, momentum, rtol=1e-13)


# One rod ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("amplitude", [0.01, 1.0, 2.0, 3.0, 3.1])
def test_one_rod_has_the_period_of_the_elliptic_integral(amplitude: float) -> None:
    quarters = float(time_to(0, amplitude, G, L)) * np.arange(13)
    sol = solve(ONE, DOWN - amplitude, 0.0, quarters[-1])
    q = (sol(quarters)[0] - DOWN) / amplitude
    assert_allclose(q, np.tile([-1, 0, 1, 0], 4)[:13], atol=1e-9)


def test_one_rod_dropped_from_horizontal_loads_the_pivot_with_mg_4_and_5mg_2() -> None:
    assert_allclose(reactions(ONE, [RIGHT]), [(0, -1 / 4)], atol=1e-15)
    below = solve(ONE, RIGHT, 0.0, float(time_to(0, np.pi / 2, G, L)))
    assert_allclose(below.reactions()[-1] / (M * G), [(0, -5 / 2)], atol=1e-11)


# Extreme parameters -----------------------------------------------------------------------------


@pytest.mark.parametrize("mass", [1e-6, 1e-9, 1e-12])
def test_a_light_link_leaves_the_other_a_single_rod_or_moves_as_a_massless_one(mass) -> None:
    t = np.linspace(0, 3, 31)
    single = solve(ONE, 0.3, 1.0, 3.0)(t)
    below = solve(rods(M, mass * M), [0.3, -0.8], [1.0, 2.0], 3.0)(t)
    assert np.abs(below[0] - single[0]).max() < 30 * mass + 1e-11
    light, none = (solve(rods(m, M), [0.9, 1.2], 0.0, 2.0)(t * 2 / 3) for m in (mass * M, 0.0))
    assert np.abs(light - none).max() < 100 * mass + 1e-10


def test_a_massless_first_link_passes_the_force_on_along_itself() -> None:
    scene, q, qd = rods(0.0, M), [0.4, 1.9], [2.0, -1.0]
    pivot, hinge = reactions(scene, q, qd)
    assert_allclose(pivot, hinge, rtol=1e-13)
    assert abs(hinge[0] * np.sin(q[0]) - hinge[1] * np.cos(q[0])) < 1e-14
    rig = Rig(bodies=[uniform_rod(0.0, L), uniform_rod(M, L)], gravity=G)
    exact = rig.motion(0, q, qd)
    assert_allclose(scene.accelerations(0, q, qd), exact.accelerations, rtol=1e-13)
