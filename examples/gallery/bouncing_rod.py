"""A rod on its stop.

A rod falls on a stop, bounces ever lower, and lies still after infinitely many
impacts.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

stop = pc.effects.JointStop(joint=1, range=(-np.pi, np.radians(20)), restitution=0.7)
scene = pc.Scene(links=[pc.Link(mass=1.0, length=1.0)], effects=[stop])
sol = pc.simulate(scene, (0, 5), np.radians(-80), ledger=True)
sol.to_video("bouncing_rod.mp4", energy=True, trace=0.4)
sol.to_html("bouncing_rod.html", title="A rod on its stop")
