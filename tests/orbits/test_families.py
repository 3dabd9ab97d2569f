"""Families of orbits agree with elliptic integrals and with runs that settle; folds are passed."""

from __future__ import annotations

from functools import cache

import mpmath
import numpy as np
import pendcore as pc
import pytest
from swings import period_of

E = pc.effects
TEXTBOOK = pc.Scene.textbook()
ROD = TEXTBOOK.replace(links=[pc.Link(mass=1.0, length=1.0)])


def test_a_family_of_swings_has_the_periods_of_the_elliptic_integral():
    small = pc.equilibria(ROD)[0].orbit(1)
    family = small.continued("energy", until=0.99 * ROD.gravity / 2)
    assert 10 < len(family) < 60
    for one in family:
        amplitude = mpmath.acos(-mpmath.mpf(one.energy) / (ROD.gravity / 2))
        assert abs(one.period - period_of(amplitude, ROD.gravity)) < 1e-11
    assert family[-1].energy == pytest.approx(0.99 * ROD.gravity / 2, rel=1e-14)


@pytest.mark.parametrize(("name", "until"), [("gravity", 2.0), ("link[1].length", 3.0)])
def test_swings_of_one_energy_have_the_periods_of_the_elliptic_integral(name, until):
    """At hanging a rod has V = -m g L/2."""
    first = pc.periodic_orbit(ROD, [np.pi / 2 - 1.5])
    family = first.continued(name, until)
    assert family[-1].scene.parameters()[name] == until
    for one in family:
        g, length = one.scene.gravity, one.scene.links[0].length
        amplitude = np.arccos(-first.energy / (g * length / 2))
        assert abs(one.period - period_of(amplitude, g, length)) < 1e-11
    assert max(one.corrections for one in family) <= 7  # as Newton's method does


def driven(frequency):
    """A damped rod on which a torque acts, so weak that it swings in two ways below resonance."""
    push = E.Sinusoid(amplitude=0.25, angular_frequency=frequency)
    damper = E.ViscousJoint(joint=1, damping=0.05)
    return ROD.replace(effects=[E.Motor(joint=1, sinusoid=push), damper])


def settled(frequency, start):
    span = (0, 2 * np.pi / frequency * 200)
    return pc.simulate(driven(frequency), span, *np.split(start, 2), store="end").y[:, -1]


@cache
def resonance():
    fast = pc.periodic_orbit(driven(4.6), *np.split(settled(4.6, np.array([np.pi / 2, 0])), 2))
    return fast.continued("effect[1].sinusoid.angular_frequency", 2.6, step=0.05)


def test_a_resonance_curve_turns_back_twice_and_runs_settle_on_its_stable_parts():
    family = resonance()
    frequencies = np.array([2 * np.pi / one.period for one in family])
    steps = np.sign(np.diff(frequencies))
    assert np.count_nonzero(np.diff(steps)) == 2  # two folds
    back = slice(*np.flatnonzero(np.diff(steps)) + 1)
    assert not any(one.is_stable for one in family[back][2:-2])
    for one in family[::7]:
        w = 2 * np.pi / one.period
        again = settled(w, np.array([*one.q0 + 1e-3, *one.qd0]))
        away = np.abs(again - [*one.q0, *one.qd0]).max()
        assert (away < 1e-4) == one.is_stable, (w, away)


@pytest.mark.parametrize("phase", [0.0, 0.3, 0.7])
def test_the_manifolds_of_a_driven_saddle_grow_by_its_multipliers(phase):
    """The drive goes on: a motion of a phase begins at that phase's time."""
    one = [x for x in resonance() if not x.is_stable][5]
    times = [phase * one.period]
    on_orbit = one.solution(rtol=1e-13, t_eval=times).y[:, 0]
    for stability, factor in (("unstable", max), ("stable", min)):
        run = one.manifold(stability, duration=one.period, offset=1e-6).run(phase)
        growth = (run.y[:, -1] - on_orbit) / (run.y[:, 0] - on_orbit)
        grown = factor(one.multipliers.real)
        np.testing.assert_allclose(growth, max(grown, 1 / grown), rtol=1e-4)


def test_a_family_that_does_not_come_there_says_how_far_it_came():
    small = pc.equilibria(TEXTBOOK)[0].orbit(1)
    with pytest.raises(RuntimeError, match="5 orbits are all that were asked for") as told:
        small.continued("energy", 0.0, most=5)
    assert len(told.value.orbits) == 5
    with pytest.raises(RuntimeError, match="it stays there, at a period of") as told:
        pc.equilibria(ROD)[0].orbit(1).continued("energy", 2 * ROD.gravity)
    last = told.value.orbits[-1]  # close to the motion that comes to rest upright
    assert last.energy == pytest.approx(ROD.gravity / 2, rel=1e-5)
    assert last.energy < ROD.gravity / 2
    with pytest.raises(ValueError, match=r"until = -20: must be > -19.614 \(J\): links that hang"):
        small.continued("energy", -20.0)
    down_up = pc.equilibria(TEXTBOOK)[1].orbit(1)
    with pytest.raises(RuntimeError, match=r"shrinks to .* \[1\.5708, -1\.5708\], .* -9\.807 J"):
        down_up.continued("energy", -9.9)
    with pytest.raises(ValueError, match=r"name = 'gravty': did you mean 'gravity'\?"):
        small.continued("gravty", 1.0)
    fast = pc.periodic_orbit(driven(4.6), *np.split(settled(4.6, np.array([np.pi / 2, 0])), 2))
    with pytest.raises(ValueError, match="nothing keeps the energy here"):
        fast.continued("energy", 1.0)
