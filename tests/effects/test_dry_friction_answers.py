"""Dry friction that slides, on one rod: where it stops, when it stops, and when it never starts.

Without gravity unless a test says otherwise; J is the rod's moment of inertia about the pivot.
"""

from __future__ import annotations

from typing import Any

import mpmath  # type: ignore[import-untyped]
import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from test_effect_answers import J, rod


def friction(coulomb: float, static: float, velocity: float, exponent: float) -> Any:
    """Stribeck's law in joint 1."""
    return fx.DryJointFriction(
        1, coulomb, static=static, stribeck_velocity=velocity, exponent=exponent
    )


def assert_rests(sol: pc.Solution) -> None:
    assert sol.status == "at_rest"
    assert sol.success
    assert sol.qd[-1] == 0.0


def time_of_rest(sol: pc.Solution) -> float:
    """Return the time from which the rod rests: the last step goes from there to the end."""
    return float(sol.t[-2])


def time_to_stop(w0: float, law: Any) -> float:
    """The integral of J dw/friction(w) from 0 to w0."""
    velocity, exponent = law.stribeck_velocity, law.exponent

    def torque(w: Any) -> Any:
        peak = law.static - law.coulomb
        return law.coulomb + peak * mpmath.exp(-((w / velocity) ** exponent))

    # Dense where the friction changes; 40 Stribeck velocities on, the rest is constant.
    pieces = [0.0, *(velocity * x for x in (0.25, 0.5, 1, 2, 4, 10, 20, 40)), w0]
    pieces = sorted(x for x in pieces if x <= w0)
    return float(mpmath.quad(lambda w: J / torque(w), pieces))


@pytest.mark.parametrize("w0", [3.0, -3.0, 1e-3, 1e4])
@pytest.mark.parametrize("rtol", [1e-3, 1e-9, 1e-12])
def test_constant_friction_stops_the_rod_after_its_momentum_over_the_friction(
    w0: float, rtol: float, method: str
) -> None:
    """It takes its torque times the angle, all of the kinetic energy."""
    stop = J * abs(w0) / 0.4
    how = {"t_span": (0, 2 * stop), "rtol": rtol, "method": method, "ledger": True}
    sol = pc.simulate(rod(fx.DryJointFriction(1, coulomb=0.4)), q0=0.2, qd0=w0, **how)
    assert_rests(sol)
    assert time_of_rest(sol) == pytest.approx(stop, rel=1e-12)
    turned = sol.q[:, 0] - 0.2
    assert turned[-1] == pytest.approx(w0 * stop / 2, rel=1e-11)
    energy, lost = J * w0**2 / 2, sol.energy().ledger.dry
    np.testing.assert_allclose(lost, 0.4 * np.abs(turned), rtol=1e-12, atol=1e-16)
    assert lost[-1] == pytest.approx(energy, rel=1e-11)


@pytest.mark.few_cases
@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize(
    ("static", "velocity", "exponent"),
    [(0.8, 0.1, 2.0), (2.0, 0.01, 2.0), (2.0, 0.5, 1.0), (1.0, 0.1, 1.5)],
)
def test_with_stribecks_law_it_stops_a_little_sooner(
    static: float, velocity: float, exponent: float, rtol: float, method: str
) -> None:
    """A step over the last stretch, where friction rises, ends too late.

    At the finest tolerances it stops within 1e-10 with every method.
    """
    law = friction(0.4, static, velocity, exponent)
    how = {"t_span": (0, 10), "rtol": rtol, "atol": 1e-2 * rtol, "method": method}
    sol = pc.simulate(rod(law), q0=0.2, qd0=3.0, **how)
    assert_rests(sol)
    # radau5 keeps an estimate of order 3 below its tolerance, while its error is of order 5. The
    # tolerance is chosen such that the error falls as rtol, times a factor for the sharpness of the
    # law. The factor is 33 at the exponent 1.5, and below 3 in the other three cases.
    share = 100 if method == "radau5" else 3
    assert time_of_rest(sol) == pytest.approx(time_to_stop(3.0, law), rel=max(1e-11, share * rtol))


NARROW_PEAKS = [
    friction(coulomb, static, velocity, exponent)
    for velocity in (1e-3, 1e-6)
    for coulomb, static, exponent in [(0.1, 0.3, 2.0), (0.4, 2.0, 2.0), (0.1, 1.0, 1.0)]
]


def own_tolerance(method: str, rtol: float) -> float:
    """The bound below which a method keeps the estimate of its error, per rate.

    Under a smooth law the error of radau5 is far less than its estimate, and this bound aims at an
    error of rtol. A step that enters a peak of friction meets a corner, where both are of one size.
    """
    return 0.1 * rtol ** (2 / 3) if method == "radau5" else rtol


