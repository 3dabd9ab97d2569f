"""Runs that kept a few times, or their end alone, each beside the same run with dense output."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
from matplotlib.artist import Artist
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from pendcore.plotting.stage import Film, Stage

TEXTBOOK = pc.Scene.textbook()
STOP = 1.9
BOUNCING = TEXTBOOK.replace(
    effects=[
        pc.effects.JointStop(joint=1, range=(-1.0, STOP), restitution=0.6),
        pc.effects.ViscousJoint(joint=2, damping=0.05),
    ]
)
RESTING = pc.Scene(
    links=[pc.Link(mass=1.0, length=1.0)],
    effects=[
        pc.effects.JointStop(joint=1, range=(-1.0, STOP), restitution=0.4),
        pc.effects.DryJointFriction(joint=1, coulomb=0.6),
    ],
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


Pair = tuple[Callable[[Path], pc.Solution], Callable[[], pc.Solution]]


def alike(scene: pc.Scene, keep: dict[str, Any] | None = None, **options: Any) -> Pair:
    """Return what makes a run that keeps eleven times, or what `keep` says, and the dense run."""
    if keep is None:
        return lambda _: few(scene, **options), lambda: simulate(scene, **options)
    return lambda _: simulate(scene, **options, **keep), lambda: simulate(scene, **options)


def loaded(folder: Path) -> pc.Solution:
    few(BOUNCING).save(folder / "run.npz")
    return pc.load(folder / "run.npz")


def member(_: Path) -> pc.Solution:
    starts, times = np.array([[1.8, 2.5], [1.9, 2.5]]), np.linspace(0, 10, 11)
    return pc.ensemble(TEXTBOOK, (0, 10), starts, keep="times", t_eval=times).member(0)


def resumed_twice(run: pc.Solution) -> pc.Solution:
    return run.resume(10.0).resume(10.0)


def resumed_after_a_break(run: pc.Solution) -> pc.Solution:
    return run.resume(10.0, max_steps=30, on_failure="ignore")


EVENT, BREAK = {"events": [BOTTOM]}, {"max_steps": 40}
CAP: dict[str, Any] = {"max_steps": 5, "on_failure": "ignore"}
RUNS: dict[str, Pair] = {
    "dense": alike(TEXTBOOK, {}),
    "times": alike(TEXTBOOK),
    "one time": alike(TEXTBOOK, {"t_eval": [7.0]}),
    "end": alike(TEXTBOOK, {"store": "end"}),
    "steps": alike(TEXTBOOK, {"store": "steps"}),
    "backward": alike(TEXTBOOK, t_span=(10, 0)),
    "stop": alike(BOUNCING),
    "at rest on its stop": alike(RESTING, {}),
    "loaded": (loaded, lambda: simulate(BOUNCING)),
    "ledger": alike(BOUNCING, {"store": "end", "ledger": True}),
    "member": (member, lambda: simulate(TEXTBOOK)),
    "event": alike(TEXTBOOK, **EVENT),
    "resumed past events": (
        lambda _: resumed_twice(few(TEXTBOOK, **EVENT)),
        lambda: resumed_twice(simulate(TEXTBOOK, **EVENT)),
    ),
    "broken off past events": (
        lambda _: resumed_twice(few(TEXTBOOK, **EVENT)).resume(10.0, **CAP),
        lambda: resumed_twice(simulate(TEXTBOOK, **EVENT)).resume(10.0, **CAP),
    ),
    "resumed to a later end": (
        lambda _: simulate(TEXTBOOK, store="end", t_span=(0, 4)).resume(10.0),
        lambda: simulate(TEXTBOOK),
    ),
    "broken off": alike(BOUNCING, **BREAK),
    "resumed after a break": (
        lambda _: resumed_after_a_break(few(BOUNCING, **BREAK)),
        lambda: resumed_after_a_break(simulate(BOUNCING, **BREAK)),
    ),
    "broken off before its first step": alike(TEXTBOOK, {"t_eval": [3.0, 4.0]}, time_limit=1e-9),
    "fixed steps": alike(TEXTBOOK, method="rk4", step=0.01),
    "stiff": alike(BOUNCING, method="radau5"),
    "asked for an error": alike(TEXTBOOK, error=1e-4),
}


def stage(
    *runs: pc.Solution,
    names: Sequence[str] = (),
    size: tuple[float, float] = (8.0, 4.5),
    **given: Any,
) -> Stage:
    """Return a film's picture; the size is in inches."""
    called = names or [""] * len(runs)
    return Stage(Film(solutions=runs, names=called, **given), partial(Figure, figsize=size))


def axes(rows: int = 1) -> Any:
    return Figure().subplots(rows, 1, squeeze=False)[:, 0]


def places(run: pc.Solution, t: Any) -> Any:
    return run.scene._compiled.positions(t, np.ascontiguousarray(run(t)[: len(run.scene.links)].T))


def chain_of(film: Stage, k: int) -> np.ndarray:
    """Return where the joints of the first chain are in frame k, (n+1, 2)."""
    return joints_of(film.show(k))


def joints_of(shown: Sequence[Artist]) -> np.ndarray:
    """Return where the joints of the first chain are among what a frame shows, (n+1, 2)."""
    joints = next(x for x in shown if isinstance(x, Line2D) and x.get_marker() == "o")
    return np.array(joints.get_data()).T


def trace_of(film: Stage, k: int) -> np.ndarray:
    """Return the tip's path in frame k, (points, 2); its parts meet."""
    parts = film.show(k)[0].get_segments()
    return np.concatenate([parts[0], *(part[1:] for part in parts[1:])])
