"""The cases of the handouts in the tests, and what they are handed out as."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pendcore as pc
from pendcore.derive.document import Document
from pendcore.derive.narration.page import Page
from pendcore.derive.report import bodies, motion, report, worksheet
from pendcore.derive.report.numbers import Start
from symbolic_scenes import derivation

effects = pc.effects
BUSY = pc.Case(
    scene=pc.Scene(
        links=[
            pc.Link(mass=1.2, length=0.5),
            pc.Link(mass=0.8, length=0.4, center=0.15, inertia=0.012),
            pc.Link(mass=0.5, length=0.3),
        ],
        gravity=9.81,
        effects=[
            effects.ViscousJoint(joint=2, damping=0.05),
            effects.Motor(joint=1, sinusoid=effects.Sinusoid(1.0, angular_frequency=6.0)),
            effects.TorsionalSpring(joint=3, stiffness=0.4, rest_angle=0.3),
            effects.Payload(mass=0.2, inertia=0.001),
        ],
    ),
    q0=np.radians([30.0, 75.0, 120.0]),
    t_span=(0, 2),
    name="busy arm",
)
LEVEL = pc.Case(scene=pc.Scene(links=[pc.Link(mass=2.0, length=0.5)]), q0=0.0, t_span=(0, 1))
AIRY = pc.Case(
    scene=pc.Scene(
        links=[pc.Link(mass=1.0, length=0.6), pc.Link(mass=0.5, length=0.4, center=0.1)],
        effects=[
            effects.RodDrag(link=2, drag_coefficient=1.2, diameter=0.03, wind=(4.0, 0.0)),
            effects.RotorInertia(joint=1, armature=0.01),
            effects.Lock(joint=2),
        ],
    ),
    q0=(0.3, 0.5),
    t_span=(0, 1),
)
SHAKEN = pc.Case(
    scene=pc.Scene(
        links=[pc.Link(mass=1.0, length=0.3)] * 4,
        effects=[effects.DrivenPivot(y=effects.Sinusoid(0.02, 80.0))],
    ),
    q0=(-1.4, -1.5, 0.2, 2.0),
    t_span=(0, 0.5),
    options={"method": "rk4", "step": 1e-3},
)
CASES = {
    "textbook": pc.Case.textbook(),
    "busy": BUSY,
    "level": LEVEL,
    "airy": AIRY,
    "shaken": SHAKEN,
}


@cache
def solved(case: pc.Case) -> pc.Solution:
    """The run of a case as its report has it."""
    return motion.solved(case)[0]


@cache
def reported(case: pc.Case) -> Document:
    """The report of a case."""
    return report(derivation(case.scene), case, solved(case))


@cache
def asked(case: pc.Case) -> Document:
    """The worksheet of a case."""
    return worksheet(derivation(case.scene), case, solved(case))


@cache
def at_start(case: pc.Case) -> list[tuple[str, str, float, float]]:
    """The rows of the report's table of the start: name, unit, what is derived, the core's."""
    return Start(derivation(case.scene), case).rows()


def drawn(what: str, scene: pc.Scene, q: Any) -> Any:
    """The figure of a scene: its mechanism or its free_bodies."""
    return getattr(bodies, what)(Page(derivation(scene)), q).figure
