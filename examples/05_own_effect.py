"""An effect of your own: two wooden rods in water, whose lift exceeds their weight.

A Python function is the quick way to try a law, and slow: it is called at every
right-hand side. 05_own_effect.cpp has the same function compiled, and says the same.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pendcore as pc

RADIUS, LENGTH = 0.02, 0.5  # m
LIFT = 1000.0 * pi * RADIUS**2 * LENGTH * 9.807  # N on each rod: the water it displaces
ARMS = LENGTH * np.array([1.5, 0.5])  # m: link 1 carries the lift of both


def buoyancy(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """Generalised forces of the absolute angles, N m; minus, because y points down."""
    return -LIFT * ARMS * np.cos(q)


wood = pc.Link(mass=0.4, length=LENGTH)
scene = pc.Scene(
    links=[wood, wood],
    effects=[
        pc.effects.User(buoyancy),
        pc.effects.ViscousJoint(joint=1, damping=0.1),
        pc.effects.ViscousJoint(joint=2, damping=0.1),
    ],
)
sol = pc.simulate(scene, (0, 30), [1.5, 1.5], ledger=True)

for i in range(2):
    print(f"q_{i + 1}(30) = {np.degrees(sol.q[-1, i]):.4f} deg")
work = sol.energy().ledger
water, joints = work.user[-1], work.viscous[-1]
print(f"work of the water {water:.6f} J, lost in the joints {joints:.6f} J")
