"""Random runs with impacts, stick and release, and the derivatives of their ends."""

from __future__ import annotations

import random
import re
from typing import Any

import numpy as np
from described_scenes import scene_of
from numpy.typing import NDArray
from reference.complex_runs import LITTLE, Friction, HybridRun, Range
from reference.effects import Described
from reference.named_numbers import Numbers, pieces
from reference.newton_euler import Body

from derivatives.random_run import RandomRun

WITH_TABLES = 300
"""From this seed on, some motors have tables, and some joints rest at the start."""


def drawn(seed: int) -> RandomRun:
    """Draw a case of one to three links, whose joints have dry friction or stops."""
    some = random.Random(seed)
    n = some.choice([1, 2, 2, 2, 3])

    def between(low: float, high: float) -> float:
        return round(some.uniform(low, high), 4)

    bodies = []
    for _ in range(n):
        mass, length = between(0.3, 2.0), between(0.4, 1.2)
        center = round(length * between(0.3, 0.7), 4)
        bodies.append(Body(mass, length, center, round(mass * length**2 * between(0.05, 0.1), 5)))
    q0 = [between(-2.5, 2.5) for _ in range(n)]
    qd0 = [between(-4.0, 4.0) for _ in range(n)]
    described: list[Described] = []
    for j in range(n):
        phi = q0[j] - (q0[j - 1] if j else 0.0)
        kind = some.choice(["friction", "friction", "stop", "stop", "none"])
        if kind == "friction":
            told: dict[str, Any] = {"joint": j + 1, "coulomb": between(0.1, 3.0)}
            if some.random() < 0.5:
                told |= {
                    "static": round(told["coulomb"] * between(1.05, 1.8), 4),
                    "stribeck_velocity": between(0.3, 1.0),
                    "exponent": some.choice([1.0, 2.0]),
                }
            described.append(("dry_joint_friction", told))
        elif kind == "stop":
            ends = (round(phi - between(0.05, 1.5), 4), round(phi + between(0.05, 1.5), 4))
            told = {"joint": j + 1, "range": ends, "capture_speed": between(0.01, 0.3)}
            told["restitution"] = some.choice([0.0, between(0.1, 0.95), between(0.1, 0.95)])
            described.append(("joint_stop", told))
    if seed >= WITH_TABLES:
        put_to_rest(some, q0, qd0, described)
    joint = some.randint(1, n)
    smooth: list[Described] = [
        ("viscous_joint", {"joint": joint, "damping": between(0.0, 0.5)}),
        ("torsional_spring", {"joint": joint, "stiffness": between(0.0, 9.0)}),
        ("motor", {"joint": joint, "sinusoid": {"amplitude": between(0.5, 6.0),
                                                "angular_frequency": between(1.0, 9.0)}}),
        ("payload", {"mass": between(0.1, 1.0)}),
        ("rotor_inertia", {"joint": joint, "armature": between(0.01, 0.3)}),
        ("driven_pivot", {"y": {"amplitude": between(0.01, 0.1), "angular_frequency": 7.0}}),
    ]  # fmt: skip
    described += some.sample(smooth, some.randint(0, 3))
    if seed >= WITH_TABLES and some.random() < 0.7:
        times = [0.0, *sorted(between(0.05, 1.9) for _ in range(some.randint(1, 4))), 2.5]
        table = {"t": times, "torque": [between(-6.0, 6.0) for _ in times]}
        more = {"limit": between(1.0, 5.0)} if some.random() < 0.5 else {}
        table["hold"] = some.random() < 0.4
        described.append(("motor", {"joint": some.randint(1, n), "table": table, **more}))
    scene = scene_of(bodies, 9.807, described)
    starts = [f"{what}[{i}]" for what in ("q0", "qd0") for i in range(1, n + 1)]
    unknown = re.compile(r"capture_speed|exponent")
    named = [
        name
        for name, value in scene.parameters().items()
        if not unknown.search(name) and np.isfinite(value) and value != 0
    ]
    names = [*some.sample(starts, min(2, len(starts))), *some.sample(named, min(5, len(named)))]
    changes = {name: some.choice([-1.0, 1.0]) * between(0.3, 1.0) for name in names}
    return RandomRun(bodies=bodies, gravity=9.807, described=described, q0=q0, qd0=qd0,
                      t_end=between(0.5, 2.0), changes=changes)  # fmt: skip


def put_to_rest(
    some: random.Random, q0: list[float], qd0: list[float], described: list[Described]
) -> None:
    """Let some joints begin at rest, and some of these at a stop."""
    for j in range(len(q0)):
        if some.random() < 0.5:
            continue
        qd0[j] = qd0[j - 1] if j else 0.0
        for kind, told in described:
            if kind == "joint_stop" and told["joint"] == j + 1 and some.random() < 0.7:
                phi, (lower, upper) = q0[j] - (q0[j - 1] if j else 0.0), told["range"]
                told["range"] = some.choice([(phi, upper), (lower, phi)])


def by_complex_numbers(
    case: RandomRun, changes: dict[str, float], step: float
) -> tuple[NDArray[Any], NDArray[Any], list[str]]:
    """Return the state at the end, its derivative along these changes, and the events."""
    numbers = Numbers(case.bodies, case.gravity, case.described, [*case.q0, *case.qd0])
    for _, told in numbers.described:
        if "range" in told:
            told["range"] = dict(zip(("lower", "upper"), told["range"], strict=True))
        if "coulomb" in told:
            told.setdefault("static", None)
            told.setdefault("stribeck_velocity", 0.1)
    for name, change in changes.items():
        numbers.move(name, change * LITTLE)
    friction, stops, smooth, laws = {}, {}, [], [(0.0, [])]
    for kind, told in numbers.described:
        if "table" in told:
            laws = [(t, [(kind, piece)]) for t, piece in pieces(told)]
            continue
        if kind not in {"dry_joint_friction", "joint_stop"}:
            smooth.append((kind, told))
            continue
        joint = told.pop("joint") - 1
        if kind == "joint_stop":
            stops[joint] = Range(**told.pop("range"), **told)
        else:
            told["static"] = told["coulomb"] if told["static"] is None else told["static"]
            friction[joint] = Friction(**told)
    (_, rig), *later = [(t, numbers.rig([*smooth, *law])) for t, law in laws]
    run = HybridRun(rig=rig, later=later, friction=friction, stops=stops)
    end = run.end(numbers.y, case.t_end, step)
    return end.real, end.imag / LITTLE.imag, run.events
