"""Periodic orbits agree with elliptic integrals, with Floquet's theory and with many digits."""

from __future__ import annotations

import warnings
from fractions import Fraction

import mpmath
import numpy as np
import pendcore as pc
import pytest
from reference.taylor_series import RodChain, motion
from swings import period_of

E = pc.effects
TEXTBOOK = pc.Scene.textbook()
ROD = TEXTBOOK.replace(links=[pc.Link(mass=1.0, length=1.0)])


def turn(rate):
    """The time of a whole turn of a rod that passes hanging at a rate above that to upright."""
    k = mpmath.sqrt(6 * mpmath.mpf(ROD.gravity)) / mpmath.mpf(rate)
    return 4 * mpmath.ellipk(k**2) / mpmath.mpf(rate)


def off(orbit, period):
    with mpmath.workdps(40):
        return abs(float(mpmath.mpf(orbit.period) - period))


@pytest.mark.parametrize("theta", [1e-3, 0.1, 0.5, 1.0, 1.57, 2.5, 3.0, 3.13])
def test_a_rod_swings_with_the_period_of_the_elliptic_integral(theta):
    orbit = pc.periodic_orbit(ROD, [np.pi / 2 - theta])
    theta_found = np.arccos(-orbit.energy / (ROD.gravity / 2))
    assert off(orbit, period_of(theta, ROD.gravity)) <= orbit.period_error < 1e-9
    assert theta_found == pytest.approx(theta, rel=1e-6)
    np.testing.assert_array_equal(orbit.multipliers, [1, 1])


@pytest.mark.parametrize("rate", [7.9, 8.5, 12.0, 60.0])
@pytest.mark.parametrize("sign", [1, -1])
def test_a_rod_turns_over_in_the_time_of_the_elliptic_integral(rate, sign):
    orbit = pc.periodic_orbit(ROD, [np.pi / 2], [sign * rate])
    with mpmath.workdps(40):
        assert off(orbit, turn(rate)) <= orbit.period_error < 1e-11
    np.testing.assert_array_equal(orbit.turns, [sign])
    np.testing.assert_array_equal(orbit.multipliers, [1, 1])


def test_a_small_orbit_has_the_frequency_of_its_mode_and_the_square_of_its_size_beyond():
    for equilibrium in pc.equilibria(TEXTBOOK)[:3]:
        for mode, w in enumerate(equilibrium.frequencies, 1):
            sizes = (0.02, 0.01, 0.005)
            periods = [equilibrium.orbit(mode, amplitude=a).period for a in sizes]
            beyond = np.array(periods) - 2 * np.pi / w
            np.testing.assert_allclose(beyond[:-1] / beyond[1:], 4, rtol=1e-3)


def canonical(q):
    """(q, qd) to (q, p) of the textbook's rods, to first order in qd and at one q for all."""
    c = np.cos(q[0] - q[1]) / 2
    return np.array([[4 / 3, c], [c, 1 / 3]])


@pytest.mark.parametrize("which", [0, 1, 2])
def test_the_monodromy_is_symplectic_and_its_multipliers_pair(which):
    orbit = pc.equilibria(TEXTBOOK)[which].orbit(1, amplitude=0.3)
    pairs = orbit.multipliers[:, np.newaxis] * orbit.multipliers
    assert all(np.abs(row - 1).min() < 1e-9 for row in pairs)
    # dp = M dq' + (dM/dq dq) q': both parts, by the masses alone.
    (q1, q2), (w1, w2) = orbit.q0, orbit.qd0
    s = -np.sin(q1 - q2) / 2
    by_q = np.array([[s * w2, -s * w2], [s * w1, -s * w1]])
    to_p = np.block([[np.eye(2), np.zeros((2, 2))], [by_q, canonical(orbit.q0)]])
    carried = to_p @ orbit.monodromy @ np.linalg.inv(to_p)
    form = np.block([[np.zeros((2, 2)), np.eye(2)], [-np.eye(2), np.zeros((2, 2))]])
    size = np.abs(carried).max() ** 2
    assert np.abs(carried.T @ form @ carried - form).max() < 1e-12 * size
    assert orbit.multipliers.prod() == pytest.approx(1, rel=1e-9)


