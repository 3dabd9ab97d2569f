"""Lasting contact with a stop: when it is entered, when it ends, and what never touches it."""

from __future__ import annotations

from typing import Any

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain, joints
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import links, rod, solve, time_of_rest

BOOK = pc.Scene.textbook()
inf = np.inf


def stop(*bounds: float, joint: int = 1, **more: Any) -> Any:
    return fx.JointStop(joint=joint, range=bounds, **more)


# Release ----------------------------------------------------------------------------------------


@pytest.mark.parametrize("w", [0.05, 3.0])
@pytest.mark.parametrize("e", [0.0, 0.6])
def test_contact_ends_where_the_torque_turns_away_from_the_stop(
    e: float, w: float, fine: Any
) -> None:
    """Pressed by -sin(wt) until pi/w; from there the angle is (ws - sin ws)/w^2."""
    push = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=-1.0, angular_frequency=w))
    sol = solve(rod(push, stop(0, inf, restitution=e)), 0, 0, 1.8 * np.pi / w, **fine)
    assert sol.status == "finished"
    pressed = sol.t < np.pi / w * (1 - 1e-9)
    assert not sol.q[pressed].any()
    assert not sol.qd[pressed].any()
    assert np.abs(sol.t - np.pi / w).min() < 1e-9 / w  # a triple root of the angle
    s = np.linspace(0.01, 0.79, 9) * np.pi
    np.testing.assert_allclose(
        sol(np.pi / w + s / w),
        [(s - np.sin(s)) / w**2, (1 - np.cos(s)) / w],
        rtol=1e-9,
        atol=1e-13,  # the rounding of the dense output, where the angle is next to nothing
    )


def test_a_biased_push_lets_go_at_its_arcsine(fine: Any) -> None:
    """0.3 away from the stop, sin(wt) towards it and back: free where sin wt = 0.3 on the way."""
    w = 2.0
    hum = fx.Motor(joint=1, sinusoid=fx.Sinusoid(amplitude=-1.0, angular_frequency=w))
    lean = fx.Motor(joint=1, constant=0.3)
    t0 = np.pi / (2 * w)  # where the push is largest
    release = (np.pi - np.arcsin(0.3)) / w
    sol = pc.simulate(rod(hum, lean, stop(0, inf)), q0=0, qd0=0, t_span=(t0, release + 0.2), **fine)
    assert np.abs(sol.t - release).min() < 1e-12
    assert not sol.qd[sol.t < release * (1 - 1e-12)].any()
    end = release + 0.2
    rate = 0.3 * 0.2 + (np.cos(w * end) - np.cos(w * release)) / w
    assert sol.qd[-1, 0] == pytest.approx(rate, rel=1e-9)


def test_a_shaken_pivot_throws_a_hanging_rod_off_its_stop(fine: Any) -> None:
    """At the stop, 0.2 before the vertical: off where a_1 (g cos q + xdd sin q) changes sign."""
    g, amplitude, w = 9.81, 0.1, 6.0
    q = np.pi / 2 - 0.2
    # gravity turns it on (cos q > 0): the stop is the upper bound; xdd = -A w^2 sin wt pulls it off
    release = np.arcsin(g * np.cos(q) / (amplitude * w**2 * np.sin(q))) / w
    drive = fx.DrivenPivot(x=fx.Sinusoid(amplitude=amplitude, angular_frequency=w))
    sol = solve(rod(drive, stop(-inf, q), gravity=g), q, 0, release + 0.05, **fine)
    assert np.abs(sol.t - release).min() < 1e-12
    before = sol.t < release * (1 - 1e-12)
    assert (sol.q[before] == q).all()
    assert not sol.qd[before].any()
    assert sol.q[-1, 0] < q


def test_a_rod_dropped_into_contact_stays_until_the_torque_turns(fine: Any) -> None:
    """Plastic: contact from the first touch on; energy of the fall is the loss."""
    table = fx.Motor(joint=1, table=fx.Table(t=[0, 1, 3, 4], torque=[-2, -2, 2, 2]))
    sol = solve(rod(table, stop(0, inf)), 0.25, 0, 3, ledger=True, **fine)
    touch = np.sqrt(2 * 0.25 / 2)
    assert np.abs(sol.t - touch).min() < 1e-12
    held = (sol.t > touch * (1 + 1e-12)) & (sol.t < 2 * (1 - 1e-12))
    assert not sol.q[held].any()
    assert not sol.qd[held].any()
    # the torque passes zero at 2 s and grows by 2 a second
    np.testing.assert_allclose(sol.y[:, -1], [1 / 3, 1.0], rtol=1e-9)
    assert sol.energy().ledger.impact[-1] == pytest.approx(0.5, rel=1e-10)


