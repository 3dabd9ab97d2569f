"""The numbers of a run by the names that `simulate(sensitivities=...)` gives them."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from reference.arithmetic import COMPLEX
from reference.effects import Described, law
from reference.newton_euler import Body
from reference.rig import Rig


class Numbers:
    """All numbers of a run that have names, copied, so that some may be moved."""

    def __init__(
        self, bodies: Sequence[Body], gravity: float, described: Sequence[Described],
        y0: Sequence[float],
    ) -> None:  # fmt: skip
        self.bodies: list[Any] = [list(body) for body in bodies]
        self.gravity: Any = gravity
        self.described: Any = [
            (kind, {k: dict(v) if isinstance(v, dict) else v for k, v in told.items()})
            for kind, told in described
        ]
        self.y: Any = np.array(y0, dtype=complex)

    def move(self, name: str, by: complex) -> None:
        """Add to what a name of `simulate(sensitivities=...)` means."""
        if name == "gravity":
            self.gravity += by
        elif start := re.fullmatch(r"(q0|qd0)\[(\d)\]", name):
            self.y[int(start[2]) - 1 + len(self.bodies) * (start[1] == "qd0")] += by
        elif link := re.fullmatch(r"link\[(\d)\]\.(\w+)", name):
            self.bodies[int(link[1]) - 1][Body._fields.index(link[2])] += by
        else:
            i, path = re.findall(r"effect\[(\d)\]\.(.+)", name)[0]
            *parts, last = path.split(".")
            owner: Any = self.described[int(i) - 1][1]
            for part in parts:
                owner = owner[part]
            owner[last] = (owner.get(last) or 0.0) + by

    def rig(self, described: Sequence[Described] | None = None) -> Rig:
        """Return the rig of these numbers, with all effects or with some."""
        effects = [law(one) for one in (self.described if described is None else described)]
        return Rig(bodies=[Body(*body) for body in self.bodies], gravity=self.gravity,
                   effects=effects, arithmetic=COMPLEX)  # fmt: skip


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
