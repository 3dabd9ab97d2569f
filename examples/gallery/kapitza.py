"""Kapitza's pendulum.

A pivot that is shaken fast holds a rod upside down (Kapitza, 1951).
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

shake = pc.effects.Sinusoid(amplitude=0.03, angular_frequency=150.0)
air = pc.effects.ViscousJoint(joint=1, damping=0.02)
rod = pc.Link(mass=0.3, length=0.4)
scene = pc.Scene(links=[rod], effects=[pc.effects.DrivenPivot(y=shake), air])
sol = pc.simulate(scene, (0, 8), np.radians(-50))  # -90 deg is upright
sol.to_video("kapitza.mp4", trace=1.0)
sol.to_html("kapitza.html", title="Kapitza's pendulum")
