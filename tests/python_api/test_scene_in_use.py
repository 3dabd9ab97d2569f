"""A scene keeps what it computes with; a call within a call, or in a thread, has its own."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pendcore as pc

E = pc.effects
ROD = pc.Link(mass=1.0, length=1.0)
STATES = np.random.default_rng(1).uniform(-3, 3, (40, 2, 3))
SPRING = E.TorsionalSpring(joint=2, stiffness=3.0)


def of_a_scene(scene: pc.Scene, q: Any, qd: Any) -> list[np.ndarray]:
    found = scene.linearize(q, qd, 0.3, inputs=[1])
    return [scene.accelerations(0.3, q, qd), found.A, found.B, *scene.jacobian(0.3, q, qd)]


def test_a_function_that_asks_its_own_scene_in_the_middle_of_a_call() -> None:
    plain = pc.Scene(links=[ROD] * 3, effects=[SPRING])
    scenes: list[pc.Scene] = []
    asked = False

    def torques(t: float, q: Any, qd: Any) -> Any:
        nonlocal asked
        if scenes and not asked:
            asked = True  # or it would ask without end
            scenes[0].accelerations(t, q + 1, qd - 2)
            scenes[0].mass_matrix(q + 1)
            asked = False
        return np.zeros(3)

    scenes.append(pc.Scene(links=[ROD] * 3, effects=[SPRING, E.User(torques)]))
    for q, qd in STATES[:5]:
        for one, other in zip(of_a_scene(plain, q, qd), of_a_scene(scenes[0], q, qd), strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9 * np.abs(other).max())


def test_threads_find_what_one_finds() -> None:
    friction = E.DryJointFriction(joint=3, coulomb=0.2, static=0.5, stribeck_velocity=0.1)
    user = E.User(lambda t, q, qd: np.array([0.1, -0.2, 0.0]) * np.sin(t) * qd)
    scene = pc.Scene(links=[ROD] * 3, effects=[SPRING, friction, user])
    alone = [of_a_scene(scene, *state) for state in STATES]
    with ThreadPoolExecutor(4) as threads:
        together = list(threads.map(lambda state: of_a_scene(scene, *state), STATES))
    for one, other in zip(alone, together, strict=True):
        for x, y in zip(one, other, strict=True):
            np.testing.assert_array_equal(x, y)


def test_a_call_that_was_refused_leaves_no_trace() -> None:
    stop = E.JointStop(joint=2, range=(-0.5, 0.5))
    friction = E.DryJointFriction(joint=1, coulomb=0.3)
    scene = pc.Scene(links=[ROD] * 3, effects=[stop, friction])
    q, qd = np.array([0.1, 0.3, 2.0]), np.array([1.0, -1.0, 0.5])
    before = of_a_scene(scene, q, qd)
    for refused in ([0.1, 0.6, 2.0], [0.0, 0.0, 0.0]):
        try:
            scene.linearize(refused, 0.0)
        except ValueError:
            continue
        raise AssertionError("it was not refused")
    for one, other in zip(before, of_a_scene(scene, q, qd), strict=True):
        np.testing.assert_array_equal(one, other)
