"""A case to solve: a chain of uniform rods, a start, a grid of times, and the known states there.

The reference is `tests/data/trajectories.json`. A program that is no contender integrated it in
multiple precision.
"""

from __future__ import annotations

import json
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import numpy.typing as npt

TESTS = Path(__file__).parents[2] / "tests"
sys.path += [str(TESTS), str(TESTS / "models")]  # references that share no code with the core
REFERENCES = TESTS / "data" / "trajectories.json"
Array = npt.NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """Masses (n,) are in kg, lengths (n,) in m, gravity in m/s^2; other units are rad, rad/s and s.

    The torque -stiffness (phi - rest) - damping dphi/dt, in N m, acts in joint j. It comes from a
    spring and a damper, or from a controller's motor. `start` (2n,) is q_1..q_n, qd_1..qd_n;
    `reference` (n_t, 2n) has the states at `times` (n_t,), known to `uncertainty` of the total
    length.
    """

    name: str
    masses: tuple[float, ...]
    lengths: tuple[float, ...]
    gravity: float
    damping: tuple[float, ...]
    stiffness: tuple[float, ...]
    rest: tuple[float, ...]
    controller: bool = False
    start: Array
    times: Array
    reference: Array
    uncertainty: float

    @property
    def n(self) -> int:
        return len(self.masses)

    @property
    def bare(self) -> bool:
        """Whether no torque acts in any joint, so that the energy is conserved."""
        return not any(self.damping) and not any(self.stiffness)


def read_case(name: str, path: Path = REFERENCES) -> Case:
    """Read the case of this name; every number is the double that the file's decimals read as."""
    known = json.loads(path.read_text(encoding="utf-8"))
    if name not in known:
        raise ValueError(f"case {name!r}: not in {path.name}, which has {', '.join(known)}")
    data = known[name]
    none = (0.0,) * len(data["masses"])
    return Case(
        name=name,
        masses=tuple(data["masses"]),
        lengths=tuple(data["lengths"]),
        gravity=data["g"],
        damping=tuple(data["viscous_joint"] or none),
        stiffness=none,
        rest=none,
        start=np.array([*data["q0"], *data["qd0"]], dtype=np.float64),
        times=np.array(data["t"], dtype=np.float64),
        reference=np.column_stack([np.array(data["q"], float), np.array(data["qd"], float)]),
        uncertainty=data["disagreement"],
    )


def one_step(case: Case, duration: float = 1e-4) -> Case:
    """Keep the start and shorten the interval to one step, to measure the fixed cost of a call."""
    times = case.times[0] + np.array([0.0, duration])
    return replace(
        case, name=f"{case.name}, one step", times=times, reference=np.tile(case.start, (2, 1))
    )
