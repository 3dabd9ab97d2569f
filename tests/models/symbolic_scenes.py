"""Scenes for the derivation in symbols: every smooth effect, and numbers drawn at random.

A derivation holds for any numbers. So a chain is derived once, and looked at with many.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

import mpmath
import numpy as np
import numpy.typing as npt
import pendcore as pc
import sympy
from pendcore.derive import Derivation

fx = pc.effects
Draw = Callable[[float, float], float]
Floats = npt.NDArray[np.float64]
DIGITS = 40


def links(n: int, draw: Draw, uniform: bool = False) -> list[pc.Link]:
    found = []
    for _ in range(n):
        mass, length = draw(0.3, 2.0), draw(0.3, 2.0)
        center = length * draw(0.2, 0.8)
        inertia = mass * center * (length - center) * draw(0.1, 0.9)
        own = {} if uniform else {"center": center, "inertia": inertia}
        found.append(pc.Link(mass=mass, length=length, **own))
    return found


def wave(draw: Draw, size: float) -> Any:
    return fx.Sinusoid(draw(-size, size), draw(0.5, 9.0), phase=draw(-3.0, 3.0))


def viscous_joint(n: int, draw: Draw) -> list[Any]:
    return [
        fx.ViscousJoint(joint=1, damping=draw(0, 1)),
        fx.ViscousJoint(
            joint=n, damping=draw(0, 1), damping2=draw(0.1, 1), damping3=draw(0.1, 0.3)
        ),
    ]


def torsional_spring(n: int, draw: Draw) -> list[Any]:
    return [
        fx.TorsionalSpring(joint=1, stiffness=draw(1, 9)),
        fx.TorsionalSpring(joint=n, stiffness=draw(1, 9), rest_angle=draw(-2, 2)),
    ]


def motor(n: int, draw: Draw) -> list[Any]:
    return [
        fx.Motor(joint=1, constant=draw(-3, 3), limit=3.5),
        fx.Motor(joint=n, sinusoid=wave(draw, 3)),
        fx.Motor(joint=n, pd=fx.PD(kp=draw(1, 9), kd=draw(0, 1), reference=draw(-2, 2))),
    ]


def rotor_inertia(n: int, draw: Draw) -> list[Any]:
    return [fx.RotorInertia(joint=j, armature=draw(0.01, 0.3)) for j in (1, n)]


def payload(n: int, draw: Draw) -> list[Any]:
    return [fx.Payload(mass=draw(0.1, 1)), fx.Payload(mass=draw(0.1, 1), inertia=draw(0.01, 0.1))]


def driven_pivot(n: int, draw: Draw) -> list[Any]:
    return [fx.DrivenPivot(x=wave(draw, 0.2), y=wave(draw, 0.2))]


def rod_drag(n: int, draw: Draw) -> list[Any]:
    wind = draw(-4, 4), draw(-4, 4)
    return [
        fx.RodDrag(link=1, drag_coefficient=draw(0.5, 2), diameter=draw(0.1, 0.3)),
        fx.RodDrag(link=n, drag_coefficient=draw(0.5, 2), diameter=draw(0.1, 0.3), wind=wind),
    ]


def lock(n: int, draw: Draw) -> list[Any]:
    return [fx.Lock(joint=n)]


SMOOTH = {
    f.__name__: f
    for f in (
        driven_pivot, lock, motor, payload, rod_drag, rotor_inertia, torsional_spring,
        viscous_joint,
    )
}  # fmt: skip
"""Effects of each kind on a chain of n links."""


def together(*kinds: str) -> Callable[[int, Draw], list[Any]]:
    return lambda n, draw: [effect for kind in kinds for effect in SMOOTH[kind](n, draw)]


FREE = [kind for kind in SMOOTH if kind != "lock"]
SETS: dict[str, Callable[[int, Draw], list[Any]]] = {
    "none": together(),
    "none, uniform rods": together(),
    **SMOOTH,
    "all": together(*FREE),
    "all, locked": together(*FREE, "lock"),
    "two pivots": together("driven_pivot", "driven_pivot", "rod_drag"),
    "all locked": lambda n, draw: [fx.Lock(joint=j) for j in range(1, n + 1)],
    "locked first": lambda n, draw: [*SMOOTH["motor"](n, draw), fx.Lock(joint=1)],
}


def scene(name: str, n: int, seed: int) -> pc.Scene:
    """A chain with numbers drawn at random."""
    rng = np.random.default_rng([n, seed])

    def draw(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    made = SETS[name](n, draw)
    rods = links(n, draw, uniform="uniform" in name)
    return pc.Scene(links=rods, gravity=draw(0, 15), effects=made)


@dataclass(frozen=True)
class State:
    """One instant."""

    t: float
    q: Floats
    qd: Floats


def states(scene: pc.Scene, seed: int, count: int = 3) -> list[State]:
    """States that the locks of a scene allow."""
    n, rng, found = len(scene.links), np.random.default_rng(seed), []
    for _ in range(count):
        t, q, qd = rng.uniform(0, 3), rng.uniform(-4, 4, n), rng.uniform(-4, 4, n)
        for joint in sorted(effect.joint for effect in scene.effects if effect.kind == "lock"):
            qd[joint - 1] = qd[joint - 2] if joint > 1 else 0.0
        found.append(State(float(t), q, qd))
    return found


derivation = cache(Derivation)
"""The derivation of a scene, made once."""


def derived(name: str, n: int) -> Derivation:
    """The derivation of a chain, for any numbers."""
    return derivation(scene(name, n, seed=0))


class Evaluated:
    """Expressions of a derivation, in forty digits, for the numbers of any such scene."""

    def __init__(self, of: Derivation, expressions: list[Any]) -> None:
        s = of.symbols
        self._symbols = [s.t, *s.q, *s.qd, *s.qdd, *s.values]
        self._function = sympy.lambdify(self._symbols, expressions, modules="mpmath", cse=True)

    def __call__(self, scene: pc.Scene, state: State, qdd: Any = None) -> list[Any]:
        """Return the values; the numbers of the scene are by the names of its own derivation."""
        values = derivation(scene).values
        parameters = [values[symbol] for symbol in self._symbols if symbol in values]
        n = len(scene.links)
        with mpmath.workdps(DIGITS):
            given = [state.t, *state.q, *state.qd, *([0.0] * n if qdd is None else qdd)]
            return list(self._function(*map(mpmath.mpf, [*given, *parameters])))


def named_in_order(of: Derivation) -> list[Any]:
    """The accelerations by `shared`, put together again."""
    known: dict[Any, Any] = {}
    for symbol, value in of.shared:
        known[symbol] = value.xreplace(known)
    return [a.xreplace(known) for a in of.shared_accelerations]
