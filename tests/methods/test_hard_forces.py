"""Forces that go wrong, ratios that are extreme, pulses narrower than steps, a thousand links."""

from __future__ import annotations

import warnings

import mpmath
import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain
from hybrid_chain import extrapolated_step
from pendcore import _core
from pendcore import effects as fx
from unit_rods import rod, time_of_rest

BOOK = pc.Scene.textbook()
G = BOOK.gravity


@pytest.mark.filterwarnings("ignore::pendcore.PendcoreWarning")  # coefficient < 0; the end
@pytest.mark.parametrize("rate", [1.0, -3.0, 1e-3])
def test_a_blow_up_ends_at_its_pole(rate):
    """W' = w^3: the pole is at 1/(2 w_0^2)."""
    scene = rod(fx.ViscousJoint(joint=1, damping=0, damping3=-1.0))
    pole = 1 / (2 * rate**2)
    sol = pc.simulate(scene, (0, 3 * pole), 0, rate, rtol=1e-12, atol=1e-14)
    assert sol.status in {"step_too_small", "non_finite"}
    assert not sol.success
    assert np.isfinite(sol.y).all()
    assert sol.t[-1] == pytest.approx(pole, rel=1e-10)
    before = np.linspace(0, 0.999 * pole, 20)
    exact = rate / np.sqrt(1 - 2 * rate**2 * before)
    np.testing.assert_allclose(sol(before)[1], exact, rtol=1e-8)


@pytest.mark.parametrize("beyond", ["an angle", "a time"])
@pytest.mark.parametrize("at", [0.5, 1.7])
def test_what_is_no_number_beyond_a_time_or_an_angle_ends_there(at, beyond):
    """A rod that turns freely at 1 rad/s, under a couple 0 sqrt(at - q) or 0 sqrt(at - t)."""

    def law(t, q, qd):
        with np.errstate(invalid="ignore"):
            return 0 * np.sqrt(np.array([at - (t if beyond == "a time" else q[0])]))

    sol = pc.simulate(rod(fx.User(law)), (0, 5), 0, 1, on_failure="ignore")
    assert sol.status == "non_finite"
    np.testing.assert_allclose(sol.y[:, -1], [sol.t[-1], 1], rtol=1e-9)
    assert sol.t[-1] == pytest.approx(at, abs=1e-6)
    assert sol.t[-1] <= at + np.spacing(at)


@pytest.mark.few_cases
@pytest.mark.parametrize("method", [method["name"] for method in _core.methods()])
@pytest.mark.parametrize("links", [1, 2, 3])
@pytest.mark.parametrize("rtol", [1e-9, 1.0, 1e30])
def test_what_a_fixed_step_keeps_is_finite_between_its_ends_as_well(method, links, rtol):
    """Rods under a damper far too strong for the step: the motion grows until it overflows."""
    times, ends = np.linspace(0, 30, 301), set()
    how = {"method": method, "step": 0.3, "rtol": rtol, "atol": rtol, "t_eval": times}
    for damping in 10 ** np.random.default_rng(8).uniform(0.5, 3, 60):
        damper = fx.ViscousJoint(joint=1, damping=damping)
        scene = pc.Scene(links=[pc.Link(mass=1, length=0.5)] * links, effects=[damper])
        sol = pc.simulate(scene, (0, 30), 0.4, 1.0, on_failure="ignore", **how)
        ends.add(sol.status)
        assert np.isfinite(sol.y).all(), (sol.status, sol.message)
    if method != "radau5":
        assert "non_finite" in ends


# Pulses -----------------------------------------------------------------------------------------

FRICTION = 0.5
RUBBED = fx.DryJointFriction(joint=1, coulomb=FRICTION)


def pulse(at, half, impulse=1.0):
    """A table with a triangular pulse from at - half to at + half."""
    knots = [-1.0, at - half, at, at + half, 2 * at + 10]
    peak = impulse / ((knots[3] - knots[1]) / 2)
    return fx.Motor(joint=1, table=fx.Table(t=knots, torque=[0, 0, peak, 0, 0]))