@pytest.mark.few_cases
@pytest.mark.parametrize("atol", [1e-12, None], ids=["atol=1e-12", "atol=rtol/100"])
@pytest.mark.parametrize("rtol", [1e-6, 1e-9, 1e-12])
@pytest.mark.parametrize("law", NARROW_PEAKS, ids=repr)
def test_a_peak_of_friction_that_is_far_narrower_than_the_run_is_not_strided_over(
    law: Any, rtol: float, atol: float | None, method: str
) -> None:
    """Where friction is constant no step errs: only the time under the peak is off by rtol.

    Beyond 36^(1/exponent) Stribeck velocities the peak is below the last bit, exp(-36). The step
    that enters it begins at a rate that is hundreds of times less than the first, and may err by
    rtol of that rate. Each step under the peak may err by atol as well; ten of them are allowed.
    """
    atol = 1e-2 * rtol if atol is None else atol
    stop = time_to_stop(1.0, law)
    under_the_peak = time_to_stop(law.stribeck_velocity * 36 ** (1 / law.exponent), law)
    how = {"method": method, "rtol": rtol, "atol": atol, "max_steps": 10_000}
    sol = pc.simulate(rod(law), q0=0.2, qd0=1.0, t_span=(0, 10), **how)
    assert_rests(sol)
    # The rate falls by 1 rad/s in the time to stop, so an error of the rate in rad/s is the error
    # of that time as a share of it.
    of_rates = (1e-3 + 10 * atol / rtol) * stop
    allowed = own_tolerance(method, rtol) * (of_rates + under_the_peak)
    assert abs(time_of_rest(sol) - stop) <= allowed


@pytest.mark.parametrize("rtol", [1e-9, 1e-12])
def test_a_narrow_peak_of_friction_shortens_every_run_by_the_same_time(
    rtol: float, method: str
) -> None:
    """J w0/tc less the integral of J (1/tc - 1/friction(w)), which ends with the peak.

    The step that enters the peak begins at a tenth of the first rate or below, and may err by the
    tolerance for that rate.
    """
    allowed = max(1e-12, 0.1 * own_tolerance(method, rtol))
    coulomb, peak_ends = 0.1, 6e-3
    law = friction(coulomb, 0.3, 1e-3, 2.0)
    sooner = J * peak_ends / coulomb - time_to_stop(peak_ends, law)
    how = {"method": method, "rtol": rtol, "atol": 1e-2 * rtol, "max_steps": 10_000}
    for w0 in np.random.default_rng(6).uniform(0.5, 20, 100):
        sol = pc.simulate(rod(law), q0=0.2, qd0=w0, t_span=(0, 100), **how)
        assert_rests(sol)
        assert time_of_rest(sol) == pytest.approx(J * w0 / coulomb - sooner, rel=allowed)


@pytest.mark.parametrize("side", [1, -1])
@pytest.mark.parametrize(
    ("static", "amplitude"),
    [(0.1, 1.03), (0.1, 1.08), (0.1, 0.06), (0.1, 0.7), (0.2, 1.03), (0.2, 0.06), (0.2, 0.72)],
)
def test_a_rod_on_a_spring_with_friction_swings_less_by_the_same_each_time(
    static: float, amplitude: float, side: int, fine: Any
) -> None:
    """Turning points A, -(A - 2 tc/k), ...; at rest for good once k abs(A) <= ts.

    Each half swing passes a peak of friction twice, which takes 2 ts ws of impulse or so.
    """
    stiffness, coulomb, rest = 2.0, 0.1, 0.3
    within = 1e-10 if static == coulomb else 1e-5
    spring = fx.TorsionalSpring(joint=1, stiffness=stiffness, rest_angle=rest)
    half = np.pi * np.sqrt(J / stiffness)
    turns = [amplitude]
    while stiffness * abs(turns[-1]) > static:
        turns.append(-(turns[-1] - np.sign(turns[-1]) * 2 * coulomb / stiffness))
    scene = rod(spring, friction(coulomb, static, 1e-7, 2.0))
    sol = pc.simulate(scene, q0=rest + side * amplitude, qd0=0, t_span=(0, 20), **fine)
    assert_rests(sol)
    assert time_of_rest(sol) == pytest.approx(half * (len(turns) - 1), rel=within)
    at_turns = half * np.arange(len(turns))
    np.testing.assert_allclose(side * (sol(at_turns)[0] - rest), turns, atol=within)
    # No step strides over a turning point.
    assert np.abs(sol.t - at_turns[:, None]).min(axis=1).max() < 10 * within
