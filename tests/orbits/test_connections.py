"""Orbits about Down-Up and Up-Down, their manifolds and connections agree with published numbers.

The pendulum is that of Kaheman, Bramburger, Kutz & Brunton, Nonlinear Dynamics 111 (2023) 7199, and
the numbers are those of the programs that go with it (github.com/dynamicslab, "Saddle-Mediated-
Transport-of-Double-Pendulum"): they found orbits by gradient descent to some six digits, and
connections by looking for neighbours among ten thousand motions of each manifold, to three.
"""

from __future__ import annotations

import dataclasses
from functools import cache

import numpy as np
import pendcore as pc
import pytest

SCENE = pc.Scene(
    links=[
        pc.Link(mass=0.0938439747983407, length=0.172719203817519, center=0.108565214610396,
                inertia=0.00043752942975691),
        pc.Link(mass=0.137595970499412, length=0.2286, center=0.116779018445656,
                inertia=0.00126882939257741),
    ],
    gravity=9.8085802336215,
)  # fmt: skip
TEXTBOOK = pc.Scene.textbook()
DOWN = np.pi / 2
"""Their angles are from hanging: ours less this, or the mirror images of ours."""
SECTIONS = {
    "hanging 1": pc.events.LinkAngle(1, DOWN, every_turn=True),
    "hanging 2": pc.events.LinkAngle(2, DOWN, every_turn=True),
    "straight": pc.events.JointAngle(2, 0.0, every_turn=True),
}


@cache
def orbit(which, energy=0.2):
    small = pc.equilibria(SCENE)[which].orbit(1)
    return small.continued("energy", energy)[-1]


@pytest.mark.parametrize(
    ("which", "link", "rates", "digits"),
    [
        (1, 1, [14.75091676562244, 8.84629055058124], 1e-5),
        (2, 2, [1.2873939240043606, 4.869279573811112], 1e-6),
    ],
)
def test_the_orbits_about_the_saddles_pass_where_theirs_do(which, link, rates, digits):
    """They pass with their link hanging and the other upright, for symmetry, at these rates."""
    passes = pc.events.LinkAngle(link, DOWN, every_turn=True, direction=1, terminal=True)
    end = orbit(which).solution(events=[passes], rtol=1e-13, atol=1e-16).events[0]
    np.testing.assert_allclose(end.qd[0], rates, rtol=digits)
    np.testing.assert_allclose(np.abs(np.sin(end.q[0])), 1, atol=1e-12)


@pytest.mark.parametrize(
    ("start", "turns"),
    [
        ([0.0, 0.0, 20.704284411720227, -20.03102661145768], [1, 0]),
        ([0.0, np.pi, -9.65638354688606, -20.5152473222608], [0, -1]),
    ],
)
def test_the_orbits_of_whole_turns_are_theirs(start, turns):
    start = np.add(start, [DOWN, DOWN, 0, 0])
    found = pc.periodic_orbit(SCENE, start[:2] + 1e-3, start[2:] + 1e-2, energy=0.2)
    theirs = found.solution(events=[pc.events.LinkAngle(1, DOWN, every_turn=True)], rtol=1e-13)
    near = np.abs(np.sin((theirs.events[0].q - start[:2]) / 2)).max(axis=1)
    away = near + np.abs(theirs.events[0].qd - start[2:]).max(axis=1)
    assert away.min() < 1e-5
    np.testing.assert_array_equal(found.turns, turns)


@pytest.mark.parametrize("stability", ["unstable", "stable"])
def test_motions_leave_along_a_manifold_by_its_multiplier(stability):
    """After a period, a motion is off the orbit as much more as the multiplier says."""
    one = orbit(1)
    tube = one.manifold(stability, duration=one.period, offset=1e-6)
    for phase in (0.0, 0.3, 0.8):
        sol = tube.run(phase)
        on_orbit = tube.start(phase) - (sol.y[:, -1] - tube.start(phase)) / (
            max(tube.multiplier, 1 / tube.multiplier) - 1
        )
        closer = pc.simulate(SCENE, (0, one.period), *np.split(on_orbit, 2), rtol=1e-13)
        assert np.abs(closer.y[:, -1] - on_orbit).max() < 2e-5


# Their windows about each: an angle from hanging and its rate.
ABOUT_DOWN_UP = [
    ([0.0, 9.592], [0.0, 9.596]), ([0.0, -9.22], [0.0, -9.218]), ([0.0, -20.2108], [0.0, -20.205]),
    ([-0.299, 8.315], [-0.297, 8.325]), ([0.296, 8.315], [0.2975, 8.335]),
    ([-1.692, -3.135], [-1.691, -3.125]), ([1.6916, -3.132], [1.692, -3.1265]),
]  # fmt: skip
ABOUT_UP_DOWN = [
    ([0.0, 21.052], [0.0, 21.056]), ([0.0, 18.724], [0.0, 18.728]),
    ([0.4362, 17.865], [0.4366, 17.87]), ([-0.4368, 17.864], [-0.4364, 17.868]),
]  # fmt: skip


