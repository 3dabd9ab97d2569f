"""Chains with effects at one instant, against Newton and Euler with every joint force unknown.

An error is measured against the size of what the number is made of, as in
test_right_hand_side.py. In a long chain that size is no plain sum: a light link between heavy ones
is thrown about by forces that nearly cancel. So the terms of each equation of the reference are
added up in magnitude and sent through the magnitude of the inverse matrix (Skeel's condition,
`Equations.sizes`): how far the answer moves when every term moves by as much as itself. The
reference has forty digits; what its solution costs in doubles is nobody's error here.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc
import pytest
from described_scenes import scene_of
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import ArrayLike
from reference.arithmetic import multiple_precision
from reference.effects import LAWS, Described, law
from reference.effects.torsional_spring import TorsionalSpring
from reference.newton_euler import Body
from reference.random_rigs import START, DrawnRig, rigs
from reference.rig import Rig

TOLERANCE = 1e-12
FORTY = multiple_precision(40)
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
    centers = [instant.mass_center(link)[:2] for link in range(1, n + 1)]
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


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=30, deadline=None)
@given(data=st.data())
def test_an_effect_alone_and_on_a_moving_pivot(kind: str, data: st.DataObject) -> None:
    check_instant(data.draw(rigs([kind], short)))
    check_instant(data.draw(rigs(sorted({kind, "driven_pivot"}), short)))


@pytest.mark.parametrize("kind", KINDS)
@settings(max_examples=8, deadline=None)
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
    settings(max_examples=count, deadline=None)(given(rigs(kinds, links))(check_instant))()


@settings(max_examples=30, deadline=None)
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
