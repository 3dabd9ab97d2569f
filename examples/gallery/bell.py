"""A bell and its clapper.

The clapper hangs inside the bell, which is far heavier, and strikes it on both sides.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

bell = pc.Link(mass=300.0, length=0.5, center=0.42, inertia=10.0)
clapper = pc.Link(mass=9.0, length=0.7, center=0.6, inertia=0.4)
wall = pc.effects.JointStop(joint=2, range=np.radians([-22, 22]), restitution=0.3)
scene = pc.Scene(links=[bell, clapper], effects=[wall])
sol = pc.simulate(scene, (0, 8), np.radians([20, 35]))
sol.to_video("bell.mp4")
sol.to_html("bell.html", title="A bell and its clapper")
