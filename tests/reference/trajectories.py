"""The multiple-precision trajectories of tests/data/trajectories.json, as arrays of doubles."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
import pendcore as pc
from numpy.typing import NDArray

from reference.newton_euler import Body, uniform_rod

DATA = Path(__file__).parent.parent / "data" / "trajectories.json"

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Trajectory:
    """A chain of uniform rods and its motion; rows of ``q`` and ``qd`` belong to ``t``."""

    masses: Array
    lengths: Array
    gravity: float
    damping: Array
    q0: Array
    qd0: Array
    t: Array
    q: Array
    qd: Array

    @property
    def bodies(self) -> list[Body]:
        """The links as the reference takes them."""
        return [uniform_rod(m, length) for m, length in zip(self.masses, self.lengths, strict=True)]

    @property
    def scene(self) -> pc.Scene:
        """The same for the core."""
        links = [pc.Link(mass=body.mass, length=body.length) for body in self.bodies]
        dampers = [pc.effects.ViscousJoint(j, b) for j, b in enumerate(self.damping, 1) if b]
        return pc.Scene(links=links, gravity=self.gravity, effects=dampers)


@cache
def _cases() -> dict[str, dict[str, Any]]:
    cases: dict[str, dict[str, Any]] = json.loads(DATA.read_text(encoding="utf-8"))
    return cases


def trajectory(name: str) -> Trajectory:
    """Read the case of that name."""
    case = _cases()[name]
    arrays = {
        of: np.array(case[of], dtype=np.float64)
        for of in ("masses", "lengths", "q0", "qd0", "t", "q", "qd")
    }
    damping = np.array(case["viscous_joint"] or [0.0] * len(case["masses"]))
    return Trajectory(gravity=case["g"], damping=damping, **arrays)
