"""Pulses of a torque that are far narrower than the steps beside them: none is strided over."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx
from unit_rods import rod, time_of_rest

FRICTION = 0.5


def pulse(at: float, half: float, impulse: float = 1.0) -> fx.Motor:
    """A table with a triangular pulse from at - half to at + half."""
    knots = [-1.0, at - half, at, at + half, 2 * at + 10]
    peak = impulse / ((knots[3] - knots[1]) / 2)
    return fx.Motor(joint=1, table=fx.Table(t=knots, torque=[0, 0, peak, 0, 0]))


@pytest.mark.parametrize("half", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("at", [1.0, 10.0])
def test_a_narrow_pulse_of_a_table_gives_a_turning_rod_its_impulse(
    at: float, half: float, method: str
) -> None:
    last_bits = 1e-13 + 4 * np.spacing(at) / half  # by the last bits of the times within the pulse
    # a finer tolerance would ask for more than these bits can give
    sol = pc.simulate(
        rod(pulse(at, half)),
        q0=0,
        qd0=0.1,
        t_span=(0, 2 * at),
        method=method,
        rtol=max(1e-9, last_bits),
    )
    assert sol.status == "finished"
    assert sol.stats.accepted < 30
    assert sol.qd[-1, 0] == pytest.approx(1.1, rel=last_bits)
    assert sol.q[-1, 0] == pytest.approx(0.1 * 2 * at + at, rel=last_bits)


def test_pulses_of_both_signs_move_a_rod_a_step_and_leave_it_there(method: str) -> None:
    """A table has two pulses within one long step; without either, the rod is elsewhere."""
    there_and_back = [pulse(3.0, 1e-6), pulse(7.0, 1e-6, -1.0)]
    sol = pc.simulate(rod(*there_and_back), q0=0, qd0=0, t_span=(0, 12), method=method)
    assert sol.status == "finished"
    assert sol.qd[-1, 0] == pytest.approx(0, abs=1e-13)
    assert sol.q[-1, 0] == pytest.approx(4.0, rel=1e-12)


def slide(half: float, impulse: float) -> tuple[float, float]:
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


@pytest.mark.parametrize(("half", "impulse"), [(0.1, 0.2), (1e-2, 0.1), (1e-2, 1e-2)])
@pytest.mark.parametrize("at", [1.0, 10.0, 1000.0])
def test_a_narrow_pulse_of_a_table_knocks_a_stuck_rod_as_far_as_friction_lets_it(
    at: float, half: float, impulse: float, method: str
) -> None:
    scene = rod(pulse(at, half, impulse), fx.DryJointFriction(joint=1, coulomb=FRICTION))
    how = {"method": method, "rtol": max(1e-12, 4 * np.spacing(at) / half), "atol": 1e-14}
    sol = pc.simulate(scene, q0=0, qd0=0, t_span=(0, 2 * at), **how)
    assert sol.status == "finished"
    assert sol.stats.accepted < 60
    way, past = slide(half, impulse)
    assert sol.q[-1, 0] == pytest.approx(way, rel=1e-9)
    assert time_of_rest(sol) == pytest.approx(at + past, abs=1e-10)
    release = at - half * (1 - FRICTION * half / impulse)
    assert not sol.y[:, sol.t < release - 1e-10].any()


@pytest.mark.parametrize(
    ("half", "impulse"), [(1e-3, 0.1), (1e-4, 0.01), (1e-6, 1), (3e-7, 1), (3e-8, 1)]
)
@pytest.mark.parametrize("at", [1.0, 10.0])
def test_a_pulse_that_grows_within_the_last_bits_of_time_knocks_a_stuck_rod_as_far(
    at: float, half: float, impulse: float, method: str
) -> None:
    """From one time to the next the torque changes by more than the rounding of its limit."""
    scene = rod(pulse(at, half, impulse), fx.DryJointFriction(joint=1, coulomb=FRICTION))
    last_bits = 1e-9 + 8 * np.spacing(at) / half
    sol = pc.simulate(scene, q0=0, qd0=0, t_span=(0, 2 * at + 2), method=method, rtol=last_bits)
    assert sol.status == "finished"
    assert sol.stats.accepted < 60
    way, past = slide(half, impulse)
    assert sol.q[-1, 0] == pytest.approx(way, rel=last_bits)
    assert time_of_rest(sol) == pytest.approx(at + past, abs=1e-9 + last_bits)


@pytest.mark.parametrize("half", [0.05, 1e-3])
def test_a_narrow_pulse_of_ones_own_knocks_a_stuck_rod_where_max_step_is_as_short(
    half: float, method: str
) -> None:
    """At rest steps are a hundredth of 1/w0 = 1 s; shorter pulses need max_step, as documented."""

    def blow(t: float, q: Any, qd: Any) -> Any:
        return np.array([max(0.0, 0.2 / half * (1 - abs(t - 1) / half))])

    how: dict[str, Any] = {} if half > 0.01 else {"max_step": half / 2}
    effects = [fx.User(blow), fx.DryJointFriction(joint=1, coulomb=FRICTION)]
    sol = pc.simulate(rod(*effects), q0=0, qd0=0, t_span=(0, 1.5), method=method, rtol=1e-9, **how)
    assert sol.status == "finished"
    way, past = slide(half, 0.2)
    assert sol.q[-1, 0] == pytest.approx(way, rel=1e-5)
    assert time_of_rest(sol) == pytest.approx(1 + past, abs=1e-5)
