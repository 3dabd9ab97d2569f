"""Chains with effects at one instant, against Newton and Euler with every joint force unknown.

An error is measured against the size of what the number is made of, as in
test_right_hand_side.py. In a long chain that size is no plain sum: a light link between heavy ones
is thrown about by forces that nearly cancel. So the terms of each equation of the reference are
added up in magnitude and sent through the magnitude of the inverse matrix (Skeel's condition,
`Equations.sizes`): how far the answer moves when every term moves by as much as itself. The
reference has forty digits; what its solution costs in doubles is nobody's error here.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from reference.arithmetic import Number, multiple_precision
from reference.effects import LAWS, Described, TorsionalSpring, law
from reference.instant import Instant
from reference.newton_euler import Body
from reference.random_rigs import START, DrawnRig, rigs
from reference.rig import Rig, balance
from sweeps import random_examples

TOLERANCE = 1e-12
FORTY, FIFTY = multiple_precision(40), multiple_precision(50)
ROUNDING_OF_THE_REFERENCE = 1e-36
KINDS = sorted(pc.effects.kinds())

short, long = st.sampled_from([1, 2, 3]), st.integers(4, 10)


def assert_close(computed: ArrayLike, exact: object, scale: ArrayLike) -> None:
    error = np.abs(np.asarray(computed) - np.array(exact, dtype=float))
    assert np.all(error <= TOLERANCE * np.asarray(scale) + ROUNDING_OF_THE_REFERENCE)


def check_instant(drawn: DrawnRig) -> None:
    bodies, gravity, described, (t, q, qd) = drawn
    n, scene = len(bodies), scene_of(bodies, gravity, described)
    now = pc.simulate(scene, q0=q, qd0=qd, t_span=(t, t), store="steps")
    laws = [law(one) for one in described]
    rig = Rig(bodies=bodies, gravity=gravity, effects=laws, arithmetic=FORTY)
    instant = rig.instant(t, q, qd)
    equations = rig.equations(instant)
    unknowns = equations.solve(FORTY)
    sizes = equations.sizes(unknowns)

    assert_close(scene.accelerations(t, q, qd), unknowns[:n], sizes[:n])
    assert_close(now.accelerations()[0], unknowns[:n], sizes[:n])
    beyond = np.cumsum(np.hypot(*sizes[n : 3 * n].reshape(n, 2).T)[::-1])[::-1]
    assert_close(np.ravel(now.reactions()[0]), unknowns[n : 3 * n], np.repeat(beyond, 2))

    masses, lengths, *_ = np.array(bodies).T
    pivot = np.max(np.abs(np.array([instant.pivot.position, instant.pivot.velocity], float)), 1)
    reach = pivot[0] + np.cumsum([0.0, *lengths])
    joints = [(joint.x, joint.y) for joint in instant.joints]
    assert_close(now.positions()[0], joints, reach[:, np.newaxis] + 1)
    centers = [center[:2] for center in instant.mass_centers()]
    assert_close(now.mass_centers()[0], centers, reach[1:, np.newaxis] + 1)

    turns = np.abs(qd) + np.abs([0.0, *qd[:-1]])
    angles = np.abs(q) + np.abs([0.0, *q[:-1]])
    loads = rig.loads(instant)
    carried = np.array([*masses, sum(float(mass) for mass, _ in loads.payloads)])
    speed = pivot[1] + np.cumsum([*(lengths * np.abs(qd)), 0.0])
    inertias = sum(float(inertia) for _, inertia in loads.payloads)
    rotors = np.array([float(armature) for armature in loads.armatures])
    fast = np.sum(carried * speed**2) + inertias * qd[-1] ** 2 + np.sum(rotors * turns**2)
    high = gravity * np.sum(carried * (reach[[*range(1, n + 1), n]]))
    for spring in laws:
        if isinstance(spring, TorsionalSpring):
            wound = angles[spring.joint - 1] + abs(spring.rest_angle)
            high += spring.stiffness * wound**2
    kinetic, potential = rig.energy(t, q, qd)
    assert_close(now.energy().kinetic[0], kinetic, fast)
    assert_close(now.energy().potential[0], potential, high)


def test_every_kind_of_effect_has_a_law_in_the_reference() -> None:
    assert sorted(LAWS) == KINDS


@pytest.mark.few_cases
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=random_examples(30), deadline=None)
@given(data=st.data())
def test_an_effect_alone_and_on_a_moving_pivot(kind: str, data: st.DataObject) -> None:
    check_instant(data.draw(rigs([kind], short)))
    check_instant(data.draw(rigs(sorted({kind, "driven_pivot"}), short)))


@pytest.mark.few_cases
@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=random_examples(8), deadline=None)
@given(data=st.data())
def test_an_effect_alone_on_a_long_chain(kind: str, data: st.DataObject) -> None:
    check_instant(data.draw(rigs([kind], long)))


@pytest.mark.parametrize(
    ("kinds", "links", "count"),
    [
        ([kind for kind in KINDS if kind != "lock"], short, 60),
        (KINDS, short, 60),
        (KINDS, long, 20),
        ([], short | long, 50),
    ],
    ids=["all but locks", "all", "all on a long chain", "none"],
)
def test_effects_together(kinds: list[str], links: st.SearchStrategy[int], count: int) -> None:
    settings(max_examples=random_examples(count), deadline=None)(
        given(rigs(kinds, links))(check_instant)
    )()


@settings(max_examples=random_examples(30), deadline=None)
@given(rigs(["rotor_inertia", "payload", "driven_pivot"], short | long))
def test_the_mass_matrix_holds_rotors_and_the_payload(drawn: DrawnRig) -> None:
    bodies, gravity, described, (_, q, _) = drawn
    laws = [law(one) for one in described]
    exact = Rig(bodies=bodies, gravity=0.0, effects=laws, arithmetic=FORTY).mass_matrix(q)
    size = np.sqrt([float(exact[i][i]) for i in range(len(q))])
    computed = scene_of(bodies, gravity, described).mass_matrix(q)
    assert_close(computed, exact, np.outer(size, size))
    np.testing.assert_array_equal(computed, computed.T)


@pytest.mark.parametrize("n", [1, 2, 3, 7])
def test_many_instants_at_once(n: int) -> None:
    random = np.random.default_rng(n)
    bodies = [Body(1.0 + 0.1 * i, 0.5 + 0.1 * i, 0.3, 0.02) for i in range(n)]
    described: list[Described] = [
        ("driven_pivot", {"x": {"amplitude": 0.1, "angular_frequency": 5.0}}),
        ("motor", {"joint": n, "table": {"t": [START, 0.3, 1.0], "torque": [1.0, -2.0, 5.0]}}),
        ("viscous_joint", {"joint": 1, "damping": 0.3}),
    ]
    scene = scene_of(bodies, 9.81, described)
    t, q, qd = random.uniform(0, 1, 40), *random.uniform(-4, 4, (2, 40, n))
    alone = [scene.accelerations(*state) for state in zip(t, q, qd, strict=True)]
    np.testing.assert_array_equal(scene.accelerations(t, q, qd), alone)
    at_one_state = scene.accelerations(t, q[0], qd[0])
    np.testing.assert_array_equal(at_one_state[3], scene.accelerations(t[3], q[0], qd[0]))


# The reference itself ---------------------------------------------------------------------------

S, TINY = FIFTY.number("1e-13"), 1e-18


def slope(f: Callable[[Number], Number]) -> Number:
    """Differentiate at 0, to about 25 digits."""
    return (f(S) - f(-S)) / (2 * S)


def plus(values: list[Number], s: Number, direction: Sequence[Number]) -> list[Number]:
    return [x + s * d for x, d in zip(values, direction, strict=True)]


def exact_rig(drawn: DrawnRig) -> tuple[Rig, Number, list[Number], list[Number]]:
    """Return the rig, the time, the angles and the rates in fifty digits."""
    bodies, gravity, described, state = drawn
    laws = [law(one) for one in described]
    rig = Rig(bodies=bodies, gravity=gravity, effects=laws, arithmetic=FIFTY)
    q, qd = ([FIFTY.number(x) for x in values] for values in state[1:])
    return rig, FIFTY.number(state[0]), q, qd


def check_power(drawn: DrawnRig) -> None:
    """The energy grows as fast as the entries of the ledger say."""
    rig, t, q, qd = exact_rig(drawn)
    qdd = rig.motion(t, q, qd).accelerations

    def total(s: Number) -> Number:
        moved = plus(plus(q, s, qd), s * s / 2, qdd)
        return sum(rig.energy(t + s, moved, plus(qd, s, qdd)))

    shares = rig.shares(t, q, qd)
    size = 1 + sum(abs(power) for power in shares.values())
    assert abs(slope(total) - balance(shares)) < TINY * size


def check_lagrange(drawn: DrawnRig) -> None:
    """d/dt dT/dqd_i - dT/dq_i + dV/dq_i is the generalised force of q_i, for every link i."""
    rig, t, q, qd = exact_rig(drawn)
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


@pytest.mark.parametrize("kind", [*KINDS, "all"])
@settings(max_examples=random_examples(10), deadline=None)
@given(data=st.data())
def test_newton_and_euler_agree_with_lagrange_and_with_the_growth_of_the_energy(
    kind: str, data: st.DataObject
) -> None:
    kinds, links = KINDS if kind == "all" else [kind], st.sampled_from([1, 2, 3, 5])
    check_lagrange(data.draw(rigs(kinds, links)))
    check_power(data.draw(rigs(kinds, links)))
    check_power(data.draw(rigs(sorted({*kinds, "driven_pivot"}), links)))
