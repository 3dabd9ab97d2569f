"""The multiple-precision trajectories of tests/data/trajectories.json, as arrays of doubles."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
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


@cache
def _cases() -> dict[str, dict[str, Any]]:
    cases: dict[str, dict[str, Any]] = json.loads(DATA.read_text(encoding="utf-8"))
    return cases


def names() -> list[str]:
    """Return the names of all cases."""
    return list(_cases())


def trajectory(name: str) -> Trajectory:
    """Read the case of that name."""
    case = _cases()[name]
    return Trajectory(
        masses=np.array(case["masses"]),
        lengths=np.array(case["lengths"]),
        gravity=case["g"],
        damping=np.array(case["viscous_joint"] or [0.0] * len(case["masses"])),
        q0=np.array(case["q0"]),
        qd0=np.array(case["qd0"]),
        t=np.array(case["t"]),
        q=np.array(case["q"], dtype=np.float64),
        qd=np.array(case["qd"], dtype=np.float64),
    )
