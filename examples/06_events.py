"""When does it flip, and where is the motion chaotic: events along a run.

Link 2 turns over where its joint passes +-180 degrees: the first time ends the run. And
whenever link 1 hangs straight on its way to the right, link 2 has some angle and some
rate: a point of Poincare's section. At one energy, regular motions draw curves there
and chaotic ones fill areas.
"""

from __future__ import annotations

import matplotlib.pyplot as plt
import numpy as np
import pendcore as pc
from pendcore.plotting import sheet

scene = pc.Scene.textbook()
turns = (-np.pi, np.pi)
over = [pc.events.JointAngle(2, turn, terminal=True, name="over") for turn in turns]
for degrees in (90, 100, 110, 120):
    start = pc.angles_from_vertical(np.radians([degrees, degrees]))
    sol = pc.simulate(scene, (0, 100), start, events=over)
    flips = sol.status == "event"
    when = f"turns over at t = {sol.t[-1]:.6f} s" if flips else "does not turn over"
    print(f"from {degrees} degrees: {when}")

# J above hanging. With m = 1 and L = 1, T = 2/3 qd_1^2 where qd_2 = 0.
ENERGY = 0.7 * scene.gravity
section = pc.events.LinkAngle(1, np.pi / 2, every_turn=True, direction=-1)
plt.style.use(sheet())
figure, axis = plt.subplots(layout="constrained")
for degrees in (-55, -30, -10, 5, 20, 35, 50, 65):
    theta = np.radians([0, degrees])
    left = ENERGY - scene.gravity / 2 * (1 - np.cos(theta[1]))
    q0, qd0 = pc.angles_from_vertical(theta), [-np.sqrt(1.5 * left), 0]
    sol = pc.simulate(scene, (0, 4000), q0, qd0, store="end", events=[section])
    angles = pc.angles_to_vertical(np.array([found.q for found in sol.events[0]]))[:, 1]
    rates = np.array([found.qd[1] for found in sol.events[0]])
    axis.plot(np.degrees(angles), rates, ".", markersize=1.5)
    points = f"{len(rates)} points, up to {rates.max():.2f} rad/s"
    print(f"link 2 at {degrees:3} degrees: {points}")
axis.set(xlabel="angle of link 2 from the vertical (degrees)")
axis.set(ylabel="rate of link 2 (rad/s)")
axis.grid(True)
figure.savefig("section.png", dpi=150)
