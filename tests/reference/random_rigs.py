"""Random chains, effects and states for hypothesis.

The effects are about as strong as the weight of the links, so that an error in any of them shows.
An effect is described by its kind and its parameters; see `reference.effects.Described`.
"""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from typing import Any

from compiled_functions import FORCES
from hypothesis import assume
from hypothesis import strategies as st

from reference.effects import Described
from reference.newton_euler import Body

State = tuple[float, list[float], list[float]]
"""Time, angles and rates."""

NOT_SMOOTH = {"dry_joint_friction"}
START, END = 0.0, 1.0  # the times of random states

gravities = st.just(0.0) | st.floats(1, 20)


def between(low: float, high: float) -> st.SearchStrategy[float]:
    """Numbers of six decimals: none is so small that its square vanishes."""
    return st.floats(low, high).map(lambda x: round(x, 6))


@st.composite
def links(draw: st.DrawFn, mass_decades: float = 1.0, length_decades: float = 0.5) -> Body:
    """A link that a rod with a few lumps on it could be, around 1 kg and 1 m."""
    mass = 10 ** draw(st.floats(-mass_decades, mass_decades))
    length = 10 ** draw(st.floats(-length_decades, length_decades))
    center = length * draw(st.floats(0.2, 0.8))
    return Body(mass, length, center, draw(st.floats(0.1, 0.9)) * mass * center * (length - center))


@st.composite
def knots(draw: st.DrawFn, count: int) -> list[float]:
    """Times that enclose those of the random states."""
    gaps = [draw(between(0.2, 1.0)) for _ in range(count - 1)]
    scale = (END - START + 0.5) / sum(gaps)
    return [START - 0.25 + scale * sum(gaps[:i]) for i in range(count - 1)] + [END + 0.25]


def sinusoids(size: float) -> st.SearchStrategy[dict[str, float]]:
    return st.fixed_dictionaries(
        {"amplitude": between(-size, size), "angular_frequency": between(0, 9)},
        optional={"phase": between(-3, 3)},
    )


@st.composite
def tables(draw: st.DrawFn, *columns: str, size: float = 3.0) -> dict[str, list[float]]:
    """Knots and as many values in every column."""
    count = draw(st.integers(3, 6))
    values = {name: [draw(between(-size, size)) for _ in range(count)] for name in columns}
    return {"t": draw(knots(count)), **values}


@st.composite
def motors(draw: st.DrawFn, joint: int) -> dict[str, Any]:
    mode = draw(st.sampled_from(["constant", "sinusoid", "table", "pd"]))
    told: dict[str, st.SearchStrategy[Any]] = {
        "constant": between(-5, 5),
        "sinusoid": sinusoids(3),
        "table": tables("torque"),
        "pd": st.fixed_dictionaries(
            {"kp": between(0, 10), "kd": between(0, 2), "reference": between(-3, 3)}
        ),
    }
    limit = draw(st.just({}) | st.fixed_dictionaries({"limit": between(0.5, 5)}))
    return {"joint": joint, mode: draw(told[mode]), **limit}


def polynomial(a: float, b: float, c: float) -> Any:
    """Forces of a user: of time, angles and rates, different on every link."""

    def forces(t: Any, q: Any, qd: Any) -> Any:
        return a * t - b * q - c * qd + b * q[::-1]

    def sizes(t: Any, q: Any, qd: Any) -> Any:
        return abs(a * t) + abs(b * q) + abs(c * qd) + abs(b * q[::-1])

    forces.sizes = sizes  # type: ignore[attr-defined]
    return forces


COMPILED: list[Any] = []  # what an address stands for lives as long as the tests


def address_of(a: float, b: float, c: float) -> int:
    """Compile the same forces, as far as ctypes compiles."""

    def write(t: float, n: int, q: Any, qd: Any, forces: Any, data: object) -> None:
        for i in range(n):
            forces[i] += a * t - b * q[i] - c * qd[i] + b * q[n - 1 - i]

    COMPILED.append(FORCES(write))
    return ctypes.cast(COMPILED[-1], ctypes.c_void_p).value or 0


