"""The comparison on stiff scenes: implicit methods, pendcore's and its peers'.

Two unit rods move for 5 s with a strong damper, a hard spring or a stiff controller in joint 2. The
references are in tests/data/stiff_trajectories.json; stiff_references.py made them.
"""

from __future__ import annotations

import json
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import solves
from cases import Case
from contenders.equations import GRAVITY
from machine import circumstances

REFERENCES = Path(__file__).parents[2] / "tests" / "data" / "stiff_trajectories.json"
START = np.array([0.8, 1.0, 0.0, 0.0])
TIMES = np.linspace(0.0, 5.0, 101)
TIGHTEST = {"spring": 1e-7}  # below, every method has to follow a vibration of 3e4 rad/s
LABELS = {
    "damper": "viscous joint, b/J = 1e6 1/s",
    "spring": "torsional spring, k = 1e8 N m/rad",
    "controller": "PD controller, kp = 1e6, kd = 1e3",
}
# The stiffness (N m/rad) and the damping (N m s/rad) in joint 2.
LOADS = {"damper": (0.0, 1e6 / 3), "spring": (1e8, 0.0), "controller": (1e6, 1e3)}
TAKING_PART = ("radau5", "pendcore_dopri5", "cvode_bdf", "radau", "lsoda", "bdf")


def takes_part(name: str) -> bool:
    return any(part in name for part in TAKING_PART)


def scene(name: str) -> Case:
    """Make the case of that name, without its reference."""
    stiffness, damping = LOADS[name]
    return Case(
        name=name,
        masses=(1.0, 1.0),
        lengths=(1.0, 1.0),
        gravity=GRAVITY,
        damping=(0.0, damping),
        stiffness=(0.0, stiffness),
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


def measure(*, quick: bool, rounds: int) -> solves.Record:
    """Measure everything that is here; return the record, with the machine, as JSON holds it."""
    begin = time.perf_counter()
    records = [
        solves.measure(
            read_scene(name),
            quick=quick,
            rounds=rounds,
            takes_part=takes_part,
            tightest=TIGHTEST.get(name, 1e-9),
        )
        for name in LOADS
    ]
    return {
        "comparison": "stiff",
        **circumstances(begin, rounds, solves.BURST_SECONDS),
        "scenes": [{**record, "label": LABELS[record["case"]]} for record in records],
    }
