"""A trapeze.

Somebody on a swing bends and stretches in time with it, and rises.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

rope, body = pc.Link(mass=2.0, length=3.0), pc.Link(mass=60.0, length=1.2)
pump = pc.effects.Sinusoid(amplitude=260.0, angular_frequency=1.55)
effects = [
    pc.effects.Motor(joint=2, sinusoid=pump),
    pc.effects.TorsionalSpring(joint=2, stiffness=400.0),
    pc.effects.ViscousJoint(joint=2, damping=60.0),
]
scene = pc.Scene(links=[rope, body], effects=effects)
sol = pc.simulate(scene, (0, 30), np.radians([90, 90]))
sol.to_video("trapeze.mp4", speed=2.0)
sol.to_html("trapeze.html", title="A trapeze")