@pytest.mark.parametrize("torque", [0.5, 2.0, 8.0])
def test_liouville_the_multipliers_of_a_driven_rod_shrink_area_as_its_damping_does(torque):
    push = E.Sinusoid(amplitude=torque, angular_frequency=3.0)
    damper = E.ViscousJoint(joint=1, damping=0.4)
    scene = ROD.replace(effects=[E.Motor(joint=1, sinusoid=push), damper])
    late = pc.simulate(scene, (0, 2 * np.pi / 3 * 40), [np.pi / 2]).y[:, -1]
    orbit = pc.periodic_orbit(scene, late[:1], late[1:])
    assert orbit.is_forced
    assert orbit.period == 2 * np.pi / 3
    assert orbit.period_error == 0
    shrinks = np.exp(-0.4 / (1 / 3) * orbit.period)
    assert orbit.multipliers.prod() == pytest.approx(shrinks, rel=1e-11)
    assert orbit.is_stable == (torque < 8)
    if orbit.is_stable:
        np.testing.assert_allclose(late, [*orbit.q0, *orbit.qd0], atol=1e-5)


def test_a_rod_that_feeds_itself_has_a_cycle_whose_multiplier_is_the_integral_of_its_damping():
    """Tau = -(b w + c w^3), b < 0: areas shrink by exp(-int (b + 3 c w^2)/J dt), J = 1/3."""
    with warnings.catch_warnings(action="ignore"):  # a damping below 0 is allowed, and told
        scene = ROD.replace(effects=[E.ViscousJoint(joint=1, damping=-0.1, damping3=0.02)])
    late = pc.simulate(scene, (0, 100), [2.0], rtol=1e-12)
    orbit = pc.periodic_orbit(scene, late.q[-1], late.qd[-1])
    assert not orbit.is_forced
    times = np.linspace(0, orbit.period, 4097)[:-1]
    rates = orbit.solution(rtol=1e-13, t_eval=times).qd[:, 0]
    shrinks = np.exp(-3 * orbit.period * np.mean(-0.1 + 0.06 * rates**2))
    np.testing.assert_allclose(orbit.multipliers, [1, shrinks], rtol=1e-10)
    again = pc.periodic_orbit(scene, orbit.q0 + 0.3, orbit.qd0, orbit.period)
    assert abs(again.period - orbit.period) <= again.period_error + orbit.period_error


@pytest.mark.parametrize("stability", ["unstable", "stable"])
def test_nothing_depends_on_the_number_of_arcs(stability):
    one = pc.equilibria(TEXTBOOK)[2].orbit(1, amplitude=0.3)
    start = one.q0, one.qd0, one.period
    few, many = (pc.periodic_orbit(TEXTBOOK, *start, arcs=arcs) for arcs in (1, 5))
    (single,) = few.arcs
    names = ["q0[1]", "q0[2]", "qd0[1]", "qd0[2]"]
    run = pc.simulate(TEXTBOOK, (0, few.period), *np.split(single, 2), sensitivities=names)
    np.testing.assert_allclose(many.monodromy, run.sensitivities[-1], rtol=1e-6)
    np.testing.assert_allclose(many.multipliers, few.multipliers, rtol=1e-9)
    tubes = [x.manifold(stability, offset=1e-3) for x in (few, many)]
    for phase in (0.0, 0.37, 0.81):
        starts = np.array([tube.start(phase) for tube in tubes])
        away = starts - few.solution(rtol=1e-13)(phase * few.period)
        assert (np.abs(away).max(axis=1) > 1e-4).all()
        np.testing.assert_allclose(*(x / np.linalg.norm(x) for x in away), atol=1e-6)
        assert np.abs(away).max() < 5e-3  # a rate counts over 2 pi/period, as 4.8 here


