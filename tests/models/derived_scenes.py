"""Scenes that can be derived in symbols, random states, and what the core says of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pendcore as pc
from pendcore import effects as fx

Floats = npt.NDArray[np.float64]
STATES = 12


def links(n: int, seed: int, uniform: bool = False) -> list[pc.Link]:
    """Links of random numbers, uniform rods or any."""
    rng = np.random.default_rng(seed)
    found = []
    for _ in range(n):
        mass, length = (float(x) for x in rng.uniform(0.4, 2.0, 2))
        own = {} if uniform else {
            "center": length * float(rng.uniform(0.2, 0.8)),
            "inertia": mass * length**2 * float(rng.uniform(0.05, 0.15)),
        }  # fmt: skip
        found.append(pc.Link(mass=mass, length=length, **own))
    return found


def smooth_effects(n: int) -> list[fx.Effect]:
    """Every kind that is smooth, but for locks."""
    return [
        fx.ViscousJoint(joint=1, damping=0.3, damping2=0.07, damping3=0.02),
        fx.RodDrag(link=n, drag_coefficient=1.2, diameter=0.05, wind=(2.0, -0.7)),
        fx.RodDrag(link=n, drag_coefficient=0.9, diameter=0.11, air_density=2.0),
        fx.TorsionalSpring(joint=n, stiffness=6.0, rest_angle=0.3),
        fx.TorsionalSpring(joint=n, stiffness=2.5),
        fx.Motor(joint=1, sinusoid=fx.Sinusoid(3.0, angular_frequency=2.0, phase=0.4)),
        fx.Motor(joint=n, pd=fx.PD(kp=5.0, kd=0.7, reference=0.9)),
        fx.Motor(joint=1, constant=-1.5),
        fx.RotorInertia(joint=n, armature=0.08),
        fx.DrivenPivot(x=fx.Sinusoid(0.1, 3.0), y=fx.Sinusoid(0.05, 7.0, phase=1.1)),
        fx.Payload(mass=0.6, inertia=0.02),
    ]


SCENES: dict[str, pc.Scene] = {"textbook": pc.Scene.textbook()}
for _n in (1, 2, 3):
    SCENES[f"rods_{_n}"] = pc.Scene(links=links(_n, _n, uniform=True), gravity=3.7)
    SCENES[f"links_{_n}"] = pc.Scene(links=links(_n, 10 + _n))
    SCENES[f"effects_{_n}"] = pc.Scene(links=links(_n, 20 + _n), effects=smooth_effects(_n))
SCENES["locked"] = pc.Scene(
    links=links(3, 30), effects=[fx.Lock(joint=2), fx.ViscousJoint(joint=1, damping=0.2)]
)
"""By names that every language allows."""


@dataclass(frozen=True)
class Known:
    """Values of the core for random states; links lie along the last axis, but for forces."""

    t: Floats
    q: Floats
    qd: Floats
    qdd: Floats
    forces: Floats
    energies: Floats


def known(scene: pc.Scene) -> Known:
    """Draw states, and ask the core."""
    n, rng = len(scene.links), np.random.default_rng(len(repr(scene)))
    t, q = rng.uniform(0.0, 5.0, STATES), rng.uniform(-4.0, 4.0, (STATES, n))
    qd = rng.uniform(-4.0, 4.0, (STATES, n))
    for effect in scene.effects:
        if effect.kind == "lock":
            qd[:, effect.joint - 1] = qd[:, effect.joint - 2]
    forces, energies = [], []
    for time, angles, rates in zip(t, q, qd, strict=True):
        at = pc.simulate(scene, q0=angles, qd0=rates, t_span=(time, time))
        forces.append(at.reactions()[0])
        energies.append([at.energy().kinetic[0], at.energy().potential[0]])
    return Known(t, q, qd, scene.accelerations(t, q, qd), np.array(forces), np.array(energies))
