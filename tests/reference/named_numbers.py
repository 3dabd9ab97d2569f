"""The numbers of a run by the names that `simulate(sensitivities=...)` gives them."""

from __future__ import annotations

import itertools
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from reference.arithmetic import COMPLEX, Arithmetic
from reference.effects import Described, law
from reference.instant import Instant, PivotMotion
from reference.loads import Loads
from reference.newton_euler import Body
from reference.rig import Law, Rig

DEFAULTS = {"limit": math.inf, "air_density": 1.225, "stribeck_velocity": 0.1, "exponent": 2.0}
"""Parameters of effects that are not zero where nobody gives them."""


@dataclass(frozen=True, kw_only=True)
class Pushed(Law):
    """Torques in the joints, and an acceleration of the pivot, which begins at a time from rest."""

    torques: Sequence[Any]
    pivot_acceleration: tuple[Any, Any]
    since: Any

    def act(self, instant: Instant, loads: Loads) -> None:
        for joint, torque in enumerate(self.torques, 1):
            loads.couple_at_joint(joint, torque)

    def pivot(self, t: Any, arithmetic: Arithmetic) -> PivotMotion:
        x, y = self.pivot_acceleration
        after = t - self.since
        return PivotMotion(
            (x * after**2 / 2, y * after**2 / 2), (x * after, y * after), (x, y), abs(x) + abs(y)
        )


class Numbers:
    """All numbers of a run that have names, copied, so that some may be moved."""

    def __init__(
        self, bodies: Sequence[Body], gravity: float, described: Sequence[Described],
        y0: Sequence[float], arithmetic: Arithmetic = COMPLEX, begin: float = 0.0,
    ) -> None:  # fmt: skip
        number = self.number = arithmetic.number
        self.arithmetic, self.begin = arithmetic, number(begin)
        self.bodies: list[Any] = [list(map(number, body)) for body in bodies]
        self.gravity: Any = number(gravity)
        self.described: Any = [
            (kind, {k: dict(v) if isinstance(v, dict) else v for k, v in told.items()})
            for kind, told in described
        ]
        self.y: Any = np.array([number(x) for x in y0])
        self.torques: list[Any] = [number(0) for _ in bodies]
        self.pivot: list[Any] = [number(0), number(0)]

    def move(self, name: str, by: Any) -> None:
        """Add to what a name of `simulate(sensitivities=...)` means."""
        ((what, number, path),) = re.findall(r"^(\w+)(?:\[(\d+)\])?\.?(.*)", name)
        i = int(number or 0) - 1
        if what == "gravity":
            self.gravity += by
        elif what in {"q0", "qd0"}:
            self.y[i + len(self.bodies) * (what == "qd0")] += by
        elif what == "torque":
            self.torques[i] += by
        elif what == "pivot":
            self.pivot["xy".index(path)] += by
        elif what == "link":
            self.bodies[i][Body._fields.index(path)] += by
        else:
            self.move_parameter(self.described[i][1], path.split("."), by)

    def move_parameter(self, owner: Any, path: Sequence[str], by: Any) -> None:
        *parts, last = path
        if parts == ["wind"]:
            wind = map(self.number, owner.get("wind", (0.0, 0.0)))
            owner["wind"] = [x + by * (axis == last) for axis, x in zip("xy", wind, strict=True)]
            return
        for part in parts:
            owner = owner[part]
        start = owner.get(last)
        owner[last] = self.number(DEFAULTS.get(last, 0.0) if start is None else start) + by

    def rig(self, described: Sequence[Described] | None = None) -> Rig:
        """Return the rig of these numbers, with all effects or with some."""
        effects = [law(one) for one in (self.described if described is None else described)]
        if any(self.torques) or any(self.pivot):
            effects.append(
                Pushed(torques=self.torques, pivot_acceleration=(*self.pivot,), since=self.begin)
            )
        return Rig(bodies=[Body(*body) for body in self.bodies], gravity=self.gravity,
                   effects=effects, arithmetic=self.arithmetic)  # fmt: skip


def pieces(told: dict[str, Any]) -> Iterator[tuple[Any, dict[str, Any]]]:
    """The laws of a motor that has a table, one after another, and when each begins.

    They begin at the times of the table, and where its torque meets the limit.
    """
    limit, joint = told.get("limit", np.inf), told["joint"]
    points = zip(told["table"]["t"], told["table"]["torque"], strict=True)
    for (begin, a), (end, b) in itertools.pairwise(points):
        if told["table"].get("hold"):
            b = a
        line = {"table": {"t": (begin, end), "torque": (a, b)}}
        cuts = [begin, end]
        for meets in (limit, -limit):
            if min(a, b) < meets.real < max(a, b):
                cuts.append(begin + (meets - a) / (b - a) * (end - begin))
        cuts.sort(key=lambda t: t.real)
        for first, last in itertools.pairwise(cuts):
            middle = (first.real + last.real) / 2
            torque = a + (b - a) * (middle - begin) / (end - begin)
            is_cut = abs(torque) > limit.real
            yield (
                first,
                {"joint": joint, **({"constant": np.sign(torque) * limit} if is_cut else line)},
            )
