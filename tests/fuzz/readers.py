"""The readers: each takes choices, damages valid input, reads it, and uses the result.

A reader either works or raises one of `REFUSALS` with a message, within `MOST_SECONDS`; anything
else is a finding.
"""

from __future__ import annotations

import copyreg
import tempfile
import time
import warnings
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
from pendcore import _core

from fuzz import damage
from fuzz.choices import Choices

REFUSALS = (ValueError, TypeError, KeyError)
EXAMPLES = Path(__file__).parents[2] / "examples"
STEPS = {"max_steps": 200, "time_limit": 2.0}
MOST_SECONDS = 5.0
"""Processor time that an input may take, also on a busy machine. Most take 0.02 s."""


def whole_cases() -> list[str]:
    """Return the case files that damage begins with: the project's examples, and hard cases."""
    cases = [path for path in sorted(EXAMPLES.rglob("*.toml")) if path.name != "ruff.toml"]
    examples = [path.read_text() for path in cases]
    return [*examples, *(solution.case().to_toml() for solution in _hard_solutions())]


@cache
def whole_solutions() -> list[pc.Solution]:
    """Return short solutions of every form: stored, sampled, with modes, cut short, backward."""
    fx = pc.effects
    rod = pc.Link(mass=1.0, length=1.0)
    driven = [
        fx.Motor(1, table=fx.Table([-1.0, 0.5, 2.0], [1.0, -1.0, 0.5])),
        fx.DryJointFriction(2, coulomb=0.2, static=0.3),
        fx.DrivenPivot(spline=fx.Spline([-1.0, 0.0, 2.0], [0.0, 0.1, 0.0], [0.1, 0.0, 0.1])),
        fx.Motor(2, pd=fx.PD(3.0, 0.1, 0.5), limit=0.5),
    ]
    plain = pc.Scene(links=[rod, rod]), [0.3, 1.0], [0.0, 0.0]
    moved = pc.Scene(links=[rod, rod, rod], effects=driven), [0.3, 1.0, 0.5], [0.0, 1.0, 0.0]
    held = [fx.Lock(2), fx.RodDrag(1, 1.0, 0.1)]
    locked = pc.Scene(links=[rod, rod], effects=held), [0.3, 1.0], [1.0, 1.0]
    runs: list[tuple[Any, tuple[float, float], dict[str, Any]]] = [
        (plain, (0, 0.2), {}),
        (plain, (0.2, 0), {"store": "steps", "max_steps": 5}),
        (plain, (0, 0.2), {"t_eval": [0.0, 0.1, 0.2], "ledger": True}),
        (moved, (0, 0.4), {"ledger": True}),
        (moved, (0, 1.0), {"max_steps": 9}),
        (locked, (0, 0.3), {"rtol": [1e-6] * 4, "max_step": 0.01}),
        (plain, (0, 0), {}),
    ]
    found = [
        pc.simulate(scene, span, q0, qd0, on_failure="ignore", **how)
        for (scene, q0, qd0), span, how in runs
    ]
    return [*found, *_hard_solutions()]


@cache
def _hard_solutions() -> list[pc.Solution]:
    """Return solutions with events, with bounces, by all methods, and with compensated steps."""
    fx, ev = pc.effects, pc.events
    rods = [pc.Link(mass=1.0, length=1.0)] * 2
    stops = [fx.JointStop(1, range=(0.0, 0.6), restitution=0.6), fx.JointStop(2, range=(-1, 0.8))]
    bouncing = pc.Scene(links=rods, effects=[*stops, fx.DryJointFriction(1, coulomb=0.1)])
    damped = pc.Scene(links=rods, effects=[*stops, fx.ViscousJoint(2, damping=1e3)])
    watched = [
        ev.LinkAngle(1, 0.5, name="half"),
        ev.RateZero(joint=1, direction=-1),
        ev.TipLine(point=(1.3, 1.3), normal=(1.0, -0.5)),
    ]
    till_the_second = [ev.JointAngle(1, 1.5, every_turn=True, terminal=2)]

    def solution(scene: pc.Scene, **how: Any) -> pc.Solution:
        return pc.simulate(scene, q0=[0.3, 1.0], qd0=[2.0, 0.0], t_span=(0, 0.2), rtol=1e-4, **how)

    return [
        solution(bouncing, events=watched, ledger=True),
        solution(bouncing, events=watched, method="radau5"),
        solution(bouncing, method="dopri5", compensated=True, store="steps"),
        solution(damped, method="radau5", compensated=True),
        solution(damped, method="dopri5-radau5", ledger=True),
        pc.simulate(
            bouncing.replace(effects=[]), q0=[0.3, 1], t_span=(0, 9), events=till_the_second
        ),
    ]