@pytest.mark.parametrize(("eps", "w"), [(0.02, 82.6393), (0.05, 33.0639)])
def test_two_rods_stand_on_a_shaken_pivot_beyond_the_border(eps, w):
    """The border of the linear equations, in sqrt(g/L) (see tests/core/test_kapitza.py)."""

    def largest(frequency):
        pivot = E.DrivenPivot(y=E.Sinusoid(amplitude=eps, angular_frequency=frequency))
        scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)] * 2, gravity=1.0, effects=[pivot])
        orbit = pc.periodic_orbit(scene, [-np.pi / 2, -np.pi / 2])
        assert orbit.closure < 1e-13
        return np.abs(orbit.multipliers).max()

    assert largest(w * 1.0001) == pytest.approx(1, abs=1e-6)
    assert largest(w * 0.9999) > 1.0003


def many_digits(orbit, digits=36):
    """Newton's method in many digits on the orbit of two rods: (q0, qd0, T) and the first miss."""
    chain = RodChain([1.0, 1.0], [1.0, 1.0], TEXTBOOK.gravity)
    first = [*map(Fraction, [*orbit.q0, *orbit.qd0, orbit.period])]
    rates = [*first[2:4], *map(Fraction, TEXTBOOK.accelerations(0.0, orbit.q0, orbit.qd0))]
    around = [2 * Fraction(str(mpmath.pi)) * int(k) for k in orbit.turns] + [0, 0]

    def energy(y):
        (q1, q2), (w1, w2) = map(number, y[:2]), map(number, y[2:4])
        kinetic = w1**2 * 2 / 3 + w2**2 / 6 + w1 * w2 * mpmath.cos(q1 - q2) / 2
        return kinetic - TEXTBOOK.gravity * (3 * mpmath.sin(q1) + mpmath.sin(q2)) / 2

    def residual(y):
        (end,) = motion(chain, y[:2], y[2:4], [y[4]], digits)
        closes = [number(a - b - c) for a, b, c in zip(end, y[:4], around, strict=True)]
        phase = sum(number(f * (a - b)) for f, a, b in zip(rates, y[:4], first[:4], strict=True))
        return mpmath.matrix([*closes, phase, energy(y) - mpmath.mpf(orbit.energy)])

    y = list(first)
    for _ in range(3):
        here, little = residual(y), Fraction(1, 10**14)
        columns = []
        for i in range(5):
            moved = [x + little * (i == k) for k, x in enumerate(y)]
            columns.append((residual(moved) - here) / number(little))
        slopes = mpmath.matrix(6, 5)
        for i, column in enumerate(columns):
            slopes[:, i] = column
        step = mpmath.lu_solve(slopes, -here)
        y = [a + exactly(b) for a, b in zip(y, step, strict=True)]
    assert max(abs(x) for x in residual(y)[:4]) < mpmath.mpf(10) ** -20
    return [float(a - b) for a, b in zip(y, first, strict=True)]


def number(x):
    return mpmath.mpf(x.numerator) / x.denominator


def exactly(x):
    return Fraction(int(x * mpmath.mpf(2) ** 130), 2**130)


@pytest.mark.parametrize(
    "found",
    [
        lambda: pc.equilibria(TEXTBOOK)[0].orbit(2),  # its energy hardly tells its size
        lambda: pc.equilibria(TEXTBOOK)[1].orbit(1).continued("energy", -4.6)[-1],
        lambda: pc.equilibria(TEXTBOOK)[2].orbit(1).continued("energy", 12.0)[3],  # on its way
        lambda: pc.periodic_orbit(TEXTBOOK, [np.pi / 2] * 2, [12.0, 12.0]),
    ],
    ids=["down-down", "down-up", "up-down", "turning"],
)
def test_an_orbit_of_two_rods_is_as_far_from_that_in_36_digits_as_it_says(found):
    orbit = found()
    with mpmath.workdps(36):
        *state, period = many_digits(orbit)
    assert abs(period) <= orbit.period_error < 1e-12
    assert (np.abs(state) <= orbit.state_error).all()
    assert orbit.state_error.max() < 1e-11