def parameters(kind: str, joint: int) -> st.SearchStrategy[dict[str, Any]]:
    """Parameters of an effect; ``joint`` is the number of its joint or link."""
    at, user = {"joint": st.just(joint)}, [between(-2, 2)] * 3
    fixed, builds, small = st.fixed_dictionaries, st.builds, sinusoids(0.3)
    return {
        "viscous_joint": fixed(
            {**at, "damping": between(0, 3)},
            optional={"damping2": between(0, 1), "damping3": between(0, 0.3)},
        ),
        "dry_joint_friction": fixed({**at, "coulomb": between(0, 5)})
        | builds(
            lambda more, **given: {**given, "static": given["coulomb"] + more},
            **at,
            coulomb=between(0, 5),
            more=between(0, 5),
            stribeck_velocity=between(0.05, 2),
            exponent=between(1, 3),
        ),
        "rod_drag": fixed(
            {
                "link": st.just(joint),
                "drag_coefficient": between(0.5, 2),
                "diameter": between(0.01, 0.5),
            },
            optional={
                "air_density": between(0.5, 5),
                "wind": st.tuples(between(-9, 9), between(-9, 9)),
            },
        ),
        "torsional_spring": fixed(
            {**at, "stiffness": between(0, 20)}, optional={"rest_angle": between(-3, 3)}
        ),
        "rotor_inertia": fixed({**at, "armature": between(0, 2)}),
        "payload": fixed({"mass": between(0, 5)}, optional={"inertia": between(0, 1)}),
        "joint_stop": fixed({**at, "range": st.tuples(between(-99, -50), between(50, 99))}),
        "lock": fixed(at, optional={"angle": between(-3, 3)}),
        "driven_pivot": fixed({"x": small, "y": small})
        | fixed({"x": small})
        | fixed({"y": small})
        | fixed({"spline": tables("x", "y", size=0.3)}),
        "motor": motors(joint),
        "user": builds(lambda *c: {"function": polynomial(*c)}, *user),
        "compiled_user": builds(lambda *c: {"address": address_of(*c)}, *user),
    }[kind]


@st.composite
def effects(draw: st.DrawFn, kind: str, n: int) -> list[Described]:
    """Effects of one kind: on some joints or links, or one for the whole chain."""
    if kind in {"payload", "driven_pivot", "user", "compiled_user"}:
        return [(kind, draw(parameters(kind, 0)))]
    joints = draw(st.lists(st.integers(1, n), min_size=1, max_size=3, unique=True))
    return [(kind, draw(parameters(kind, joint))) for joint in joints]


DrawnRig = tuple[list[Body], float, list[Described], State]
"""Links, gravity, effects and a state."""


@st.composite
def rigs(draw: st.DrawFn, kinds: Sequence[str], sizes: st.SearchStrategy[int]) -> DrawnRig:
    """A chain with effects of each kind, at an instant."""
    n = draw(sizes)
    described = [one for kind in kinds for one in draw(effects(kind, n))]
    return (
        [draw(links()) for _ in range(n)],
        draw(gravities),
        described,
        draw(states(n, described)),
    )


@st.composite
def states(draw: st.DrawFn, n: int, effects: Sequence[Described]) -> State:
    """A state that the locks allow and in which dry friction slides."""
    q = [draw(between(-4, 4)) for _ in range(n)]
    qd = [draw(between(-10, 10)) for _ in range(n)]
    locked = {told["joint"]: told.get("angle") for kind, told in effects if kind == "lock"}
    for joint in sorted(locked):
        q_before, qd_before = (q[joint - 2], qd[joint - 2]) if joint > 1 else (0.0, 0.0)
        qd[joint - 1] = qd_before
        if locked[joint] is not None:
            q[joint - 1] = q_before + locked[joint]
    for kind, told in effects:
        if kind in NOT_SMOOTH and told["joint"] not in locked:
            joint = told["joint"]
            assume(qd[joint - 1] != (qd[joint - 2] if joint > 1 else 0.0))
    return draw(between(START, END)), q, qd
