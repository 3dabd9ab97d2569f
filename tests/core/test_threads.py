"""Threads of Python share scenes and solutions at once, and each gets the bits of one alone."""

from __future__ import annotations

import threading
import time
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pendcore as pc
import pytest
from pendcore import effects as fx

BOOK = pc.Scene.textbook()
SCENES = {
    "bare": BOOK,
    "with switches": pc.Scene(links=[pc.Link(mass=1.0, length=0.6)] * 3, effects=[
        fx.DryJointFriction(2, coulomb=0.01),
        fx.Motor(1, table=fx.Table(t=[-1, 0.2, 0.6, 9], torque=[0.5, -0.5, 1.0, 1.0])),
        fx.DrivenPivot(spline=fx.Spline(t=[-1, 1, 9], x=[0, 0.1, 0], y=[0.1, 0, 0])),
        fx.Lock(3)]),
    "with a function": BOOK.replace(effects=[fx.User(lambda t, q, qd: -0.1 * qd)]),
}  # fmt: skip


def all_of(scene: pc.Scene, begun: pc.Solution) -> list[np.ndarray]:
    """Simulate, resume, sample and evaluate what is shared."""
    q0 = [0.7] * len(scene.links)
    whole = pc.simulate(scene, (0, 1.5), q0, ledger=True, compensated=True)
    sampled = pc.simulate(scene, (0, 1.5), q0, t_eval=np.linspace(0, 0.5, 20))
    return [
        whole.t, whole.y, sampled.y, begun.resume(1.5).y, begun(np.linspace(0, begun.t[-1], 50)),
        begun.energy().total, whole.energy().total, begun.reactions(), begun.positions(),
        scene.mass_matrix(begun.q),
    ]  # fmt: skip


@pytest.mark.parametrize("scene", SCENES.values(), ids=SCENES.keys())
def test_threads_on_one_scene_and_one_solution_compute_what_one_alone_does(scene: pc.Scene) -> None:
    begun = pc.simulate(scene, q0=[0.7] * len(scene.links), t_span=(0, 0.8))
    alone = all_of(scene, begun)
    together = threading.Barrier(6)

    def at_once(_: int) -> list[list[np.ndarray]]:
        together.wait()
        return [all_of(scene, begun) for _ in range(3)]

    with ThreadPoolExecutor(6) as pool:
        for found in [one for three in pool.map(at_once, range(6)) for one in three]:
            assert all(np.array_equal(a, b) for a, b in zip(alone, found, strict=True))


def test_others_run_while_the_core_computes() -> None:
    """A run holds no lock of Python's, so no thread beside it has to wait until the run ends."""
    ticks, over = [time.monotonic()], threading.Event()

    def look_at_the_clock() -> None:
        while not over.wait(0.001):
            ticks.append(time.monotonic())

    beside = threading.Thread(target=look_at_the_clock)
    beside.start()
    begun = time.monotonic()
    pc.simulate(
        BOOK, (0, 1e9), 0.7, store="end", max_steps=10**12, time_limit=1.0,
        on_failure="ignore", progress=False,
    )  # fmt: skip
    length = time.monotonic() - begun
    over.set()
    beside.join()
    assert length >= 1.0
    assert np.diff([*ticks, time.monotonic()]).max() < 0.9 * length
