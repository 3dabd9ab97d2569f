"""A clock.

Friction takes what a small kick gives: from a large swing and from a small one the
clock comes to the same swing, its limit cycle.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc


def kick(t, q, qd):
    return 0.12 * np.tanh(20 * qd)


effects = [pc.effects.User(kick), pc.effects.ViscousJoint(joint=1, damping=0.1)]
scene = pc.Scene(links=[pc.Link.point_mass(mass=1.0, length=0.994)], effects=effects)
sol, small = [pc.simulate(scene, (0, 60), np.radians(q0)) for q0 in (150, 92)]
sol.to_video("clock.mp4", small, speed=4.0, beside=True, names=("large", "small"))
sol.to_html("clock.html", title="A clock")
