"""How hard the joints are pulled: two rods let go with both links horizontal.

At the first moment the pivot carries 2/7 of one rod's weight, and joint 2 presses
link 2 *down* with 1/14 of it. Swinging through, the pivot carries several times the
weight of both.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from pendcore.plotting import sheet

scene = pc.Scene.textbook()
weight = scene.links[0].mass * scene.gravity
sol = pc.simulate(scene, (0, 3), 0.0, t_eval=np.linspace(0, 3, 1001))

force = sol.reactions()  # (time, joint, x and y), N, on the link that begins there
print(f"at the start, in weights of one rod: F_01 = {force[0, 0] / weight}")
print(f"                                     F_12 = {force[0, 1] / weight}")

size = np.linalg.norm(force, axis=-1) / weight
for joint, k in enumerate(size.argmax(axis=0)):
    largest = f"{size[k, joint]:.2f} weights"
    print(f"joint {joint + 1}: largest at t = {sol.t[k]:.3f} s, {largest}")

plt.style.use(sheet())
figure, axis = plt.subplots(layout="constrained")
axis.plot(sol.t, size, label=["joint 1, pivot", "joint 2"])
axis.axhline(2, color="0.6", linestyle="--", label="pivot, hanging at rest")
axis.set(xlabel="t (s)", ylabel="force (weights of one rod)")
axis.margins(x=0)
axis.grid(True)
axis.legend()
figure.savefig("reactions.png")
