"""Swing up.

A motor at the elbow alone swings two rods up: the elbow bends with the way in which
the arm moves.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc


def elbow(t, q, qd):
    bend, rate = q[1] - q[0], qd[1] - qd[0]
    torque = 40.0 * (1.1 * np.arctan(2 * qd[0]) - bend) - 4.0 * rate
    return [-torque, torque]


scene = pc.Scene.textbook().replace(effects=[pc.effects.User(elbow)])
sol = pc.simulate(scene, (0, 12), np.radians([95, 95]))
sol.to_video("swing_up.mp4")
sol.to_html("swing_up.html", title="Swing up")
