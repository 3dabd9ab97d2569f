"""Caught upside down.

A controller at the lower joint holds two rods upright against gravity after a push.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

hold = pc.effects.PD(kp=120.0, kd=18.0, reference=np.radians(-90))
stiff = pc.effects.PD(kp=60.0, kd=6.0, reference=0.0)
effects = [pc.effects.Motor(joint=1, pd=hold), pc.effects.Motor(joint=2, pd=stiff)]
scene = pc.Scene.textbook().replace(effects=effects)
sol = pc.simulate(scene, (0, 6), np.radians([-90, -90]), qd0=[6.0, -4.0])
sol.to_video("caught.mp4")
sol.to_html("caught.html", title="Caught upside down")
