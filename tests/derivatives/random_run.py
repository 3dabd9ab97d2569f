"""A random run, and what pendcore says of the derivatives of its end."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import pendcore as pc
from described_scenes import scene_of
from numpy.typing import NDArray
from reference.effects import Described
from reference.newton_euler import Body


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomRun:
    """A scene, a start, and by how much each name is changed."""

    bodies: list[Body]
    gravity: float
    described: list[Described]
    q0: list[float]
    qd0: list[float]
    t_end: float
    changes: dict[str, float]
    """A derivative is taken along all of them at once: one wrong entry spoils the sum."""

    @property
    def scene(self) -> pc.Scene:
        return scene_of(self.bodies, self.gravity, self.described)


def by_pendcore(case: RandomRun, **how: Any) -> tuple[NDArray[Any], NDArray[Any], str]:
    """Return the state, its derivative by each name, and what is said of those that are missing."""
    with warnings.catch_warnings(record=True) as told:
        warnings.simplefilter("always", pc.PendcoreWarning)
        sol = pc.simulate(case.scene, (0, case.t_end), case.q0, case.qd0, store="end",
                          sensitivities=list(case.changes), **how)  # fmt: skip
    why = " ".join(str(one.message) for one in told if "sensitivities" in str(one.message))
    return sol.y[:, -1], sol.sensitivities[-1], why
