"""The comparison on stiff scenes: implicit methods, pendcore's and its peers'.

Two unit rods move for 5 s with a strong damper, a hard spring or a stiff controller in joint 2. The
references are in tests/data/stiff_trajectories.json; stiff_references.py made them.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import solves
from cases import Case
from contenders.equations import GRAVITY
from record import Record

REFERENCES = Path(__file__).parents[2] / "tests" / "data" / "stiff_trajectories.json"
START = np.array([0.8, 1.0, 0.0, 0.0])
TIMES = np.linspace(0.0, 5.0, 101)


@dataclass(frozen=True, slots=True)
class Load:
    """What acts in joint 2: stiffness, N m/rad, and damping, N m s/rad."""

    label: str
    stiffness: float
    damping: float
    tightest: float = 1e-9


LOADS = {
    "damper": Load("viscous joint, b/J = 1e6 1/s", 0.0, 1e6 / 3),
    # Below 1e-7 every method has to follow a vibration of 3e4 rad/s.
    "spring": Load("torsional spring, k = 1e8 N m/rad", 1e8, 0.0, tightest=1e-7),
    "controller": Load("PD controller, kp = 1e6, kd = 1e3", 1e6, 1e3),
}
TAKING_PART = ("radau5", "pendcore_dopri5", "cvode_bdf", "radau", "lsoda", "bdf")


def takes_part(name: str) -> bool:
    return any(part in name for part in TAKING_PART)


def scene(name: str) -> Case:
    """Make the case of that name, without its reference."""
    return Case(
        name=name,
        masses=(1.0, 1.0),
        lengths=(1.0, 1.0),
        gravity=GRAVITY,
        damping=(0.0, LOADS[name].damping),
        stiffness=(0.0, LOADS[name].stiffness),
        rest=(0.0, START[1] - START[0]),
        controller=name == "controller",
        start=START,
        times=TIMES,
        reference=np.tile(START, (len(TIMES), 1)),
        uncertainty=float("inf"),
    )


def read_scene(name: str) -> Case:
    """Make the case of that name with its reference."""
    known = json.loads(REFERENCES.read_text(encoding="utf-8"))[name]
    reference = np.array(known["states"], dtype=np.float64)
    return replace(scene(name), reference=reference, uncertainty=known["disagreement"])


def measure(*, quick: bool, rounds: int) -> Record:
    """Measure everything that is here."""
    how = {"quick": quick, "rounds": rounds, "takes_part": takes_part}
    found = [
        solves.measure(read_scene(name), **how, tightest=load.tightest, facts={"label": load.label})
        for name, load in LOADS.items()
    ]
    seconds = sum(one.measured["seconds_in_all"] for one in found)
    return Record.of(
        {**found[0].measured, "comparison": "stiff", "seconds_in_all": round(seconds, 1)},
        {name: facts for one in found for name, facts in one.contenders.items()},
        {name: facts for one in found for name, facts in one.cases.items()},
        [row for one in found for row in one.rows()],
    )