@cache
def whole_archives() -> list[bytes]:
    """Return the same as npz files."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.npz")
        found = []
        for solution in whole_solutions():
            solution.save(path)
            found.append(path.read_bytes())
    return found


@cache
def whole_stores() -> list[dict[str, bytes]]:
    """Return stores, as the contents of their files: with reducers, with times, not all run."""
    scene, starts = pc.Scene.textbook(), pc.sampling.uniform(-2, 2, (2, 3, 2), seed=1)
    over = pc.events.LinkAngle(2, 0.5, every_turn=True)
    asked: list[dict[str, Any]] = [
        {"vary": {"gravity": [5.0, 7.0, 9.0]}, "keep": {
            "over": pc.reducers.FirstEvent(over), "extremes": pc.reducers.Extremes()}},
        {"keep": "times", "t_eval": [0.1, 0.2], "max_steps": 3},
        {},
    ]  # fmt: skip
    found = []
    for one in asked:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, "a.zarr")
            pc.ensemble(
                scene, q0=starts, t_span=(0, 0.2), store=path, chunk=2, on_failure="ignore", **one
            )
            files = sorted(file for file in path.rglob("*") if file.is_file())
            found.append({file.relative_to(path).as_posix(): file.read_bytes() for file in files})
    left_out = [name for name in found[-1] if name.startswith("status/c/1/")]
    found[-1] = {name: content for name, content in found[-1].items() if name not in left_out}
    return found


def use(solution: pc.Solution) -> None:
    """Ask a solution for all that it has."""
    solution.t, solution.y, solution.stats, solution.message, solution.success, solution.case()
    repr(solution), solution.relative_angles(), solution.positions(), solution.reactions()
    solution.energy()
    reached = solution._run.t_reached
    if solution.store == "dense":
        solution(np.linspace(solution._run.arguments["t_start"], reached, 5))
    # Whatever the file says, STEPS bounds the run if it goes on.
    for end in (reached, reached + 0.5, reached - 0.5, solution._run.arguments["t_end"]):
        try:
            solution.resume(end, **STEPS)
        except REFUSALS:
            continue


def read_case(text: str) -> None:
    """Read a case, and run it shortly."""
    case = pc.read_case(text + "\n")
    repr(case), hash(case)
    case = pc.Case(
        scene=case.scene, q0=case.q0, qd0=case.qd0, t_span=case.t_span,
        options=dict(case.options) | STEPS,
    )  # fmt: skip
    pc.read_case(case.to_toml())
    use(case.simulate())


def a_case(choices: Choices) -> None:
    read_case(damage.text(choices, choices.one_of(whole_cases())))


def read_archive(data: bytes) -> None:
    """Load a file that holds these bytes."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "run.npz")
        path.write_bytes(data)
        use(pc.load(path))


def an_archive(choices: Choices) -> None:
    read_archive(damage.archive(choices, choices.one_of(whole_archives())))


def read_store(files: Mapping[str, bytes]) -> None:
    """Load a folder of these files, and use all of it. A file may well be unreadable."""
    with tempfile.TemporaryDirectory() as folder:
        for name, content in files.items():
            path = Path(folder, name)
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(content)
        try:
            found = pc.load(folder)
            repr(found), str(found), found.status, found.q, found.qd, found.t, found.energy()
        except OSError as refusal:
            raise ValueError(str(refusal)) from refusal


def a_store(choices: Choices) -> None:
    read_store(damage.folder(choices, choices.one_of(whole_stores())))


def a_state(choices: Choices) -> None:
    solution = choices.one_of(whole_solutions())
    run = _core.Run.__new__(_core.Run)
    run.__setstate__(damage.state(choices, solution._run.__getstate__()))
    use(pc.Solution(solution.scene, run))


def a_scene(choices: Choices) -> None:
    """Build a scene from what its pickle holds, some of it replaced."""
    scene = choices.one_of(whole_solutions()).scene
    build, (links, gravity, effects) = scene.__reduce__()
    parts = [_a_part(choices, x) for x in (*links, *effects)]
    links, effects = parts[: len(links)], parts[len(links) :]
    if choices.integer(0, 5) == 0:
        gravity = choices.one_of(damage.VALUES)
    found = build(links, gravity, effects)
    q0 = np.linspace(0.1, 0.3, len(found.links))
    repr(found), use(pc.simulate(found, q0=q0, t_span=(0, 0.1), **STEPS))


def _a_part(choices: Choices, whole: Any) -> Any:
    if choices.integer(0, 2):
        return whole
    if isinstance(whole, pc.Link):
        link = copyreg.__newobj__(pc.Link)
        numbers = list(whole.__getstate__())
        numbers[choices.integer(0, 3)] = choices.one_of(damage.VALUES)
        link.__setstate__(numbers)
        return link
    build, (cls, values) = whole.__reduce__()
    key = choices.one_of(sorted(values))
    return build(cls, dict(values) | {key: damage.value(choices, values[key])})


READERS: dict[str, Callable[[Choices], None]] = {
    "case": a_case,
    "archive": an_archive,
    "state": a_state,
    "scene": a_scene,
    "store": a_store,
}


def finding(read: Callable[[], None], most_seconds: float = MOST_SECONDS) -> str | None:
    """Return what is wrong with how a reader took something damaged; None where it did well."""
    begin = time.process_time()
    with warnings.catch_warnings(), np.errstate(all="ignore"):
        warnings.simplefilter("ignore", pc.PendcoreWarning)
        try:
            read()
        except REFUSALS as refusal:
            if len(str(refusal)) <= 5:
                return f"{refusal!r} says nothing"
        except Exception as error:
            return f"{type(error).__name__}: {error}"
    taken = time.process_time() - begin
    return f"took {taken:.1f} s of processor time" if taken > most_seconds else None