# At and beside the bound ------------------------------------------------------------------------


@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_rod_at_its_bound_that_moves_outward_hits_at_once(e: float, fine: Any) -> None:
    sol = solve(rod(stop(-1, 0.5, restitution=e)), 0.5, 2.0, 0.5, ledger=True, **fine)
    assert sol.success
    assert sol(0.0)[1] == pytest.approx(-2 * e, abs=1e-15)
    if e:
        assert sol.y[:, -1] == pytest.approx([0.5 - 2 * e * 0.5, -2 * e], abs=1e-12)
    else:
        assert sol.y[:, -1].tolist() == [0.5, 0.0]
    assert sol.energy().ledger.impact[-1] == pytest.approx((1 - e**2) * 2, abs=1e-12)


def test_a_rod_at_its_bound_that_moves_inward_or_rests_hits_nothing(method: str) -> None:
    away = solve(rod(stop(-1, 0.5)), 0.5, -0.5, 1.0, ledger=True, method=method)
    assert away.y[:, -1] == pytest.approx([0.0, -0.5], abs=1e-12)
    assert away.energy().ledger.impact[-1] == 0
    still = solve(rod(stop(-1, 0.5)), 0.5, 0.0, 1.0, method=method)
    assert still.success
    assert still.y[:, -1].tolist() == [0.5, 0.0]


def test_a_start_outside_the_range_is_refused_with_angle_and_range() -> None:
    with pytest.raises(ValueError, match=r"(?s)joint 1.*0\.6.*0\.5"):
        solve(rod(stop(-1, 0.5)), 0.6, 0.0, 1.0)


@pytest.mark.parametrize("links", [1, 2, 5])
def test_a_stop_that_is_never_reached_changes_no_bit(links: int, method: str) -> None:
    rods = [pc.Link(mass=1, length=1)] * links
    bare = pc.Scene(links=rods, gravity=9.807)
    stopped = bare.replace(
        effects=[stop(-51.0, 51.0, joint=j + 1, restitution=0.5) for j in range(links)]
    )
    start = np.linspace(0.3, 1.2, links)
    free = pc.simulate(bare, q0=start, qd0=0.1, t_span=(0, 3), method=method)
    never = pc.simulate(stopped, q0=start, qd0=0.1, t_span=(0, 3), method=method)
    np.testing.assert_array_equal(never.t, free.t)
    np.testing.assert_array_equal(never.y, free.y)
    times = np.linspace(0, 3, 50)
    np.testing.assert_array_equal(never(times), free(times))


