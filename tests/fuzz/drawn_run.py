"""A random case: a scene, a start, a span, how it is run, and the events that it looks for."""

from __future__ import annotations

from dataclasses import dataclass, field
from math import inf, ulp
from typing import Any

import numpy as np
import pendcore as pc
from carried import carried
from pendcore import _core
from pendcore.options import RUN_DEFAULTS

from fuzz import drawn_scene, own_functions
from fuzz.choices import Choices, angle, happens, regime, signed, size

METHODS = tuple(method["name"] for method in _core.methods())
FIXED_STEP_METHODS = {method["name"] for method in _core.methods() if method["error_order"] == 0}
TIME_LIMIT = 5.0
"""s; max_steps bounds a case, and so does this limit if a step takes long."""


@dataclass
class Drawn:
    """The arguments of `pc.simulate`. They print as Python code that makes them again."""

    scene: pc.Scene
    q0: list[float]
    qd0: list[float]
    t_span: tuple[float, float]
    options: dict[str, Any] = field(default_factory=dict)

    def simulate(self, **changes: Any) -> pc.Solution:
        options = self.options | changes
        if "method" in options:
            options["method"] = carried(options["method"], self.scene)
        return pc.simulate(
            self.scene, q0=self.q0, qd0=self.qd0, t_span=self.t_span, on_failure="ignore", **options
        )

    def __repr__(self) -> str:
        keywords = "".join(f"    {name}={value!r},\n" for name, value in self.options.items())
        links = ",\n        ".join(repr(link) for link in self.scene.links)
        effects = ",\n        ".join(repr(effect) for effect in self.scene.effects)
        return (
            f"simulate(\n    Scene(links=[\n        {links},\n    ], "
            f"gravity={self.scene.gravity!r}, effects=[\n        {effects},\n    ]),\n"
            f"    q0={self.q0!r},\n    qd0={self.qd0!r},\n    t_span={self.t_span!r},\n{keywords})"
        )


def span(choices: Choices, regime: str) -> tuple[float, float]:
    """Return a start and an end: mostly seconds; of no length, of a few bits, far from 0."""
    length = choices.real(0, 5)
    start = choices.one_of((0.0, 0.0, 0.0, 1.0, -2.5))
    kind = choices.one_of(("plain",) * 8 + ("none", "bits", "far", "sized"))
    if kind == "none":
        length = 0.0
    elif kind == "far":
        start = signed(choices, "extreme")
    elif kind == "sized":
        length = size(choices, regime)
    if kind == "bits":
        start = signed(choices, "ordinary")
        length = choices.integer(1, 200) * ulp(start)
    return start, start + choices.one_of((1.0, 1.0, -1.0)) * length


def start(choices: Choices, regime: str, scene: pc.Scene) -> tuple[list[float], list[float]]:
    """Return angles and rates that mostly agree with what locks and stops say."""
    n = len(scene.links)
    q = [angle(choices, regime) for _ in range(n)]
    still = happens(choices, 25)
    qd = [0.0 if still else signed(choices, regime) for _ in range(n)]
    if happens(choices, 95):
        for effect in sorted(scene.effects, key=lambda e: getattr(e, "joint", 0)):
            joint = getattr(effect, "joint", 0)
            before = q[joint - 2] if joint > 1 else 0.0
            if effect.kind == "lock":
                qd[joint - 1] = qd[joint - 2] if joint > 1 else 0.0
                if effect.angle is not None:
                    q[joint - 1] = before + effect.angle
            elif hasattr(effect, "range"):
                low, high = effect.range
                low, high = max(low, -1e3), min(high, 1e3)
                share = choices.one_of((0.5, 0.0, 1.0, choices.real(0, 1)))
                q[joint - 1] = before + low + share * (high - low)
    return q, qd


def options(choices: Choices, regime: str, span: tuple[float, float]) -> dict[str, Any]:
    """Return how it is run: never without a bound on the steps and on the time."""
    length = abs(span[1] - span[0])
    steps = choices.one_of((1000, 1000, 3000, 300, 10, 1))
    given: dict[str, Any] = {"max_steps": steps, "time_limit": TIME_LIMIT}
    if len(METHODS) > 1:
        given["method"] = choices.one_of(METHODS)
    if happens(choices, 60):
        given["rtol"] = 10 ** choices.real(-13, -2)
        given["atol"] = 10 ** choices.real(-16, -3)
    elif happens(choices, 20):
        given["rtol"] = choices.one_of((1e-300, 1e-17, 1.0, 1e30))
        given["atol"] = choices.one_of((0.0, 1e-300, 1.0, 1e30))
    kind = choices.one_of(("",) * 6 + ("first_step", "max_step", "step"))
    if (
        given.get("method") in FIXED_STEP_METHODS
    ):  # without a step it is refused, which shows nothing
        kind = "step"
    if kind:
        given[kind] = size(choices, regime) * choices.one_of((1e-2, 1e-3, length or 1.0))
    given["store"] = choices.one_of(("dense", "dense", "steps", "end", "times"))
    if given["store"] == "times" or (given["store"] == "dense" and happens(choices, 20)):
        shares = sorted({choices.real(0, 1) for _ in range(choices.integer(1, 9))} | {1.0})
        times = np.unique(np.array([span[0] + x * (span[1] - span[0]) for x in shares]))
        given["t_eval"] = (times if span[0] <= span[1] else times[::-1]).tolist()
    if happens(choices, 30):
        given["ledger"] = True
    if "compensated" in RUN_DEFAULTS and happens(choices, 25):
        given["compensated"] = True
    return given


def events(choices: Choices, regime: str, n: int) -> list[Any]:
    """Return some events of a chain of n links; raises ValueError for values that are none."""
    return [_event(choices, regime, n) for _ in range(choices.one_of((1, 1, 2, 3)))]


def _event(choices: Choices, regime: str, n: int) -> Any:
    fx = pc.events
    common: dict[str, Any] = {"direction": choices.one_of((0, 0, 1, -1))}
    if happens(choices, 20):
        common["terminal"] = choices.one_of((True, 1, 2, 5))
    number = choices.integer(1, n)
    kind = choices.integer(0, 9)
    if kind <= 3:
        turning = fx.JointAngle if kind <= 1 else fx.LinkAngle
        every_turn = happens(choices, 30)
        return turning(number, angle(choices, regime), every_turn=every_turn, **common)
    if kind <= 6:
        return fx.RateZero(**{choices.one_of(("joint", "link")): number}, **common)
    if kind <= 8:
        point = (signed(choices, regime), signed(choices, regime))
        normal = (signed(choices, regime), size(choices, regime))
        return fx.TipLine(point, normal, **common)
    function = own_functions.Watched(choices.one_of(own_functions.WATCHED))
    return fx.Function(function, samples=choices.integer(1, 9), **common)


def drawn(choices: Choices) -> Drawn:
    """Return any case; raises ValueError where its parts do not agree."""
    how = regime(choices)
    times = span(choices, how)
    scene = drawn_scene.scene(choices, how, times)
    q0, qd0 = start(choices, how, scene)
    asked = options(choices, how, times)
    if happens(choices, 40):
        asked["events"] = events(choices, how, len(scene.links))
    if not all(abs(x) < inf for x in (*times, *q0, *qd0)):
        raise ValueError("the start is not finite")
    if any(hasattr(e, "coulomb") for e in scene.effects) and happens(choices, 95):
        times = (min(times), max(times))
        if "t_eval" in asked:
            asked["t_eval"] = sorted(asked["t_eval"])
    return Drawn(scene, q0, qd0, times, asked)