@pytest.mark.parametrize(("which", "energy"), [(0, -10.0), (1, -4.6), (2, 12.0)])
def test_multipliers_are_those_of_differences_in_36_digits(which, energy):
    """The monodromy's error is that of a start that is rounded, as often as it grows."""
    mode = 2 if which == 0 else 1
    orbit = pc.equilibria(TEXTBOOK)[which].orbit(mode).continued("energy", energy)[-1]
    start = [*map(Fraction, [*orbit.q0, *orbit.qd0])]
    little, chain = Fraction(1, 10**14), RodChain([1.0, 1.0], [1.0, 1.0], TEXTBOOK.gravity)
    columns = []
    for i in range(4):
        moved = [[x + s * little * (i == k) for k, x in enumerate(start)] for s in (1, -1)]
        (here,), (there,) = (motion(chain, y[:2], y[2:], [orbit.period], 36) for y in moved)
        columns.append([(a - b) / (2 * little) for a, b in zip(here, there, strict=True)])
    with mpmath.workdps(36):
        matrix = mpmath.matrix([[number(x) for x in column] for column in columns])
        values = [complex(x) for x in mpmath.eig(matrix, left=False, right=False)]
    largest = np.abs(orbit.multipliers[0])
    for one in orbit.multipliers[[0, -1]]:
        off = np.abs(np.array(values) / one - 1).min()
        assert off < 1e-12 + 4e-15 * largest


def test_an_orbit_so_unstable_that_no_run_returns_is_cut_into_arcs():
    _, down_up, *_ = pc.equilibria(TEXTBOOK)
    orbit = down_up.orbit(1).continued("energy", 15.0)[-1]
    assert np.abs(orbit.multipliers[0]) > 1e5
    assert len(orbit.arcs) > 1
    assert orbit.closure < 1e-12 < np.abs(orbit.solution().y[:, -1] - orbit.arcs[0]).max()
    again = pc.periodic_orbit(TEXTBOOK, *np.hsplit(orbit.arcs + 1e-4, 2), orbit.period, energy=15.0)
    assert again.period == pytest.approx(orbit.period, abs=again.period_error + orbit.period_error)


with warnings.catch_warnings(action="ignore"):  # link 1 stays upright
    OFF_CENTRE = [pc.Link(mass=1.0, length=1.0, center=x) for x in (-2.0, 0.5)]
    UPRIGHT_AT_REST = TEXTBOOK.replace(links=OFF_CENTRE)