@pytest.mark.parametrize("miss", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_grazing_stop_is_hit_if_and_only_if_the_swing_reaches_it(
    e: float, miss: float, fine: Any
) -> None:
    """A rod on a spring turns at 1 exactly. The speed at 1 - miss is sqrt(2 miss): no more is lost.

    Whatever happens within a miss of the turn, the rest of the swing is cos t to its square root.
    """
    spring = fx.TorsionalSpring(joint=1, stiffness=1.0)
    free = solve(rod(spring), -1, 0, 6.0, **fine)
    beyond = solve(rod(spring, stop(-inf, 1 + miss, restitution=e)), -1, 0, 6.0, **fine)
    np.testing.assert_array_equal(beyond.y, free.y)
    short = solve(rod(spring, stop(-inf, 1 - miss, restitution=e)), -1, 0, 6.0, ledger=True, **fine)
    assert short.status == "finished"
    assert short.q.max() <= 1 - miss
    s = np.linspace(0, 6, 50)
    # reflected on the way, it is ahead by the time from there to the turn and back
    ahead = 2 * np.arccos(1 - miss)
    np.testing.assert_allclose(short(s)[0], -np.cos(s), atol=1.01 * ahead)
    lost = short.energy().ledger.impact[-1]
    assert lost == pytest.approx((1 - e**2) * (1 - (1 - miss) ** 2) / 2, rel=1e-4, abs=2e-12)


@pytest.mark.parametrize("miss", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_joint_of_a_chain_grazes_its_stop_if_and_only_if_its_swing_reaches_it(
    e: float, miss: float, fine: Any
) -> None:
    """A miss short of its largest angle it is as fast as its acceleration there makes it."""
    chain = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=9.81)
    free_scene = pc.Scene(links=links(chain), gravity=chain.gravity)
    start = [1.0, 0.9]
    fine = {**fine, "rtol": 1e-13}  # a hundredth of the least miss
    turn = ev.RateZero(joint=2, direction=-1)
    free = pc.simulate(free_scene, q0=start, qd0=0, t_span=(0, 2), events=[turn], **fine)
    top = max(free.events[0], key=lambda found: found.q[1] - found.q[0])
    angle = top.q[1] - top.q[0]

    def run(bound: float) -> pc.Solution:
        effects = [stop(-inf, bound, joint=2, restitution=e)]
        return pc.simulate(
            free_scene.replace(effects=effects), q0=start, qd0=0, t_span=(0, 2), **fine
        )

    np.testing.assert_array_equal(run(angle + miss).y, free.y)
    short = run(angle - miss)
    (struck,) = np.flatnonzero(np.diff(short.t) == 0)
    forces = chain.forces(top.q, top.qd, np.zeros(2))
    turning = joints(2) @ np.linalg.solve(chain.mass_matrix(top.q), forces)
    speed = np.sqrt(-2 * turning[1] * miss)
    before, after = joints(2)[1] @ short.qd[struck : struck + 2].T
    assert before == pytest.approx(speed, rel=5e-3)
    assert after == pytest.approx(-e * before, rel=1e-12)
    assert top.t - short.t[struck] == pytest.approx(speed / -turning[1], rel=5e-3)
    assert (short.q[:, 1] - short.q[:, 0]).max() <= angle - miss + 1e-15


# Stop and friction in one joint -----------------------------------------------------------------


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_friction_acts_between_the_bounces(e: float, fine: Any) -> None:
    """From 0 at w0 to the bound at 0.5 against tc, back at e times the speed until it stops."""
    tc, w0 = 0.8, 2.0
    scene = rod(fx.DryJointFriction(joint=1, coulomb=tc), stop(-5, 0.5, restitution=e))
    sol = solve(scene, 0, w0, 10, ledger=True, **fine)
    hit = np.sqrt(w0**2 - 2 * tc * 0.5)
    back = (e * hit) ** 2 / (2 * tc)
    assert sol.status == "at_rest"
    assert sol.q[-1, 0] == pytest.approx(0.5 - back, abs=1e-11)
    assert sol.qd[-1, 0] == 0.0
    assert time_of_rest(sol) == pytest.approx((w0 - hit + e * hit) / tc, rel=1e-10)
    ledger = sol.energy().ledger
    assert ledger.impact[-1] == pytest.approx((1 - e**2) * hit**2 / 2, rel=1e-10)
    assert ledger.dry[-1] == pytest.approx(tc * (0.5 + back), rel=1e-10)


def test_friction_that_stops_the_rod_short_of_the_stop_leaves_it_there(fine: Any) -> None:
    for share, reaches in ((1 + 1e-9, False), (1 - 1e-9, True)):
        friction = fx.DryJointFriction(joint=1, coulomb=share * 2.0**2 / (2 * 0.5))
        sol = solve(rod(friction, stop(-5, 0.5)), 0, 2.0, 10, **fine)
        assert sol.status == "at_rest"
        assert (sol.q[-1, 0] == 0.5) == reaches
        assert sol.q[-1, 0] == pytest.approx(0.5, abs=1e-9)


def test_friction_and_a_stop_hold_together_and_let_go_by_the_friction_alone(fine: Any) -> None:
    """Pressed by -2, turned to +2 from 1 s to 3 s: free once the torque exceeds friction, 0.5."""
    table = fx.Motor(joint=1, table=fx.Table(t=[0, 1, 3, 4], torque=[-2, -2, 2, 2]))
    scene = rod(table, fx.DryJointFriction(joint=1, coulomb=0.5), stop(0, inf))
    sol = solve(scene, 0, 0, 3, **fine)
    release = 2.25  # 2 (t - 2) = 0.5
    assert np.abs(sol.t - release).min() < 1e-12
    assert not sol.y[:, sol.t < release * (1 - 1e-12)].any()
    np.testing.assert_allclose(sol.y[:, -1], [0.75**3 / 3, 0.75**2], rtol=1e-9)
