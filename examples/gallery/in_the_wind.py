"""In the wind.

A light rod hangs from another in a steady wind of 9 m/s, and settles where drag and
weight balance.
"""

from __future__ import annotations

import numpy as np
import pendcore as pc

rods = [pc.Link(mass=0.2, length=0.8), pc.Link(mass=0.1, length=0.8)]
drag = [
    pc.effects.RodDrag(link=i, drag_coefficient=1.2, diameter=0.03, wind=(9.0, 0.0))
    for i in (1, 2)
]
scene = pc.Scene(links=rods, effects=drag)
sol = pc.simulate(scene, (0, 12), np.radians([90, 90]))
sol.to_video("in_the_wind.mp4")
sol.to_html("in_the_wind.html", title="In the wind")
