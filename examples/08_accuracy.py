"""Ask for an error, not a tolerance, and see what accuracy costs on your own scene."""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc

scene = pc.Scene(
    links=[pc.Link(mass=1.0, length=0.6), pc.Link(mass=0.5, length=0.4)],
    effects=[pc.effects.ViscousJoint(joint=1, damping=0.02)],
)
start = {"q0": [np.pi / 4, np.pi / 3], "t_span": (0, 10)}

sol = pc.simulate(scene, **start, error=1e-8)
print(sol.accuracy)
print(f"chosen: {sol.case().options}")

try:
    pc.simulate(scene, **start, error=1e-16)
except pc.AccuracyError as refusal:
    print(f"refused: {refusal}")

cost = pc.accuracy_cost(scene, **start, name="two rods with a damper", time_limit=5.0)
print(cost.sentence(1e-8))
figure, ax = plt.subplots(figsize=(7.6, 4.6), layout="constrained")
cost.plot(ax=ax)
figure.savefig("accuracy_cost.png")
