"""Two rods with dry friction in both joints under a slow motor: each holds or slides.

What a joint does depends on what the other lets it: that is decided at every switch,
and a joint that sticks does not move at all. docs/background/hard_cases.md shows the
same scene in other programs.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from pendcore.plotting import sheet

hum = pc.effects.Sinusoid(amplitude=10.0, angular_frequency=1.0)
effects = [
    pc.effects.DryJointFriction(joint=1, coulomb=5.0),
    pc.effects.DryJointFriction(joint=2, coulomb=1.5),
    pc.effects.Motor(joint=1, sinusoid=hum),
]
scene = pc.Scene.textbook().replace(effects=effects)
sol = pc.simulate(scene, (0, 9), np.pi / 2, rtol=1e-11)

phid = np.diff(sol.qd, axis=1, prepend=0.0)  # of the joints: exactly 0 where they stick
rest = sol.t[(phid == 0).all(axis=1) & (abs(sol.t - 5.8) < 0.5)]
print(f"both joints rest from {rest[0]:.6f} s to {rest[-1]:.6f} s")
phi = sol.relative_angles()[-1] - [np.pi / 2, 0]  # from hanging
print(f"at 9 s: phi_1 = {phi[0]:.8f}, phi_2 = {phi[1]:.8f} rad")

plt.style.use(sheet())
figure, axes = plt.subplots(layout="constrained")
t = np.linspace(0, 9, 901)
q = sol(t)[:2]
axes.plot(t, np.degrees(q[0]) - 90, "k", label="joint 1, from hanging")
axes.plot(t, np.degrees(q[1] - q[0]), "k--", label="joint 2")
axes.axvspan(rest[0], rest[-1], color="0.85", label="both at rest")
axes.set(xlabel="t (s)", ylabel="angle (deg)", xlim=(0, 9))
axes.legend()
figure.savefig("stick_slip.png")
