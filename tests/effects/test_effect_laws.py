"""The laws of the reference, before the core is compared with them; these tests need no core.

Exact results are checked in fifty digits, by differences over 1e-13 s.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.arithmetic import Number, multiple_precision
from reference.effects import LAWS, Described, law
from reference.effects.natural_spline import natural_spline
from reference.effects.sinusoid import sinusoid
from reference.effects.torsional_spring import TorsionalSpring
from reference.instant import Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Body
from reference.random_rigs import State, between, effects, gravities, links, states
from reference.rig import Rig, balance

FIFTY = multiple_precision(50)
S = FIFTY.number("1e-13")
TINY = 1e-18
few = settings(max_examples=10, deadline=None)
ALONE_AND_ALL = [[kind] for kind in sorted(LAWS)] + [sorted(LAWS)]
ON_A_MOVING_PIVOT = [sorted({kind, "driven_pivot"}) for kind in sorted(LAWS)]


@st.composite
def rigs(draw: st.DrawFn, kinds: Sequence[str]) -> tuple[Rig, State]:
    """A chain with effects of these kinds and a state of it."""
    n = draw(st.sampled_from([1, 2, 3, 5]))
    described: list[Described] = []
    for kind in kinds:
        described += draw(effects(kind, n))
    bodies, laws = [draw(links()) for _ in range(n)], [law(one) for one in described]
    rig = Rig(bodies=bodies, gravity=draw(gravities), effects=laws, arithmetic=FIFTY)
    return rig, draw(states(n, described))


def slope(f: Callable[[Number], Number]) -> Number:
    """Differentiate at 0, to about 25 digits."""
    return (f(S) - f(-S)) / (2 * S)


def name_of(kinds: list[str]) -> str:
    return "all" if len(kinds) > 2 else " and ".join(kinds)


def in_fifty_digits(state: State) -> tuple[Number, list[Number], list[Number]]:
    t, q, qd = state
    return FIFTY.number(t), [FIFTY.number(x) for x in q], [FIFTY.number(x) for x in qd]


def plus(values: list[Number], s: Number, direction: Sequence[Number]) -> list[Number]:
    return [x + s * d for x, d in zip(values, direction, strict=True)]


@pytest.mark.every_value("kinds")
@pytest.mark.parametrize("kinds", [*ON_A_MOVING_PIVOT, *ALONE_AND_ALL], ids=name_of)
@few
@given(data=st.data())
def test_the_energy_grows_as_fast_as_the_entries_of_the_ledger_say(
    kinds: list[str], data: st.DataObject
) -> None:
    rig, state = data.draw(rigs(kinds))
    t, q, qd = in_fifty_digits(state)
    qdd = rig.motion(t, q, qd).accelerations

    def total(s: Number) -> Number:
        moved = plus(plus(q, s, qd), s * s / 2, qdd)
        return sum(rig.energy(t + s, moved, plus(qd, s, qdd)))

    shares = rig.shares(t, q, qd)
    size = 1 + sum(abs(power) for power in shares.values())
    assert abs(slope(total) - balance(shares)) < TINY * size


@pytest.mark.every_value("kinds")
@pytest.mark.parametrize("kinds", ALONE_AND_ALL, ids=name_of)
@few
@given(data=st.data())
def test_newton_and_euler_agree_with_lagrange(kinds: list[str], data: st.DataObject) -> None:
    """d/dt dT/dqd_i - dT/dq_i + dV/dq_i is the generalised force of q_i, for every link i."""
    rig, state = data.draw(rigs(kinds))
    t, q, qd = in_fifty_digits(state)
    motion, loads = rig.motion(t, q, qd), rig.loads(rig.instant(t, q, qd))
    # A spring's couple is among the loads: it must not count twice.
    others = [effect for effect in rig.effects if not isinstance(effect, TorsionalSpring)]
    rig = dataclasses.replace(rig, effects=others)

    def unit(i: int) -> list[Number]:
        return [FIFTY.number(i == k) for k in range(len(q))]

    def momentum(i: int, s: Number) -> Number:
        then, rates = plus(q, s, qd), plus(qd, s, motion.accelerations)
        return slope(lambda r: rig.energy(t + s, then, plus(rates, r, unit(i))).kinetic)

    def lagrangian(i: int, s: Number) -> Number:
        kinetic, potential = rig.energy(t, plus(q, s, unit(i)), qd)
        return kinetic - potential

    for i in range(len(q)):
        # How the mass centres move as q_i alone grows, and what does work then.
        alone = Instant(bodies=rig.bodies, gravity=0.0, q=q, qd=unit(i), arithmetic=FIFTY)
        force = loads.couples[i].value
        force += motion.holding.get(i + 1, 0) - motion.holding.get(i + 2, 0)
        for link, (fx, fy) in enumerate(loads.forces, start=1):
            center = alone.mass_center(link)
            force += fx.value * center.vx + fy.value * center.vy
        left = slope(lambda s, i=i: momentum(i, s)) - slope(lambda s, i=i: lagrangian(i, s))
        assert abs(left - force) < TINY * (1 + loads.couples[i].size)


@few
@given(rigs(["rotor_inertia", "payload", "driven_pivot"]))
def test_the_mass_matrix_belongs_to_the_accelerations(rig: tuple[Rig, State]) -> None:
    """A couple on one link changes the accelerations by M^-1 of it."""
    chain, (t, q, qd) = rig
    free = chain.motion(t, q, qd).accelerations
    for i in range(len(q)):
        push = law(("user", {"function": lambda t, q, qd, i=i: (np.arange(len(q)) == i) * 1.0}))
        pushed = dataclasses.replace(chain, effects=[*chain.effects, push])
        change = [a - b for a, b in zip(pushed.motion(t, q, qd).accelerations, free, strict=True)]
        for k, row in enumerate(chain.mass_matrix(q)):
            couple = sum(m * a for m, a in zip(row, change, strict=True))
            assert abs(couple - (i == k)) < TINY


@settings(max_examples=200)
@given(*[between(-5, 5)] * 4, links())
def test_drag_along_the_rod_is_what_the_polynomials_of_a_linear_speed_integrate_to(
    wx: float, wy: float, angle: float, rate: float, link: Body
) -> None:
    """The formulas of the design, which split where the speed changes sign."""
    told = {"link": 1, "drag_coefficient": 1.2, "diameter": 0.1, "wind": (wx, wy)}
    moves = PivotMotion(velocity=(0.3, -0.4))
    loads = Loads(1)
    instant = Instant(bodies=[link], gravity=0.0, q=[angle], qd=[rate], pivot=moves)
    law(("rod_drag", told)).act(instant, loads)
    k, length = 1.225 * 1.2 * 0.1 / 2, link.length
    w0 = -np.sin(angle) * (0.3 - wx) + np.cos(angle) * (-0.4 - wy)
    w1 = w0 + length * rate
    if w0 * w1 >= 0:
        sign = np.sign(w0 + w1)
        force = -k * sign * length * (w0**2 + w0 * w1 + w1**2) / 3
        moment = -k * sign * length**2 * (w0**2 + 2 * w0 * w1 + 3 * w1**2) / 12
    else:
        s, b = length * w0 / (w0 - w1), length * w1 / (w1 - w0)
        s0, s1 = np.sign([w0, w1])
        force = -k * (s0 * s * w0**2 + s1 * b * w1**2) / 3
        moment = -k * (s0 * s**2 * w0**2 / 12 + s1 * (s * b * w1**2 / 3 + b**2 * w1**2 / 4))
    # w0 is a difference of two speeds, and is as exact as these are.
    speed, wind = abs(w0) + abs(w1), np.hypot(0.3 - wx, -0.4 - wy)
    size = k * length * speed * (speed + wind)
    found = [component.value for component in loads.forces[0]]
    across = np.array([-np.sin(angle), np.cos(angle)])
    assert found == pytest.approx(across * force, abs=1e-14 * size)
    about_joint = loads.couples[0].value + link.center * force
    assert about_joint == pytest.approx(moment, abs=1e-14 * size * length)


KNOTS, VALUES = [0.0, 0.5, 1.5, 1.75, 3.0], [1.0, -1.0, 0.3, 0.8, 0.0]
SINE = {"amplitude": 1.5, "angular_frequency": 3.0, "phase": 0.4}
PATHS: dict[str, Callable[[Number], tuple[Number, ...]]] = {
    "spline": lambda t: natural_spline(t, KNOTS, VALUES, FIFTY),
    "sinusoid": lambda t: sinusoid(t, SINE, FIFTY),
}


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize("t", [0.1, 0.7, 1.6, 2.9])
def test_rates_and_accelerations_are_derivatives(path: str, t: float) -> None:
    at = FIFTY.number(t)
    _, rate, acceleration = PATHS[path](at)
    assert abs(slope(lambda s: PATHS[path](at + s)[0]) - rate) < 1e-20
    assert abs(slope(lambda s: PATHS[path](at + s)[1]) - acceleration) < 1e-20


def test_the_spline_is_the_natural_one() -> None:
    """It meets its points; between them it is cubic; no derivative jumps; its ends are straight."""
    spline = PATHS["spline"]
    assert [float(spline(t)[0]) for t in KNOTS] == pytest.approx(VALUES, abs=1e-15)
    assert [spline(t)[2] for t in (KNOTS[0], KNOTS[-1])] == [0, 0]
    for a, b in pairwise(KNOTS):
        bends = [float(spline(a + (b - a) * share)[2]) for share in (0.0, 0.25, 0.5, 1.0)]
        assert bends == pytest.approx(np.interp([0.0, 0.25, 0.5, 1.0], [0, 1], bends[::3]))
    for t in KNOTS[1:-1]:
        for before, after in zip(spline(t - S), spline(t + S), strict=True):
            assert abs(after - before) < 1e-10
