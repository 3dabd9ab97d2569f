"""A joint at its stop, beside it and just short of it; friction beside a stop.

Rods of moment of inertia 1, so that torques are accelerations; without gravity unless said.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from dense_chain import DenseChain, joints
from pendcore import effects as fx
from pendcore import events as ev
from unit_rods import links, rod, solve, time_of_rest

inf = np.inf


def stop(*bounds, joint=1, **more):
    return fx.JointStop(joint=joint, range=bounds, **more)


def test_a_rod_dropped_into_contact_stays_until_the_torque_turns(fine):
    """Plastic: contact from the first touch on; energy of the fall is the loss."""
    table = fx.Motor(joint=1, table=fx.Table(t=[0, 1, 3, 4], torque=[-2, -2, 2, 2]))
    sol = solve(rod(table, stop(0, inf)), 0.25, 0, 3, ledger=True, **fine)
    touch = np.sqrt(2 * 0.25 / 2)
    assert np.abs(sol.t - touch).min() < 1e-12
    held = (sol.t > touch * (1 + 1e-12)) & (sol.t < 2 * (1 - 1e-12))
    assert not sol.y[:, held].any()
    # the torque passes zero at 2 s and grows by 2 a second
    np.testing.assert_allclose(sol.y[:, -1], [1 / 3, 1.0], rtol=1e-9)
    assert sol.energy().ledger.impact[-1] == pytest.approx(0.5, rel=1e-10)


AT_BOUND = {  # restitution, rate at the bound of 0.5, rate after it, energy lost
    "outward, plastic": (0.0, 2.0, 0.0, 2.0),
    "outward": (0.5, 2.0, -1.0, 1.5),
    "outward, elastic": (1.0, 2.0, -2.0, 0.0),
    "inward": (0.0, -0.5, -0.5, 0.0),
    "at rest": (0.0, 0.0, 0.0, 0.0),
}


@pytest.mark.parametrize("start", AT_BOUND)
def test_a_rod_at_its_bound_hits_at_once_if_it_moves_outward_and_else_not(start, fine):
    e, before, after, lost = AT_BOUND[start]
    sol = solve(rod(stop(-1, 0.5, restitution=e)), 0.5, before, 0.5, ledger=True, **fine)
    assert sol.success
    assert sol(0.0)[1] == pytest.approx(after, abs=1e-15)
    end = [0.5 + after * 0.5, after]
    assert sol.y[:, -1].tolist() == (pytest.approx(end, abs=1e-12) if after else end)
    assert sol.energy().ledger.impact[-1] == pytest.approx(lost, abs=1e-12 * (lost > 0))


def test_a_start_outside_the_range_is_refused_with_angle_and_range():
    with pytest.raises(ValueError, match=r"(?s)joint 1.*0\.6.*0\.5"):
        solve(rod(stop(-1, 0.5)), 0.6, 0.0, 1.0)


@pytest.mark.parametrize("links", [1, 2, 5])
def test_a_stop_that_is_never_reached_changes_no_bit(links, method):
    bare = pc.Scene(links=[pc.Link(mass=1, length=1)] * links, gravity=9.807)
    far = [stop(-51.0, 51.0, joint=j + 1, restitution=0.5) for j in range(links)]
    start = np.linspace(0.3, 1.2, links)
    free, never = (
        pc.simulate(scene, (0, 3), start, 0.1, method=method)
        for scene in (bare, bare.replace(effects=far))
    )
    times = np.linspace(0, 3, 50)
    np.testing.assert_array_equal(never.t, free.t)
    np.testing.assert_array_equal(never.y, free.y)
    np.testing.assert_array_equal(never(times), free(times))


@pytest.mark.parametrize("miss", [1e-6, 1e-9, 1e-11])
@pytest.mark.parametrize("e", [0.0, 0.5, 1.0])
def test_a_grazing_stop_is_hit_if_and_only_if_the_swing_reaches_it(e, miss, fine):
    """A rod on a spring turns at 1 exactly. The speed at 1 - miss is sqrt(2 miss): no more is lost.

    Whatever happens within a miss of the turn, the rest of the swing is cos t to its square root.
    """
    spring = fx.TorsionalSpring(joint=1, stiffness=1.0)

    def run(*stops):
        return solve(rod(spring, *stops), -1, 0, 6.0, ledger=True, **fine)

    beyond = run(stop(-inf, 1 + miss, restitution=e))
    np.testing.assert_array_equal(beyond.y, run().y)
    short = run(stop(-inf, 1 - miss, restitution=e))
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
def test_a_joint_of_a_chain_grazes_its_stop_if_and_only_if_its_swing_reaches_it(e, miss, fine):
    """A miss short of its largest angle it is as fast as its acceleration there makes it."""
    chain = DenseChain(masses=np.ones(2), lengths=np.ones(2), gravity=9.81)
    fine = {**fine, "rtol": 1e-13}  # a hundredth of the least miss

    def run(*effects, **how):
        scene = pc.Scene(links=links(chain), gravity=chain.gravity, effects=effects)
        return pc.simulate(scene, (0, 2), [1.0, 0.9], **fine, **how)

    free = run(events=[ev.RateZero(joint=2, direction=-1)])
    top = max(free.events[0], key=lambda found: found.q[1] - found.q[0])
    angle = top.q[1] - top.q[0]
    beyond = run(stop(-inf, angle + miss, joint=2, restitution=e))
    np.testing.assert_array_equal(beyond.y, free.y)
    short = run(stop(-inf, angle - miss, joint=2, restitution=e))
    (struck,) = np.flatnonzero(np.diff(short.t) == 0)
    forces = chain.forces(top.q, top.qd, np.zeros(2))
    turning = joints(2) @ np.linalg.solve(chain.mass_matrix(top.q), forces)
    speed = np.sqrt(-2 * turning[1] * miss)
    before, after = joints(2)[1] @ short.qd[struck : struck + 2].T
    assert before == pytest.approx(speed, rel=5e-3)
    assert after == pytest.approx(-e * before, rel=1e-12)
    assert top.t - short.t[struck] == pytest.approx(speed / -turning[1], rel=5e-3)
    assert (short.q[:, 1] - short.q[:, 0]).max() <= angle - miss + 1e-15


@pytest.mark.parametrize("e", [0.0, 0.6, 1.0])
def test_friction_acts_between_the_bounces(e, fine):
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


@pytest.mark.parametrize(("share", "reaches"), [(1 + 1e-9, False), (1 - 1e-9, True)])
def test_friction_that_stops_the_rod_short_of_the_stop_leaves_it_there(share, reaches, fine):
    friction = fx.DryJointFriction(joint=1, coulomb=share * 2.0**2 / (2 * 0.5))
    sol = solve(rod(friction, stop(-5, 0.5)), 0, 2.0, 10, **fine)
    assert sol.status == "at_rest"
    assert (sol.q[-1, 0] == 0.5) == reaches
    assert sol.q[-1, 0] == pytest.approx(0.5, abs=1e-9)


def test_a_joint_let_go_from_its_stop_by_a_slow_drive_sets_out_away_from_it(method):
    """The torque sin t - 1/2 lets it go at pi/6, with no acceleration yet to tell which way."""
    effects = (
        stop(0.0, inf),
        fx.ViscousJoint(joint=1, damping=0.0, damping2=0.1),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(1.0, angular_frequency=1.0)),
        fx.Motor(joint=1, constant=-0.5),
    )
    for order in (1, -1):
        sol = solve(rod(*effects[::order]), 0, 0, 1, method=method)
        assert sol.status == "finished", sol.message
        # Without the damping, which changes it by some b2 w^2 s^2/12: w = cos s0 - cos t - s/2
        released, s = np.pi / 6, 1 - np.pi / 6
        free = np.cos(released) - np.cos(1) - s / 2
        assert free - 0.1 * free**2 * s < sol.y[1, -1] < free


WATCHED = [
    ev.JointAngle(1, 1.5),
    ev.RateZero(joint=1),
    ev.TipLine((0.0, 0.0), (1.0, 0.0)),
    ev.Function(lambda t, q, qd: q[0] - 1.4),
]
CONTACTS = {"friction": fx.DryJointFriction(joint=1, coulomb=0.8), "a stop": stop(-9.0, 1.7)}


@pytest.mark.parametrize("contact", CONTACTS)
def test_what_changes_after_the_change_of_method_is_found_as_under_a_lock(contact):
    """A damper of 1e5 N m s/rad lets its joint turn at its load divided by that."""

    def run(joint_2, **how):
        scene = pc.Scene.textbook().replace(effects=[joint_2, CONTACTS[contact]])
        return pc.simulate(scene, (0, 3), 0.5, events=WATCHED, **how)

    stiff = run(fx.ViscousJoint(joint=2, damping=1e5), method="dopri5-radau5", rtol=1e-8)
    locked = run(fx.Lock(joint=2), rtol=1e-10)
    assert stiff.stats.njev > 20  # it has gone over, and early
    assert stiff.stats.accepted < 10_000
    np.testing.assert_allclose(stiff.y[:, -1], locked.y[:, -1], atol=1e-4)
    for found, expected in zip(stiff.events, locked.events, strict=True):
        assert [one.t for one in found] == pytest.approx([one.t for one in expected], abs=1e-4)
        assert [one.direction for one in found] == [one.direction for one in expected]
        assert expected


@pytest.mark.parametrize("held_by", ["a stop", "friction"])
@pytest.mark.parametrize("damping", [300.0, 3e3])
def test_a_joint_that_is_held_has_no_rate_in_and_between_stiff_steps(damping, held_by, method):
    """Leaning on its stop, or stuck, while link 2 creeps through honey: no zero of the rate."""
    hold, rate = stop(-0.3, 1.1), 0.1
    if held_by == "friction":
        hold, rate = fx.DryJointFriction(joint=1, coulomb=9.0), 0.0
    damper = fx.ViscousJoint(joint=2, damping=damping)
    scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 2, effects=[hold, damper])
    watched = [ev.RateZero(joint=1), ev.RateZero(link=1), ev.JointAngle(joint=1, value=1.1)]
    how = {"method": method, "rtol": 1e-6, "events": watched}
    sol = pc.simulate(scene, (0, 1), [1.1, 1.6], [0, rate], **how)
    assert sol.status == "finished"
    assert abs(sol.qd[-1, 1]) > 1e-6
    assert [list(found) for found in sol.events] == [[], [], []]
    states = np.column_stack([sol.y, sol(np.linspace(0, 1, 1001))])
    assert set(states[0]) == {1.1}
    assert not states[2].any()