@pytest.mark.parametrize(
    ("which", "energy", "side", "section", "windows"),
    [
        (1, 0.2, 1, "hanging 2", ABOUT_DOWN_UP),
        # Their orbit here has 8144 states, as one of 0.2003 J would have, not one of 0.2 J: 8140.
        (2, 0.2003, -1, "hanging 1", ABOUT_UP_DOWN),
    ],
)
def test_homoclinic_connections_are_those_of_the_paper(which, energy, side, section, windows):
    one, until = orbit(which, energy), SECTIONS[section]
    away = one.manifold("unstable", side, until=until)
    back = one.manifold("stable", -1, until=until)
    found = pc.connections(away, back, count=400)
    points = np.array([[*x.q - DOWN, *x.qd] for x in found])[:, [which - 1, which + 1]]
    points[:, 0] = (points[:, 0] + np.pi) % (2 * np.pi) - np.pi
    assert len(found) == len(windows)
    for low, high in np.array(windows):
        inside = (points > low - 1e-6) & (points < high + 1e-6)
        assert np.count_nonzero(inside.all(axis=1)) == 1, (low, high)
    # Mirrored, and backward in time, each is one of them again; its bar must know.
    for x, (angle, rate) in zip(found, points, strict=True):
        off = np.abs(points - [-angle, rate]) / [1, 2 * np.pi / one.period]
        twin = off.max(axis=1).argmin()
        assert off[twin].max() <= x.error + found[twin].error
        assert x.gap < 1e-9
        assert x.error < 2e-9
        assert x.angle > 0.1
        kinetic, potential = SCENE.energy(0.0, x.q, x.qd)
        assert kinetic + potential == pytest.approx(energy, abs=1e-9)
        t, y = x.motion()
        assert (np.diff(t) > 0).all()
        assert np.abs(np.diff(y[:, :2], axis=0)).max() < 0.3


def test_a_connection_that_begins_farther_off_is_as_far_off_as_it_says():
    one, until = orbit(1), SECTIONS["hanging 2"]
    found = [
        pc.connections(
            one.manifold("unstable", 1, until=until, offset=offset),
            one.manifold("stable", -1, until=until, offset=offset),
            count=400,
        )
        for offset in (2e-3, 4e-5)
    ]
    assert len(found[0]) == len(found[1])
    for x in found[0]:
        apart = [np.abs([*(x.q - y.q), *(x.qd - y.qd)]) / [1, 1, 6.6, 6.6] for y in found[1]]
        off = min(one.max() for one in apart)
        assert 1e-9 < off < x.error < 1e-5


def test_a_heteroclinic_connection_is_one_motion_from_orbit_to_orbit():
    """A run from its middle comes to both orbits, by a method that did not find it."""
    leaves, comes = orbit(1), orbit(2)
    away = leaves.manifold("unstable", 1, until=SECTIONS["straight"])
    back = comes.manifold("stable", -1, until=SECTIONS["straight"])
    found = pc.connections(away, back, count=300)
    assert len(found) == 2
    for x in found:
        t, y = x.motion()
        for end, last, one in ((t[0], y[0], leaves), (t[-1], y[-1], comes)):
            how = {"rtol": 1e-13, "atol": 1e-16, "method": "dop853"}
            sol = pc.simulate(SCENE, (0, end), x.q, x.qd, **how)
            np.testing.assert_allclose(np.sin(sol.q[-1] - last[:2]), 0, atol=2e-4)
            np.testing.assert_allclose(sol.qd[-1], last[2:], atol=2e-4)
            times = np.linspace(0, one.period, 20001)
            apart = one.solution(rtol=1e-13, t_eval=times).y.T - sol.y[:, -1]
            apart[:, :2] = (apart[:, :2] + np.pi) % (2 * np.pi) - np.pi
            assert np.abs(apart / [1, 1, 8, 8]).max(axis=1).min() < 4e-4  # that grid


def test_manifolds_that_cannot_meet_or_do_not_exist_are_refused():
    hanging = pc.equilibria(SCENE)[0].orbit(1)
    with pytest.raises(ValueError, match="no multiplier is off the unit circle"):
        hanging.manifold("stable")
    tube = orbit(1).manifold("unstable")
    with pytest.raises(ValueError, match=r"until = None: must be an event, such as pc\.even"):
        tube.crossings(3)
    small = pc.equilibria(SCENE)[1].orbit(1).manifold("stable")
    with pytest.raises(ValueError, match=r"energies 0\.2, -0\.175.* J: must agree"):
        pc.connections(tube, small)
    turning = pc.periodic_orbit(SCENE, [DOWN, -DOWN], [-9.656, -20.515], energy=0.2)
    with pytest.raises(ValueError, match=r"multiplier -2\.57.* has one side"):
        pc.connections(turning.manifold("unstable"), turning.manifold("stable"))
    with pytest.raises(ValueError, match="an unstable manifold, and then a stable one"):
        pc.connections(small, tube)
    with pytest.raises(TypeError, match="until = 5: must be an event, such as"):
        orbit(1).manifold("unstable", until=5)


TWICE = pc.events.LinkAngle(2, DOWN, every_turn=True, direction=1, terminal=2)


@pytest.mark.parametrize(
    ("stable", "count", "error", "told"),
    [
        (3, 9, TypeError, r'stable = 3: must be a manifold, as orbit\.manifold\("stable", until'),
        ({}, 9, ValueError, "until = None: must be an event"),
        ({"until": SECTIONS["straight"]}, 9, ValueError,
         "until = LinkAngle.* and JointAngle.*: must"),
        ({"until": SECTIONS["hanging 1"]}, 9, ValueError,
         r"until = .*2.* and .*1.*: must be one sec"),
        ({"until": TWICE}, 0, ValueError, "count = 0: must be >= 3"),
        ({"until": SECTIONS["hanging 2"], "scene": TEXTBOOK}, 9, ValueError, "of two scenes"),
    ],
)  # fmt: skip
def test_manifolds_without_a_common_section_are_refused_at_once(stable, count, error, told):
    away = orbit(1).manifold("unstable", until=SECTIONS["hanging 2"])
    if isinstance(stable, dict):
        of = orbit(1).manifold("stable", until=stable.get("until"))
        stable = dataclasses.replace(of, scene=stable.get("scene", SCENE))
    with pytest.raises(error, match=told):
        pc.connections(away, stable, count=count)
