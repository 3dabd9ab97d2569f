"""Runs that kept a few times, or their end alone, each beside the same run with dense output."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
from matplotlib.figure import Figure
from pendcore.films.stage import Choices, Stage

TEXTBOOK = pc.Scene.textbook()
STOP = 1.9
BOUNCING = TEXTBOOK.replace(
    effects=[
        pc.effects.JointStop(joint=1, range=(-1.0, STOP), restitution=0.6),
        pc.effects.ViscousJoint(joint=2, damping=0.05),
    ]
)
SWINGING = pc.Scene(links=[pc.Link.point_mass(mass=1.0, length=1.0)])
BOTTOM = pc.events.LinkAngle(1, np.pi / 2, terminal=True)


def simulate(scene: pc.Scene, **options: Any) -> pc.Solution:
    start = {
        "q0": [1.8, 2.5] if len(scene.links) == 2 else 0.3,
        "t_span": (0, 10),
        "on_failure": "ignore",
    }
    return pc.simulate(scene, **(start | options))


def few(scene: pc.Scene, **options: Any) -> pc.Solution:
    """Return a run that kept eleven times in ten seconds."""
    first, last = options.get("t_span", (0, 10))
    return simulate(scene, t_eval=np.linspace(first, last, 11), **options)


def loaded(run: pc.Solution, folder: Path) -> Any:
    run.save(folder / "run.npz")
    return pc.load(folder / "run.npz")


def member(**options: Any) -> pc.Solution:
    starts = np.array([[1.8, 2.5], [1.9, 2.5]])
    return pc.ensemble(TEXTBOOK, q0=starts, t_span=(0, 10), on_failure="ignore", **options).member(
        0
    )


RUNS: dict[str, tuple[Callable[[Path], pc.Solution], Callable[[], pc.Solution]]] = {
    "times": (lambda _: few(TEXTBOOK), lambda: simulate(TEXTBOOK)),
    "one time": (lambda _: simulate(TEXTBOOK, t_eval=[7.0]), lambda: simulate(TEXTBOOK)),
    "end": (lambda _: simulate(TEXTBOOK, store="end"), lambda: simulate(TEXTBOOK)),
    "steps": (lambda _: simulate(TEXTBOOK, store="steps"), lambda: simulate(TEXTBOOK)),
    "backward": (
        lambda _: few(TEXTBOOK, t_span=(10, 0)),
        lambda: simulate(TEXTBOOK, t_span=(10, 0)),
    ),
    "stop": (lambda _: few(BOUNCING), lambda: simulate(BOUNCING)),
    "loaded": (lambda folder: loaded(few(BOUNCING), folder), lambda: simulate(BOUNCING)),
    "ledger": (
        lambda _: simulate(BOUNCING, store="end", ledger=True),
        lambda: simulate(BOUNCING),
    ),
    "member": (
        lambda _: member(keep="times", t_eval=np.linspace(0, 10, 11)),
        lambda: simulate(TEXTBOOK),
    ),
    "event": (
        lambda _: few(TEXTBOOK, events=[BOTTOM]),
        lambda: simulate(TEXTBOOK, events=[BOTTOM]),
    ),
    "resumed past events": (
        lambda _: few(TEXTBOOK, events=[BOTTOM]).resume(10.0).resume(10.0),
        lambda: simulate(TEXTBOOK, events=[BOTTOM]).resume(10.0).resume(10.0),
    ),
    "resumed to a later end": (
        lambda _: simulate(TEXTBOOK, store="end", t_span=(0, 4)).resume(10.0),
        lambda: simulate(TEXTBOOK),
    ),
    "broken off": (
        lambda _: few(BOUNCING, max_steps=40),
        lambda: simulate(BOUNCING, max_steps=40),
    ),
    "resumed after a break": (
        lambda _: few(BOUNCING, max_steps=40).resume(10.0, max_steps=30, on_failure="ignore"),
        lambda: simulate(BOUNCING, max_steps=40).resume(10.0, max_steps=30, on_failure="ignore"),
    ),
    "broken off before its first step": (
        lambda _: simulate(TEXTBOOK, t_eval=[3.0, 4.0], time_limit=1e-9),
        lambda: simulate(TEXTBOOK, time_limit=1e-9),
    ),
    "fixed steps": (
        lambda _: few(TEXTBOOK, method="rk4", step=0.01),
        lambda: simulate(TEXTBOOK, method="rk4", step=0.01),
    ),
    "stiff": (
        lambda _: few(BOUNCING, method="radau5"),
        lambda: simulate(BOUNCING, method="radau5"),
    ),
    "asked for an error": (
        lambda _: few(TEXTBOOK, error=1e-4),
        lambda: simulate(TEXTBOOK, error=1e-4),
    ),
}


def stage(*runs: pc.Solution, **given: Any) -> Stage:
    return Stage(runs, Figure(), Choices(**given), [""] * len(runs))


def axes(rows: int = 1) -> Any:
    return Figure().subplots(rows, 1, squeeze=False)[:, 0]


def places(run: pc.Solution, t: Any) -> Any:
    return run.scene._compiled.positions(t, np.ascontiguousarray(run(t)[: len(run.scene.links)].T))
