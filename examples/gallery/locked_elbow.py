"""A locked elbow.

Two rods with their joint locked are one bent rod, which swings as regularly as any.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

lock = pc.effects.Lock(joint=2)
scene = pc.Scene.textbook()
start = np.radians([10, 80])
sol = pc.simulate(scene.replace(effects=[lock]), (0, 10), start)
free = pc.simulate(scene, (0, 10), start)
sol.to_video("locked_elbow.mp4", free, names=("locked", "free"))
sol.to_html("locked_elbow.html", title="A locked elbow")
