"""An effect of your own: two wooden rods hang in water, which lifts them more than they weigh.

A Python function is the quick way to try a law, and slow: it is called at every right-hand side.
05_own_effect.cpp has the same function compiled, and says the same.
"""

from __future__ import annotations

from math import pi

import numpy as np
import pendcore as pc

RADIUS, LENGTH = 0.02, 0.5  # m
LIFT = 1000.0 * pi * RADIUS**2 * LENGTH * 9.807  # N on each rod: the water that it takes away
ARMS = LENGTH * np.array([1.5, 0.5])  # m: at joint 1 the lift of both, on link 2 its own


def buoyancy(t: float, q: np.ndarray, qd: np.ndarray) -> np.ndarray:
    """Generalised forces of the absolute angles, N m; y points down, so it turns upward."""
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
print(f"work of the water {work.user[-1]:.6f} J, lost in the joints {work.viscous[-1]:.6f} J")
