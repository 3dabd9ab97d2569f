"""A golf swing.

A steady torque turns the arm; a stop holds the club back at the wrist until it swings
through.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

arm, club = pc.Link(mass=5.0, length=0.65), pc.Link(mass=0.4, length=1.1, center=0.75)
shoulder = pc.effects.Motor(joint=1, constant=-95.0)
wrist = pc.effects.JointStop(joint=2, range=(-np.radians(110), np.radians(110)))
scene = pc.Scene(links=[arm, club], effects=[shoulder, wrist])
sol = pc.simulate(scene, (0, 0.36), np.radians([300, 410]))
sol.to_video("golf_swing.mp4", speed=0.06, trace=0.3)
sol.to_html("golf_swing.html", title="A golf swing")