@pytest.mark.parametrize("half", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("at", [1.0, 10.0])
def test_a_narrow_pulse_of_a_table_gives_a_turning_rod_its_impulse(at, half, method):
    last_bits = 1e-13 + 4 * np.spacing(at) / half  # by the last bits of the times within the pulse
    # a finer tolerance would ask for more than these bits can give
    how = {"method": method, "rtol": max(1e-9, last_bits)}
    sol = pc.simulate(rod(pulse(at, half)), (0, 2 * at), 0, 0.1, **how)
    assert sol.status == "finished"
    assert sol.stats.accepted < 30
    np.testing.assert_allclose(sol.y[:, -1], [0.1 * 2 * at + at, 1.1], rtol=last_bits)


def test_pulses_of_both_signs_move_a_rod_a_step_and_leave_it_there(method):
    """A table has two pulses within one long step; without either, the rod is elsewhere."""
    there_and_back = [pulse(3.0, 1e-6), pulse(7.0, 1e-6, -1.0)]
    sol = pc.simulate(rod(*there_and_back), (0, 12), 0, method=method)
    assert sol.status == "finished"
    assert sol.q[-1, 0] == pytest.approx(4.0, rel=1e-12)
    assert sol.qd[-1, 0] == pytest.approx(0, abs=1e-13)


def slide(half, impulse):
    """How far a pulse knocks a rod that friction holds, and how long it slides after the middle.

    Only the part of the pulse above friction counts, which is a triangle again. Friction slows the
    rod down in the last part of the pulse and afterwards.
    """
    peak = impulse / half
    above = half * (1 - FRICTION / peak)  # half the time for which the pulse exceeds friction
    gained = above * (peak - FRICTION)
    tail = half - above
    speed = gained - FRICTION * tail / 2
    assert speed > 0
    way = gained * above + gained * tail - FRICTION * tail**2 / 6
    return way + speed**2 / (2 * FRICTION), half + speed / FRICTION


ORDINARY = [(0.1, 0.2), (1e-2, 0.1), (1e-2, 1e-2)]
# From one time to the next the torque changes by more than the rounding of its limit.
WITHIN_LAST_BITS = [(1e-3, 0.1), (1e-4, 0.01), (1e-6, 1), (3e-7, 1), (3e-8, 1)]
PULSES = [(at, *of) for at in (1.0, 10.0) for of in ORDINARY + WITHIN_LAST_BITS]
PULSES += [(1000.0, *of) for of in ORDINARY]


@pytest.mark.parametrize(("at", "half", "impulse"), PULSES)
def test_a_narrow_pulse_of_a_table_knocks_a_stuck_rod_as_far_as_friction_lets_it(
    at, half, impulse, method
):
    last_bits = 8 * np.spacing(at) / half
    how = {"method": method, "rtol": max(1e-12, last_bits), "atol": 1e-14}
    sol = pc.simulate(rod(pulse(at, half, impulse), RUBBED), (0, 2 * at + 2), 0, **how)
    assert sol.status == "finished"
    assert sol.stats.accepted < 60
    way, past = slide(half, impulse)
    assert sol.q[-1, 0] == pytest.approx(way, rel=1e-9 + last_bits)
    assert time_of_rest(sol) == pytest.approx(at + past, abs=1e-10 + last_bits)
    release = at - half * (1 - FRICTION * half / impulse)
    assert not sol.y[:, sol.t < release - 1e-10].any()


@pytest.mark.few_cases
@pytest.mark.parametrize(("half", "how"), [(0.05, {}), (1e-3, {"max_step": 5e-4})])
def test_a_narrow_pulse_of_ones_own_knocks_a_stuck_rod_where_max_step_is_as_short(
    half, how, method
):
    """At rest steps are a hundredth of 1/w0 = 1 s; shorter pulses need max_step, as documented."""

    def blow(t, q, qd):
        return np.array([max(0.0, 0.2 / half * (1 - abs(t - 1) / half))])

    sol = pc.simulate(rod(fx.User(blow), RUBBED), (0, 1.5), 0, method=method, rtol=1e-9, **how)
    assert sol.status == "finished"
    way, past = slide(half, 0.2)
    assert sol.q[-1, 0] == pytest.approx(way, rel=1e-5)
    assert time_of_rest(sol) == pytest.approx(1 + past, abs=1e-5)


# Ratios -----------------------------------------------------------------------------------------
# The limits follow from M x'' = -K x about where the rods hang, in terms of the first one:
# M = [[1/3 + m, mL/2], [mL/2, mL^2/3]] and K = g [[1/2 + m, 0], [0, mL/2]].

PERIOD = 2 * np.pi / np.sqrt((5 - np.sqrt(19)) * G)


def two(mass=1.0, length=1.0):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        return pc.Scene(links=[pc.Link(mass=1, length=1), pc.Link(mass=mass, length=length)])


@pytest.mark.few_cases
@pytest.mark.parametrize("ratio", [1e-12, 1e-6, 1e6, 1e12])
def test_extreme_ratios_of_mass_keep_energy_and_motion(ratio, fine):
    """Large swings over the period of a slow small one, beside a dense matrix in NumPy."""
    chain = DenseChain(masses=np.array([1.0, ratio]), lengths=np.ones(2), gravity=G)

    def rates(_, y):
        forces = chain.forces(y[:2], y[2:], np.zeros(2))
        return np.append(y[2:], np.linalg.solve(chain.mass_matrix(y[:2]), forces))

    y = np.array([0.5, 1.2, 0, 0])
    for _ in range(100):
        y = extrapolated_step(rates, 0.0, y, PERIOD / 100)
    sol = pc.simulate(two(mass=ratio), (0, PERIOD), [0.5, 1.2], **fine)
    np.testing.assert_allclose(sol.y[:, -1], y, atol=1e-9)
    energy = sol.energy()
    assert np.ptp(energy.total) < 1e-10 * energy.kinetic.max()


SWITCHING = ["dopri5", "radau5", "dop853-radau5", "taylor-radau5"]


@pytest.mark.parametrize(
    ("length", "methods"),
    [
        (1e-12, ["radau5"]),  # the fast mode is 1e6 times as fast: steps for it are too many
        (1e-6, SWITCHING),
        (1e6, SWITCHING),
        pytest.param(1e12, ["radau5"], marks=pytest.mark.unsanitized),
    ],
)
def test_two_rods_of_which_one_is_next_to_a_point_swing_as_one(length, methods):
    """A short second one is a mass at the tip of the first, s = 9/8, along the force there.

    A short first one is a hinge of the second, s = 3/2, and hangs along half the force of it.
    """
    shape, s = ((1.0, 9 / 8), 9 / 8) if length < 1 else ((0.5, 1.0), 1.5 / length)
    amplitude, w = 1e-4, np.sqrt(s * G)
    times = np.linspace(0, 2 * np.pi / w, 9)
    start = np.pi / 2 + amplitude * np.array(shape)
    how = {"rtol": 1e-10, "atol": [1e-12] * 2 + [1e-12 * w] * 2}
    for method in methods:
        sol = pc.simulate(two(length=length), (0, times[-1]), start, method=method, **how)
        moved = (sol(times)[:2] - np.pi / 2) / amplitude
        within = 3e-7 + 3 * min(length, 1 / length)
        np.testing.assert_allclose(moved, np.outer(shape, np.cos(w * times)), atol=within)


@pytest.mark.parametrize("ratio", [1e3, 1e6])
def test_a_payload_of_a_million_links_swings_as_a_pendulum_on_a_string(ratio):
    """The slow mode of two rods and what hangs below them, from the linearised equations.

    The fast one is sqrt(3 ratio g/L); for ratio -> inf the slow one is sqrt(g/2L).
    """
    a = np.array([1.5 + ratio, 0.5 + ratio])
    m = np.array([[4 / 3 + ratio, 0.5 + ratio], [0.5 + ratio, 1 / 3 + ratio]])
    squares, modes = np.linalg.eig(np.linalg.solve(m, np.diag(a) * G))
    slow, fast = np.argsort(squares)
    assert squares[fast] == pytest.approx(3 * ratio * G, rel=0.02)
    assert squares[slow] == pytest.approx(G / 2, rel=1 / ratio)
    amplitude, period = 1e-3, 2 * np.pi / np.sqrt(squares[slow])
    start = np.pi / 2 + amplitude * modes[:, slow] / modes[0, slow]
    scene = BOOK.replace(effects=[fx.Payload(mass=ratio)])
    sol = pc.simulate(scene, (0, period), start, rtol=1e-10, atol=1e-13, store="end")
    assert sol.success
    # to the second order of the amplitude
    np.testing.assert_allclose(sol.q[-1], start, atol=amplitude**2)


def test_a_chain_of_a_thousand_links_keeps_its_energy():
    """It hangs in the shape of its slowest mode, J_1(2 w sqrt(x/g))/sqrt(x) from the free end."""
    n, g, length = 1000, 9.81, 10.0
    scene = pc.Scene(links=[pc.Link(mass=1e-3, length=length / n)] * n, gravity=g)
    w = float(mpmath.besseljzero(0, 1)) / 2 * np.sqrt(g / length)
    below = length * (1 - (np.arange(n) + 0.5) / n)
    slope = [float(mpmath.besselj(1, 2 * w * np.sqrt(x / g)) / np.sqrt(x)) for x in below]
    shape = np.array(slope) / max(slope)
    amplitude, t_end = 1e-3, 0.3
    sol = pc.simulate(scene, (0, t_end), np.pi / 2 + amplitude * shape, rtol=1e-9)
    assert sol.success
    energy = sol.energy().total
    assert np.ptp(energy) < 1e-14 * np.abs(energy).max()  # rounding
    # what a mode of links has that one of a chain has not starts at the free end, and goes up
    moved = (sol.q[-1] - np.pi / 2) / amplitude
    assert np.cos(w * t_end) < 0.94
    np.testing.assert_allclose(moved[: n // 2], shape[: n // 2] * np.cos(w * t_end), atol=1e-7)
    np.testing.assert_allclose(moved, shape * np.cos(w * t_end), atol=3e-4)
