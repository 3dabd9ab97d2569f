"""The laws of the reference, before the core is compared with them; these tests need no core.

Exact results are checked in fifty digits, by differences over 1e-13 s.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

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