PUSHED = E.Motor(joint=1, sinusoid=E.Sinusoid(amplitude=1.0, angular_frequency=3.0))
SHAKEN = E.DrivenPivot(y=E.Sinusoid(amplitude=0.01, angular_frequency=3.0 * np.sqrt(2)))
DRIVEN, BOTH = (TEXTBOOK.replace(effects=effects) for effects in ([PUSHED], [PUSHED, SHAKEN]))
SPRUNG = TEXTBOOK.replace(effects=[E.TorsionalSpring(joint=1, stiffness=1.0)])
LOCKED = TEXTBOOK.replace(effects=[E.Lock(joint=2)])
RUBBING = TEXTBOOK.replace(effects=[E.DryJointFriction(joint=1, coulomb=0.5)])
STOPPED = ROD.replace(effects=[E.JointStop(joint=1, range=(-9, np.pi / 2), restitution=1.0)])
ZEROS, START = np.zeros((3, 2)), [0.6, 0.3]
REFUSED = [
    (TEXTBOOK, [0.5], {"period": -1}, ValueError, r"period = -1: must be finite and > 0 \(s\)"),
    (TEXTBOOK, [[0.5, 0.2], [3.0, -4.0], 1.1], {}, RuntimeError,
     "after 25 corrections it still fails to close by .* rad"),
    (ROD, [[-np.pi / 2 + 1e-5]], {"arcs": 1}, RuntimeError, r"fails to close by .*e-0[89] rad"),
    (TEXTBOOK, [np.pi / 2 + 1e-9], {"period": 1.7}, RuntimeError, "came to the equilibrium"),
    (TEXTBOOK, [START], {"energy": -20.0}, ValueError,
     r"energy = -20: must be > -19\.614 \(J\): links that hang"),
    (UPRIGHT_AT_REST, [START], {"energy": -15.0}, ValueError,
     r"energy = -15: must be > -14\.7105 \(J\)"),
    (DRIVEN, [0.5], {"period": 2.0}, ValueError, "must be a whole number of its periods"),
    (BOTH, [0.5], {}, ValueError, r"period = None: .* not the same after 1\.48096 s, the per"),
    (DRIVEN, [0.5], {"energy": 1.0}, ValueError, "does not keep its energy"),
    (SPRUNG, [0.5, [9.0, 9.0], 1.0], {"turns": 1}, ValueError,
     "a scene that has turned so is another one"),
    (TEXTBOOK, [ZEROS[:2], ZEROS, 1.0], {}, ValueError, "qd0: 3 rows: must be as many as q0 has"),
    (TEXTBOOK, [START], {"period": 2.6, "arcs": 1000}, ValueError, "arcs = 1000: must be 1 to 200"),
    (TEXTBOOK, [START], {"period": 2.6, "turns": [0, 0, 0]}, ValueError,
     r"turns: shape \(3,\): must be one number, or \(2,\)"),
    (LOCKED, [0.5], {"period": 2.5}, ValueError,
     r"scene: effect 1 \(lock\): the rate of a locked joint"),
    (STOPPED, [np.pi / 2, -1.0, 0.8], {}, RuntimeError,
     "has no derivative .*: joint 1 is at its stop, and"),
    (RUBBING, [START], {"period": 2.6}, RuntimeError,
     "has no derivative .*: joint 1 is at rest, where its fr"),
]  # fmt: skip


@pytest.mark.parametrize(("scene", "given", "how", "error", "told"), REFUSED)
def test_bad_input_and_what_is_not_found_are_told(scene, given, how, error, told):
    with pytest.raises(error, match=told):
        pc.periodic_orbit(scene, *given, **how)


@pytest.mark.parametrize("step", [np.inf, 0.0])
def test_impossible_steps_of_a_family_are_refused(step):
    with pytest.raises(ValueError, match=f"step = {step}: must be finite and > 0$"):
        pc.periodic_orbit(ROD, 0.5).continued("energy", until=-1.0, step=step)


@pytest.mark.parametrize("restitution", [0.3, 0.6])
def test_an_orbit_with_an_impact_is_where_long_runs_settle(restitution):
    """In each period, the damper takes exp(-c T/I) from the multipliers' product, the stop e^2."""
    push = E.Motor(joint=1, sinusoid=E.Sinusoid(amplitude=2.0, angular_frequency=4.6))
    stop = E.JointStop(joint=1, range=(-9, 1.8), restitution=restitution)
    scene = ROD.replace(effects=[push, E.ViscousJoint(joint=1, damping=0.05), stop])
    orbit = pc.periodic_orbit(scene, 1.4)
    product = restitution**2 * np.exp(-0.05 * 3 * orbit.period)
    assert abs(orbit.multipliers.prod()) == pytest.approx(product, rel=1e-11)
    assert orbit.is_stable
    settled = pc.simulate(scene, (0, 150 * orbit.period), 1.4, store="end", rtol=1e-12)
    np.testing.assert_allclose(settled.q[-1], orbit.q0, atol=1e-9)
    np.testing.assert_allclose(settled.qd[-1], orbit.qd0, atol=1e-8)
