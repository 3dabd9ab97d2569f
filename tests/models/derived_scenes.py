"""Scenes that are derived in symbols, random states, and what the core says of both."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pendcore as pc
from pendcore import effects as fx
from symbolic_scenes import Floats, scene, states

STATES = 12


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


LOCKED = [fx.Lock(joint=2), fx.ViscousJoint(joint=1, damping=0.2)]
SCENES = {"textbook": pc.Scene.textbook()}
for _n in (1, 2, 3):
    SCENES[f"rods_{_n}"] = scene("none, uniform rods", _n, seed=1)
    SCENES[f"links_{_n}"] = scene("none", _n, seed=2)
    SCENES[f"effects_{_n}"] = scene("none", _n, seed=3).replace(effects=smooth_effects(_n))
SCENES["locked"] = scene("none", 3, seed=4).replace(effects=LOCKED)
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
    drawn = states(scene, seed=len(repr(scene)), count=STATES)
    t, q, qd = (np.array([getattr(one, name) for one in drawn]) for name in ("t", "q", "qd"))
    forces, energies = [], []
    for one in drawn:
        at = pc.simulate(scene, q0=one.q, qd0=one.qd, t_span=(one.t, one.t))
        forces.append(at.reactions()[0])
        energies.append([at.energy().kinetic[0], at.energy().potential[0]])
    return Known(t, q, qd, scene.accelerations(t, q, qd), np.array(forces), np.array(energies))
