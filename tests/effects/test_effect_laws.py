"""The reference laws of the effects themselves, before the core is compared with them.

These tests need no core. Exact results are checked in fifty digits, by differences over 1e-13 s.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from reference.arithmetic import Number, multiple_precision
from reference.effects import LAWS, Described, law
from reference.effects.torsional_spring import TorsionalSpring
from reference.instant import Instant
from reference.random_rigs import State, effects, gravities, links, states
from reference.rig import Rig, balance

FIFTY = multiple_precision(50)
S = FIFTY.number("1e-13")
TINY = 1e-18
KINDS = sorted(LAWS)
few = settings(max_examples=10, deadline=None)


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


def numbers(values: Sequence[float]) -> list[Number]:
    return [FIFTY.number(x) for x in values]


def plus(values: list[Number], s: Number, direction: Sequence[Number]) -> list[Number]:
    return [x + s * d for x, d in zip(values, direction, strict=True)]


def check_power(rig: Rig, state: State) -> None:
    """The energy grows as fast as the entries of the ledger say."""
    t, q, qd = FIFTY.number(state[0]), numbers(state[1]), numbers(state[2])
    qdd = rig.motion(t, q, qd).accelerations

    def total(s: Number) -> Number:
        moved = plus(plus(q, s, qd), s * s / 2, qdd)
        return sum(rig.energy(t + s, moved, plus(qd, s, qdd)))

    shares = rig.shares(t, q, qd)
    size = 1 + sum(abs(power) for power in shares.values())
    assert abs(slope(total) - balance(shares)) < TINY * size


def check_lagrange(rig: Rig, state: State) -> None:
    """d/dt dT/dqd_i - dT/dq_i + dV/dq_i is the generalised force of q_i, for every link i."""
    t, q, qd = FIFTY.number(state[0]), numbers(state[1]), numbers(state[2])
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


@pytest.mark.parametrize("kind", KINDS)
@few
@given(data=st.data())
def test_the_energy_grows_by_the_power_of_an_effect(kind: str, data: st.DataObject) -> None:
    check_power(*data.draw(rigs([kind])))


@pytest.mark.parametrize("kind", KINDS)
@few
@given(data=st.data())
def test_the_energy_grows_by_the_power_of_an_effect_and_of_a_moving_pivot(
    kind: str, data: st.DataObject
) -> None:
    check_power(*data.draw(rigs(sorted({kind, "driven_pivot"}))))


@few
@given(rigs(KINDS))
def test_the_energy_grows_by_the_power_of_all_effects(rig: tuple[Rig, State]) -> None:
    check_power(*rig)


@pytest.mark.parametrize("kind", KINDS)
@few
@given(data=st.data())
def test_newton_and_euler_agree_with_lagrange(kind: str, data: st.DataObject) -> None:
    check_lagrange(*data.draw(rigs([kind])))


@few
@given(rigs(KINDS))
def test_newton_and_euler_agree_with_lagrange_on_all_effects(rig: tuple[Rig, State]) -> None:
    check_lagrange(*rig)


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
