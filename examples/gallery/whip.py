"""A whip.

A tapered chain is swung and stopped at the handle: the wave that runs out is fastest
at the tip.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

count = 20
links = [pc.Link(mass=0.2 * 0.75**k, length=0.1) for k in range(count)]
torques = pc.effects.Table(
    t=[0.0, 0.3, 0.34, 0.5, 0.54, 1.0], torque=[6, 6, -14, -14, 0, 0]
)
hand = pc.effects.Motor(joint=1, table=torques)
damping = [pc.effects.ViscousJoint(joint=j, damping=1e-3) for j in range(1, count + 1)]
scene = pc.Scene(links=links, effects=[hand, *damping], gravity=0.0)
sol = pc.simulate(scene, (0, 1.0), np.pi, rtol=1e-6)
sol.to_video("whip.mp4", speed=0.15, trace=0.5)
sol.to_html("whip.html", title="A whip")
