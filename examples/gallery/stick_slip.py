"""Stick and slip.

A torque that rises and falls slowly has to break the friction in the joint each time:
the rod sticks, slips, and sticks again.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

friction = pc.effects.DryJointFriction(
    joint=1, coulomb=0.7, static=1.4, stribeck_velocity=0.05
)
slow = pc.effects.Motor(
    joint=1, sinusoid=pc.effects.Sinusoid(amplitude=2.1, angular_frequency=0.9)
)
scene = pc.Scene(links=[pc.Link(mass=1.0, length=0.5)], effects=[slow, friction])
sol = pc.simulate(scene, (0, 14), np.radians(90))
sol.to_video("stick_slip.mp4")
sol.to_html("stick_slip.html", title="Stick and slip")
