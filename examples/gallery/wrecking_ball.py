"""A wrecking ball.

A heavy ball on a cable, which hangs from a boom that a drive holds: the ball is a
payload.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

boom, cable = pc.Link(mass=800.0, length=6.0), pc.Link(mass=30.0, length=5.0)
hold = pc.effects.PD(kp=4e6, kd=6e5, reference=np.radians(-50))
effects = [pc.effects.Motor(joint=1, pd=hold), pc.effects.Payload(mass=1500.0)]
scene = pc.Scene(links=[boom, cable], effects=effects)
sol = pc.simulate(scene, (0, 16), np.radians([-50, 150]))
sol.to_video("wrecking_ball.mp4", speed=2.0)
sol.to_html("wrecking_ball.html", title="A wrecking ball")
